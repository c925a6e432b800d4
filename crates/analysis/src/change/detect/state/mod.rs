//! The detector's state between rows.

mod alternatives;
mod detector;
mod extra_drift;
mod leads;
mod noise_learning;
mod port_departures;

pub(crate) use alternatives::{Doubt, Faint, Rival};
pub(crate) use detector::{Search, earlier};
pub(crate) use extra_drift::Unsettled;
pub(crate) use leads::Leads;
pub(crate) use noise_learning::{Learnt, Lesson};
