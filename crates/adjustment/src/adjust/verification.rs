//! Headings at sea after an adjustment, held against what was foretold.
//!
//! What always holds: an alarm is given where a heading is off by more than three
//! standard errors, or by more than 2° as all headings together have it. The plan passes
//! only by what the headings say: whatever a slip of the hand may have done to B, C, D
//! and E is left open at first, and they must leave less than 2° of it with their band, on
//! every heading, until there is no other heading to sail. Samples within 15° of each
//! other share the errors of one reference and count as one heading.

use binnacle_compass::angle::{CompassHeading, wrap_180};
use binnacle_compass::deviation::{DeviationError, NORMAL_95, linearised_at_compass};
use binnacle_compass::model::{Covariance, Model};
use binnacle_compass::ship::{EarthField, PARAMETERS};
use serde::{Deserialize, Serialize};

/// Off by more is an alarm, degrees; and with the band it is no pass.
const ALARM_DEG: f64 = 2.0;
/// Off by more standard errors is an alarm too.
const ALARM_SD: f64 = 3.0;
/// What a slip may have done, standard deviation, degrees: magnets to B and C, spheres to
/// D and E.
const SLIP_DEG: [f64; 2] = [3.0, 1.5];
/// Sectors that the headings fall into.
const SECTORS: usize = 24;
/// A passed plan is known to this by the headings, 95 %, degrees.
const PASSED_BAND_DEG: f64 = 1.25;
/// In so many quadrants there must have been headings.
const QUADRANTS: usize = 4;
/// What a heading yet to come will be good for, degrees.
const USUAL_SD_DEG: f64 = 0.7;

/// A settled heading at sea.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct SettledHeading {
    /// What the compass read.
    pub compass: CompassHeading,
    /// Reference less variation less compass, degrees.
    pub deviation_deg: f64,
    /// Standard deviation of that, degrees.
    pub sd_deg: f64,
    /// The earth's field there.
    pub earth: EarthField,
}

/// What the headings say of the plan.
#[derive(Clone, Debug, PartialEq, Serialize, Deserialize)]
#[serde(tag = "verdict", rename_all = "snake_case")]
pub enum Verification {
    /// They agree, and are enough.
    Passed {
        /// Headings that counted.
        headings: usize,
        /// The widest 95 % band that is left, degrees.
        band95_deg: f64,
        /// Root mean square of what they are off, degrees.
        rms_deg: f64,
    },
    /// They agree so far.
    MoreNeeded {
        /// Headings that counted.
        headings: usize,
        /// Which others are needed.
        needed: NeededHeadings,
    },
    /// One is off by too much.
    Alarm {
        /// Its compass heading, degrees.
        compass_deg: f64,
        /// By how much it is off, degrees.
        off_deg: f64,
        /// The standard error of that, degrees.
        standard_error_deg: f64,
    },
}

/// Headings that are still needed.
#[derive(Clone, Debug, PartialEq, Serialize, Deserialize)]
pub struct NeededHeadings {
    /// How many.
    pub count: usize,
    /// Compass headings that would do, degrees, the best first.
    pub compass_deg: Vec<f64>,
}

