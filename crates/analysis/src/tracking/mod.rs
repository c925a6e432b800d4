//! Tracking of a ship's magnetism by weighed hypotheses (multiple-hypothesis tracking).

mod evidence_sums;
mod filter;
mod hypothesis;
mod kinds;
mod learning;
mod levels;
mod row;
mod scalar;
mod starts;
mod states;
mod tracker;
mod transition;
pub mod study;
