//! Roles: selection of one source per instrument, such as *the* gyro among several.
//!
//! The sources of a role are ranked. A source is used while no better one has been heard within the
//! silence limit; the better one is used again with its next reading. An instrument that reports
//! itself invalid counts as silent.

use super::gnss_clock::{GnssClock, Step};
use super::observation::{Observation, Reading};
use super::role::Role;
use crate::config::{RolesConfig, SourceConfig};
use binnacle_compass::angle::{CompassHeading, CourseOverGround, TrueHeading};
use binnacle_compass::position::Position;
use binnacle_compass::sample::SourceId;
use binnacle_compass::time::Timestamp;

/// Signal of an instrument, whichever source it came from.
#[derive(Clone, Copy, Debug, PartialEq)]
pub(crate) enum Signal {
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
    /// Fix.
    Position(Position),
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

/// Heading of a reference, and the source that gave it.
#[derive(Clone, Copy, Debug, PartialEq)]
pub(crate) struct ReferenceHeading {
    pub(crate) heading: TrueHeading,
    pub(crate) source: SourceId,
}

/// The vessel's instruments and its clock.
#[derive(Debug)]
pub(crate) struct Roles {
    compass: Role,
    gyro: Role,
    satellite: Role,
    position: Role,
    rate_of_turn: Role,
    roll: Role,
    temperature: Role,
    clock: GnssClock,
}

impl Roles {
    /// Creates the configured roles; sources fall silent after `stale_s` of GNSS time.
    pub(crate) fn new(config: &RolesConfig, stale_s: f64) -> Roles {
        let role = |sources: &[SourceConfig]| Role::new(sources, stale_s);
        Roles {
            compass: role(&config.compass),
            gyro: role(&config.gyro),
            satellite: role(&config.satellite),
            position: role(&config.position),
            rate_of_turn: role(&config.rate_of_turn),
            roll: role(&config.roll),
            temperature: role(&config.temperature),
            // A recording's own time stamps rank behind every receiver.
            clock: GnssClock::new(config.position.len() + 1, stale_s),
        }
    }

    /// Returns GNSS time, once it is known.
    pub(crate) fn now(&self) -> Option<Timestamp> {
        self.clock.now()
    }

    /// Returns GNSS time unless it is uncertain.
    pub(crate) fn reliable_time(&self) -> Option<Timestamp> {
        self.clock.now().filter(|_| !self.clock.is_uncertain())
    }

    /// Returns the clock, to set its references.
    pub(crate) fn clock(&mut self) -> &mut GnssClock {
        &mut self.clock
    }

    /// Describes the fault of the receiver's time.
    pub(crate) fn clock_problem(&self) -> Option<String> {
        self.clock.problem()
    }

    /// Applies the time that a recording gives a line: used when no receiver gives any.
    pub(crate) fn observe_recorded_time(&mut self, stamp: Timestamp) -> Option<Signal> {
        self.set_clock(self.position.source_count(), stamp)
    }

    /// Returns the signals of an observation: none when its source has no role, or when a better
    /// source is alive.
    pub(crate) fn observe(&mut self, seen: &Observation) -> [Option<Signal>; 3] {
        let now = self.clock.now();
        match seen.reading {
            Reading::Compass { raw, .. } => single(
                self.compass
                    .note_reading(seen, now)
                    .map(|_| Signal::Compass(raw)),
            ),
            Reading::Magnetic(heading) => {
                let used = self.compass.note_reading(seen, now).is_some();
                let raw = CompassHeading::new(heading.degrees());
                single(raw.filter(|_| used).map(Signal::Compass))
            }
            Reading::True(heading) => {
                let reference = |source| ReferenceHeading { heading, source };
                if let Some(source) = self.gyro.note_reading(seen, now) {
                    return single(Some(Signal::Gyro(reference(source))));
                }
                let source = self.satellite.note_reading(seen, now);
                single(source.map(|source| Signal::Satellite(reference(source))))
            }
            Reading::TrueNotValid => {
                if self.gyro.note_invalid(seen, now) {
                    return single(Some(Signal::GyroInvalid));
                }
                let used = self.satellite.note_invalid(seen, now);
                single(used.then_some(Signal::SatelliteInvalid))
            }
            Reading::Fix {
                position,
                time,
                sog_kn,
            } => self.fix(seen, position, time, sog_kn),
            Reading::Time(stamp) => {
                let rank = self.position.device_rank(seen);
                single(rank.and_then(|rank| self.set_clock(rank, stamp)))
            }
            Reading::Speed { sog_kn } => single(
                self.is_from_receiver(seen, now)
                    .then_some(Signal::Speed(sog_kn)),
            ),
            Reading::Course(course) => single(
                self.is_from_receiver(seen, now)
                    .then_some(Signal::Course(course)),
            ),
            Reading::RateOfTurn { deg_min } => {
                let used = self.rate_of_turn.note_reading(seen, now);
                single(used.map(|_| Signal::RateOfTurn(deg_min)))
            }
            Reading::Roll { deg } => {
                single(self.roll.note_reading(seen, now).map(|_| Signal::Roll(deg)))
            }
            Reading::Temperature { celsius } => single(
                self.temperature
                    .note_reading(seen, now)
                    .map(|_| Signal::Temperature(celsius)),
            ),
            Reading::Pitch { .. } => single(None),
        }
    }