/// Holds headings at sea against the model of a plan.
///
/// # Errors
/// When the model's headings are ambiguous, it came without a covariance or there is no
/// field to steer by.
pub fn verify(
    model_after: &Model,
    settled: &[SettledHeading],
    here: EarthField,
) -> Result<Verification, DeviationError> {
    let predicted = model_after.covariance.ok_or(DeviationError::NotFinite)?;
    let mut posterior = Posterior::new(&predicted, here);
    let mut means = Vec::new();
    for sector in 0..SECTORS {
        let Some((heading, off_deg)) = mean_of(model_after, settled, sector)? else {
            continue;
        };
        let slope = slope(model_after, heading.compass, heading.earth)?;
        let variance = heading.sd_deg.powi(2);
        posterior.observe(&slope, off_deg, variance);
        means.push(SectorMean {
            sector,
            compass_deg: heading.compass.degrees(),
            off_deg,
            standard_error_deg: (quadratic(&predicted, &slope) + variance).sqrt(),
            slope,
        });
    }
    if let Some(alarm) = alarm(&posterior, &means) {
        return Ok(alarm);
    }
    let headings = means.len();
    let squares: f64 = means.iter().map(|mean| mean.off_deg.powi(2)).sum();
    let sector_slopes = sector_slopes(model_after, here)?;
    let band95_deg = sector_slopes.iter().map(|slope| posterior.band_deg(slope));
    let band95_deg = band95_deg.fold(0.0, f64::max);
    let counted = means.iter().map(|mean| mean.sector).collect();
    let needed = needed(&sector_slopes, posterior, counted);
    if needed.count > 0 {
        return Ok(Verification::MoreNeeded { headings, needed });
    }
    Ok(Verification::Passed {
        headings,
        band95_deg,
        rms_deg: (squares / headings as f64).sqrt(),
    })
}

/// A sector in which there were headings.
struct SectorMean {
    sector: usize,
    compass_deg: f64,
    off_deg: f64,
    /// Of the heading and of what was foretold for it.
    standard_error_deg: f64,
    slope: Slope,
}

type Slope = [f64; PARAMETERS + 1];

/// The worst of what is off by too much.
fn alarm(posterior: &Posterior, means: &[SectorMean]) -> Option<Verification> {
    let too_far = means.iter().filter_map(|mean| {
        let together_deg = posterior.off_deg(&mean.slope);
        let beyond_errors = mean.off_deg.abs() > ALARM_SD * mean.standard_error_deg;
        if !beyond_errors && together_deg.abs() <= ALARM_DEG {
            return None;
        }
        let own = mean.off_deg.abs() >= together_deg.abs();
        Some((mean, if own { mean.off_deg } else { together_deg }))
    });
    let worst = too_far.max_by(|a, b| a.1.abs().total_cmp(&b.1.abs()));
    worst.map(|(mean, off_deg)| Verification::Alarm {
        compass_deg: mean.compass_deg,
        off_deg,
        standard_error_deg: mean.standard_error_deg,
    })
}

/// What the headings say of the difference to what was foretold.
struct Posterior {
    /// Of the model's parameters and constant.
    correction: Slope,
    covariance: Covariance,
}

impl Posterior {
    /// Nothing yet: what was foretold, and what slips may have done.
    fn new(predicted: &Covariance, here: EarthField) -> Posterior {
        let [magnets, spheres] = SLIP_DEG.map(f64::to_radians);
        let mut covariance = *predicted;
        for b in [0, 2] {
            covariance[b][b] += (magnets * here.h_nt).powi(2);
        }
        // χ11 − χ22 is 2D; E is the mean of χ12 and χ21, of which A is half the difference.
        covariance[4][4] += (2.0 * spheres).powi(2);
        for (row, column) in [(5, 5), (5, 6), (6, 5), (6, 6)] {
            covariance[row][column] += spheres.powi(2);
        }
        Posterior {
            correction: [0.0; PARAMETERS + 1],
            covariance,
        }
    }

    /// By how much a heading is off, degrees, as all of them have it.
    fn off_deg(&self, slope: &Slope) -> f64 {
        dot(&self.correction, slope)
    }

    fn band_deg(&self, slope: &Slope) -> f64 {
        NORMAL_95 * quadratic(&self.covariance, slope).sqrt()
    }

    /// Takes in that a heading was off by so much.
    fn observe(&mut self, slope: &Slope, off_deg: f64, variance: f64) {
        let with = times(&self.covariance, slope);
        let whole = quadratic(&self.covariance, slope) + variance;
        let innovation = (off_deg - self.off_deg(slope)) / whole;
        for row in 0..=PARAMETERS {
            self.correction[row] += with[row] * innovation;
            for column in 0..=PARAMETERS {
                self.covariance[row][column] -= with[row] * with[column] / whole;
            }
        }
    }
}

