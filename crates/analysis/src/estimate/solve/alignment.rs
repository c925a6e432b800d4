//! Compass mounted turned: the place of its zero on the circle, from the data.
//!
//! Most compasses are bolted down within a degree or two of the keel, but a sensor may be
//! mounted on its side, backwards, or behind a wrong offset. The fit linearises about small
//! angles, and its prior has the ship's iron lie about her own axes. So a turned compass is
//! turned back first, fitted as any other, and its model turned again (docs/science.md, eq.
//! 17). The two explanations are weighed as two components of one prior on the constant:
//! about straight, with a heavy tail, and anywhere on the circle.

use super::start::{RobustStart, start};
use crate::estimate::prior::{Prior, constant_density};
use crate::estimate::rows::{CONSTANT, UNKNOWNS, frames};
use crate::estimate::undated_rows::{design_effect, heading_cell};
use crate::observation::Observation;
use binnacle_compass::angle::{CompassHeading, Deviation, wrap_180};
use binnacle_compass::model::Parameters;
use binnacle_compass::ship::PARAMETERS;
use nalgebra::{SMatrix, SVector};
use std::collections::BTreeMap;
use std::f64::consts::TAU;

/// Shares of compasses bolted down with care, by eye, and at any angle (a sensor on its side,
/// a wrong offset): of recorded installations, zeros of −3.6°, 3.6° and −27.8° are known.
const STRAIGHT_SHARE: f64 = 0.80;
const ASKEW_SHARE: f64 = 0.17;
const TURNED_SHARE: f64 = 0.03;
/// Standard deviation of a zero by eye, degrees.
const ASKEW_SD_DEG: f64 = 4.0;
/// Standard deviation of an even distribution over the circle, degrees: 360/√12.
const ANY_ANGLE_SD_DEG: f64 = 103.923;
/// Number of rows that show the zero to a fraction of a degree.
const ENOUGH_ROWS: usize = 400;
/// Number of rows among which the first guess is chosen.
const ENOUGH_GUESSES: usize = 100;
/// Angle between starts: from the nearest, half of it away, the iteration settles.
const START_STEP_DEG: f64 = 30.0;
const STARTS: u32 = 12;
/// Residual of a start that no other can better: sound instruments leave less.
const SOUND_DEG: f64 = 1.0;
/// Number of refinements about the found zero.
const REFINEMENTS: u32 = 2;
/// Steps of the average over the zero's distribution, to either side, and their length in
/// standard deviations.
const AVERAGE_STEPS: i32 = 20;
const AVERAGE_STEP_SD: f64 = 0.2;

/// Rotation of a compass against its prior.
#[derive(Clone, Copy, Debug, PartialEq)]
pub(crate) struct Turn {
    /// Angle by which readings are to be increased, degrees.
    pub(crate) by_deg: f64,
}

/// The zero by the data and the prior of the ship, with any zero taken for as likely.
struct Zero {
    /// Angle beyond the prior's constant, degrees.
    by_deg: f64,
    /// Its standard error, degrees.
    sd_deg: f64,
}

impl Turn {
    /// Finds the rotation of a compass from observations in any order; none where it is
    /// mounted as the prior has it.
    pub(crate) fn find(observations: &[Observation], prior: &Prior) -> Option<Turn> {
        let rows = thinned(observations);
        let zero = find_zero(&rows, &prior.with_any_constant(ANY_ANGLE_SD_DEG))?;
        let straight = average_density(&zero, |off_deg| constant_density(prior, off_deg));
        let askew = average_density(&zero, askew_density);
        let turned = ASKEW_SHARE * askew + TURNED_SHARE / 360.0;
        let is_turned = turned > STRAIGHT_SHARE * straight;
        is_turned.then_some(Turn {
            by_deg: zero.by_deg,
        })
    }

    /// Returns the observations of the compass as if it were mounted straight.
    pub(crate) fn straighten(self, observations: &[Observation]) -> Vec<Observation> {
        let straight = |o: &Observation| {
            let compass = CompassHeading::new(o.compass.degrees() + self.by_deg);
            let deviation = Deviation::new(o.deviation.degrees_east() - self.by_deg);
            Observation {
                // Finite angles moved by a finite angle.
                compass: compass.unwrap_or(o.compass),
                deviation: deviation.unwrap_or(o.deviation),
                ..*o
            }
        };
        observations.iter().map(straight).collect()
    }

    /// Returns the prior with any angle for the constant.
    pub(crate) fn prior(prior: &Prior) -> Prior {
        prior.with_any_constant(ANY_ANGLE_SD_DEG)
    }

    /// Returns parameters of the straightened compass as those of the compass as mounted.
    pub(crate) fn parameters(self, straight: &Parameters) -> Parameters {
        straight.with_compass_turned(-self.by_deg.to_radians())
    }

    /// Returns the constant of the compass as mounted.
    pub(crate) fn constant_deg(self, straight_deg: f64) -> f64 {
        wrap_180(straight_deg + self.by_deg)
    }

    /// Returns the matrix that takes parameters and constant of the straightened compass to
    /// those of the compass as mounted, all in units of `scale`.
    pub(crate) fn matrix(self, scale: &[f64; 8]) -> SMatrix<f64, 8, 8> {
        let mut matrix = SMatrix::identity();
        for j in 0..PARAMETERS {
            let mut unit = [0.0; PARAMETERS];
            unit[j] = scale[j];
            let column = self.parameters(&Parameters::from_array(unit)).to_array();
            for (i, value) in column.into_iter().enumerate() {
                matrix[(i, j)] = value / scale[i];
            }
        }
        matrix
    }
}

