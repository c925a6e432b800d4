//! Scheduling of compass adjustments: the firm, place and hour for each ship.
//!
//! Invariants: nothing here reads a clock or draws a random number, and the
//! same input gives the same schedule. In reading order:

pub mod time;
pub mod zone;

pub mod ports;
pub mod rules;

pub mod needs;

pub mod calls;

pub mod input;

pub mod plan;

pub mod bookings;

pub mod solve;

#[cfg(feature = "openapi")]
pub mod openapi;
