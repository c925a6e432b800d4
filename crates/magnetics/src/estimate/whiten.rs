//! The filter: takes the memory out of the residuals and, alike, out of the
//! columns, and adds what is left up to normal equations.
//!
//! The filter's gain depends on the noise alone, so that one covariance serves
//! the residual and every column.

use super::noise::{NoiseLevels, STATES, Transition};
use super::row::{Row, Station, UNKNOWNS, loads};
use nalgebra::{SMatrix, SVector};

/// The residual (first) and the columns.
const SERIES: usize = 1 + UNKNOWNS;

/// Innovations beyond so many standard deviations have their variance raised
/// (Huber): large enough that Gaussian noise loses nothing worth naming.
pub(crate) const HUBER: f64 = 2.5;

/// An innovation beyond this is no noise of the kind that levels describe.
const GROSS: f64 = 6.0;

/// What one pass over the rows adds up to.
#[derive(Clone, Debug)]
pub(crate) struct Pass {
    /// XᵀV⁻¹X.
    pub(crate) information: SMatrix<f64, UNKNOWNS, UNKNOWNS>,
    /// XᵀV⁻¹r.
    pub(crate) score: SVector<f64, UNKNOWNS>,
    /// Sum of loss and log variance over the innovations: −2 log
    /// likelihood but for a constant.
    pub(crate) loss: f64,
}

/// What a row came to.
#[derive(Clone, Copy, Debug)]
pub(crate) struct Whitened {
    /// The innovation in standard deviations.
    pub(crate) innovation: f64,
    /// Huber's weight, 0 to 1.
    pub(crate) weight: f64,
    /// The whitened columns.
    pub(crate) columns: [f64; UNKNOWNS],
}

/// The state of the filter between rows.
struct Filter {
    covariance: [[f64; STATES]; STATES],
    /// For each state its estimate in the residual and in every column.
    series: [[f64; SERIES]; STATES],
    stationary: [f64; STATES],
    drift_variance: f64,
}

impl Filter {
    fn new(levels: &NoiseLevels) -> Filter {
        let stationary = levels.initial_variances();
        let mut covariance = [[0.0; STATES]; STATES];
        for s in 0..STATES {
            covariance[s][s] = stationary[s];
        }
        Filter {
            covariance,
            series: [[0.0; SERIES]; STATES],
            stationary,
            drift_variance: levels.drift_nt.powi(2),
        }
    }

    fn advance(&mut self, t: &Transition) {
        advance_rows(&mut self.series, t);
        advance_rows(&mut self.covariance, t);
        self.covariance = transposed(&self.covariance);
        advance_rows(&mut self.covariance, t);
        // What the stationary process lost in the step comes in as new noise.
        let [[a, b], [c, d]] = t.schuler;
        let swing = self.stationary[0];
        let cross = -swing * (a * c + b * d);
        self.covariance[0][0] += swing * (1.0 - a * a - b * b);
        self.covariance[1][1] += swing * (1.0 - c * c - d * d);
        self.covariance[0][1] += cross;
        self.covariance[1][0] += cross;
        for (s, decay) in t.decay.iter().enumerate() {
            self.covariance[s + 2][s + 2] += self.stationary[s + 2] * (1.0 - decay * decay);
        }
        for s in 5..STATES {
            self.covariance[s][s] += self.drift_variance * t.drift_share;
        }
    }

    /// Takes a row in; gives its innovations (residual first), their variance
    /// and Huber's weight.
    fn update(&mut self, row: &Row, load: &[f64; STATES], white: f64) -> ([f64; SERIES], f64, f64) {
        let mut innovation = [0.0; SERIES];
        innovation[0] = row.residual;
        innovation[1..].copy_from_slice(&row.columns);
        let mut gain = [0.0; STATES];
        let mut variance = white;
        for s in 0..STATES {
            for (value, state) in innovation.iter_mut().zip(&self.series[s]) {
                *value -= load[s] * state;
            }
            gain[s] = self.covariance[s]
                .iter()
                .zip(load)
                .map(|(c, l)| c * l)
                .sum();
            variance += load[s] * gain[s];
        }
        let weight = huber_weight(innovation[0] / variance.sqrt());
        let raised = variance / weight;
        for s in 0..STATES {
            let step = gain[s] / raised;
            for (state, value) in self.series[s].iter_mut().zip(&innovation) {
                *state += step * value;
            }
            for (covariance, other) in self.covariance[s].iter_mut().zip(&gain) {
                *covariance -= step * other;
            }
        }
        (innovation, variance, weight)
    }
}

fn advance_rows<const N: usize>(rows: &mut [[f64; N]; STATES], t: &Transition) {
    let [[a, b], [c, d]] = t.schuler;
    let [swings, rates, slow @ .., _, _] = rows;
    for (swing, rate) in swings.iter_mut().zip(rates) {
        (*swing, *rate) = (a * *swing + b * *rate, c * *swing + d * *rate);
    }
    for (row, decay) in slow.iter_mut().zip(t.decay) {
        for value in row {
            *value *= decay;
        }
    }
}

fn transposed(m: &[[f64; STATES]; STATES]) -> [[f64; STATES]; STATES] {
    let mut out = [[0.0; STATES]; STATES];
    for (i, row) in m.iter().enumerate() {
        for (j, value) in row.iter().enumerate() {
            out[j][i] = *value;
        }
    }
    out
}

/// 1 up to [`HUBER`] standard deviations, then falling as 1/|z|.
pub(crate) fn huber_weight(z: f64) -> f64 {
    if z.abs() <= HUBER {
        1.0
    } else {
        HUBER / z.abs()
    }
}

/// Huber's loss (z² near zero, linear beyond), but no more than at
/// [`GROSS`]: however wild a few rows are, the levels are for the others.
fn loss_of(z: f64) -> f64 {
    let size = z.abs().min(GROSS);
    if size <= HUBER {
        size * size
    } else {
        2.0 * HUBER * size - HUBER * HUBER
    }
}

/// Runs the filter over all rows; `each` sees every whitened row.
pub(crate) fn whiten(
    stations: &[Station],
    rows: &[Row],
    levels: &NoiseLevels,
    mut each: impl FnMut(usize, Whitened),
) -> Pass {
    let mut filter = Filter::new(levels);
    let mut normal = [[0.0; SERIES]; SERIES];
    let mut loss = 0.0;
    let white_variance = levels.white_deg.powi(2);
    for (index, (station, row)) in stations.iter().zip(rows).enumerate() {
        filter.advance(&station.transition);
        let white = white_variance * station.white_factor;
        let (innovation, variance, weight) = filter.update(row, &loads(station, row), white);
        let deviation = variance.sqrt();
        let z = innovation[0] / deviation;
        loss += loss_of(z) + variance.ln();
        let per_variance = weight / variance;
        for i in 0..SERIES {
            let scaled = innovation[i] * per_variance;
            for j in 0..SERIES {
                normal[i][j] += scaled * innovation[j];
            }
        }
        let mut columns = [0.0; UNKNOWNS];
        for (column, value) in columns.iter_mut().zip(&innovation[1..]) {
            *column = value / deviation;
        }
        each(
            index,
            Whitened {
                innovation: z,
                weight,
                columns,
            },
        );
    }
    Pass {
        information: SMatrix::from_fn(|i, j| normal[i + 1][j + 1]),
        score: SVector::from_fn(|i, _| normal[i + 1][0]),
        loss,
    }
}
