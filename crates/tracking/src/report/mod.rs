//! Analysis of a compass as epochs, models and changes.

mod analysis;
mod band_scale;
mod detected_changes;
mod frozen_filter;
mod watch_predictions;

pub use analysis::{Input, analyse};
