//! Latest readings of the instruments.

use super::roles::{Instrument, ReferenceHeading, Refusal, Signal};
use binnacle_compass::angle::{CompassHeading, TrueHeading};
use binnacle_compass::position::Position;
use std::time::Duration;
use tokio::time::Instant;

/// Latest intervals of the compass, of which the middle one counts: one that is missed does not.
const INTERVALS: usize = 7;

/// A reading and the time at which it was measured, by the computer's clock.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Latest<T> {
    value: T,
    measured: Instant,
}

impl<T: Copy> Latest<T> {
    /// Returns the reading, unless it is older than `age` by the computer's clock.
    ///
    /// GNSS time does not serve here: it stands still when the receiver fails, and a heading must
    /// not look alive because of it.
    pub fn within(this: Option<Latest<T>>, age: Duration, now: Instant) -> Option<T> {
        let latest = this?;
        (now.saturating_duration_since(latest.measured) <= age).then_some(latest.value)
    }
}

/// Latest readings of the instruments.
#[derive(Clone, Copy, Debug, Default)]
pub struct Readings {
    /// Magnetic compass, raw.
    pub compass: Option<Latest<CompassHeading>>,
    /// Set while two sensors that read differently send as the compass.
    pub compass_is_mixed: bool,
    /// Gyro compass.
    pub gyro: Option<Latest<TrueHeading>>,
    /// Satellite compass.
    pub satellite: Option<Latest<TrueHeading>>,
    /// Position.
    pub position: Option<Latest<Position>>,
    /// Speed over ground, knots.
    pub sog_kn: Option<Latest<f64>>,
    /// Rate of turn, degrees a minute, starboard positive.
    pub rate_of_turn_deg_min: Option<Latest<f64>>,
    /// Roll, degrees, starboard side down positive.
    pub roll_deg: Option<Latest<f64>>,
    compass_intervals: Intervals,
}

impl Readings {
    /// Applies the signal of an instrument, measured at `measured`.
    pub fn apply(&mut self, signal: Signal, measured: Instant) {
        match signal {
            Signal::Compass(value) => {
                self.compass_intervals.note(self.compass, measured);
                replace(&mut self.compass, value, measured);
                self.compass_is_mixed = false;
            }
            Signal::Gyro(ReferenceHeading { heading, .. }) => {
                replace(&mut self.gyro, heading, measured);
            }
            Signal::Satellite(ReferenceHeading { heading, .. }) => {
                replace(&mut self.satellite, heading, measured);
            }
            Signal::Refused(Instrument::Compass, refusal) => {
                self.compass = None;
                self.compass_is_mixed = refusal == Refusal::TwoSensors;
            }
            Signal::GyroInvalid | Signal::Refused(Instrument::Gyro, _) => self.gyro = None,
            Signal::SatelliteInvalid | Signal::Refused(Instrument::Satellite, _) => {
                self.satellite = None;
            }
            Signal::Position(value) | Signal::Reckoned(value) => {
                replace(&mut self.position, value, measured);
            }
            Signal::Speed(value) => replace(&mut self.sog_kn, value, measured),
            Signal::RateOfTurn(value) => {
                replace(&mut self.rate_of_turn_deg_min, value, measured);
            }
            Signal::Roll(value) => replace(&mut self.roll_deg, value, measured),
            Signal::Time(_)
            | Signal::Jump(_)
            | Signal::Course(_)
            | Signal::WaterSpeed(_)
            | Signal::Temperature(_) => {}
        }
    }

    /// Returns the compass's own interval; zero before it is known.
    pub fn compass_interval(&self) -> Duration {
        self.compass_intervals.middle()
    }
}

/// Replaces a reading by a later one: a delayed one replaces nothing newer.
fn replace<T: Copy>(known: &mut Option<Latest<T>>, value: T, measured: Instant) {
    if known.is_none_or(|known| known.measured <= measured) {
        *known = Some(Latest { value, measured });
    }
}

/// Latest intervals between readings.
#[derive(Clone, Copy, Debug, Default)]
struct Intervals {
    recent: [Duration; INTERVALS],
    count: usize,
}

impl Intervals {
    fn note<T>(&mut self, last: Option<Latest<T>>, measured: Instant) {
        let Some(last) = last else {
            return;
        };
        let interval = measured.saturating_duration_since(last.measured);
        self.recent[self.count % INTERVALS] = interval;
        self.count = self.count.saturating_add(1);
    }

    fn middle(&self) -> Duration {
        let known = self.count.min(INTERVALS);
        let mut sorted = self.recent;
        sorted[..known].sort_unstable();
        // Of an even number the shorter one: the output ends sooner.
        sorted[..known]
            .get(known.saturating_sub(1) / 2)
            .copied()
            .unwrap_or_default()
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    fn compass(degrees: f64) -> Signal {
        Signal::Compass(CompassHeading::new(degrees).unwrap())
    }

    #[test]
    fn a_reading_is_as_old_as_its_measurement() {
        let start = Instant::now() + Duration::from_mins(1);
        let mut readings = Readings::default();
        readings.apply(compass(10.0), start);
        let within = |readings: Readings, ms| {
            let now = start + Duration::from_millis(ms);
            Latest::within(readings.compass, Duration::from_secs(2), now).is_some()
        };
        assert!(within(readings, 2_000));
        assert!(!within(readings, 2_001));
        // A delayed reading is no newer than it was measured.
        readings.apply(compass(20.0), start - Duration::from_secs(5));
        assert!(!within(readings, 2_001));
    }

    #[test]
    fn the_compass_has_its_own_interval() {
        let start = Instant::now();
        let mut readings = Readings::default();
        assert_eq!(readings.compass_interval(), Duration::ZERO);
        for at in [0, 10, 20, 30, 90, 100] {
            readings.apply(compass(1.0), start + Duration::from_secs(at));
        }
        assert_eq!(readings.compass_interval(), Duration::from_secs(10));
    }

    #[test]
    fn a_mixed_compass_has_no_reading_until_it_is_one_again() {
        let start = Instant::now();
        let mut readings = Readings::default();
        readings.apply(compass(1.0), start);
        let mixed = Signal::Refused(Instrument::Compass, Refusal::TwoSensors);
        readings.apply(mixed, start);
        assert!(readings.compass.is_none() && readings.compass_is_mixed);
        readings.apply(compass(1.0), start);
        assert!(readings.compass.is_some() && !readings.compass_is_mixed);
    }
}
