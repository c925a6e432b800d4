//! What a plan must keep to, and which of it may be asked for.

use super::number_error::NumberError;
use serde::{Deserialize, Serialize};

/// What a plan must keep to.
#[derive(Clone, Copy, Debug, PartialEq, Serialize, Deserialize)]
#[serde(default, deny_unknown_fields)]
pub struct Limits {
    /// The greatest residual that may be foretold, band included, degrees.
    pub residual_deg: f64,
    /// The widest 95 % band, degrees.
    pub band_deg: f64,
    /// Settings within this are as good as each other, and the one with the fewest
    /// moves is taken, degrees.
    pub near_equal_deg: f64,
    /// The oldest model, days.
    pub model_age_days: f64,
    /// With a λ less sure than this share the soft iron is left as it is.
    pub lambda_sd: f64,
}

impl Default for Limits {
    fn default() -> Limits {
        Limits {
            residual_deg: 3.0,
            band_deg: 2.5,
            near_equal_deg: 0.1,
            model_age_days: 60.0,
            lambda_sd: 0.03,
        }
    }
}

impl Limits {
    /// Whether somebody who answers for a compass may ask for this: no residual that flags
    /// want adjusted again (5°), no band that tells nothing, no model of last season.
    ///
    /// # Errors
    /// Names the limit.
    pub fn check_ranges(&self) -> Result<(), NumberError> {
        for (field, value, least, greatest) in [
            ("residual_deg", self.residual_deg, 0.5, 5.0),
            ("band_deg", self.band_deg, 0.2, 4.0),
            ("near_equal_deg", self.near_equal_deg, 0.0, 1.0),
            ("model_age_days", self.model_age_days, 1.0, 90.0),
            ("lambda_sd", self.lambda_sd, 0.005, 0.1),
        ] {
            if !(least..=greatest).contains(&value) {
                return Err(NumberError {
                    field,
                    what: format!("{value} is not between {least} and {greatest}"),
                });
            }
        }
        Ok(())
    }
}
