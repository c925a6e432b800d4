//! The ship's magnetism at the berth, and with any other setting.

mod corrector_errors;
mod field_drift;
mod iron_bands;
mod magnetic_state;

mod earlier_lambda;

pub(crate) use corrector_errors::{errors_between, setting_errors};
pub(crate) use iron_bands::IronBands;
pub(crate) use magnetic_state::{MagneticState, StateWithSetting};
