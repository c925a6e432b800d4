//! Whitening filter: removes the correlation from the residuals and, alike, from the
//! columns, and adds them up to normal equations.
//!
//! The filter's gain depends on the noise alone, so that one covariance serves the residual
//! and every column.

use crate::estimate::noise_process::{DRIFT, STATES, Transition, initial_variances};
use crate::estimate::products::Products;
use crate::estimate::robust_loss::{batch_weight, robust_loss};
use crate::estimate::rows::{Row, RowFrame, UNKNOWNS};
use binnacle_compass::result::NoiseLevels;
use nalgebra::{SMatrix, SVector};

/// Number of series: the residual (first), the columns, and a zero that makes the number
/// even.
const SERIES: usize = (1 + UNKNOWNS).next_multiple_of(2);
/// Number of series without the last column, that of the references' residual difference:
/// without pairs of references it is zero.
const OF_ONE_REFERENCE: usize = UNKNOWNS;

/// Sums of one pass over the rows.
#[derive(Clone, Debug)]
pub(crate) struct Pass {
    /// XᵀV⁻¹X.
    pub(crate) information: SMatrix<f64, UNKNOWNS, UNKNOWNS>,
    /// XᵀV⁻¹r.
    pub(crate) score: SVector<f64, UNKNOWNS>,
    /// Sum of loss and log variance over the innovations: −2 log likelihood but for a
    /// constant.
    pub(crate) loss: f64,
    /// Drift of bx and by at the last row.
    pub(crate) drift: Drift,
}

/// Drift of bx and by from the first row to the last, nT.
#[derive(Clone, Copy, Debug)]
pub(crate) struct Drift {
    /// Estimate at the linearised unknowns.
    pub(crate) nt: [f64; 2],
    /// Negative slope of the estimate by each unknown.
    pub(crate) per_unknown: [[f64; UNKNOWNS]; 2],
    /// Covariance for known unknowns.
    pub(crate) covariance: [[f64; 2]; 2],
}

impl Drift {
    /// Returns the drift after a step of the unknowns.
    pub(crate) fn after(&self, step: &SVector<f64, UNKNOWNS>) -> Drift {
        let mut drift = *self;
        for (nt, per_unknown) in drift.nt.iter_mut().zip(&self.per_unknown) {
            *nt -= per_unknown
                .iter()
                .zip(step)
                .map(|(p, d)| p * d)
                .sum::<f64>();
        }
        drift
    }
}

/// State of the filter between rows.
struct Filter<const N: usize> {
    covariance: [[f64; STATES]; STATES],
    /// Estimate of each state in the residual and in every column.
    series: [[f64; N]; STATES],
    stationary: [f64; STATES],
    drift_variance: f64,
    turn_variance: f64,
}

/// A scalar for the filter.
struct Scalar<const N: usize> {
    /// Residual and columns.
    series: [f64; N],
    load: [f64; STATES],
    white: f64,
}

/// Result of a scalar.
struct Whitened<const N: usize> {
    /// Innovations, the residual's first.
    innovations: [f64; N],
    variance: f64,
    /// Squared innovation of the residual over its variance.
    z_squared: f64,
    /// Weight of the scalar, 0 to 1.
    weight: f64,
    /// Weight over variance.
    weight_per_variance: f64,
}

impl<const N: usize> Filter<N> {
    fn new(levels: &NoiseLevels) -> Filter<N> {
        let stationary = initial_variances(levels);
        let mut covariance = [[0.0; STATES]; STATES];
        for s in 0..STATES {
            covariance[s][s] = stationary[s];
        }
        Filter {
            covariance,
            series: [[0.0; N]; STATES],
            stationary,
            drift_variance: levels.drift_nt.powi(2),
            turn_variance: levels.turn_deg.powi(2),
        }
    }

