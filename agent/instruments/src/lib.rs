//! Instruments: observations of sources, their age, the roles that rank them, the GNSS clock, and
//! the guard against false fixes.

pub mod config;

mod clock_checkpoint;
mod gnss_clock;
mod gnss_guard;
mod heard;
mod independence;
mod own_output;
mod readings;
mod role;
mod roles;
mod stated_clock;
mod succession;
mod two_sensors;

pub use clock_checkpoint::ClockCheckpoint;
pub use gnss_clock::Trust;
pub use gnss_guard::{GnssGuard, Interference, PlaceCheckpoint, ReckonedPlace, offset};
pub use heard::{HeardSource, HeardSources, SourceReport};
pub use independence::Independence;
pub use own_output::{AGENT_TALKER, OwnHeadings, OwnOutput, SentHeading};
pub use readings::{Latest, Readings};
pub use roles::{Instrument, ReferenceHeading, Refusal, Roles, Signal};
pub use stated_clock::StatedClocks;
