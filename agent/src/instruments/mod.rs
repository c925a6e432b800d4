//! Instruments: observations of sources, the roles that rank them, and the GNSS clock.

mod clock_checkpoint;
mod gnss_clock;
mod observation;
mod readings;
mod role;
mod roles;

pub(crate) use clock_checkpoint::ClockCheckpoint;
pub(crate) use observation::{AGENT_TALKER, Observation, RECORDED_TIME, Reading, is_recorded_time};
pub(crate) use readings::{Latest, Readings};
#[cfg(test)]
pub(crate) use roles::ReferenceHeading;
pub(crate) use roles::{Roles, Signal};
