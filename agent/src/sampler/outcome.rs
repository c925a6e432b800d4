//! Outcomes of ten-second windows, and their counts.

use binnacle_instruments::Refusal;
use std::collections::BTreeMap;

/// Acceptance, or the first reason for rejection.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub(crate) enum Outcome {
    /// Part of a sample.
    Accepted,
    /// Excluded by the crew: alongside.
    ExcludedBerthed,
    /// Excluded by the crew: magnetic cargo on board.
    ExcludedMagneticCargo,
    /// Excluded by the crew: degaussing.
    ExcludedDegaussing,
    /// The GNSS clock jumped while the window was open.
    Clock,
    /// No time stamp in the window.
    NoTime,
    /// No compass heading.
    NoCompass,
    /// Neither gyro nor satellite compass.
    NoReference,
    /// The reference is made of the compass.
    NotIndependent,
    /// The reference is not yet shown to be independent of the compass.
    UnprovenReference,
    /// Two sensors that read differently send as one.
    TwoSensors,
    /// The only reference is a satellite compass, whose receiver is disturbed.
    GnssInterference,
    /// No fresh position.
    NoPosition,
    /// No fresh speed.
    NoSpeed,
    /// Too few readings for a mean.
    Sparse,
    /// Too slow over ground.
    Slow,
    /// Rate of turn above the limit.
    Turning,
    /// Too soon after a turn, or after the start of the agent.
    Settling,
    /// Heading swung too far.
    Swinging,
    /// Horizontal field too weak for a compass.
    HighLatitude,
}

impl Outcome {
    /// Returns the outcome of a window whose heading must not be used.
    pub(super) fn of_refusal(refusal: Refusal) -> Outcome {
        match refusal {
            Refusal::NotIndependent => Outcome::NotIndependent,
            Refusal::Unproven => Outcome::UnprovenReference,
            Refusal::TwoSensors => Outcome::TwoSensors,
            Refusal::Interference => Outcome::GnssInterference,
        }
    }
}

const ALL: [(Outcome, &str); 20] = [
    (Outcome::Accepted, "accepted"),
    (Outcome::ExcludedBerthed, "hold_berthed"),
    (Outcome::ExcludedMagneticCargo, "hold_magnetic_cargo"),
    (Outcome::ExcludedDegaussing, "hold_degaussing"),
    (Outcome::Clock, "clock"),
    (Outcome::NoTime, "no_time"),
    (Outcome::NoCompass, "no_compass"),
    (Outcome::NoReference, "no_reference"),
    (Outcome::NotIndependent, "not_independent"),
    (Outcome::UnprovenReference, "unproven_reference"),
    (Outcome::TwoSensors, "two_sensors"),
    (Outcome::GnssInterference, "gnss_interference"),
    (Outcome::NoPosition, "no_position"),
    (Outcome::NoSpeed, "no_speed"),
    (Outcome::Sparse, "sparse"),
    (Outcome::Slow, "slow"),
    (Outcome::Turning, "turning"),
    (Outcome::Settling, "settling"),
    (Outcome::Swinging, "swinging"),
    (Outcome::HighLatitude, "high_latitude"),
];

/// Windows by outcome.
#[derive(Clone, Debug, Default, PartialEq, Eq)]
pub(crate) struct Tally([u64; ALL.len()]);

impl Tally {
    /// Counts windows.
    pub(crate) fn add(&mut self, outcome: Outcome, windows: u64) {
        let count = &mut self.0[outcome as usize];
        *count = count.saturating_add(windows);
    }

    /// Returns the count of one outcome.
    pub(crate) fn count(&self, outcome: Outcome) -> u64 {
        self.0[outcome as usize]
    }

    /// Returns the non-zero counts by name.
    pub(crate) fn by_name(&self) -> BTreeMap<String, u64> {
        ALL.iter()
            .filter(|(outcome, _)| self.count(*outcome) > 0)
            .map(|(outcome, name)| ((*name).to_owned(), self.count(*outcome)))
            .collect()
    }

    /// Takes the counts and resets them.
    pub(crate) fn take(&mut self) -> Tally {
        std::mem::take(self)
    }

    /// Adds the counts of another tally.
    pub(crate) fn add_all(&mut self, other: &Tally) {
        for (count, more) in self.0.iter_mut().zip(other.0) {
            *count = count.saturating_add(more);
        }
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn every_outcome_is_counted_under_its_own_name() {
        for (index, (outcome, name)) in ALL.iter().enumerate() {
            assert_eq!(*outcome as usize, index, "{name}");
            let mut tally = Tally::default();
            tally.add(*outcome, 2);
            assert_eq!(tally.by_name(), BTreeMap::from([((*name).to_owned(), 2)]));
        }
    }
}
