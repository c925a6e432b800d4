//! Deviations of a card by a model, or the reason why it makes none.

use super::observed::STEP_DEG;
use super::refusal::{OLDEST_DAYS, Refusal};
use binnacle_compass::ship::EarthField;
use binnacle_fleet::deviation::{self, DeviationRow};
use binnacle_fleet::models::StoredModel;
use binnacle_platform::time::Time;

/// Degrees of compass heading between points of the curve.
const CURVE_STEP_DEG: f64 = 5.0;

/// A band that excludes no heading.
pub(super) const NO_BAND_DEG: f64 = 180.0;

/// Deviations of a card.
pub(super) struct Tables {
    /// Points of the curve.
    pub(super) curve: Vec<DeviationRow>,
    /// Lines of the table.
    pub(super) lines: Vec<DeviationRow>,
    /// Half the 95 % band where it is widest, degrees.
    pub(super) widest_band95_deg: f64,
}

/// Returns the deviations of a card by a model in a field at a time, or the reason why the model
/// makes no card.
pub(super) fn tables(
    model: &StoredModel,
    earth: EarthField,
    limit_deg: f64,
    at: Time,
) -> Result<Tables, Refusal> {
    not_too_old(model.data_until, at)?;
    let ship = &model.model.0;
    let curve = deviation::table(ship, earth, CURVE_STEP_DEG)?;
    Ok(Tables {
        widest_band95_deg: widest(&curve, limit_deg)?,
        lines: deviation::table(ship, earth, STEP_DEG)?,
        curve,
    })
}

fn not_too_old(data_until: Time, at: Time) -> Result<(), Refusal> {
    let days = at.0.seconds_since(data_until.0) / 86_400.0;
    if days > OLDEST_DAYS {
        return Err(Refusal::TooOld { data_until, days });
    }
    Ok(())
}

fn widest(curve: &[DeviationRow], limit_deg: f64) -> Result<f64, Refusal> {
    let (mut widest_deg, mut compass_deg) = (0.0, 0.0);
    for row in curve {
        // Without a covariance the band is unknown.
        let band95_deg = row.band95_deg.unwrap_or(NO_BAND_DEG);
        if band95_deg > widest_deg {
            (widest_deg, compass_deg) = (band95_deg, row.compass_deg);
        }
    }
    if widest_deg > limit_deg {
        return Err(Refusal::BandTooWide {
            band95_deg: widest_deg,
            compass_deg,
            limit_deg,
        });
    }
    Ok(widest_deg)
}
