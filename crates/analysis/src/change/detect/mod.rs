//! Detector of changes: `decision.rs` decides, `acceptance.rs` carries out.

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
