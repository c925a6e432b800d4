//! From what was read to observations: one true heading out of a gyro and a
//! satellite compass, and which of them to believe.
//!
//! What always holds: a difference between the two references never depends on
//! the ship's magnetism, so that it is never put down to the magnetic compass.
//! The usual one is halved between them, so that the reference does not jump when
//! one drops out, and stands in the standard deviation of the reference's
//! constant. Any other is a failure, be it of an hour or for good: the magnetic
//! compass, by a model of other readings, tells which has failed, and that one is
//! dropped; where it cannot tell, both are.

mod check;
mod majority_vote;
mod observe;
mod reading;
mod refer;
mod reference_drift;
mod stuck_reference;

pub use reading::HeadingReading;
pub use refer::{Referred, refer};

#[cfg(test)]
mod tests;
