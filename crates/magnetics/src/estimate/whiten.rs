//! The filter: takes the memory out of the residuals and, alike, out of the
//! columns, and adds what is left up to normal equations.
//!
//! The filter's gain depends on the noise alone, so that one covariance serves
//! the residual and every column.

use super::noise::{DRIFT, NoiseLevels, STATES, Transition};
use super::row::{Row, Station, UNKNOWNS};
use nalgebra::{SMatrix, SVector};

/// The residual (first) and the columns.
const SERIES: usize = 1 + UNKNOWNS;

/// Innovations beyond so many standard deviations have their variance raised:
/// large enough that Gaussian noise loses nothing worth naming.
const DOUBTED: f64 = 2.5;

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
    /// Sum of log variance over the innovations.
    pub(crate) log_variance: f64,
    /// How bx and by have drifted when the last row was taken.
    pub(crate) drift: Drift,
}

/// The drift of bx and by, nT, from the first row to the last, as far as the
/// rows tell.
#[derive(Clone, Copy, Debug)]
pub(crate) struct Drift {
    /// As estimated at the unknowns that the rows were taken at.
    pub(crate) nt: [f64; 2],
    /// How the estimate falls with each unknown.
    pub(crate) per_unknown: [[f64; UNKNOWNS]; 2],
    /// Covariance that is left, were the unknowns known.
    pub(crate) covariance: [[f64; 2]; 2],
}

/// What a whitened row measures.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub(crate) enum Measured {
    /// The deviation.
    Deviation,
    /// How gyro and satellite compass differ.
    Difference,
}

/// What a row came to.
#[derive(Clone, Copy, Debug)]
pub(crate) struct Whitened {
    /// The innovation in standard deviations.
    pub(crate) innovation: f64,
    /// Its weight, 0 to 1.
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
    turn_variance: f64,
}

/// One scalar that the filter takes in.
struct Scalar {
    /// The residual and its columns.
    series: [f64; SERIES],
    load: [f64; STATES],
    white: f64,
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
            turn_variance: levels.turn_deg.powi(2),
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
        for s in DRIFT..STATES {
            self.covariance[s][s] += self.drift_variance * t.drift_share;
        }
        if let Some(kick) = t.since_turn {
            for (i, a) in kick.iter().enumerate() {
                for (j, b) in kick.iter().enumerate() {
                    self.covariance[i][j] += self.turn_variance * a * b;
                }
            }
        }
    }

    /// Takes a scalar in; gives its innovations (residual first), their variance
    /// and the residual's weight.
    fn update(&mut self, scalar: &Scalar) -> ([f64; SERIES], f64, f64) {
        let mut innovation = scalar.series;
        let load = &scalar.load;
        let mut gain = [0.0; STATES];
        let mut variance = scalar.white;
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
        let weight = weight(innovation[0] / variance.sqrt());
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

    fn drift(&self) -> Drift {
        let states = [&self.series[DRIFT], &self.series[DRIFT + 1]];
        Drift {
            nt: states.map(|series| series[0]),
            per_unknown: states.map(|series| {
                let mut columns = [0.0; UNKNOWNS];
                columns.copy_from_slice(&series[1..]);
                columns
            }),
            covariance: [0, 1].map(|i| [0, 1].map(|j| self.covariance[DRIFT + i][DRIFT + j])),
        }
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

/// 1 up to [`DOUBTED`] standard deviations, then falling as 1/z²: the wilder an
/// innovation, the less it moves the fit.
pub(crate) fn weight(z: f64) -> f64 {
    let beyond = (z.abs() / DOUBTED).max(1.0);
    1.0 / (beyond * beyond)
}

/// The loss whose slope is twice the weighted innovation, but no more than at
/// [`GROSS`]: however wild a few rows are, the levels are for the others.
fn loss_of(z: f64) -> f64 {
    let size = z.abs().min(GROSS);
    if size <= DOUBTED {
        size * size
    } else {
        DOUBTED * DOUBTED * (1.0 + 2.0 * (size / DOUBTED).ln())
    }
}

/// Runs the filter over all rows; `each` sees every whitened row.
pub(crate) fn whiten(
    stations: &[Station],
    rows: &[Row],
    levels: &NoiseLevels,
    mut each: impl FnMut(usize, Measured, Whitened),
) -> Pass {
    let mut filter = Filter::new(levels);
    let mut sums = Sums::default();
    let white = levels.white_deg.powi(2);
    let difference_white = levels.difference_deg.powi(2);
    for (index, (station, row)) in stations.iter().zip(rows).enumerate() {
        filter.advance(&station.transition);
        if let Some(residual) = row.difference {
            let (columns, load) = station.difference(row);
            let scalar = Scalar {
                series: series_of(residual, &columns),
                load,
                white: difference_white * station.white_factor,
            };
            each(index, Measured::Difference, sums.take(&mut filter, &scalar));
        }
        let scalar = Scalar {
            series: series_of(row.residual, &row.columns),
            load: station.loads(row),
            white: white * station.white_factor,
        };
        each(index, Measured::Deviation, sums.take(&mut filter, &scalar));
    }
    Pass {
        information: SMatrix::from_fn(|i, j| sums.normal[i.max(j) + 1][i.min(j) + 1]),
        score: SVector::from_fn(|i, _| sums.normal[i + 1][0]),
        loss: sums.loss + sums.log_variance,
        log_variance: sums.log_variance,
        drift: filter.drift(),
    }
}

fn series_of(residual: f64, columns: &[f64; UNKNOWNS]) -> [f64; SERIES] {
    let mut series = [0.0; SERIES];
    series[0] = residual;
    series[1..].copy_from_slice(columns);
    series
}

/// What has been added up so far.
#[derive(Default)]
struct Sums {
    /// Products of the whitened series, the lower triangle.
    normal: [[f64; SERIES]; SERIES],
    loss: f64,
    log_variance: f64,
}

impl Sums {
    fn take(&mut self, filter: &mut Filter, scalar: &Scalar) -> Whitened {
        let (innovation, variance, weight) = filter.update(scalar);
        let deviation = variance.sqrt();
        let z = innovation[0] / deviation;
        self.loss += loss_of(z);
        self.log_variance += variance.ln();
        let per_variance = weight / variance;
        for (i, row) in self.normal.iter_mut().enumerate() {
            let scaled = innovation[i] * per_variance;
            for (sum, other) in row[..=i].iter_mut().zip(&innovation) {
                *sum += scaled * other;
            }
        }
        let mut columns = [0.0; UNKNOWNS];
        for (column, value) in columns.iter_mut().zip(&innovation[1..]) {
            *column = value / deviation;
        }
        Whitened {
            innovation: z,
            weight,
            columns,
        }
    }
}
