//! Roles: selection of one source per instrument, such as *the* gyro among several.
//!
//! The selections of a role are ranked. One is used while no better one has been heard within the
//! silence limit; the better one is used again with its next reading. An instrument that reports
//! itself invalid counts as silent. A true heading of the device that serves as the compass is made
//! of the compass, and is no reference.

use super::gnss_clock::{GnssClock, Step, TimeSource, Trust};
use super::role::{Moment, Role, Use};
use crate::config::{RolesConfig, SilenceConfig};
use binnacle_compass::angle::{CompassHeading, CourseOverGround, TrueHeading};
use binnacle_compass::position::Position;
use binnacle_compass::sample::SourceId;
use binnacle_compass::time::Timestamp;
use binnacle_observation::{Observation, Reading, Source};
use std::time::Duration;
use tokio::time::Instant;

/// Refused sources that are remembered.
const MAX_REFUSED: usize = 16;

/// Signal of an instrument, whichever source it came from.
#[derive(Clone, Copy, Debug, PartialEq)]
pub enum Signal {
    /// Time advanced.
    Time(Timestamp),
    /// Time jumped.
    Jump(Timestamp),
    /// Raw compass.
    Compass(CompassHeading),
    /// Gyro.
    Gyro(ReferenceHeading),
    /// Gyro reports itself invalid.
    GyroInvalid,
    /// Satellite compass.
    Satellite(ReferenceHeading),
    /// Satellite compass reports itself invalid.
    SatelliteInvalid,
    /// A heading that must not be used.
    Refused(Instrument, Refusal),
    /// Fix.
    Position(Position),
    /// Place by dead reckoning, while the fixes are not trusted.
    Reckoned(Position),
    /// Speed through the water, knots.
    WaterSpeed(f64),
    /// Speed over ground, knots.
    Speed(f64),
    /// Course over ground.
    Course(CourseOverGround),
    /// Degrees per minute, starboard positive.
    RateOfTurn(f64),
    /// Degrees, starboard down positive.
    Roll(f64),
    /// Degrees Celsius.
    Temperature(f64),
}

/// Instrument that gives a heading.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Instrument {
    /// Magnetic compass.
    Compass,
    /// Gyro compass.
    Gyro,
    /// Satellite compass.
    Satellite,
}

/// Reason why a heading must not be used.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Refusal {
    /// It is made of the compass.
    NotIndependent,
    /// It is not yet shown to be another instrument's than the compass.
    Unproven,
    /// It comes from two sensors that read differently.
    TwoSensors,
    /// It is of a receiver that is disturbed.
    Interference,
}

/// Heading of a reference, and the source that gave it.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct ReferenceHeading {
    /// True heading.
    pub heading: TrueHeading,
    /// Instrument that gave it.
    pub source: SourceId,
}

/// Receiver that a signal comes from.
#[derive(Clone, Copy, Debug)]
pub struct GnssSource<'a> {
    pub source: &'a Source,
    /// Selection of the position that it matches, 0 being the best.
    pub rank: usize,
    /// Set if that selection names its talker, which then tells receivers on one line apart.
    pub names_talker: bool,
}

impl GnssSource<'_> {
    /// Returns whether both are one receiver.
    pub fn is_same_receiver(self, other: GnssSource<'_>) -> bool {
        let (source, other_source) = (self.source, other.source);
        if self.names_talker || other.names_talker {
            return source.is_same_device(other_source);
        }
        source.is_same_receiver(other_source)
    }
}

/// The vessel's instruments and its clock.
#[derive(Debug)]
pub struct Roles {
    compass: Role,
    gyro: Role,
    satellite: Role,
    position: Role,
    rate_of_turn: Role,
    log: Role,
    roll: Role,
    temperature: Role,
    clock: GnssClock,
    /// References of the compass's own device, by role, when they were last heard.
    refused: Vec<(&'static str, Source, Instant)>,
}

impl Roles {
    /// Creates the configured roles.
    pub fn new(config: &RolesConfig, silence: &SilenceConfig) -> Roles {
        let position_s = silence.stale_s(silence.position.sampling());
        let compass_s = silence.stale_s(silence.compass.sampling());
        let sampled = |role| silence.stale_s(role);
        Roles {
            compass: Role::new("compass", &config.compass, compass_s),
            gyro: Role::new("gyro", &config.gyro, sampled(silence.gyro)),
            satellite: Role::new("satellite", &config.satellite, sampled(silence.satellite)),
            position: Role::new("position", &config.position, position_s),
            rate_of_turn: Role::new(
                "rate_of_turn",
                &config.rate_of_turn,
                sampled(silence.rate_of_turn),
            ),
            log: Role::new("log", &config.log, sampled(silence.log)),
            roll: Role::new("roll", &config.roll, sampled(silence.roll)),
            temperature: Role::new(
                "temperature",
                &config.temperature,
                sampled(silence.temperature),
            ),
            clock: GnssClock::new(config.position.len(), position_s),
            refused: Vec::new(),
        }
    }

