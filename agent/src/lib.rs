//! The shipboard agent: instruments → settled windows → samples → spool → shore,
//! and from the shore's model a corrected heading back to the bridge.
//!
//! A library only so that tests can reach it; the program is `main.rs`.

pub mod cli;
mod run;

mod config;

mod input;
mod observation;

mod alert;
mod gnss_clock;
mod roles;
mod sampler;
mod ship;
mod weak_field;

mod raw_log;
mod spool;

mod short_burst;
mod uplink;

mod card_invalidation;
mod corrected_heading;
mod output;

mod http_limits;
mod offline;
mod page;
mod reports;
mod status;

mod atomic_file;
mod replay;

mod clock;
mod clock_checkpoint;
