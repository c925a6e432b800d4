//! Counts of an input, shared between its task and the status page.

use binnacle_nmea::Tally;
use binnacle_observation::signalk::DeltaCounts;
use serde::Serialize;
use std::collections::BTreeMap;
use std::sync::{Mutex, MutexGuard, PoisonError};
use std::time::Instant;

/// Counts since the agent started; updated once per chunk of bytes.
#[derive(Debug, Default)]
pub struct InputStats(Mutex<Counts>);

#[derive(Debug, Default)]
struct Counts {
    connected: bool,
    problem: Option<String>,
    times_opened: u64,
    bytes: u64,
    observations: u64,
    dropped: u64,
    sentences: Tally,
    /// Signal K values in use, and rejected deltas and values.
    values: DeltaCounts,
    last_heard: Option<Instant>,
}

/// Snapshot of an input's counts.
#[derive(Clone, Debug, Default, PartialEq, Serialize)]
pub struct InputStatus {
    /// Open or connected.
    pub connected: bool,
    /// Reason for the last closing, while it is not open.
    pub problem: Option<String>,
    /// Seconds since the last byte.
    pub last_heard_s_ago: Option<f64>,
    /// Bytes received.
    pub bytes: u64,
    /// Observations delivered.
    pub observations: u64,
    /// Observations dropped because the channel was full (datagrams only).
    pub dropped: u64,
    /// Number of times it was reopened.
    pub reconnects: u64,
    /// Parsed sentences and Signal K values, by kind.
    pub sentences: BTreeMap<&'static str, u64>,
    /// Unused lines, deltas and values, by reason.
    pub rejected: BTreeMap<&'static str, u64>,
}

impl InputStats {
    /// Returns the counts now.
    pub fn status(&self) -> InputStatus {
        let counts = self.lock();
        let mut sentences: BTreeMap<_, _> = counts.sentences.sentences().collect();
        sentences.extend(&counts.values.values);
        let mut rejected: BTreeMap<_, _> = counts.sentences.rejected().collect();
        rejected.extend(&counts.values.rejected);
        InputStatus {
            connected: counts.connected,
            problem: counts.problem.clone(),
            last_heard_s_ago: counts.last_heard.map(|at| at.elapsed().as_secs_f64()),
            bytes: counts.bytes,
            observations: counts.observations,
            dropped: counts.dropped,
            reconnects: counts.times_opened.saturating_sub(1),
            sentences,
            rejected,
        }
    }

    pub(crate) fn bytes(&self) -> u64 {
        self.lock().bytes
    }

    pub(crate) fn opened(&self) {
        let mut counts = self.lock();
        counts.connected = true;
        counts.problem = None;
        counts.times_opened += 1;
    }

    /// Marks the input as closed. Returns whether the reason has changed.
    pub(crate) fn closed(&self, problem: &str) -> bool {
        let mut counts = self.lock();
        counts.connected = false;
        if counts.problem.as_deref() == Some(problem) {
            return false;
        }
        counts.problem = Some(problem.to_owned());
        true
    }

    /// Counts a received chunk.
    pub(crate) fn count_received(&self, bytes: usize, sentences: &Tally) {
        let mut counts = self.lock();
        counts.bytes += bytes as u64;
        counts.sentences.add(sentences);
        counts.last_heard = Some(Instant::now());
    }

    pub(crate) fn count_delivered(&self, observations: usize) {
        self.lock().observations += observations as u64;
    }

    pub(crate) fn count_dropped(&self, observations: usize) {
        self.lock().dropped += observations as u64;
    }

    pub(crate) fn count_values(&self, values: &DeltaCounts) {
        self.lock().values.add(values);
    }

    pub(crate) fn reject(&self, reason: &'static str) {
        *self.lock().values.rejected.entry(reason).or_default() += 1;
    }

    /// Counts stay consistent when a thread dies between two of them.
    fn lock(&self) -> MutexGuard<'_, Counts> {
        self.0.lock().unwrap_or_else(PoisonError::into_inner)
    }
}
