//! Records that the tracker keeps: where it could begin again, and what it weighed and detected.

use super::evidence_sums::EvidenceSums;
use crate::constants::{CALLS_A_YEAR, FALSE_ALARMS_A_YEAR};
use crate::hypotheses::hypothesis::{Begin, Event, Hypothesis};
use crate::hypotheses::kinds::{KINDS, Kind};
use binnacle_compass::time::Timestamp;
use serde::{Deserialize, Serialize};

/// Filter after some row, with the sums until then.
#[derive(Clone, Debug, Serialize, Deserialize)]
pub(super) struct Checkpoint {
    pub(super) after: usize,
    pub(super) time: Timestamp,
    /// Plausible hypotheses, the lead first.
    pub(super) plausible: Vec<Hypothesis>,
    pub(super) sums: EvidenceSums,
    pub(super) begin: Begin,
    /// True if the next row came long after.
    pub(super) before_gap: bool,
}

/// Event that was supposed once, with its log posterior ratio then.
#[derive(Clone, Copy, Debug, Serialize, Deserialize)]
pub(super) struct Tried {
    pub(super) kind: Kind,
    pub(super) from: Timestamp,
    pub(super) score: f64,
}

/// Subject of a detection: the ship, a reference, what passes by, or the compass.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Serialize, Deserialize)]
pub(crate) enum Class {
    Ship,
    Reference,
    Passing,
    Compass,
}

impl Class {
    /// Returns the subject of a kind of event.
    pub(crate) fn of(kind: Kind) -> Class {
        match kind {
            Kind::Strike | Kind::Cargo | Kind::Alignment | Kind::ShipDrift | Kind::Deflection => {
                Class::Ship
            }
            Kind::Storm | Kind::SevereStorm | Kind::Anomaly => Class::Passing,
            Kind::FailedCard => Class::Compass,
            _ => Class::Reference,
        }
    }

    /// Returns the posterior probability from which an event is detected: of as many events a
    /// year as the table has, so many are false as are allowed.
    pub(super) fn threshold(self) -> f64 {
        let of_class = KINDS.iter().filter(|row| Class::of(row.kind) == self);
        let a_year: f64 = of_class
            .map(|row| row.a_year + row.a_call * CALLS_A_YEAR)
            .sum();
        1.0 - FALSE_ALARMS_A_YEAR[self as usize] / a_year
    }
}

/// Event that was detected.
#[derive(Clone, Debug, Serialize, Deserialize)]
pub(crate) struct Detected {
    pub(crate) class: Class,
    pub(crate) event: Event,
    /// Row that made it certain.
    pub(crate) at: Timestamp,
    pub(crate) withdrawn: Option<Timestamp>,
    /// Posterior of the event when it was last judged.
    pub(crate) posterior: EventPosterior,
}

/// Posterior of one event of a class, by all hypotheses.
#[derive(Clone, Debug, Serialize, Deserialize)]
pub(crate) struct EventPosterior {
    /// Probability that such an event happened.
    pub(crate) probability: f64,
    /// Probability of each kind of the class, the likeliest first.
    pub(crate) kinds: Vec<(Kind, f64)>,
    /// Probability of each kind of another class in its place, the likeliest first.
    pub(crate) instead: Vec<(Kind, f64)>,
    /// Probability that it happened in port.
    pub(crate) in_port: f64,
    /// Probability that it is over, and the likeliest end.
    pub(crate) is_over: f64,
    pub(crate) end: Option<Timestamp>,
    pub(crate) earliest: Timestamp,
    pub(crate) latest: Timestamp,
}
