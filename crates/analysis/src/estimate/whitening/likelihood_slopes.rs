//! Slopes of the likelihood by the noise levels: filters side by side over the same rows,
//! each with one level nudged.
//!
//! All filters share transitions and loads, so that one step of arithmetic serves them all.
//! Covariances are symmetric, and only their lower triangle is kept.

use crate::estimate::noise_process::{LEVELS, STATES, Transition, initial_variances};
use crate::estimate::products::Products;
use crate::estimate::robust_loss::{batch_weight, loss_slope};
use crate::estimate::rows::WhiteNoise;
use crate::estimate::rows::{Row, RowFrame, UNKNOWNS};
use binnacle_compass::result::NoiseLevels;

/// Nudge of a level's logarithm: far below what matters, far above rounding.
const NUDGE: f64 = 1e-4;
/// Number of filters side by side: that of the levels and one for each nudged level.
const FEW: usize = 8;
const MANY: usize = 10;

/// Slopes by the logarithms of the levels, in the order of [`NoiseLevels`].
#[derive(Clone, Debug)]
pub(crate) struct Slopes {
    /// Slopes of the loss, −2 log likelihood but for a constant.
    pub(crate) loss: [f64; LEVELS],
    /// Slopes of the sum of log variance.
    pub(crate) log_variance: [f64; LEVELS],
    /// Mean second slopes of the loss over data (twice Fisher's information).
    pub(crate) information: [[f64; LEVELS]; LEVELS],
}

/// Returns the slopes at `levels` by the `moved` ones; the others' are zero. `known` is
/// subtracted from the unknowns at which the rows were linearised.
pub(crate) fn slopes(
    frames: &[RowFrame],
    rows: &[Row],
    levels: &NoiseLevels,
    moved: &[usize],
    known: &[f64; UNKNOWNS],
) -> Slopes {
    if moved.len() < FEW {
        side_by_side::<FEW>(frames, rows, levels, moved, known)
    } else {
        side_by_side::<MANY>(frames, rows, levels, moved, known)
    }
}

fn side_by_side<const N: usize>(
    frames: &[RowFrame],
    rows: &[Row],
    levels: &NoiseLevels,
    moved: &[usize],
    known: &[f64; UNKNOWNS],
) -> Slopes {
    let mut nudged = [*levels; N];
    for (levels, &k) in nudged[1..].iter_mut().zip(moved) {
        let mut array = levels.to_array();
        array[k] *= NUDGE.exp();
        *levels = NoiseLevels::from_array(array);
    }
    let white = nudged.map(|levels| levels.white_deg.powi(2));
    let difference_white = nudged.map(|levels| levels.difference_deg.powi(2));
    let mut filters = Filters::new(&nudged);
    let mut sums = Sums::new();
    for (frame, row) in frames.iter().zip(rows) {
        filters.advance(&frame.transition);
        if let Some(residual) = row.difference {
            let (columns, load) = frame.difference(row);
            let value = residual - dot(&columns, known);
            sums.add(&filters.update(value, &load, &difference_white, frame.difference_white));
        }
        let value = row.residual - dot(&row.columns, known);
        sums.add(&filters.update(value, &frame.loads(row), &white, frame.white));
    }
    sums.by_level(moved)
}

fn dot(a: &[f64; UNKNOWNS], b: &[f64; UNKNOWNS]) -> f64 {
    a.iter().zip(b).map(|(a, b)| a * b).sum()
}

/// One number for each filter.
type Each<const N: usize> = [f64; N];

fn times_add<const N: usize>(sum: &mut Each<N>, factor: f64, of: &Each<N>) {
    for (sum, of) in sum.iter_mut().zip(of) {
        *sum += factor * of;
    }
}

struct Filters<const N: usize> {
    /// Covariance; the lower triangle only.
    covariance: [[Each<N>; STATES]; STATES],
    state: [Each<N>; STATES],
    stationary: [Each<N>; STATES],
    drift_variance: Each<N>,
    turn_variance: Each<N>,
}

/// Innovation and variance of each filter.
struct Innovation<const N: usize> {
    value: Each<N>,
    variance: Each<N>,
}

impl<const N: usize> Filters<N> {
    fn new(levels: &[NoiseLevels; N]) -> Filters<N> {
        let initial = levels.map(|levels| initial_variances(&levels));
        let mut covariance = [[[0.0; N]; STATES]; STATES];
        let mut stationary = [[0.0; N]; STATES];
        for s in 0..STATES {
            stationary[s] = initial.map(|of_states| of_states[s]);
            covariance[s][s] = stationary[s];
        }
        Filters {
            covariance,
            state: [[0.0; N]; STATES],
            stationary,
            drift_variance: levels.map(|levels| levels.drift_nt.powi(2)),
            turn_variance: levels.map(|levels| levels.turn_deg.powi(2)),
        }
    }

