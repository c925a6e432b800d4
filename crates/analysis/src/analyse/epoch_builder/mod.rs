//! Epochs built one after the other from the logbook and the changes found.

mod builder;
mod open_uncertainty;

pub(super) use builder::Course;