    /// Adds headings that the agent sends, which no source without a talker matches.
    pub fn add_own_headings(&mut self, headings: &[([u8; 2], [u8; 3])]) {
        for role in [&mut self.compass, &mut self.gyro, &mut self.satellite] {
            role.add_own_headings(headings);
        }
    }

    /// Returns GNSS time, once it is known.
    pub fn now(&self) -> Option<Timestamp> {
        self.clock.now()
    }

    /// Returns GNSS time as it runs on while it is uncertain.
    pub fn running_time(&self) -> Option<Timestamp> {
        self.clock.running()
    }

    /// Returns GNSS time unless it is uncertain.
    pub fn reliable_time(&self) -> Option<Timestamp> {
        self.clock.now().filter(|_| !self.clock.is_uncertain())
    }

    /// Returns the clock, to set its references.
    pub fn clock(&mut self) -> &mut GnssClock {
        &mut self.clock
    }

    /// Describes the fault of the receiver's time.
    pub fn clock_problem(&self) -> Option<String> {
        self.clock.problem()
    }

    /// Describes sources that must not be used as they are configured.
    pub fn problems(&self, now: Instant, heard_within: Duration) -> Vec<String> {
        let moment = self.moment(now, Duration::ZERO);
        let mixed = self.roles().flat_map(|role| role.problems(moment));
        let recent = self
            .refused
            .iter()
            .filter(|(_, _, heard)| now.saturating_duration_since(*heard) <= heard_within);
        let refused = recent.map(|(role, source, _)| {
            format!("{role}: {source} is of the compass's own device, and no reference for it")
        });
        mixed.chain(refused).collect()
    }

    /// Returns the roles that a source matches, and whether it serves in each.
    pub fn uses(&self, seen: &Observation) -> Vec<(&'static str, bool)> {
        self.roles()
            .filter(|role| role.rank(seen).is_some())
            .map(|role| (role.name(), role.has_served(&seen.source)))
            .collect()
    }

    fn roles(&self) -> impl Iterator<Item = &Role> {
        [
            &self.compass,
            &self.gyro,
            &self.satellite,
            &self.position,
            &self.rate_of_turn,
            &self.log,
            &self.roll,
            &self.temperature,
        ]
        .into_iter()
    }

    fn moment(&self, measured: Instant, age: Duration) -> Moment {
        Moment {
            ship: self.clock.now(),
            measured,
            age,
        }
    }

    /// Applies the time that a recording gives a line: used when no receiver gives any.
    pub fn observe_recorded_time(&mut self, stamp: Timestamp) -> Option<Signal> {
        self.set_clock(TimeSource::Recording, stamp)
    }

    /// Returns the signals of an observation of some age on arrival: none when its source has no
    /// role, or when a better source is alive. Every receiver gives its positions: which of them is
    /// used depends on whether it is trusted, as is the receiver of this observation or not.
    pub fn observe(
        &mut self,
        seen: &Observation,
        measured: Instant,
        age: Duration,
        trust: Trust,
    ) -> [Option<Signal>; 3] {
        let moment = self.moment(measured, age);
        match seen.reading {
            Reading::Compass { raw, .. } => self.compass_heading(seen, moment, raw),
            Reading::Magnetic { heading, .. } => match CompassHeading::new(heading.degrees()) {
                Some(raw) => self.compass_heading(seen, moment, raw),
                None => single(None),
            },
            Reading::True(heading) => single(self.true_heading(seen, moment, heading)),
            Reading::TrueNotValid => {
                if self.gyro.note_invalid(seen, moment) {
                    return single(Some(Signal::GyroInvalid));
                }
                let used = self.satellite.note_invalid(seen, moment);
                single(used.then_some(Signal::SatelliteInvalid))
            }
            Reading::Fix {
                position,
                time,
                sog_kn,
            } => {
                let Some(rank) = self.position.rank(seen) else {
                    return single(None);
                };
                if !self.position.is_recent(moment) {
                    return single(None);
                }
                // Time first: the fix belongs to the time it carries.
                let receiver = TimeSource::Receiver(rank, trust);
                [
                    time.and_then(|stamp| self.set_clock(receiver, stamp)),
                    Some(Signal::Position(position)),
                    sog_kn.map(Signal::Speed),
                ]
            }
            Reading::Time(stamp) => {
                let rank = self.position.device_rank(&seen.source);
                let rank = rank.filter(|_| self.position.is_recent(moment));
                single(
                    rank.and_then(|rank| self.set_clock(TimeSource::Receiver(rank, trust), stamp)),
                )
            }
            Reading::Speed { sog_kn } => {
                let used = self.is_from_receiver(seen, moment);
                single(used.then_some(Signal::Speed(sog_kn)))
            }
            Reading::Course(course) => {
                let used = self.is_from_receiver(seen, moment);
                single(used.then_some(Signal::Course(course)))
            }
            Reading::RateOfTurn { deg_min } => {
                let used = self.rate_of_turn.note_reading(seen, moment).source();
                single(used.map(|_| Signal::RateOfTurn(deg_min)))
            }
            Reading::WaterSpeed { kn } => {
                let used = self.log.note_reading(seen, moment).source();
                single(used.map(|_| Signal::WaterSpeed(kn)))
            }
            Reading::Roll { deg } => {
                let used = self.roll.note_reading(seen, moment).source();
                single(used.map(|_| Signal::Roll(deg)))
            }
            Reading::Temperature { celsius } => {
                let used = self.temperature.note_reading(seen, moment).source();
                single(used.map(|_| Signal::Temperature(celsius)))
            }
            Reading::Pitch { .. } | Reading::Greeting(_) | Reading::AlertCommand(_) => single(None),
        }
    }