    fn advance(&mut self, t: &Transition) {
        let [[a, b], [c, d]] = t.schuler;
        let turn = |swing: &mut Each<N>, rate: &mut Each<N>| {
            for (swing, rate) in swing.iter_mut().zip(rate) {
                (*swing, *rate) = (a * *swing + b * *rate, c * *swing + d * *rate);
            }
        };
        let [swing, rate, slow @ .., _, _] = &mut self.state;
        turn(swing, rate);
        for (state, decay) in slow.iter_mut().zip(t.decay) {
            *state = state.map(|value| value * decay);
        }
        let [swings, rates, others @ ..] = &mut self.covariance;
        for n in 0..N {
            let (p, q, r) = (swings[0][n], rates[0][n], rates[1][n]);
            // The variance that the stationary process lost returns as new noise.
            let lasting = self.stationary[0][n];
            let (p, r) = (p - lasting, r - lasting);
            swings[0][n] = a * a * p + 2.0 * a * b * q + b * b * r + lasting;
            rates[0][n] = a * c * p + (a * d + b * c) * q + b * d * r;
            rates[1][n] = c * c * p + 2.0 * c * d * q + d * d * r + lasting;
        }
        for (i, row) in others.iter_mut().enumerate() {
            let [swing, rate, others @ ..] = row;
            turn(swing, rate);
            for (cell, decay) in others[..=i].iter_mut().zip(t.decay) {
                *cell = cell.map(|value| value * decay);
            }
            let Some(decay) = t.decay.get(i) else {
                times_add(&mut others[i], t.drift_share, &self.drift_variance);
                continue;
            };
            for cell in &mut row[..=i + 2] {
                *cell = cell.map(|value| value * decay);
            }
            let lost = 1.0 - decay * decay;
            times_add(&mut row[i + 2], lost, &self.stationary[i + 2]);
        }
        if let Some([swing, rate]) = t.since_turn {
            let turned = &self.turn_variance;
            times_add(&mut self.covariance[0][0], swing * swing, turned);
            times_add(&mut self.covariance[1][0], swing * rate, turned);
            times_add(&mut self.covariance[1][1], rate * rate, turned);
        }
    }

    fn update(
        &mut self,
        measured: f64,
        load: &[f64; STATES],
        levels_squared: &Each<N>,
        white: WhiteNoise,
    ) -> Innovation<N> {
        let mut value = [measured; N];
        for (state, &load) in self.state.iter().zip(load) {
            times_add(&mut value, -load, state);
        }
        let mut gain = [[0.0; N]; STATES];
        for (t, gain) in gain.iter_mut().enumerate() {
            let mut sum = [0.0; N];
            for (s, &load) in load.iter().enumerate() {
                if load != 0.0 {
                    times_add(&mut sum, load, &self.covariance[s.max(t)][s.min(t)]);
                }
            }
            *gain = sum;
        }
        let mut variance = levels_squared.map(|level| white.variance(level));
        for (gain, load) in gain.iter().zip(load) {
            times_add(&mut variance, *load, gain);
        }
        let mut per_variance = variance.map(f64::recip);
        for (per_variance, value) in per_variance.iter_mut().zip(&value) {
            *per_variance *= batch_weight(value * value * *per_variance);
        }
        for (s, row) in self.covariance.iter_mut().enumerate() {
            // A state without a part in any measurement stays as it is.
            if gain[s][0] == 0.0 {
                continue;
            }
            let mut step = gain[s];
            for (step, per_variance) in step.iter_mut().zip(&per_variance) {
                *step *= per_variance;
            }
            let state = self.state[s].iter_mut();
            for ((state, step), value) in state.zip(&step).zip(&value) {
                *state += step * value;
            }
            for (cell, gain) in row[..=s].iter_mut().zip(&gain) {
                for ((cell, step), gain) in cell.iter_mut().zip(&step).zip(gain) {
                    *cell -= step * gain;
                }
            }
        }
        Innovation { value, variance }
    }
}

/// Sums over the innovations by filter; the first is of the levels themselves.
struct Sums<const N: usize> {
    loss: Each<N>,
    log_variance: Each<N>,
    information: Products<N>,
}

