//! Cramér–Rao bound on the deviation's variance, from the ship's true parameters, their
//! population, and the true covariance of the noise, turns and drift included, as a dense
//! matrix. Storms and wild readings are left out, so that no real voyage is quite so easy.

use super::{Faults, Variety, Voyage, needle, sail};
use binnacle_analysis::fit::Observation;
use binnacle_compass::angle::wrap_180;
use binnacle_compass::model::Parameters;
use nalgebra::{DMatrix, DVector, Matrix2, RowVector2, Vector2};
use std::f64::consts::TAU;

/// Headings at which the curve is judged.
pub(crate) const HEADINGS: usize = 36;
/// Minutes after which a swing has decayed.
const FORGOTTEN: usize = 1440;
/// Readings of a minute in one observation.
const MINUTES: usize = 10;
/// Length of an observation, minutes.
const WINDOW: i64 = 10;

/// Standard deviations over the generator's ships, the constant (compass and
/// gyro together) last.
fn population(faults: &Faults) -> [f64; 8] {
    let mut sd = [1500.0, 0.012, 1500.0, 0.006, 0.02, 0.008, 0.008, 0.0];
    for s in &mut sd[..7] {
        *s *= faults.ship;
    }
    sd[7] = 0.5_f64.hypot(faults.gyro_constant_deg);
    sd
}

/// Returns the bound on the variance of the curve in a field, averaged over headings, with
/// the gyro's constant counted to the curve.
pub(crate) fn bound(voyage: &Voyage, h_nt: f64, z_nt: f64) -> f64 {
    let left = covariance_of_parameters(voyage);
    let headings = (0..HEADINGS).map(|k| {
        let row = slopes(&voyage.truth.parameters, k as f64 * 10.0, h_nt, z_nt);
        let row = DVector::from_row_slice(&row);
        row.dot(&(&left * &row))
    });
    headings.sum::<f64>() / HEADINGS as f64
}

/// Returns the bound on the variance of the curve's shape, which is the curve less its mean
/// over the headings.
pub(crate) fn shape_bound(voyage: &Voyage, h_nt: f64, z_nt: f64) -> f64 {
    let left = covariance_of_parameters(voyage);
    let rows = DMatrix::from_fn(HEADINGS, 8, |k, j| {
        slopes(&voyage.truth.parameters, k as f64 * 10.0, h_nt, z_nt)[j]
    });
    let mean = rows.row_mean();
    let headings = rows.row_iter().map(|row| {
        let row = row - &mean;
        (&row * &left * row.transpose())[0]
    });
    headings.sum::<f64>() / HEADINGS as f64
}

fn covariance_of_parameters(voyage: &Voyage) -> DMatrix<f64> {
    let rows = &voyage.observations;
    let n = rows.len();
    let slopes: Vec<[f64; 8]> = rows
        .iter()
        .map(|o| {
            let magnetic = o.compass.degrees() + o.deviation.degrees_east();
            slopes(&voyage.truth.parameters, magnetic, o.h_nt, o.z_nt)
        })
        .collect();
    let mut noise = noise(voyage);
    noise += DMatrix::from_fn(n, n, |i, j| drift(voyage, i.min(j), i.max(j), &slopes));
    let x = DMatrix::from_fn(n, 8, |i, j| slopes[i][j]);
    let sd = population(&voyage.sizes);
    let mut information =
        DMatrix::from_diagonal(&DVector::from_iterator(8, sd.map(|s| 1.0 / (s * s))));
    information += x.transpose() * noise.cholesky().unwrap().solve(&x);
    information.cholesky().unwrap().inverse()
}

/// The true covariance of the noise in a voyage's deviations, drift aside.
pub(crate) fn noise(voyage: &Voyage) -> DMatrix<f64> {
    let rows = &voyage.observations;
    let swings = Swings::new(voyage);
    DMatrix::from_fn(rows.len(), rows.len(), |i, j| {
        let (i, j) = (i.min(j), i.max(j));
        swings.covariance(i, j) / (cos_lat(&rows[i]) * cos_lat(&rows[j]))
            + other_noise(&rows[i], &rows[j], &voyage.sizes)
    })
}

/// Slopes of the deviation, degrees, by the parameters and the constant, on a
/// magnetic heading.
fn slopes(p: &Parameters, magnetic_deg: f64, h_nt: f64, z_nt: f64) -> [f64; 8] {
    let p = p.to_array();
    let steps = [1.0, 1e-5, 1.0, 1e-5, 1e-5, 1e-5, 1e-5];
    let mut slopes = [1.0; 8];
    for j in 0..7 {
        let at = |off: f64| {
            let mut moved = p;
            moved[j] += off;
            needle(&Parameters::from_array(moved), magnetic_deg, h_nt, z_nt)
        };
        slopes[j] = wrap_180(at(-steps[j]) - at(steps[j])) / (2.0 * steps[j]);
    }
    slopes
}

fn cos_lat(o: &Observation) -> f64 {
    o.position.unwrap().lat_deg().to_radians().cos()
}