/// Returns enough of the observations, the same ones whatever their order.
fn thinned(observations: &[Observation]) -> Vec<Observation> {
    let mut sorted: Vec<&Observation> = observations.iter().collect();
    sorted.sort_by(|a, b| {
        let angles = |o: &Observation| [o.compass.degrees(), o.deviation.degrees_east()];
        let ([a_compass, a_deviation], [b_compass, b_deviation]) = (angles(a), angles(b));
        (a.time.cmp(&b.time))
            .then(a_compass.total_cmp(&b_compass))
            .then(a_deviation.total_cmp(&b_deviation))
    });
    let every = sorted.len().div_ceil(ENOUGH_ROWS).max(1);
    sorted.into_iter().step_by(every).copied().collect()
}

/// Finds the zero by robust fits from all over the circle.
fn find_zero(rows: &[Observation], prior: &Prior) -> Option<Zero> {
    let (mean, information) = prior.in_population_units()?;
    let guess = middle_deviation(rows)? - mean[CONSTANT];
    let mut prior_mean = [0.0; UNKNOWNS];
    prior_mean[..=CONSTANT].copy_from_slice(&mean);
    let mut prior_information = SMatrix::<f64, UNKNOWNS, UNKNOWNS>::identity();
    prior_information
        .fixed_view_mut::<8, 8>(0, 0)
        .copy_from(&information);
    let fit = |by_deg: f64| {
        let straight = Turn { by_deg }.straighten(rows);
        let frames = frames(&straight);
        start(&straight, &frames, &prior_mean, &prior_information)
    };

    let mut by_deg = guess;
    let mut best = fit(by_deg);
    for k in 1..STARTS {
        if best.sd_deg < SOUND_DEG {
            break;
        }
        let from = guess + START_STEP_DEG * f64::from(k);
        let tried = fit(from);
        if tried.sd_deg < best.sd_deg {
            (by_deg, best) = (from, tried);
        }
    }
    for _ in 0..REFINEMENTS {
        by_deg += best.unknowns[CONSTANT] - mean[CONSTANT];
        best = fit(by_deg);
    }
    Some(Zero {
        by_deg: wrap_180(by_deg + best.unknowns[CONSTANT] - mean[CONSTANT]),
        sd_deg: constant_sd(rows, &best, &prior_information)?,
    })
}

/// Returns the constant's standard error where rows on similar headings share most of their
/// errors.
fn constant_sd(
    rows: &[Observation],
    fit: &RobustStart,
    prior_information: &SMatrix<f64, UNKNOWNS, UNKNOWNS>,
) -> Option<f64> {
    let mut cells: BTreeMap<i64, f64> = BTreeMap::new();
    for row in rows {
        *cells.entry(heading_cell(row)).or_default() += 1.0;
    }
    let shared = design_effect(cells.into_values());
    let by_rows = fit.information - prior_information;
    let factor = (by_rows / shared + prior_information).cholesky()?;
    let mut unit = SVector::<f64, UNKNOWNS>::zeros();
    unit[CONSTANT] = 1.0;
    let sd = factor.solve(&unit)[CONSTANT].max(0.0).sqrt();
    sd.is_finite().then_some(sd)
}

/// Returns the measured deviation that is nearest to all others round the circle.
fn middle_deviation(rows: &[Observation]) -> Option<f64> {
    let every = rows.len().div_ceil(ENOUGH_GUESSES).max(1);
    let guesses: Vec<f64> = rows
        .iter()
        .step_by(every)
        .map(|o| o.deviation.degrees_east())
        .collect();
    let distance = |from: f64| -> f64 { guesses.iter().map(|g| wrap_180(g - from).abs()).sum() };
    let measured = guesses.iter().map(|&guess| (distance(guess), guess));
    let nearest = measured.min_by(|a, b| a.0.total_cmp(&b.0));
    nearest.map(|(_, guess)| guess)
}

/// Returns the density per degree of a zero by eye.
fn askew_density(off_deg: f64) -> f64 {
    let z = off_deg / ASKEW_SD_DEG;
    (-z * z / 2.0).exp() / (ASKEW_SD_DEG * TAU.sqrt())
}

/// Returns a prior's density per degree at the zero by the data, averaged over the zero's own
/// error.
fn average_density(zero: &Zero, density: impl Fn(f64) -> f64) -> f64 {
    let (mut weights, mut sum) = (0.0, 0.0);
    for step in -AVERAGE_STEPS..=AVERAGE_STEPS {
        let z = AVERAGE_STEP_SD * f64::from(step);
        let weight = (-z * z / 2.0).exp();
        weights += weight;
        sum += weight * density(wrap_180(zero.by_deg + z * zero.sd_deg));
    }
    sum / weights
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn turning_there_and_back_is_the_identity() {
        let scale = [1500.0, 0.012, 1500.0, 0.006, 0.02, 0.008, 0.008, 1.0];
        for by_deg in [10.0, 90.0, -137.0, 180.0] {
            let there = Turn { by_deg }.matrix(&scale);
            let back = Turn { by_deg: -by_deg }.matrix(&scale);
            let off = there * back - SMatrix::<f64, 8, 8>::identity();
            assert!(off.amax() < 1e-12, "{by_deg}: {off}");
        }
    }
}
