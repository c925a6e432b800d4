//! Measurements in the filter's states.

use super::noise::NoiseVariances;
use super::states::{LASTING, OFFSET, OFFSET_UNKNOWN, SPEED, STATES};
use crate::estimate::{Row, RowFrame, Transition, UNKNOWNS, Unknowns};

/// One measurement: the deviation and, with both references, their difference.
pub(crate) struct Measurement {
    pub(crate) transition: Transition,
    pub(crate) seconds: f64,
    /// Variance of the drift of bx and by since the last measurement, population units.
    pub(crate) drift: f64,
    pub(crate) deviation: Scalar,
    pub(crate) difference: Option<Scalar>,
}

/// A scalar measurement, degrees.
pub(crate) struct Scalar {
    /// Measured value for zero states.
    pub(crate) value: f64,
    pub(crate) load: [f64; STATES],
    pub(crate) variance: f64,
}

/// Returns the measurement of `row` at `frame`; `extra_drift` is the variance of bx and
/// by beyond their usual drift in thirty days.
pub(crate) fn measurement(
    frame: &RowFrame,
    row: &Row,
    at: &Unknowns,
    seconds: f64,
    noise: &NoiseVariances,
    extra_drift: f64,
) -> Measurement {
    let scalar = |residual: f64, columns: &[f64; UNKNOWNS], loads: &[f64], variance: f64| {
        let mut load = [0.0; STATES];
        load[..=SPEED].copy_from_slice(&columns[..=SPEED]);
        load[OFFSET] = columns[OFFSET_UNKNOWN];
        load[LASTING..].copy_from_slice(&loads[..STATES - LASTING]);
        let known: f64 = columns.iter().zip(at).map(|(c, u)| c * u).sum();
        Scalar {
            value: residual + known,
            load,
            variance,
        }
    };
    Measurement {
        transition: frame.transition,
        seconds,
        drift: (noise.drift + extra_drift) * frame.transition.drift_share,
        deviation: scalar(
            row.residual,
            &row.columns,
            &frame.loads(row),
            frame.white.variance(noise.white),
        ),
        difference: row.difference.map(|residual| {
            let (columns, loads) = frame.difference(row);
            scalar(
                residual,
                &columns,
                &loads,
                frame.difference_white.variance(noise.difference_white),
            )
        }),
    }
}
