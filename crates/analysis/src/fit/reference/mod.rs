//! Reference headings: observations by one true heading from gyro and satellite compass,
//! and the trust in each.
//!
//! A difference between the two references never depends on the vessel's magnetism, so that
//! it is never attributed to the magnetic compass. The usual difference is halved between
//! them, so that the heading does not jump when one drops out; it counts in the standard
//! deviation of the reference's constant. Any other difference is a failure, for an hour or
//! for good. The magnetic compass, by a model of other readings, shows which one has
//! failed, and that one is dropped; where it cannot, both are.

mod check;
mod majority_vote;
mod observe;
mod observe_readings;
mod reading;
mod reference_drift;
mod stuck_reference;

pub use observe_readings::{ObservedReadings, compare_references, observe_readings};
pub use reading::HeadingReading;

#[cfg(test)]
mod tests;
