//! Who adjusts which ship's compass, where and when.
//!
//! What always holds: nothing here reads a clock or draws a random number; the same
//! input gives the same schedule. In reading order:

pub mod time;
pub mod zone;

pub mod ports;
pub mod rules;

pub mod needs;

pub mod calls;

pub mod input;

pub mod plan;

pub mod solve;
