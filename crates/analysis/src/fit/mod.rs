//! Fits of observations to a [`Model`](binnacle_compass::model::Model): as published
//! ([`fit_paper`]), as by today's tools ([`fit_ols`]), and the product's own
//! ([`fit_robust`]).

mod csv_row;
mod heading_check;
mod normal_equations;
mod ols;
mod paper;
mod reference;
mod reference_check;
mod residual_check;
mod robust;
mod shared_noise;
mod time_outliers;
mod variation_check;

pub use crate::gyro_speed_error::gyro_speed_error_deg;
pub use crate::observation::{Observation, mean_h_nt};
pub use csv_row::{CsvRow, CsvRowError, Motion, check_columns, readings_from_csv, reference_grade};
pub use heading_check::Headings;
pub use ols::fit_ols;
pub use paper::fit_paper;
pub use reference::{HeadingReading, ObservedReadings, compare_references, observe_readings};
pub use reference_check::check_references;
pub use residual_check::{check_residuals, check_used};
pub use robust::{REJECTED_BELOW, RobustFit, RobustOptions, RowOutcome, fit_robust};
pub use shared_noise::{HeadingPair, SharedNoise, check_independence, weigh_independence};
pub use time_outliers::Gaps;
pub use variation_check::{PossibleMistake, possible_mistake};
