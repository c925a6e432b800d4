//! The batch: samples of one stream, sealed, numbered and never changed again.

use crate::alert::ShipAlert;
use binnacle_compass::sample::Sample;
use serde::{Deserialize, Serialize};
use std::collections::BTreeMap;
use std::fmt;
use uuid::Uuid;

/// One compass as one agent installation reports it.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Hash, PartialOrd, Ord, Serialize, Deserialize)]
#[serde(transparent)]
pub struct StreamId(pub Uuid);

impl fmt::Display for StreamId {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        self.0.fmt(f)
    }
}

/// Samples of one stream, and what was refused since the batch before.
#[derive(Clone, Debug, PartialEq)]
pub struct Batch {
    /// The stream the samples belong to.
    pub stream: StreamId,
    /// Number within the stream, from 1, without gaps.
    pub seq: u64,
    /// In order of time; may be empty when only the tally has news.
    pub samples: Vec<Sample>,
    /// Ten-second windows since the batch before, by outcome: `accepted` or the
    /// name of the reason for refusal.
    pub tally: BTreeMap<String, u64>,
    /// What the ship says of alerts of her own.
    pub alerts: Vec<ShipAlert>,
    /// What was left out for want of room or budget.
    pub thinned: Option<Thinned>,
}

/// Samples that were sealed in a batch and left out again before it was sent. Which
/// ones was decided by heading, time and length alone, never by how far compass and
/// reference differed: what is left is as good a picture, of fewer windows.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq, Serialize, Deserialize)]
pub struct Thinned {
    /// How many samples.
    pub samples: u64,
    /// The windows in them, which the tally counts as accepted.
    pub windows: u64,
}
