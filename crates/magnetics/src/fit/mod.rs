//! From observations of deviation to a [`Model`](crate::model::Model).

mod error;

pub use error::FitError;