    /// Returns whether a reading comes from the receiver whose position is used.
    fn is_from_receiver(&self, seen: &Observation, now: Option<Timestamp>) -> bool {
        let rank = self.position.device_rank(seen);
        rank.is_some_and(|rank| self.position.is_best(rank, now))
    }

    fn fix(
        &mut self,
        seen: &Observation,
        position: Position,
        time: Option<Timestamp>,
        sog_kn: Option<f64>,
    ) -> [Option<Signal>; 3] {
        let Some(rank) = self.position.rank(seen) else {
            return single(None);
        };
        // Time first: the fix belongs to the time it carries.
        let time = time.and_then(|stamp| self.set_clock(rank, stamp));
        let used = self.position.note_reading(seen, self.clock.now());
        if used.is_none() {
            return single(time);
        }
        [
            time,
            Some(Signal::Position(position)),
            sog_kn.map(Signal::Speed),
        ]
    }

    fn set_clock(&mut self, rank: usize, stamp: Timestamp) -> Option<Signal> {
        match self.clock.observe(rank, stamp) {
            Step::Held => None,
            Step::Advanced(now) => Some(Signal::Time(now)),
            Step::Jumped(now) => Some(Signal::Jump(now)),
        }
    }
}

fn single(signal: Option<Signal>) -> [Option<Signal>; 3] {
    [signal, None, None]
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::config::Config;
    use Signal::{Gyro, Satellite, SatelliteInvalid, Time};

    fn roles(toml: &str) -> Roles {
        let text = format!(
            "data_dir = \"d\"\n[inputs.a]\ntcp = \"h:1\"\n[inputs.b]\ntcp = \"h:2\"\n[roles]\n{toml}"
        );
        let config: Config = toml::from_str(&text).unwrap();
        Roles::new(&config.roles, 15.0)
    }

    fn seen(input: &str, id: &str, reading: Reading) -> Observation {
        let id = id.as_bytes();
        Observation {
            input: input.into(),
            talker: [id[0], id[1]],
            sentence: [id[2], id[3], id[4]],
            reading,
        }
    }

    fn reference(degrees: f64, source: &str) -> ReferenceHeading {
        ReferenceHeading {
            heading: TrueHeading::new(degrees).unwrap(),
            source: SourceId::from_name(source),
        }
    }

    fn heading(degrees: f64) -> Reading {
        Reading::True(TrueHeading::new(degrees).unwrap())
    }

    fn fix(seconds: i64) -> Reading {
        Reading::Fix {
            position: Position::new(43.0, -3.0).unwrap(),
            time: Some(at(seconds)),
            sog_kn: Some(12.0),
        }
    }

    fn at(seconds: i64) -> Timestamp {
        Timestamp::from_micros((1_700_000_000 + seconds) * 1_000_000).unwrap()
    }

    const TWO_GYROS: &str = r#"
gyro = [{ input = "a", talker = "HE", sentence = "THS" }, { input = "b", sentence = "HDT" }]
satellite = [{ input = "a", talker = "GP" }]
position = [{ input = "a", talker = "GP", sentence = "RMC" }]
"#;

    fn first(roles: &mut Roles, observation: &Observation) -> Option<Signal> {
        roles.observe(observation)[0]
    }

    #[test]
    fn the_second_gyro_serves_while_the_first_is_silent() {
        let mut roles = roles(TWO_GYROS);
        let (main, spare) = (
            seen("a", "HETHS", heading(10.0)),
            seen("b", "HEHDT", heading(11.0)),
        );
        let gyro = |degrees, source| Some(Gyro(reference(degrees, source)));
        roles.observe(&seen("a", "GPRMC", fix(0)));
        assert_eq!(first(&mut roles, &main), gyro(10.0, "a HE THS"));
        assert_eq!(first(&mut roles, &spare), None);
        roles.observe(&seen("a", "GPRMC", fix(16)));
        assert_eq!(first(&mut roles, &spare), gyro(11.0, "b HDT"));
        assert_eq!(first(&mut roles, &main), gyro(10.0, "a HE THS"));
        assert_eq!(first(&mut roles, &spare), None);
    }

    #[test]
    fn an_invalid_satellite_compass_is_distinguished_from_a_gyro() {
        let mut roles = roles(TWO_GYROS);
        let valid = seen("a", "GPTHS", heading(10.0));
        assert_eq!(
            first(&mut roles, &valid),
            Some(Satellite(reference(10.0, "a GP")))
        );
        let lost = seen("a", "GPTHS", Reading::TrueNotValid);
        assert_eq!(first(&mut roles, &lost), Some(SatelliteInvalid));
    }

    #[test]
    fn an_invalid_source_makes_way_at_once() {
        let mut roles = roles(TWO_GYROS);
        roles.observe(&seen("a", "GPRMC", fix(0)));
        roles.observe(&seen("a", "HETHS", heading(10.0)));
        roles.observe(&seen("a", "HETHS", Reading::TrueNotValid));
        assert!(first(&mut roles, &seen("b", "HEHDT", heading(11.0))).is_some());
    }

    #[test]
    fn a_source_without_a_role_means_nothing() {
        let mut roles = roles(TWO_GYROS);
        assert_eq!(first(&mut roles, &seen("b", "GPRMC", fix(0))), None);
        assert_eq!(first(&mut roles, &seen("b", "HETHS", heading(1.0))), None);
        assert_eq!(
            first(&mut roles, &seen("a", "GPZDA", Reading::Time(at(0)))),
            Some(Time(at(0)))
        );
        assert_eq!(
            first(&mut roles, &seen("b", "GPZDA", Reading::Time(at(1)))),
            None
        );
    }

    #[test]
    fn a_course_comes_from_the_receiver_whose_position_is_used() {
        let mut roles = roles(TWO_GYROS);
        let course = CourseOverGround::new(91.0).unwrap();
        roles.observe(&seen("a", "GPRMC", fix(0)));
        let of = |input, id| seen(input, id, Reading::Course(course));
        assert_eq!(
            first(&mut roles, &of("a", "GPVTG")),
            Some(Signal::Course(course))
        );
        assert_eq!(first(&mut roles, &of("b", "GPVTG")), None);
    }

    #[test]
    fn a_temperature_comes_from_its_role_alone() {
        let warm = |id| seen("a", id, Reading::Temperature { celsius: 21.5 });
        assert_eq!(first(&mut roles(TWO_GYROS), &warm("WIMTA")), None);
        let mut roles = roles(r#"temperature = [{ input = "a", sentence = "MTA" }]"#);
        assert_eq!(
            first(&mut roles, &warm("WIMTA")),
            Some(Signal::Temperature(21.5))
        );
        assert_eq!(first(&mut roles, &warm("WIXDR")), None);
    }

    #[test]
    fn the_agents_own_output_is_no_compass_and_no_gyro() {
        let mut roles = roles(
            r#"
compass = [{ input = "a", sentence = "HDG" }]
gyro = [{ input = "a" }]
"#,
        );
        let compass = |id| {
            let raw = CompassHeading::new(7.0).unwrap();
            let (deviation, variation) = (None, None);
            let reading = Reading::Compass {
                raw,
                deviation,
                variation,
            };
            seen("a", id, reading)
        };
        assert!(first(&mut roles, &compass("HCHDG")).is_some());
        assert!(first(&mut roles, &seen("a", "HETHS", heading(7.0))).is_some());
        assert_eq!(first(&mut roles, &compass("IIHDG")), None);
        let echo = seen("a", "IITHS", Reading::TrueNotValid);
        assert_eq!(first(&mut roles, &echo), None);
        assert!(first(&mut roles, &seen("a", "IIHDT", heading(7.0))).is_some());
    }

    #[test]
    fn a_magnetic_heading_is_the_compass_only_when_it_is_raw() {
        let hdm = seen(
            "a",
            "HCHDM",
            Reading::Magnetic(binnacle_compass::angle::MagneticHeading::new(7.0).unwrap()),
        );
        let mut plain = roles(r#"compass = [{ input = "a", talker = "HC" }]"#);
        assert_eq!(first(&mut plain, &hdm), None);
        let mut raw = roles(r#"compass = [{ input = "a", sentence = "HDM", raw = true }]"#);
        assert!(first(&mut raw, &hdm).is_some());
    }
}
