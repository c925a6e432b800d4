//! Alerts of the agent itself: the corrected compass and its references disagree, a plain
//! difference of headings, and GNSS interference. They need no link.
//!
//! Invariants of the first, which the server gets as well:
//!
//! - Only settled windows are judged: none in turns, none before the compass has come to rest after
//!   one, none under an exclusion, none without a valid card. Delays are counted in settled
//!   windows, so no clock can shorten or extend them.
//! - At most one alert is open. It is raised once, changed by revisions, and closed once.
//! - A revision is in the spool before it is published, together with the batch that carries it to
//!   the server.

mod alarm_sentence;
mod condition;
mod heading_difference;
mod interference;
mod monitor;
mod record;

pub(crate) use alarm_sentence::AlarmSentence;
pub(crate) use heading_difference::{
    Comparison, DifferenceMonitor, DifferenceReference, HeadingDifference, HeadingDifferenceStatus,
};
pub(crate) use interference::{InterferenceMonitor, InterferenceStatus};
pub(crate) use monitor::{ActiveCard, AlertMonitor};
pub(crate) use record::{AlertRecord, AlertStatus};
