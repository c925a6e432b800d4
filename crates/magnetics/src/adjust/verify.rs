//! Headings at sea after an adjustment, held against what was foretold.
//!
//! What always holds: an alarm is given where a heading is off by more than 2° or three
//! standard errors; the plan passes only once the headings themselves, added to what was
//! foretold, leave the deviation certain enough on every heading. Samples within 15° of
//! each other share the errors of one reference and count as one heading.

use crate::angle::{CompassHeading, wrap_180};
use crate::deviation::{DeviationError, NORMAL_95, linearised_at_compass};
use crate::model::{Covariance, Model};
use crate::ship::{EarthField, PARAMETERS};
use serde::{Deserialize, Serialize};

/// Off by more is an alarm, degrees.
const ALARM_DEG: f64 = 2.0;
/// Off by more standard errors is one too.
const ALARM_SD: f64 = 3.0;
/// Sectors that the headings fall into.
const SECTORS: usize = 24;
/// A passed plan is known to this, 95 %, degrees.
const PASSED_BAND_DEG: f64 = 1.0;
/// In so many quadrants there must have been headings.
const QUADRANTS: usize = 4;
/// What a heading yet to come will be good for, degrees.
const USUAL_SD_DEG: f64 = 0.7;

/// A settled heading at sea.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Settled {
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
        needed: Needed,
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
pub struct Needed {
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
    settled: &[Settled],
    here: EarthField,
) -> Result<Verification, DeviationError> {
    let mut covariance = model_after.covariance.ok_or(DeviationError::NotFinite)?;
    let prior = covariance;
    let mut counted = Vec::new();
    let mut squares = 0.0;
    for sector in 0..SECTORS {
        let Some((heading, off_deg)) = mean_of(model_after, settled, sector)? else {
            continue;
        };
        let slope = slope(model_after, heading.compass, heading.earth)?;
        let foretold = quadratic(&prior, &slope);
        let standard_error_deg = (foretold + heading.sd_deg.powi(2)).sqrt();
        if off_deg.abs() > ALARM_DEG || off_deg.abs() > ALARM_SD * standard_error_deg {
            return Ok(Verification::Alarm {
                compass_deg: heading.compass.degrees(),
                off_deg,
                standard_error_deg,
            });
        }
        covariance = told(&covariance, &slope, heading.sd_deg.powi(2));
        squares += off_deg.powi(2);
        counted.push(sector);
    }
    let headings = counted.len();
    let needed = needed(model_after, covariance, counted, here)?;
    if needed.count > 0 {
        return Ok(Verification::MoreNeeded { headings, needed });
    }
    Ok(Verification::Passed {
        headings,
        band95_deg: widest(model_after, &covariance, here)?.1,
        rms_deg: (squares / headings as f64).sqrt(),
    })
}

/// The mean of what is off within a sector, and its last heading.
fn mean_of(
    model: &Model,
    settled: &[Settled],
    sector: usize,
) -> Result<Option<(Settled, f64)>, DeviationError> {
    let here = settled
        .iter()
        .filter(|s| sector_of(s.compass.degrees()) == sector);
    let (mut weights, mut sum, mut last) = (0.0, 0.0, None);
    for one in here {
        let foretold = model.deviation(one.compass, one.earth)?.deviation;
        let weight = one.sd_deg.max(0.05).powi(-2);
        weights += weight;
        sum += weight * wrap_180(one.deviation_deg - foretold.degrees_east());
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

fn times(covariance: &Covariance, slope: &[f64; 8]) -> [f64; 8] {
    covariance.map(|row| row.iter().zip(slope).map(|(c, s)| c * s).sum())
}

fn quadratic(covariance: &Covariance, slope: &[f64; 8]) -> f64 {
    let with = times(covariance, slope);
    with.iter()
        .zip(slope)
        .map(|(w, s)| w * s)
        .sum::<f64>()
        .max(0.0)
}

/// The covariance once a heading was read.
fn told(covariance: &Covariance, slope: &[f64; 8], variance: f64) -> Covariance {
    let with = times(covariance, slope);
    let whole = quadratic(covariance, slope) + variance;
    std::array::from_fn(|row| {
        std::array::from_fn(|column| covariance[row][column] - with[row] * with[column] / whole)
    })
}

/// The sector with the widest band, and that band.
fn widest(
    model: &Model,
    covariance: &Covariance,
    here: EarthField,
) -> Result<(usize, f64), DeviationError> {
    let mut widest = (0, 0.0);
    for sector in 0..SECTORS {
        let Some(compass) = CompassHeading::new(compass_of(sector)) else {
            continue;
        };
        let band = NORMAL_95 * quadratic(covariance, &slope(model, compass, here)?).sqrt();
        if band > widest.1 {
            widest = (sector, band);
        }
    }
    Ok(widest)
}

/// Goes on as if the least certain heading were sailed next, until all is well.
fn needed(
    model: &Model,
    mut covariance: Covariance,
    mut counted: Vec<usize>,
    here: EarthField,
) -> Result<Needed, DeviationError> {
    let mut compass_deg = Vec::new();
    loop {
        let (least_certain, band) = widest(model, &covariance, here)?;
        let quadrant = |sector: usize| sector * QUADRANTS / SECTORS;
        let unseen = (0..QUADRANTS).find(|q| !counted.iter().any(|s| quadrant(*s) == *q));
        let sector = match unseen {
            _ if band > PASSED_BAND_DEG => least_certain,
            Some(unseen) => unseen * SECTORS / QUADRANTS + SECTORS / QUADRANTS / 2,
            None => break,
        };
        // A model that no number of headings mends would go on for ever.
        if compass_deg.len() == 2 * SECTORS {
            break;
        }
        let Some(compass) = CompassHeading::new(compass_of(sector)) else {
            break;
        };
        covariance = told(
            &covariance,
            &slope(model, compass, here)?,
            USUAL_SD_DEG.powi(2),
        );
        counted.push(sector);
        compass_deg.push(compass_of(sector));
    }
    Ok(Needed {
        count: compass_deg.len(),
        compass_deg,
    })
}
