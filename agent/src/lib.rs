//! The shipboard agent: instruments → settled windows → samples → spool → shore,
//! and from the shore's model a corrected heading back to the bridge.
#![allow(dead_code)] // until every part is wired

mod clock;
mod config;
mod hold;
mod input;
mod observation;
mod roles;
mod sampler;
mod ship_time;
mod spool;
mod uplink;
