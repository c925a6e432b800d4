//! The shipboard agent: instruments → settled windows → samples → spool → server, and from the
//! server's model a corrected heading back to the bridge.
//!
//! A library only so that tests can reach it; the program is `main.rs`.

pub mod commands;
mod run;

mod config;

mod acquisition;
mod alert;
mod discovery;
mod sampler;
mod weak_field;

mod raw_log;
mod spool;

mod short_burst;
mod uplink;

mod card_invalidation;
mod corrected_heading;

mod page;
mod status;

mod atomic_file;
mod replay;

mod clock;
