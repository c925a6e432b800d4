//! The agent's own alert: the compass, corrected by its model, and the gyro have
//! parted. It needs no link.
//!
//! What always holds:
//!
//! - It is judged on settled windows alone: not in turns, nor until the compass has
//!   come to rest after one, nor under a hold, nor where the card was withdrawn or
//!   never was. Waiting is counted in settled windows, so no clock can hurry or hold
//!   it up.
//! - There is one alert at a time. It is raised once, changed by revisions, and ended
//!   once.
//! - What is known of it is in the spool before it is anywhere else, together with
//!   the batch that carries it ashore.

mod monitor;
mod record;

pub(crate) use monitor::{ActiveCard, AlertMonitor};
pub(crate) use record::{AlertRecord, AlertStatus};
