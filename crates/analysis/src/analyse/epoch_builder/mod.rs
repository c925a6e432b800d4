//! Epochs by logbook and changes.

mod builder;
mod open_uncertainty;

pub(super) use builder::EpochBuilder;
