//! Samples of one compass as an analysis takes them: with the earth's field, the deviation
//! that they show, and the reason for which one is left out.
//!
//! The order of the samples and repeated samples change nothing. No sample is left out
//! without a reason.

pub mod berth_stays;
pub mod interference;
pub mod logbook_rules;
pub mod reading;
pub mod steady_course;
pub mod stuck_compass;