/// The mean of what is off within a sector, and its last heading.
fn mean_of(
    model: &Model,
    settled: &[SettledHeading],
    sector: usize,
) -> Result<Option<(SettledHeading, f64)>, DeviationError> {
    let here = settled
        .iter()
        .filter(|s| sector_of(s.compass.degrees()) == sector);
    let (mut weights, mut sum, mut last) = (0.0, 0.0, None);
    for one in here {
        let predicted = model.deviation(one.compass, one.earth)?.deviation;
        let weight = one.sd_deg.max(0.05).powi(-2);
        weights += weight;
        sum += weight * wrap_180(one.deviation_deg - predicted.degrees_east());
        last = Some(*one);
    }
    Ok(last.map(|last| (last, sum / weights)))
}

fn sector_of(compass_deg: f64) -> usize {
    (compass_deg / 360.0 * SECTORS as f64).round() as usize % SECTORS
}

fn compass_of(sector: usize) -> f64 {
    sector as f64 * 360.0 / SECTORS as f64
}

fn slope(
    model: &Model,
    compass: CompassHeading,
    earth: EarthField,
) -> Result<[f64; PARAMETERS + 1], DeviationError> {
    let parameters = &model.parameters_over_lambda;
    let (_, gradient) = linearised_at_compass(parameters, compass.radians(), earth)?;
    let mut slope = [1.0; PARAMETERS + 1];
    for (degrees, radians) in slope.iter_mut().zip(gradient) {
        *degrees = radians.to_degrees();
    }
    Ok(slope)
}

fn dot(a: &Slope, b: &Slope) -> f64 {
    a.iter().zip(b).map(|(a, b)| a * b).sum()
}

fn times(covariance: &Covariance, slope: &Slope) -> Slope {
    covariance.map(|row| dot(&row, slope))
}

fn quadratic(covariance: &Covariance, slope: &Slope) -> f64 {
    dot(&times(covariance, slope), slope).max(0.0)
}

/// Slopes in the middle of every sector.
fn sector_slopes(model: &Model, here: EarthField) -> Result<Vec<Slope>, DeviationError> {
    let middles = (0..SECTORS).filter_map(|sector| CompassHeading::new(compass_of(sector)));
    middles.map(|compass| slope(model, compass, here)).collect()
}

/// Goes on as if the heading that may be off most were sailed next and were off by as much
/// as is thought, until all is well.
fn needed(
    sector_slopes: &[Slope],
    mut posterior: Posterior,
    mut counted: Vec<usize>,
) -> NeededHeadings {
    let quadrant = |sector: usize| sector * QUADRANTS / SECTORS;
    let mut compass_deg = Vec::new();
    // No heading is worth sailing twice, as it errs by the same reference.
    while counted.len() < SECTORS {
        let band = |sector: usize| posterior.band_deg(&sector_slopes[sector]);
        let reach = |sector: usize| posterior.off_deg(&sector_slopes[sector]).abs() + band(sector);
        let is_open = |sector| band(sector) > PASSED_BAND_DEG || reach(sector) > ALARM_DEG;
        let unseen = (0..QUADRANTS).find(|q| !counted.iter().any(|s| quadrant(*s) == *q));
        let sector = match unseen {
            _ if (0..sector_slopes.len()).any(is_open) => {
                let new = (0..sector_slopes.len()).filter(|sector| !counted.contains(sector));
                new.max_by(|a, b| reach(*a).total_cmp(&reach(*b)))
            }
            Some(unseen) => Some(unseen * SECTORS / QUADRANTS + SECTORS / QUADRANTS / 2),
            None => None,
        };
        let Some(sector) = sector else {
            break;
        };
        let slope = &sector_slopes[sector];
        let as_thought = posterior.off_deg(slope);
        posterior.observe(slope, as_thought, USUAL_SD_DEG.powi(2));
        counted.push(sector);
        compass_deg.push(compass_of(sector));
    }
    NeededHeadings {
        count: compass_deg.len(),
        compass_deg,
    }
}