    fn advance(&mut self, t: &Transition) {
        advance_rows(&mut self.series, t);
        advance_rows(&mut self.covariance, t);
        advance_columns(&mut self.covariance, t);
        // The variance that the stationary process lost returns as new noise.
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

    /// Updates the state with a scalar.
    fn update(&mut self, scalar: &Scalar<N>) -> Whitened<N> {
        let mut innovations = scalar.series;
        for (s, load) in loaded(&scalar.load) {
            for (value, state) in innovations.iter_mut().zip(&self.series[s]) {
                *value -= load * state;
            }
        }
        let mut gain = [0.0; STATES];
        for (s, load) in loaded(&scalar.load) {
            for (sum, covariance) in gain.iter_mut().zip(&self.covariance[s]) {
                *sum += load * covariance;
            }
        }
        let shown: f64 = gain.iter().zip(&scalar.load).map(|(g, l)| g * l).sum();
        let variance = scalar.white + shown;
        let per_variance = 1.0 / variance;
        let z_squared = innovations[0] * innovations[0] * per_variance;
        let weight = batch_weight(z_squared);
        let weight_per_variance = weight * per_variance;
        for (s, gain_of_s) in loaded(&gain) {
            let step = gain_of_s * weight_per_variance;
            for (state, value) in self.series[s].iter_mut().zip(&innovations) {
                *state += step * value;
            }
            for (covariance, other) in self.covariance[s].iter_mut().zip(&gain) {
                *covariance -= step * other;
            }
        }
        Whitened {
            innovations,
            variance,
            z_squared,
            weight,
            weight_per_variance,
        }
    }

    fn drift(&self) -> Drift {
        let states = [&self.series[DRIFT], &self.series[DRIFT + 1]];
        Drift {
            nt: states.map(|series| series[0]),
            per_unknown: states.map(columns_of),
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

/// Applies [`advance_rows`] to the columns.
fn advance_columns(covariance: &mut [[f64; STATES]; STATES], t: &Transition) {
    let [[a, b], [c, d]] = t.schuler;
    for [swing, rate, slow @ .., _, _] in covariance {
        (*swing, *rate) = (a * *swing + b * *rate, c * *swing + d * *rate);
        for (value, decay) in slow.iter_mut().zip(t.decay) {
            *value *= decay;
        }
    }
}

/// Returns the states with a part other than zero, and their parts.
fn loaded(parts: &[f64; STATES]) -> impl Iterator<Item = (usize, f64)> {
    let parts = parts.iter().copied().enumerate();
    parts.filter(|(_, part)| *part != 0.0)
}

/// Runs the filter over all rows.
pub(crate) fn whiten(frames: &[RowFrame], rows: &[Row], levels: &NoiseLevels) -> Pass {
    if frames.iter().any(RowFrame::reads_both) {
        whiten_series::<SERIES>(frames, rows, levels)
    } else {
        whiten_series::<OF_ONE_REFERENCE>(frames, rows, levels)
    }
}

fn whiten_series<const N: usize>(frames: &[RowFrame], rows: &[Row], levels: &NoiseLevels) -> Pass {
    let mut whitening = Whitening::<N>::new(levels);
    for (frame, row) in frames.iter().zip(rows) {
        whitening.observe(frame, row);
    }
    whitening.pass()
}

/// A pass in progress, row by row.
pub(crate) struct Whitening<const N: usize = SERIES> {
    filter: Filter<N>,
    white: f64,
    difference_white: f64,
    /// Sums since the last cut, and before it.
    sums: Sums<N>,
    before: Products<N>,
}

/// Part of the normal equations by some of the rows.
pub(crate) struct Part {
    pub(crate) information: SMatrix<f64, UNKNOWNS, UNKNOWNS>,
    pub(crate) score: SVector<f64, UNKNOWNS>,
}

impl<const N: usize> Whitening<N> {
    /// Makes a pass before the first row.
    pub(crate) fn new(levels: &NoiseLevels) -> Whitening<N> {
        Whitening {
            filter: Filter::new(levels),
            white: levels.white_deg.powi(2),
            difference_white: levels.difference_deg.powi(2),
            sums: Sums::new(),
            before: Products::new(),
        }
    }

    /// Reads the next row, and returns the weight of its residual, 0 to 1.
    pub(crate) fn observe(&mut self, frame: &RowFrame, row: &Row) -> f64 {
        self.filter.advance(&frame.transition);
        if let Some(residual) = row.difference {
            let (columns, load) = frame.difference(row);
            let scalar = Scalar {
                series: series_of(residual, &columns),
                load,
                white: frame.difference_white.variance(self.difference_white),
            };
            self.sums.add(&mut self.filter, &scalar);
        }
        let scalar = Scalar {
            series: series_of(row.residual, &row.columns),
            load: frame.loads(row),
            white: frame.white.variance(self.white),
        };
        self.sums.add(&mut self.filter, &scalar)
    }

    /// Returns the part of the rows since the last cut.
    pub(crate) fn cut(&mut self) -> Part {
        let normal = std::mem::replace(&mut self.sums.normal, Products::new());
        self.before.add_all(&normal);
        part_of(&normal)
    }

    /// Returns the sums of all rows.
    pub(crate) fn pass(mut self) -> Pass {
        self.cut();
        let Part { information, score } = part_of(&self.before);
        Pass {
            information,
            score,
            loss: self.sums.loss + self.sums.log_variance(),
            drift: self.filter.drift(),
        }
    }
}

fn part_of<const N: usize>(normal: &Products<N>) -> Part {
    let at = |i: usize, j: usize| {
        if i.max(j) < N { normal.at(i, j) } else { 0.0 }
    };
    Part {
        information: SMatrix::from_fn(|i, j| at(i + 1, j + 1)),
        score: SVector::from_fn(|i, _| at(i + 1, 0)),
    }
}

fn series_of<const N: usize>(residual: f64, columns: &[f64; UNKNOWNS]) -> [f64; N] {
    let mut series = [0.0; N];
    series[0] = residual;
    for (value, column) in series[1..].iter_mut().zip(columns) {
        *value = *column;
    }
    series
}

fn columns_of<const N: usize>(series: &[f64; N]) -> [f64; UNKNOWNS] {
    let mut columns = [0.0; UNKNOWNS];
    for (column, value) in columns.iter_mut().zip(&series[1..]) {
        *column = *value;
    }
    columns
}

/// Sums so far.
struct Sums<const N: usize> {
    /// Products of the whitened series.
    normal: Products<N>,
    loss: f64,
    /// Sum of log variance, without `variances`.
    log_variance: f64,
    /// Product of variances: one logarithm serves many.
    variances: f64,
}

impl<const N: usize> Sums<N> {
    fn new() -> Sums<N> {
        Sums {
            normal: Products::new(),
            loss: 0.0,
            log_variance: 0.0,
            variances: 1.0,
        }
    }

    fn add(&mut self, filter: &mut Filter<N>, scalar: &Scalar<N>) -> f64 {
        let whitened = filter.update(scalar);
        self.loss += robust_loss(whitened.z_squared);
        self.variances *= whitened.variance;
        // Well within the range of the product.
        if !(1e-100..1e100).contains(&self.variances) {
            self.log_variance += self.variances.ln();
            self.variances = 1.0;
        }
        let weight = whitened.weight_per_variance;
        self.normal.add(&whitened.innovations, weight);
        whitened.weight
    }

    fn log_variance(&self) -> f64 {
        self.log_variance + self.variances.ln()
    }
}
