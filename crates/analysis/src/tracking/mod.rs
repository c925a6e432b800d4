//! Tracking of a ship's magnetism by weighed hypotheses (multiple-hypothesis tracking).

mod analysis;
mod evidence_sums;
mod filter;
mod hypothesis;
mod kinds;
mod learning;
mod levels;
mod row;
mod scalar;
mod ship_state;
mod starts;
mod states;
mod told_changes;
mod tracker;
mod transition;
pub mod study;

pub use analysis::analyse;
