//! The batch: samples of one stream, sealed, numbered and never changed again.

use binnacle_magnetics::sample::Sample;
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
}
