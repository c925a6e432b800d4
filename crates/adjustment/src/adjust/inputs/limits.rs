//! Limits of a plan, and their accepted ranges.

use super::number_error::NumberError;
use serde::{Deserialize, Serialize};

/// Limits of a plan; an absent limit takes its default.
#[derive(Clone, Copy, Debug, PartialEq, Serialize, Deserialize)]
#[cfg_attr(feature = "openapi", derive(utoipa::ToSchema))]
#[cfg_attr(
    feature = "openapi",
    schema(as = PlanLimits, example = json!({ "residual_deg": 3.0, "band_deg": 1.5 }))
)]
#[serde(default, deny_unknown_fields)]
pub struct Limits {
    /// Greatest predicted residual, including its band, degrees; 3 by default.
    #[cfg_attr(feature = "openapi", schema(minimum = 0.5, maximum = 5))]
    pub residual_deg: f64,
    /// Greatest 95 % band, degrees; 2.5 by default.
    #[cfg_attr(feature = "openapi", schema(minimum = 0.2, maximum = 4))]
    pub band_deg: f64,
    /// Difference below which settings count as equal, degrees; 0.1 by default. The one with
    /// the fewest moves is chosen.
    #[cfg_attr(feature = "openapi", schema(minimum = 0, maximum = 1))]
    pub near_equal_deg: f64,
    /// Greatest age of the model, days; 60 by default.
    #[cfg_attr(feature = "openapi", schema(minimum = 1, maximum = 90))]
    pub model_age_days: f64,
    /// Relative standard error of λ above which the magnetometer is named as too poor where
    /// spheres would have to move; 0.03 by default.
    #[cfg_attr(feature = "openapi", schema(minimum = 0.005, maximum = 0.1))]
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
    /// Checks that the limits are reasonable: no residual that calls for another adjustment
    /// (5°), no meaningless band, no model of last season.
    ///
    /// # Errors
    /// Names the limit outside its range.
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
