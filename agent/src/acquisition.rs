//! Data acquisition: from observations through roles and sampler to samples, with the latest
//! readings.

use crate::sampler::{Exclusion, Sampler};
use binnacle_compass::angle::TrueHeading;
use binnacle_compass::time::Timestamp;
use binnacle_instruments::config::{RolesConfig, SilenceConfig};
use binnacle_instruments::{
    ClockCheckpoint, GnssGuard, HeardSources, Independence, Interference, OwnHeadings, OwnOutput,
    PlaceCheckpoint, Readings, ReckonedPlace, Roles, SentHeading, Signal, SourceReport,
    StatedClocks, Trust,
};
use binnacle_observation::{Observation, Reading, is_recorded_time};
use binnacle_wire::messages::Settings;
use std::time::Duration;
use tokio::time::Instant;

/// Time for which a source that is heard no more is still named as a problem.
const NAMED_FOR: Duration = Duration::from_mins(1);

/// Roles, sampler and latest readings of one vessel.
#[derive(Debug)]
pub(crate) struct Acquisition {
    roles: Roles,
    clocks: StatedClocks,
    own_output: OwnOutput,
    independence: Independence,
    guard: GnssGuard,
    /// Every source that is heard.
    pub(crate) heard: HeardSources,
    /// Set for recordings: their sources have the rates of the recorded time.
    is_recorded: bool,
    start: Instant,
    /// Sampler fed with the signals of the instruments.
    pub(crate) sampler: Sampler,
    /// Latest readings of the instruments.
    pub(crate) readings: Readings,
}