    fn compass_heading(
        &mut self,
        seen: &Observation,
        moment: Moment,
        raw: CompassHeading,
    ) -> [Option<Signal>; 3] {
        single(
            match self.compass.note_heading(seen, moment, raw.degrees()) {
                Use::None => None,
                Use::Used(_) => Some(Signal::Compass(raw)),
                Use::Mixed => Some(Signal::Refused(Instrument::Compass, Refusal::TwoSensors)),
            },
        )
    }

    fn true_heading(
        &mut self,
        seen: &Observation,
        moment: Moment,
        heading: TrueHeading,
    ) -> Option<Signal> {
        let is_of_compass = seen.source.names_device() && self.compass.has_served(&seen.source);
        for (role, instrument) in [
            (&mut self.gyro, Instrument::Gyro),
            (&mut self.satellite, Instrument::Satellite),
        ] {
            if is_of_compass {
                if role.rank(seen).is_none() {
                    continue;
                }
                note_refused(
                    &mut self.refused,
                    role.name(),
                    &seen.source,
                    moment.measured,
                );
                // Another source may serve.
                return (!role.is_served(moment))
                    .then_some(Signal::Refused(instrument, Refusal::NotIndependent));
            }
            let reference = |source| ReferenceHeading { heading, source };
            match role.note_heading(seen, moment, heading.degrees()) {
                Use::None => {}
                Use::Mixed => return Some(Signal::Refused(instrument, Refusal::TwoSensors)),
                Use::Used(source) if instrument == Instrument::Gyro => {
                    return Some(Signal::Gyro(reference(source)));
                }
                Use::Used(source) => return Some(Signal::Satellite(reference(source))),
            }
        }
        None
    }

    /// Returns the receiver of an observation, where the position may come from it.
    pub fn receiver<'a>(&self, seen: &'a Observation) -> Option<GnssSource<'a>> {
        let source = &seen.source;
        let rank = match seen.reading {
            Reading::Fix { .. } => self.position.rank(seen),
            Reading::Speed { .. } | Reading::Course(_) | Reading::Time(_) => {
                self.position.device_rank(source)
            }
            _ => None,
        };
        rank.map(|rank| GnssSource {
            source,
            rank,
            names_talker: self.position.names_talker(rank),
        })
    }

    /// Records that the position of a source was used.
    pub fn note_position_used(&mut self, source: &Source) {
        self.position.note_served(source);
    }

    fn is_from_receiver(&self, seen: &Observation, moment: Moment) -> bool {
        self.position.is_recent(moment) && self.position.device_rank(&seen.source).is_some()
    }

    fn set_clock(&mut self, source: TimeSource, stamp: Timestamp) -> Option<Signal> {
        match self.clock.observe(source, stamp) {
            Step::Held => None,
            Step::Advanced(now) => Some(Signal::Time(now)),
            Step::Jumped(now) => Some(Signal::Jump(now)),
        }
    }
}

fn note_refused(
    refused: &mut Vec<(&'static str, Source, Instant)>,
    role: &'static str,
    source: &Source,
    heard: Instant,
) {
    let known = refused
        .iter()
        .position(|(known_role, known, _)| *known_role == role && known == source);
    match known {
        Some(known) => refused[known].2 = heard,
        None if refused.len() < MAX_REFUSED => refused.push((role, source.clone(), heard)),
        None => {}
    }
}

fn single(signal: Option<Signal>) -> [Option<Signal>; 3] {
    [signal, None, None]
}

#[cfg(test)]
mod tests;
