//! Instruments: observations of sources, their age, the roles that rank them, the GNSS clock, and
//! the guard against false fixes.

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
mod two_sensors;

pub(crate) use clock_checkpoint::ClockCheckpoint;
pub(crate) use gnss_guard::{GnssGuard, Interference, ReckonedPlace, offset};
pub(crate) use heard::{HeardSource, HeardSources, SourceReport};
pub(crate) use independence::Independence;
pub(crate) use own_output::{AGENT_TALKER, OwnHeadings, OwnOutput, SentHeading};
pub(crate) use readings::{Latest, Readings};
#[cfg(test)]
pub(crate) use roles::ReferenceHeading;
pub(crate) use roles::{Instrument, Refusal, Roles, Signal};
pub(crate) use stated_clock::StatedClocks;
