//! From observations of deviation to a [`Model`](crate::model::Model): as it was
//! published ([`fit_paper`]), as today's tools do it ([`fit_ols`]), and as the
//! product does ([`fit_robust`]).

mod csv_row;
mod error;
mod normal;
mod observation;
mod ols;
mod paper;
mod reference;
mod robust;

pub use csv_row::{CsvObservations, CsvRow, CsvRowError, check_columns, observations_from_csv};
pub use error::FitError;
pub use observation::Observation;
pub use ols::fit_ols;
pub use paper::fit_paper;
pub use reference::{GyroSpeedError, Reference, ReferenceCheck, gyro_speed_error_deg};
pub use robust::{REJECTED_BELOW, RobustFit, RobustOptions, RowOutcome, WEAKEST_H_NT, fit_robust};
