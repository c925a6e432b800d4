//! The batch: samples of one stream, sealed, numbered and never changed again.

use crate::alert::ShipAlert;
use binnacle_compass::sample::Sample;
use serde::{Deserialize, Serialize};
use std::collections::BTreeMap;
use std::fmt;
use uuid::Uuid;

/// Id of a stream: one compass as one agent installation reports it.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Hash, PartialOrd, Ord, Serialize, Deserialize)]
#[serde(transparent)]
pub struct StreamId(pub Uuid);

impl fmt::Display for StreamId {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        self.0.fmt(f)
    }
}

/// Samples of one stream, and the windows counted since the batch before.
#[derive(Clone, Debug, PartialEq)]
pub struct Batch {
    /// The stream the samples belong to.
    pub stream: StreamId,
    /// Number within the stream, from 1, without gaps.
    pub seq: u64,
    /// Samples in order of time; empty when only the tally changed.
    pub samples: Vec<Sample>,
    /// Ten-second windows since the batch before, by outcome: `accepted` or the
    /// name of the reason for refusal.
    pub tally: BTreeMap<String, u64>,
    /// Alerts raised on board.
    pub alerts: Vec<ShipAlert>,
    /// Samples removed for lack of disk space or budget.
    pub thinned: Option<Thinned>,
}

/// Samples that were sealed in a batch and removed again before it was sent.
///
/// Heading, time and length alone decide which ones, never the difference of
/// compass and reference. The remaining samples are therefore unbiased, with
/// fewer windows.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq, Serialize, Deserialize)]
pub struct Thinned {
    /// Number of samples.
    pub samples: u64,
    /// Windows in them, which the tally counts as accepted.
    pub windows: u64,
}