impl Acquisition {
    /// Creates an acquisition without any observation.
    pub(crate) fn new(
        roles: &RolesConfig,
        silence: &SilenceConfig,
        settings: Settings,
        exclusion: Option<Exclusion>,
    ) -> Acquisition {
        Acquisition {
            roles: Roles::new(roles, silence),
            clocks: StatedClocks::default(),
            own_output: OwnOutput::new(OwnHeadings::default()),
            independence: Independence::default(),
            guard: GnssGuard::new(silence.stale_s(silence.position.sampling())),
            heard: HeardSources::default(),
            is_recorded: false,
            start: Instant::now(),
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

    /// Gives sources the rates of the recorded time.
    pub(crate) fn set_recorded(&mut self) {
        self.is_recorded = true;
    }

    /// Sets the headings that the agent sends.
    pub(crate) fn set_own_headings(&mut self, headings: OwnHeadings) {
        self.roles.add_own_headings(&headings.sentences);
        self.own_output = OwnOutput::new(headings);
    }

    /// Records a heading as it is sent to the bridge.
    pub(crate) fn note_sent(&mut self, heading: SentHeading, now: Instant) {
        self.own_output.note_sent(heading, now);
    }

    /// Describes sources that must not be used as they are configured.
    pub(crate) fn source_problems(&self, now: Instant) -> Vec<String> {
        let mut problems = self.roles.problems(now, NAMED_FOR);
        problems.extend(self.guard.problems());
        problems.extend(self.independence.problems());
        let repeaters = self.own_output.repeaters();
        problems.extend(
            repeaters
                .map(|source| format!("{source} repeats the agent's own output, and is not used")),
        );
        problems
    }

    /// Returns every source that is heard, with the roles that it serves.
    pub(crate) fn sources(&self, now: Instant) -> Vec<SourceReport> {
        let sources = self.heard.sorted().into_iter();
        let reports = sources.map(|(source, heard)| {
            let mut uses = Vec::new();
            for seen in &heard.values {
                let new = self.roles.uses(seen).into_iter();
                uses.extend(new.filter(|used| !uses.contains(used)).collect::<Vec<_>>());
            }
            heard.report(source, &uses, now)
        });
        reports.collect()
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
        if let Reading::Greeting(at) = seen.reading {
            self.clocks.note_greeting(&seen.source.input, at, heard);
            return;
        }
        // Commands are for the agent's alerts; they are no reading of an instrument.
        if matches!(seen.reading, Reading::AlertCommand(_)) {
            return;
        }
        let age = self.clocks.age(&seen.source, seen.stated, heard);
        let is_echo = self.own_output.is_echo(seen, heard);
        let seconds = self.seconds(heard);
        if let Some(source) = self.heard.note(seen, heard, age, seconds) {
            source.mark_own_output(is_echo);
        }
        let Some(age) = age.filter(|_| !is_echo) else {
            return;
        };
        let Some(measured) = heard.checked_sub(age) else {
            return;
        };
        let receiver = self.roles.receiver(seen);
        let trust = receiver.map_or(Trust::Trusted, |receiver| self.guard.trust(receiver));
        let signals = self.roles.observe(seen, measured, age, trust);
        self.guard.advance(self.roles.running_time(), heard);
        for signal in signals.into_iter().flatten() {
            for signal in self.guard.apply(signal, receiver).into_iter().flatten() {
                if matches!(signal, Signal::Position(_)) {
                    self.roles.note_position_used(&seen.source);
                }
                let refused = self.independence.observe(signal);
                self.sampler.apply(refused.unwrap_or(signal));
                self.readings.apply(signal, measured);
            }
        }
    }

    /// Returns the ship's place, to be saved at a computer's time.
    pub(crate) fn place_checkpoint(&self, computer: Timestamp) -> Option<PlaceCheckpoint> {
        self.guard.checkpoint(computer)
    }

    /// Restores the place saved before the restart, given the computer's time now.
    pub(crate) fn restore_place_checkpoint(&mut self, saved: PlaceCheckpoint, computer: Timestamp) {
        self.guard.restore(saved, computer);
    }

    /// Records the corrected heading, by which the ship is reckoned where there is no gyro.
    pub(crate) fn note_corrected(&mut self, heading: Option<TrueHeading>) {
        self.guard.note_corrected(heading);
    }

    /// Returns the ship's place now, by dead reckoning from the last trusted fix.
    pub(crate) fn place(&mut self, now: Instant) -> Option<ReckonedPlace> {
        self.guard.advance(self.roles.running_time(), now);
        self.guard.place()
    }

    /// Returns the interference with the receivers, if there is any.
    pub(crate) fn interference(&self) -> Option<Interference> {
        self.guard.interference()
    }

    /// Returns the time from which rates follow.
    fn seconds(&self, heard: Instant) -> f64 {
        match self.roles.now().filter(|_| self.is_recorded) {
            Some(time) => time.micros() as f64 / 1e6,
            None => heard.saturating_duration_since(self.start).as_secs_f64(),
        }
    }

    /// Applies the time stamp that a recording gives a line.
    fn observe_recorded_time(&mut self, stamp: Timestamp) {
        if let Some(signal) = self.roles.observe_recorded_time(stamp) {
            self.independence.observe(signal);
            self.sampler.apply(signal);
        }
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use binnacle_observation::Source;

    fn silence() -> SilenceConfig {
        SilenceConfig::default()
    }

    #[test]
    fn the_time_of_a_recording_ranks_behind_the_receivers() {
        let mut acquisition =
            Acquisition::new(&RolesConfig::usual(), &silence(), Settings::default(), None);
        let at = |text| Timestamp::parse(text).unwrap();
        let mut say = |talker, sentence, time| {
            let source = Source::of_sentence("log".into(), talker, sentence);
            let seen = Observation::now(source, Reading::Time(at(time)));
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
        let mut acquisition = Acquisition::new(&roles, &silence(), Settings::default(), None);
        let at = Timestamp::parse("2026-01-02T13:00:01Z").unwrap();
        let source = Source::of_sentence("log".into(), *b"--", *b"LOG");
        let seen = Observation::now(source, Reading::Time(at));
        acquisition.observe(&seen, Instant::now());
        assert_eq!(acquisition.time(), Some(at));
    }
}
