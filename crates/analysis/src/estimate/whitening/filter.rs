//! The filter: takes the memory out of the residuals and, alike, out of the
//! columns, and adds what is left up to normal equations.
//!
//! The filter's gain depends on the noise alone, so that one covariance serves
//! the residual and every column.

use crate::estimate::noise_process::{DRIFT, STATES, Transition, initial_variances};
use crate::estimate::products::Products;
use crate::estimate::robust_loss::{loss_of, weight_among_many};
use crate::estimate::rows::{Row, Station, UNKNOWNS};
use binnacle_compass::result::NoiseLevels;
use nalgebra::{SMatrix, SVector};

/// The residual (first), the columns, and a zero that makes their number even.
const SERIES: usize = (1 + UNKNOWNS).next_multiple_of(2);
/// The same but for the last column, that of what is left of the references' usual
/// difference: without pairs of references it is zero.
const OF_ONE_REFERENCE: usize = UNKNOWNS;

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

impl Drift {
    /// When the unknowns have moved by a step.
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

/// The state of the filter between rows.
struct Filter<const N: usize> {
    covariance: [[f64; STATES]; STATES],
    /// For each state its estimate in the residual and in every column.
    series: [[f64; N]; STATES],
    stationary: [f64; STATES],
    drift_variance: f64,
    turn_variance: f64,
}

/// One scalar that the filter takes in.
struct Scalar<const N: usize> {
    /// The residual and its columns.
    series: [f64; N],
    load: [f64; STATES],
    white: f64,
}

/// What a scalar came to.
struct Whitened<const N: usize> {
    /// Innovations, the residual's first.
    innovations: [f64; N],
    variance: f64,
    /// The residual's innovation over its standard deviation, squared.
    z_squared: f64,
    /// The scalar's weight, 0 to 1.
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

    /// Takes a scalar in.
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
        let told: f64 = gain.iter().zip(&scalar.load).map(|(g, l)| g * l).sum();
        let variance = scalar.white + told;
        let per_variance = 1.0 / variance;
        let z_squared = innovations[0] * innovations[0] * per_variance;
        let weight = weight_among_many(z_squared);
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

/// What [`advance_rows`] does, to the columns.
fn advance_columns(covariance: &mut [[f64; STATES]; STATES], t: &Transition) {
    let [[a, b], [c, d]] = t.schuler;
    for [swing, rate, slow @ .., _, _] in covariance {
        (*swing, *rate) = (a * *swing + b * *rate, c * *swing + d * *rate);
        for (value, decay) in slow.iter_mut().zip(t.decay) {
            *value *= decay;
        }
    }
}

/// The states that have a part in something, with their parts.
fn loaded(parts: &[f64; STATES]) -> impl Iterator<Item = (usize, f64)> {
    let parts = parts.iter().copied().enumerate();
    parts.filter(|(_, part)| *part != 0.0)
}

/// Runs the filter over all rows.
pub(crate) fn whiten(stations: &[Station], rows: &[Row], levels: &NoiseLevels) -> Pass {
    if stations.iter().any(Station::reads_both) {
        whiten_series::<SERIES>(stations, rows, levels)
    } else {
        whiten_series::<OF_ONE_REFERENCE>(stations, rows, levels)
    }
}

fn whiten_series<const N: usize>(stations: &[Station], rows: &[Row], levels: &NoiseLevels) -> Pass {
    let mut whitening = Whitening::<N>::new(levels);
    for (station, row) in stations.iter().zip(rows) {
        whitening.take(station, row);
    }
    whitening.pass()
}

/// A pass that goes on, row by row.
pub(crate) struct Whitening<const N: usize = SERIES> {
    filter: Filter<N>,
    white: f64,
    difference_white: f64,
    /// What has been added up since the last cut, and before it.
    sums: Sums<N>,
    before: Products<N>,
}

/// What some of the rows tell: their part of the normal equations.
pub(crate) struct Part {
    pub(crate) information: SMatrix<f64, UNKNOWNS, UNKNOWNS>,
    pub(crate) score: SVector<f64, UNKNOWNS>,
}

impl<const N: usize> Whitening<N> {
    /// Before the first row.
    pub(crate) fn new(levels: &NoiseLevels) -> Whitening<N> {
        Whitening {
            filter: Filter::new(levels),
            white: levels.white_deg.powi(2),
            difference_white: levels.difference_deg.powi(2),
            sums: Sums::new(),
            before: Products::new(),
        }
    }

    /// Takes the next row in; the weight of its residual, 0 to 1.
    pub(crate) fn take(&mut self, station: &Station, row: &Row) -> f64 {
        self.filter.advance(&station.transition);
        if let Some(residual) = row.difference {
            let (columns, load) = station.difference(row);
            let scalar = Scalar {
                series: series_of(residual, &columns),
                load,
                white: station.difference_white.variance(self.difference_white),
            };
            self.sums.take(&mut self.filter, &scalar);
        }
        let scalar = Scalar {
            series: series_of(row.residual, &row.columns),
            load: station.loads(row),
            white: station.white.variance(self.white),
        };
        self.sums.take(&mut self.filter, &scalar)
    }

    /// What the rows since the last cut tell.
    pub(crate) fn cut(&mut self) -> Part {
        let normal = std::mem::replace(&mut self.sums.normal, Products::new());
        self.before.add_all(&normal);
        part_of(&normal)
    }

    /// What all rows tell.
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

/// What has been added up so far.
struct Sums<const N: usize> {
    /// Products of the whitened series.
    normal: Products<N>,
    loss: f64,
    /// Sum of log variance, but for what is in `variances`.
    log_variance: f64,
    /// A product of variances: one logarithm serves many.
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

    fn take(&mut self, filter: &mut Filter<N>, scalar: &Scalar<N>) -> f64 {
        let whitened = filter.update(scalar);
        self.loss += loss_of(whitened.z_squared);
        self.variances *= whitened.variance;
        // Far from where the product would leave what a number can hold.
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
