//! λ at the berth from one magnetometer reading, which headings cannot determine.
//!
//! A fitted model gives the field at the compass except for one factor, λ. With the bowl
//! out and a magnetometer in its place, the horizontal field gives that factor on any
//! heading, and with it every parameter of Poisson's equations (docs/science.md, §5). The
//! direction of the field is the check: it must agree with the model's. A reading that
//! fails it is refused with possible reasons. Standard errors include those of the reading,
//! the heading and the model.

mod estimated;
mod reading;
mod reading_errors;

mod consistency;
mod lambda_range;

mod lambda;
mod permanent;
mod two_headings;

mod direction_check;
mod error;
mod expected_field;

pub use consistency::{Consistency, Suspect, Verdict};
pub use error::BerthError;
pub use estimated::Estimated;
pub(crate) use expected_field::slopes;
pub use lambda::{BerthEstimate, FullParameters, JointCovariance, lambda_at_berth};
pub use lambda_range::{GREATEST_LAMBDA, LEAST_LAMBDA, USUAL_LAMBDA};
pub use permanent::{Permanent, permanent_at_berth};
pub use reading::{Alignment, BerthReading};
pub use reading_errors::ReadingErrors;
pub use two_headings::{TwoHeadings, lambda_by_two_headings};

#[cfg(test)]
mod tests;
