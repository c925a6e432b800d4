//! Data acquisition: from observations through roles and sampler to samples, with the latest
//! readings.

use crate::config::RolesConfig;
use crate::instruments::{
    ClockCheckpoint, Observation, Reading, Readings, Roles, is_recorded_time,
};
use crate::sampler::{Exclusion, Sampler};
use binnacle_compass::time::Timestamp;
use binnacle_wire::messages::Settings;
use tokio::time::Instant;

/// Roles, sampler and latest readings of one vessel.
#[derive(Debug)]
pub(crate) struct Acquisition {
    roles: Roles,
    /// Sampler fed with the signals of the instruments.
    pub(crate) sampler: Sampler,
    /// Latest readings of the instruments.
    pub(crate) readings: Readings,
}

impl Acquisition {
    /// Creates an acquisition without any observation.
    pub(crate) fn new(
        roles: &RolesConfig,
        stale_s: f64,
        settings: Settings,
        exclusion: Option<Exclusion>,
    ) -> Acquisition {
        Acquisition {
            roles: Roles::new(roles, stale_s),
            sampler: Sampler::new(settings, exclusion),
            readings: Readings::default(),
        }
    }

    /// Returns the vessel's GNSS time, once it is known.
    pub(crate) fn time(&self) -> Option<Timestamp> {
        self.roles.now()
    }

    /// Describes the fault of the vessel's clock, if there is one.
    pub(crate) fn clock_problem(&self) -> Option<String> {
        self.roles.clock_problem()
    }

    /// Sets the computer's time as the reference that jumps of receivers are checked against. Not
    /// for recordings.
    pub(crate) fn set_reference_time(&mut self, time: Timestamp, now: Instant) {
        self.roles.clock().set_reference(time, now);
    }

    /// Restores the clock readings saved before the restart.
    pub(crate) fn restore_clock_checkpoint(&mut self, before: ClockCheckpoint) {
        self.roles.clock().restore_checkpoint(before);
    }

    /// Returns the vessel's GNSS time unless it is uncertain.
    pub(crate) fn reliable_time(&self) -> Option<Timestamp> {
        self.roles.reliable_time()
    }

    /// Corrects the reference by the server's time, which is better than the computer's.
    pub(crate) fn correct_reference_time(&mut self, time: Timestamp, now: Instant) {
        self.roles.clock().correct_reference(time, now);
    }

    /// Applies an observation received at `heard`.
    pub(crate) fn observe(&mut self, seen: &Observation, heard: Instant) {
        self.roles.clock().set_receive_time(heard);
        if let Reading::Time(at) = seen.reading
            && is_recorded_time(seen)
        {
            self.observe_recorded_time(at);
            return;
        }
        for signal in self.roles.observe(seen).into_iter().flatten() {
            self.sampler.apply(signal);
            self.readings.apply(signal, heard);
        }
    }

    /// Applies the time stamp that a recording gives a line.
    fn observe_recorded_time(&mut self, stamp: Timestamp) {
        if let Some(signal) = self.roles.observe_recorded_time(stamp) {
            self.sampler.apply(signal);
        }
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn the_time_of_a_recording_ranks_behind_the_receivers() {
        let mut acquisition =
            Acquisition::new(&RolesConfig::usual(), 15.0, Settings::default(), None);
        let at = |text| Timestamp::parse(text).unwrap();
        let mut say = |talker, sentence, time| {
            let seen = Observation {
                input: "log".into(),
                talker,
                sentence,
                reading: Reading::Time(at(time)),
            };
            acquisition.observe(&seen, Instant::now());
            acquisition.time()
        };
        // A recorder in the time zone of the port, and a receiver.
        let (log, zda) = ((*b"--", *b"LOG"), (*b"GP", *b"ZDA"));
        say(zda.0, zda.1, "2026-01-02T12:00:00Z");
        say(log.0, log.1, "2026-01-02T13:00:01Z");
        say(log.0, log.1, "2026-01-02T13:00:02Z");
        let now = say(zda.0, zda.1, "2026-01-02T12:00:03Z");
        assert_eq!(now, Some(at("2026-01-02T12:00:03Z")));
    }

    #[test]
    fn the_time_of_a_recording_serves_where_there_is_no_receiver() {
        let roles = RolesConfig {
            position: Vec::new(),
            ..RolesConfig::usual()
        };
        let mut acquisition = Acquisition::new(&roles, 15.0, Settings::default(), None);
        let at = Timestamp::parse("2026-01-02T13:00:01Z").unwrap();
        let seen = Observation {
            input: "log".into(),
            talker: *b"--",
            sentence: *b"LOG",
            reading: Reading::Time(at),
        };
        acquisition.observe(&seen, Instant::now());
        assert_eq!(acquisition.time(), Some(at));
    }
}
