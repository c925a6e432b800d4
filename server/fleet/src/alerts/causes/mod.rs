//! Table of causes: predicates, severity, title, advice, effect on card and plan, and ending.
//!
//! Invariant: every cause has exactly one row. The files below hold the rows by kind.

mod adjustments;
mod agent_link;
mod agent_reports;
mod change_rules;
mod deviation_over_limit;
mod disturbances;
mod evaluate;
mod facts;
mod hysteresis;
mod instruments;
mod model_quality;
mod row;
mod ship_changes;
mod table;

pub(super) use evaluate::{evaluate, evaluate_analysis};
pub(super) use facts::{AgentReports, Facts, OpenCause, Silence, StreamConflict};
pub use facts::{JobAtRisk, UnconfirmedAdjustment};
pub use row::{CardEffect, PlanEffect};
pub(super) use row::{Ending, Source};
pub(super) use table::CAUSES;

#[cfg(test)]
mod tests;
