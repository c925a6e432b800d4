//! Observations of instruments: readings with their source, made of sentences, NMEA 2000, Signal K
//! deltas and recordings.
//!
//! Invariants:
//! - A value that the instrument left empty is absent, never zero.
//! - The compass heading is the raw reading, before any deviation.
//! - No bytes cause a panic, and memory is bounded for any input.

pub mod n2k;
pub mod recording;
pub mod signalk;

mod observation;
mod readings;
mod source;

pub use observation::{Observation, RECORDED_TIME, Reading, is_recorded_time};
pub use readings::{readings, timestamp};
pub use source::Source;
