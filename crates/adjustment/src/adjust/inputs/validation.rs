//! Validation of a plan's input before any calculation.

use super::adjustment::{Adjustment, Water};
use super::error::AdjustError;

/// Greatest number of waters.
const MOST_WATERS: usize = 24;

/// Validates numbers, waters and the present setting.
///
/// # Errors
/// Names the first invalid value.
pub(crate) fn validate(adjustment: &Adjustment<'_>) -> Result<(), AdjustError> {
    numbers(adjustment)?;
    if let Some(vertical) = &adjustment.vertical {
        vertical.check_range()?;
    }
    waters(adjustment.waters)?;
    if let Some(now) = adjustment.now {
        adjustment.binnacle.with_setting(now.clone())?;
    }
    Ok(())
}

fn numbers(adjustment: &Adjustment<'_>) -> Result<(), AdjustError> {
    let limits = &adjustment.limits;
    let values = [
        ("limits.residual_deg", limits.residual_deg, 0.0, 90.0),
        ("limits.band_deg", limits.band_deg, 0.0, 90.0),
        ("limits.near_equal_deg", limits.near_equal_deg, 0.0, 10.0),
        ("limits.model_age_days", limits.model_age_days, 0.0, 1e5),
        ("limits.lambda_sd", limits.lambda_sd, 0.0, 1.0),
        ("scale_sd", adjustment.scale_sd, 0.0, 0.5),
        (
            "compass_deg",
            adjustment.compass_deg.unwrap_or(0.0),
            0.0,
            360.0,
        ),
        (
            "model_age_days",
            adjustment.circumstances.model_age_days.unwrap_or(0.0),
            0.0,
            1e5,
        ),
    ];
    for (field, value, least, greatest) in values {
        if !(least..=greatest).contains(&value) {
            return Err(AdjustError::Value {
                field,
                value,
                least,
                greatest,
            });
        }
    }
    Ok(())
}

fn waters(waters: &[Water]) -> Result<(), AdjustError> {
    if waters.len() > MOST_WATERS {
        return Err(AdjustError::Value {
            field: "number of waters",
            value: waters.len() as f64,
            least: 1.0,
            greatest: MOST_WATERS as f64,
        });
    }
    for (index, water) in waters.iter().enumerate() {
        for (field, value, least, greatest) in [
            ("h_nt", water.h_nt, 2_000.0, 100_000.0),
            ("z_nt", water.z_nt, -100_000.0, 100_000.0),
            ("weight", water.weight, 0.0, 1e9),
        ] {
            if !(least..=greatest).contains(&value) {
                return Err(AdjustError::Water {
                    index,
                    field,
                    value,
                    least,
                    greatest,
                });
            }
        }
    }
    if !waters.iter().any(|water| water.weight > 0.0) {
        return Err(AdjustError::NoWaters);
    }
    Ok(())
}