impl<const N: usize> Sums<N> {
    fn new() -> Sums<N> {
        Sums {
            loss: [0.0; N],
            log_variance: [0.0; N],
            information: Products::new(),
        }
    }

    fn add(&mut self, innovation: &Innovation<N>) {
        let (value, variance) = (innovation.value[0], innovation.variance[0]);
        let per_variance = variance.recip();
        let z_squared = value * value * per_variance;
        let slope = loss_slope(z_squared);
        let per_nudge = NUDGE.recip();
        let by_variance = innovation
            .variance
            .map(|nudged| (nudged - variance) * (per_variance * per_nudge));
        let by_value = innovation.value.map(|nudged| (nudged - value) * per_nudge);
        for n in 0..N {
            self.log_variance[n] += by_variance[n];
            let of_square = 2.0 * value * per_variance * by_value[n] - z_squared * by_variance[n];
            self.loss[n] += by_variance[n] + slope * of_square;
        }
        self.information.add(&by_variance, 1.0);
        self.information.add(&by_value, 2.0 * slope * per_variance);
    }

    fn by_level(&self, moved: &[usize]) -> Slopes {
        let mut slopes = Slopes {
            loss: [0.0; LEVELS],
            log_variance: [0.0; LEVELS],
            information: [[0.0; LEVELS]; LEVELS],
        };
        for (a, &k) in moved.iter().enumerate() {
            slopes.loss[k] = self.loss[a + 1];
            slopes.log_variance[k] = self.log_variance[a + 1];
            for (b, &l) in moved.iter().enumerate() {
                slopes.information[k][l] = self.information.at(a + 1, b + 1);
            }
        }
        slopes
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::estimate::rows::{LinearisationPoint, frames, row};
    use crate::estimate::whitening::whiten;
    use crate::observation::Observation;
    use binnacle_compass::angle::{CompassHeading, Deviation, Variation};
    use binnacle_compass::time::Timestamp;

    /// Observations with turns, a satellite compass and a wild reading.
    fn observations() -> Vec<Observation> {
        (0..200_i32)
            .map(|k| {
                let hour = f64::from(k) / 6.0;
                let time = Timestamp::from_micros(1_700_000_000_000_000).unwrap();
                let wild = if k == 77 { 30.0 } else { 0.0 };
                Observation {
                    time: Some(time.plus_seconds(600.0 * f64::from(k))),
                    position: None,
                    compass: CompassHeading::new(f64::from(k / 10 * 40)).unwrap(),
                    deviation: Deviation::new(wild + (1.3 * hour).sin() + 0.2 * (9.0 * hour).cos())
                        .unwrap(),
                    variation: Variation::new(-3.0).unwrap(),
                    h_nt: 20_000.0,
                    z_nt: 40_000.0,
                    gyro_share: 0.7,
                    gyro_less_satellite_deg: (k % 3 != 0).then(|| 0.4 * (5.0 * hour).sin()),
                    sog_kn: Some(12.0),
                    windows: 50,
                    spread_deg: None,
                    weight: 1.0,
                }
            })
            .collect()
    }

    #[test]
    fn the_slopes_are_those_of_the_loss() {
        let observations = observations();
        let frames = frames(&observations);
        let at = LinearisationPoint::at(&[0.1; UNKNOWNS], 0.7);
        let rows: Vec<Row> = observations
            .iter()
            .zip(&frames)
            .map(|(o, s)| row(o, s, &at))
            .collect();
        let levels = NoiseLevels::TYPICAL;
        let all: Vec<usize> = (0..LEVELS).collect();
        let none = [0.0; UNKNOWNS];
        let found = slopes(&frames, &rows, &levels, &all, &none);
        let level_sample = slopes(&frames, &rows, &levels, &all[..7], &none);
        for k in 0..LEVELS {
            let loss = |nudge: f64| {
                let mut moved = levels.to_array();
                moved[k] *= nudge.exp();
                whiten(&frames, &rows, &NoiseLevels::from_array(moved)).loss
            };
            let slope = (loss(1e-4) - loss(-1e-4)) / 2e-4;
            assert!(
                (found.loss[k] - slope).abs() < 0.02 + 1e-3 * slope.abs(),
                "{k}: {slope} {found:?}"
            );
            assert!(found.information[k][k] > 0.0, "{k}");
            if k < 7 {
                assert!(
                    (level_sample.loss[k] - found.loss[k]).abs() < 1e-6 * slope.abs().max(1.0),
                    "{k}"
                );
            }
        }
    }
}
