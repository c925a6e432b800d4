//! Deviation that a model predicts on every heading at one place.

use binnacle_compass::angle::CompassHeading;
use binnacle_compass::deviation::CoefficientsInDegrees;
use binnacle_compass::deviation::DeviationError;
use binnacle_compass::model::Model;
use binnacle_compass::ship::{EarthField, WEAKEST_H_NT};
use serde::{Deserialize, Serialize};
use utoipa::ToSchema;

/// Deviation on one compass heading.
#[derive(Clone, Copy, Debug, PartialEq, Serialize, ToSchema)]
pub struct DeviationRow {
    /// Compass heading.
    pub compass_deg: f64,
    /// The magnetic heading then.
    pub magnetic_deg: f64,
    /// Deviation, degrees, east positive.
    pub deviation_deg: f64,
    /// Half the width of the 95 % band, degrees; none without a covariance.
    #[schema(required)]
    pub band95_deg: Option<f64>,
}

/// The heading with the greatest deviation.
#[derive(Clone, Copy, Debug, PartialEq, Serialize, Deserialize, ToSchema)]
pub struct WorstHeading {
    /// Compass heading.
    pub compass_deg: f64,
    /// Deviation, degrees, east positive.
    pub deviation_deg: f64,
    /// Half the width of the 95 % band, degrees.
    #[schema(required)]
    pub band95_deg: Option<f64>,
}

/// Returns the deviation on compass headings from 0, in steps of `step_deg`.
///
/// # Errors
/// Fails when the field is too weak for a compass, or headings are ambiguous.
pub fn table(
    model: &Model,
    earth: EarthField,
    step_deg: f64,
) -> Result<Vec<DeviationRow>, DeviationError> {
    if earth.h_nt < WEAKEST_H_NT {
        return Err(DeviationError::FieldTooWeak {
            h_nt: earth.h_nt,
            needed_nt: WEAKEST_H_NT,
        });
    }
    // A step that fills the circle but for rounding does not count 360 again.
    let rows = (360.0 / step_deg - 1e-9).ceil() as usize;
    (0..rows)
        .map(|index| row(model, earth, index as f64 * step_deg))
        .collect()
}

fn row(model: &Model, earth: EarthField, compass_deg: f64) -> Result<DeviationRow, DeviationError> {
    let compass = CompassHeading::new(compass_deg).ok_or(DeviationError::NotFinite)?;
    let predicted = model.deviation(compass, earth)?;
    Ok(DeviationRow {
        compass_deg,
        magnetic_deg: (compass + predicted.deviation).degrees(),
        deviation_deg: predicted.deviation.degrees_east(),
        band95_deg: predicted.band95_deg,
    })
}

/// Finds the heading with the greatest deviation, to 5°; `None` where headings are ambiguous.
pub fn worst(model: &Model, earth: EarthField) -> Option<WorstHeading> {
    worst_of(&table(model, earth, 5.0).ok()?)
}

/// Finds the row with the greatest deviation.
pub fn worst_of(rows: &[DeviationRow]) -> Option<WorstHeading> {
    let worst = rows
        .iter()
        .max_by(|x, y| x.deviation_deg.abs().total_cmp(&y.deviation_deg.abs()))?;
    Some(WorstHeading {
        compass_deg: worst.compass_deg,
        deviation_deg: worst.deviation_deg,
        band95_deg: worst.band95_deg,
    })
}

/// Returns the handbook's coefficients; `None` where headings are ambiguous.
pub fn handbook(model: &Model, earth: EarthField) -> Option<CoefficientsInDegrees> {
    model.approximate_coefficients(earth).ok()
}
