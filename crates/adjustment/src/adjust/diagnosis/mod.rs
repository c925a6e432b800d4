//! Diagnosis of a berth: checks of its readings, misreadings, and refusals with their cures.

mod card_check;
mod card_precision;

mod misreadings;
mod vertical_check;

mod cures;
mod lambda_comparison;
mod refusal;
mod refusal_text;

mod berth_checks;
mod reading_check;

pub(crate) use berth_checks::{check_preconditions, refuse_berth};
pub use card_check::CardCheck;
pub(crate) use card_precision::{friction_deg, turn_sd_deg};
pub use cures::{Cure, Refused};
pub use lambda_comparison::LambdaComparison;
pub(crate) use misreadings::undetectable_misreadings;
pub use misreadings::{Misreading, find_misreadings};
pub use refusal::{Coefficient, Refusal};
pub(crate) use refusal_text::place_text;
pub(crate) use vertical_check::VerticalCheck;
