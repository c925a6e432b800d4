//! λ at the berth: what headings can never tell, from one magnetometer reading.
//!
//! A fitted model knows the field at the compass but for one factor, λ. With
//! the bowl out and a magnetometer in its place, the horizontal field itself
//! gives that factor on any heading, and with it every parameter of Poisson's
//! equations (docs/science.md, §5). The direction of the field is the check: it
//! has to be the model's. A reading that fails it is refused, with what could
//! be wrong; an answer carries standard errors that hold the reading's, the
//! heading's and the model's own.

mod consistency;
mod error;
mod field;
mod lambda;
mod permanent;
mod reading;

pub use consistency::{Consistency, Suspect, Verdict};
pub use error::BerthError;
pub(crate) use field::slopes;
pub use lambda::{
    BerthEstimate, FullParameters, GREATEST_LAMBDA, JointCovariance, LEAST_LAMBDA, USUAL_LAMBDA,
    lambda_at_berth,
};
pub use permanent::{Permanent, permanent_at_berth};
pub use reading::{Alignment, BerthReading, ReadingErrors};

use serde::{Deserialize, Serialize};

/// A number with its standard error.
#[derive(Clone, Copy, Debug, PartialEq, Serialize, Deserialize)]
pub struct Estimated {
    /// The estimate.
    pub value: f64,
    /// Its standard error in the same unit; `None` when the model came without
    /// a covariance.
    pub standard_error: Option<f64>,
}

#[cfg(test)]
mod tests;
