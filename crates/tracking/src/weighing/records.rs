//! Records that the tracker keeps: where it could begin again, and what it weighed and detected.

use super::evidence_sums::EvidenceSums;
use crate::hypotheses::hypothesis::{Begin, Event, Hypothesis};
use crate::hypotheses::kinds::Kind;
use binnacle_compass::time::Timestamp;

/// Filter after some row, with the sums until then.
#[derive(Clone, Debug)]
pub(super) struct Checkpoint {
    pub(super) after: usize,
    pub(super) time: Timestamp,
    pub(super) lead: Hypothesis,
    pub(super) sums: EvidenceSums,
    pub(super) begin: Begin,
}

/// Event that was supposed once, with its log posterior ratio then.
#[derive(Clone, Copy, Debug)]
pub(super) struct Tried {
    pub(super) kind: Kind,
    pub(super) from: Timestamp,
    pub(super) score: f64,
}

/// Subject of a detection: the ship, a reference, what passes by, or the compass.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub(crate) enum Class {
    Ship,
    Reference,
    Passing,
    Compass,
}

impl Class {
    /// Returns the subject of a kind of event.
    pub(super) fn of(kind: Kind) -> Class {
        match kind {
            Kind::Strike | Kind::Cargo | Kind::Alignment | Kind::ShipDrift => Class::Ship,
            Kind::Storm | Kind::Anomaly => Class::Passing,
            Kind::StuckCard => Class::Compass,
            _ => Class::Reference,
        }
    }
}

/// Event that was detected.
#[derive(Clone, Debug)]
pub(crate) struct Detected {
    pub(crate) class: Class,
    pub(crate) event: Event,
    /// Row that made it certain.
    pub(crate) at: Timestamp,
    pub(crate) withdrawn: Option<Timestamp>,
    /// Probability of each kind, the likeliest first.
    pub(crate) kinds: Vec<(Kind, f64)>,
    pub(crate) earliest: Timestamp,
    pub(crate) latest: Timestamp,
}
