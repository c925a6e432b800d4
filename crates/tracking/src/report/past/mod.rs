//! Settled past of a voyage: what the report needs of readings that are judged no more.
//!
//! A reading is settled when later ones can change no date about it. Its diagnosis is final
//! then, and it goes into sums. What was found among settled readings is kept as it was
//! reported.

mod piece;
mod tally;

pub(super) use piece::{Piece, stronger};
pub(super) use tally::Tally;

use super::by_course::CourseUse;
use super::kept::{SettledReading, json, micros};
use super::row_times::RowTime;
use crate::weighing::records::{Class, Detected};
use binnacle_compass::coverage::Coverage;
use binnacle_compass::result::{Change, Epoch};
use binnacle_compass::time::Timestamp;
use serde::{Deserialize, Serialize};

/// Settled past.
#[derive(Default, Serialize, Deserialize)]
pub(super) struct Past {
    /// Readings in order of time, those of an epoch in one part of the voyage each.
    pub(super) pieces: Vec<Piece>,
    /// Some of the readings since the work on ship or compass before those that are not settled.
    pub(super) sampled: Vec<SettledReading>,
    /// Rows next to the dates that a report may ask for, in order of time.
    pub(super) rows: Vec<RowTime>,
    pub(super) coverage: Coverage,
    pub(super) course: Option<CourseUse>,
    /// Epochs that are over, the first first.
    #[serde(with = "json")]
    pub(super) epochs: Vec<Epoch>,
    /// Changes by the marks of readings: stuck compass, interference, berths.
    #[serde(with = "json")]
    pub(super) marked: Vec<Change>,
    /// Changes by events that are over.
    pub(super) events: Vec<SettledEvent>,
}

/// Change by an event that is over.
#[derive(Clone, Serialize, Deserialize)]
pub(super) struct SettledEvent {
    key: EventKey,
    #[serde(with = "json")]
    change: Change,
}

/// Identity of an event.
#[derive(Clone, Copy, PartialEq, Serialize, Deserialize)]
struct EventKey {
    class: Class,
    #[serde(with = "micros")]
    from: Timestamp,
    until: Option<Timestamp>,
    withdrawn: Option<Timestamp>,
}

impl EventKey {
    fn of(detected: &Detected) -> EventKey {
        EventKey {
            class: detected.class,
            from: detected.event.from,
            until: detected.event.until,
            withdrawn: detected.withdrawn,
        }
    }
}

impl SettledEvent {
    /// Settles the change by an event if nothing of it is later than a time. A change of the
    /// ship is compared with the ship as it is known later.
    pub(super) fn of(
        detected: &Detected,
        change: &Change,
        before: Timestamp,
    ) -> Option<SettledEvent> {
        let over = match detected.class {
            Class::Ship => detected.withdrawn,
            _ => detected.withdrawn.or(change.ended),
        };
        let is_over = detected.event.from < before && over.is_some_and(|over| over < before);
        is_over.then(|| SettledEvent {
            key: EventKey::of(detected),
            change: change.clone(),
        })
    }
}

impl Past {
    /// Returns the time of the first reading.
    pub(super) fn from(&self) -> Option<Timestamp> {
        self.pieces.first().map(|piece| piece.from)
    }

    /// Returns the change by an event that is settled.
    pub(super) fn change(&self, detected: &Detected) -> Option<&Change> {
        let key = EventKey::of(detected);
        let known = self.events.iter().find(|event| event.key == key);
        known.map(|event| &event.change)
    }

    /// Returns true if a reading between two times has both references.
    pub(super) fn has_both(&self, from: Timestamp, until: Option<Timestamp>) -> bool {
        let within = self
            .pieces
            .iter()
            .filter(|piece| piece.until > from && until.is_none_or(|until| piece.from <= until));
        within.into_iter().any(|piece| piece.has_both)
    }
}
