//! The detector of changes.

mod acceptance;
mod competing_hypothesis;
mod dating;
mod decision;
mod logbook_cargo;
mod run;
mod state;
mod step_refit;
mod transient_end;
mod undecided_step;
mod undetected_step;
mod weak_transient;
mod withdrawal;

pub(crate) use run::detect;

/// Rows between times that are tried: about an hour of sailing.
pub(crate) const EVERY: usize = 6;
/// After a gap of this the next row is a time to be tried, whatever the count.
pub(crate) const GAP_S: f64 = 2.0 * 3600.0;
