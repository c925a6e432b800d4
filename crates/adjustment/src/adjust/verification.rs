//! Verification of an adjustment by headings at sea.
//!
//! Invariants: a heading raises an alarm when it is off by more than three standard errors,
//! or by more than 2° in the fit of all headings. The plan passes by the headings alone: at
//! first, B, C, D and E are as uncertain as a slip of the hand would make them. Their
//! residual with its band must fall below 2° on every heading, until no other heading is
//! left to sail. Samples within 15° of each other share the errors of one reference and
//! count as one heading.

use binnacle_compass::angle::{CompassHeading, wrap_180};
use binnacle_compass::deviation::{DeviationError, NORMAL_95, linearised_at_compass};
use binnacle_compass::model::{Covariance, Model};
use binnacle_compass::ship::{EarthField, PARAMETERS};
use serde::{Deserialize, Serialize};

/// Residual that raises an alarm, and that no band of a passed plan may reach, degrees.
const ALARM_DEG: f64 = 2.0;
/// Residual that raises an alarm, in standard errors.
const ALARM_SD: f64 = 3.0;
/// Standard deviation of a slip's effect, degrees: by magnets on B and C, by spheres on D
/// and E.
const SLIP_DEG: [f64; 2] = [3.0, 1.5];
/// Number of sectors of headings.
const SECTORS: usize = 24;
/// Greatest 95 % band of a passed plan by the headings, degrees.
const PASSED_BAND_DEG: f64 = 1.25;
/// Number of quadrants with at least one heading.
const QUADRANTS: usize = 4;
/// Assumed standard deviation of a future heading, degrees.
const USUAL_SD_DEG: f64 = 0.7;

/// A settled heading at sea.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct SettledHeading {
    /// Compass heading.
    pub compass: CompassHeading,
    /// Reference less variation less compass, degrees.
    pub deviation_deg: f64,
    /// Standard deviation of the deviation, degrees.
    pub sd_deg: f64,
    /// Earth's field at the place.
    pub earth: EarthField,
}

/// Verification of the plan by the headings.
#[derive(Clone, Debug, PartialEq, Serialize, Deserialize)]
#[cfg_attr(feature = "openapi", derive(utoipa::ToSchema))]
#[cfg_attr(feature = "openapi", schema(as = SeaVerdict))]
#[serde(tag = "verdict", rename_all = "snake_case")]
pub enum Verification {
    /// The headings agree and suffice.
    Passed {
        /// Number of headings that counted.
        headings: usize,
        /// Widest remaining 95 % band, degrees.
        band95_deg: f64,
        /// Root mean square of the residuals, degrees.
        rms_deg: f64,
    },
    /// The headings agree so far.
    MoreNeeded {
        /// Number of headings that counted.
        headings: usize,
        /// Headings that are still needed.
        needed: NeededHeadings,
    },
    /// A heading is off by too much.
    Alarm {
        /// Compass heading of it, degrees.
        compass_deg: f64,
        /// Residual, degrees.
        off_deg: f64,
        /// Standard error of the residual, degrees.
        standard_error_deg: f64,
    },
}

/// Headings that are still needed.
#[derive(Clone, Debug, PartialEq, Serialize, Deserialize)]
#[cfg_attr(feature = "openapi", derive(utoipa::ToSchema))]
pub struct NeededHeadings {
    /// Number of headings.
    pub count: usize,
    /// Suitable compass headings, degrees, the best first.
    pub compass_deg: Vec<f64>,
}

/// Verifies the model of a plan by headings at sea.
///
/// # Errors
/// Fails when the model's headings are ambiguous, it has no covariance, or the field is invalid.
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

/// Mean of the headings in a sector.
struct SectorMean {
    sector: usize,
    compass_deg: f64,
    off_deg: f64,
    /// Standard error of the mean and its prediction together.
    standard_error_deg: f64,
    slope: Slope,
}

type Slope = [f64; PARAMETERS + 1];

/// Finds the worst heading that raises an alarm.
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

/// Posterior of the correction to the prediction.
struct Posterior {
    /// Correction of the model's parameters and constant.
    correction: Slope,
    covariance: Covariance,
}

impl Posterior {
    /// Starts from the prediction and the possible slips.
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

    /// Returns the residual of a heading in the fit of all headings, degrees.
    fn off_deg(&self, slope: &Slope) -> f64 {
        dot(&self.correction, slope)
    }

    fn band_deg(&self, slope: &Slope) -> f64 {
        NORMAL_95 * quadratic(&self.covariance, slope).sqrt()
    }

    /// Updates the posterior by the residual of a heading.
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

/// Returns the last heading of a sector with the sector's mean residual.
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
    let parameters = model.parameters_at(earth);
    let (_, gradient) = linearised_at_compass(&parameters, compass.radians(), earth)?;
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

/// Returns the slopes in the middle of every sector.
fn sector_slopes(model: &Model, here: EarthField) -> Result<Vec<Slope>, DeviationError> {
    let middles = (0..SECTORS).filter_map(|sector| CompassHeading::new(compass_of(sector)));
    middles.map(|compass| slope(model, compass, here)).collect()
}

/// Plans the further headings: always the one that may be off most, with its expected
/// residual, until the plan would pass.
fn needed(
    sector_slopes: &[Slope],
    mut posterior: Posterior,
    mut counted: Vec<usize>,
) -> NeededHeadings {
    let quadrant = |sector: usize| sector * QUADRANTS / SECTORS;
    let mut compass_deg = Vec::new();
    // No sector is worth sailing twice, as its error is that of the same reference.
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
