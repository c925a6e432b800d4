//! Predictions of rows before they are used: their coverage, and the widening of a band that
//! fails.

mod band_scale;
mod frozen_filter;
mod watch_predictions;

pub(crate) use band_scale::widened;
pub(crate) use watch_predictions::WatchPredictions;
