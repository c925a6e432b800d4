//! Role of one instrument: its sources, ranked.
//!
//! A source is used while no better one has been heard within the silence limit.

use super::observation::{AGENT_TALKER, Observation, Reading};
use crate::config::SourceConfig;
use binnacle_compass::sample::SourceId;
use binnacle_compass::time::Timestamp;
use std::sync::Arc;

/// Sources of one instrument, best first.
#[derive(Debug)]
pub(super) struct Role {
    sources: Vec<Source>,
    stale_s: f64,
}

#[derive(Debug)]
pub(super) struct Source {
    input: Option<Arc<str>>,
    config: SourceConfig,
    id: SourceId,
    heard: Heard,
}

#[derive(Clone, Copy, Debug, PartialEq)]
enum Heard {
    Never,
    /// Before GNSS time was known.
    Timeless,
    At(Timestamp),
}

impl Role {
    pub(super) fn new(sources: &[SourceConfig], stale_s: f64) -> Role {
        let sources = sources.iter().map(|config| Source {
            input: config
                .input
                .as_ref()
                .map(|name| name.get_ref().as_str().into()),
            config: config.clone(),
            id: SourceId::from_name(&config.name()),
            heard: Heard::Never,
        });
        Role {
            sources: sources.collect(),
            stale_s,
        }
    }

    /// Returns the number of sources.
    pub(super) fn source_count(&self) -> usize {
        self.sources.len()
    }

    /// Records a reading of a source. Returns the source's identity if it is in use.
    pub(super) fn note_reading(
        &mut self,
        seen: &Observation,
        now: Option<Timestamp>,
    ) -> Option<SourceId> {
        let rank = self.rank(seen)?;
        self.sources[rank].heard = now.map_or(Heard::Timeless, Heard::At);
        self.is_best(rank, now).then_some(self.sources[rank].id)
    }

    /// Records that a source is invalid. Returns whether it was in use.
    pub(super) fn note_invalid(&mut self, seen: &Observation, now: Option<Timestamp>) -> bool {
        let Some(rank) = self.rank(seen) else {
            return false;
        };
        self.sources[rank].heard = Heard::Never;
        self.is_best(rank, now)
    }

    pub(super) fn is_best(&self, rank: usize, now: Option<Timestamp>) -> bool {
        !self.sources[..rank]
            .iter()
            .any(|better| self.is_alive(better, now))
    }

    fn is_alive(&self, source: &Source, now: Option<Timestamp>) -> bool {
        match (source.heard, now) {
            (Heard::At(heard), Some(now)) => now.seconds_since(heard).abs() <= self.stale_s,
            (Heard::Timeless, None) => true,
            _ => false,
        }
    }

    pub(super) fn rank(&self, seen: &Observation) -> Option<usize> {
        self.sources.iter().position(|source| source.matches(seen))
    }

    /// Returns the rank of the source on the same device: ZDA and VTG come from the receiver whose
    /// position is used.
    pub(super) fn device_rank(&self, seen: &Observation) -> Option<usize> {
        self.sources
            .iter()
            .position(|source| source.matches_device(seen))
    }
}

impl Source {
    fn matches(&self, seen: &Observation) -> bool {
        if self
            .config
            .sentence
            .is_some_and(|wanted| wanted != seen.sentence)
        {
            return false;
        }
        // Without a configured talker, the agent's own output is excluded: on a shared line a dead
        // compass would live on as its echo.
        if self.config.talker.is_none()
            && seen.talker == AGENT_TALKER
            && matches!(&seen.sentence, b"HDG" | b"THS")
        {
            return false;
        }
        // A magnetic heading is a raw one only where the configuration says so.
        if matches!(seen.reading, Reading::Magnetic(_)) && !self.config.raw {
            return false;
        }
        self.matches_device(seen)
    }

    fn matches_device(&self, seen: &Observation) -> bool {
        self.config.matches_talker(seen.talker)
            && self
                .input
                .as_ref()
                .is_none_or(|input| **input == *seen.input)
    }
}