/// Returns the noise without swing and drift.
fn other_noise(a: &Observation, b: &Observation, sizes: &Faults) -> f64 {
    let seconds = b.time.unwrap().seconds_since(a.time.unwrap());
    let miles = seconds / 3600.0 * a.sog_kn.unwrap();
    let northerly = |o: &Observation| {
        let heading = o.compass.degrees() + o.deviation.degrees_east() + o.variation.degrees_east();
        let share = o.sog_kn.unwrap() / 902.5 / cos_lat(o);
        (share * heading.to_radians().cos()).to_degrees()
    };
    let slow = sizes.slow_gyro_deg.powi(2) * (-seconds / (3.0 * 86_400.0)).exp();
    // The compass's swing is a mean over ten minutes of a memory of twenty.
    let (swing, white) = if seconds == 0.0 {
        (
            0.852,
            (0.35_f64.powi(2) + 0.15_f64.powi(2)) / MINUTES as f64,
        )
    } else {
        (1.021 * (-seconds / 1200.0).exp(), 0.0)
    };
    let crust =
        sizes.variation_deg.powi(2) * (-miles / 60.0).exp() * 24e3 * 24e3 / (a.h_nt * b.h_nt);
    slow / (cos_lat(a) * cos_lat(b))
        + sizes.swing_deg.powi(2) * swing
        + crust
        + sizes.speed_error.powi(2) * northerly(a) * northerly(b)
        + white
}

/// bx and by walk at random, and their last values are estimated.
fn drift(voyage: &Voyage, i: usize, j: usize, slopes: &[[f64; 8]]) -> f64 {
    let last = voyage.observations.last().unwrap().time.unwrap();
    let later = voyage.observations[j].time.unwrap();
    let days = last.seconds_since(later) / 86_400.0;
    let variance = voyage.sizes.drift_nt.powi(2) * days / 30.0;
    variance * (slopes[i][0] * slopes[j][0] + slopes[i][2] * slopes[j][2])
}

/// The gyro's swing, stepped by the minute as the generator steps it, each turn
/// where it was.
struct Swings {
    /// Of each observation: its last minute.
    ends: Vec<i64>,
    /// Variance of its mean.
    variances: Vec<f64>,
    /// Covariance of its mean with the state at its last minute.
    with_end: Vec<Vector2<f64>>,
    /// A mean's part in the state so many minutes before its first: first row.
    later: Vec<RowVector2<f64>>,
}

/// Returns a minute of the gyro's swing and its rate, and the variances that come to both,
/// as one error, in every minute and at a turn.
pub(super) fn swing(schuler_deg: f64) -> (Matrix2<f64>, f64, f64) {
    let omega = TAU / 84.4;
    // rate' = (1 − 0.4 ω) rate − ω² swing; swing' = swing + rate'.
    let step = Matrix2::new(
        1.0 - omega * omega,
        1.0 - 0.4 * omega,
        -omega * omega,
        1.0 - 0.4 * omega,
    );
    let noise = schuler_deg.powi(2) * omega * omega * (4.0 * 0.2 * omega * 0.3);
    let kick = (1.2 * schuler_deg * omega).powi(2);
    (step, noise, kick)
}

impl Swings {
    fn new(voyage: &Voyage) -> Swings {
        let schuler = voyage.sizes.schuler_deg;
        let (step, noise, kick) = swing(schuler);
        let start = voyage.start;
        let ends: Vec<i64> = voyage
            .observations
            .iter()
            .map(|o| (o.time.unwrap().seconds_since(start) / 60.0).round() as i64)
            .collect();
        let minutes = ends.last().map_or(0, |last| last + 1);
        let mut of_minute = Vec::new();
        let mut covariance = Matrix2::new(schuler.powi(2), 0.0, 0.0, 0.0);
        let mut turns = voyage.turns.iter().peekable();
        for minute in 0..minutes {
            let mut new = noise;
            while turns.next_if(|&&turn| turn <= minute).is_some() {
                new += kick;
            }
            covariance = step * covariance * step.transpose() + Matrix2::from_element(new);
            of_minute.push(covariance);
        }
        let mut powers = vec![Matrix2::identity()];
        for k in 0..FORGOTTEN {
            powers.push(powers[k] * step);
        }
        let first = RowVector2::new(1.0, 0.0);
        let share = 1.0 / MINUTES as f64;
        let window = |end: i64| (end as usize + 1 - MINUTES)..=(end as usize);
        let mut variances = Vec::new();
        let mut with_end = Vec::new();
        for &end in &ends {
            let mut variance = 0.0;
            let mut with = Vector2::zeros();
            for m in window(end) {
                let at = of_minute[m].column(0).into_owned();
                with += powers[end as usize - m] * at * share;
                for k in window(end) {
                    let (earlier, later) = (m.min(k), m.max(k));
                    let lagged = powers[later - earlier] * of_minute[earlier].column(0);
                    variance += lagged[0] * share * share;
                }
            }
            variances.push(variance);
            with_end.push(with);
        }
        let later = (0..FORGOTTEN)
            .map(|k| {
                let mean: RowVector2<f64> = (0..MINUTES)
                    .filter_map(|m| powers.get(k + m))
                    .map(|power| first * power * share)
                    .sum();
                mean
            })
            .collect();
        Swings {
            ends,
            variances,
            with_end,
            later,
        }
    }

    fn covariance(&self, i: usize, j: usize) -> f64 {
        if i == j {
            return self.variances[i];
        }
        let minutes = self.ends[j] - self.ends[i] + 1 - WINDOW;
        let minutes = usize::try_from(minutes).unwrap_or(0);
        self.later
            .get(minutes)
            .map_or(0.0, |later| (later * self.with_end[i])[0])
    }
}

/// Returns a voyage without storms, for which the bound holds.
pub(crate) fn fair(seed: u64, variety: Variety, days: f64, faults: &Faults) -> Voyage {
    let faults = Faults {
        storms_per_month: 0.0,
        ..*faults
    };
    sail(seed, variety, days, &faults)
}
