//! Validation of written forms; each error names its field.

mod calibration;
mod inventory;
mod setting;

pub(super) use inventory::check_tested_moments;

use super::binnacle_form::BinnacleForm;
use super::error::BinnacleError;

/// Checks that inventory, calibration and setting belong to the design.
pub(super) fn check_binnacle(form: &BinnacleForm) -> Result<(), BinnacleError> {
    inventory::check(form)?;
    calibration::check(form)?;
    setting::check(form, &form.setting)
}
