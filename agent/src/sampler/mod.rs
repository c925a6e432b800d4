//! Settled ten-second windows from the instruments' signals, and samples from them.
//!
//! Pure: time comes with the signals. Invariants:
//!
//! - Windows lie on the UTC grid of ten seconds. Each is counted once: accepted, or rejected by the
//!   first reason that applies.
//! - Samples contain accepted windows only, each of them at most once.
//! - The compass heading is the raw reading; no deviation is applied to it.
//! - Windows without gyro and satellite compass count on a ship that has had neither for an hour,
//!   if they have a course over ground.
//! - No signal causes a panic, in any order and with any time.
//!
//! After a turn, eddy currents in the hull and the liquid in the bowl disturb the compass for two
//! to three minutes (the Gaussian error). Windows are rejected until [`Settings::settle_s`] has
//! passed. The limit on swinging is that of Basterretxea-Iribar, Sotés & Uriarte 2016, J.
//! Navigation.

mod details;
mod exclusion;
mod outcome;
mod sample_builder;
mod track;

#[cfg(test)]
pub(crate) use details::Details;
pub(crate) use exclusion::Exclusion;
pub(crate) use outcome::{Outcome, Tally};
pub(crate) use sample_builder::{WINDOW_S, Window, median};

use crate::weak_field::is_weak;
use binnacle_compass::angle::{wrap_180, wrap_360};
use binnacle_compass::position::Position;
use binnacle_compass::sample::Sample;
use binnacle_compass::time::Timestamp;
use binnacle_instruments::{Instrument, Signal};
use binnacle_wire::messages::Settings;
use details::DetailReadings;
use sample_builder::SampleBuilder;
use track::{HeadingSpan, HeadingTrack};

/// Least number of readings for a ten-second mean.
const MIN_READINGS: u32 = 4;
/// Change of heading above which the vessel is turning.
const TURN_DEG: f64 = 10.0;
/// Windows without a heading above which there may have been a turn.
const MAX_BLIND_WINDOWS: i64 = 3;
/// Windows without gyro and satellite compass from which the ship counts as one that has neither,
/// an hour: then her course over ground is the reference.
const UNREFERENCED_WINDOWS: i64 = 360;
/// Windows for which a position or speed is valid.
const FIX_VALID_WINDOWS: i64 = 2;
const WINDOW_MICROS: i64 = WINDOW_S * 1_000_000;
/// Plausible range; other values are ignored.
const SPEED_KN: std::ops::RangeInclusive<f64> = 0.0..=100.0;
const RATE_OF_TURN_DEG_MIN: std::ops::RangeInclusive<f64> = -720.0..=720.0;

/// State between two signals.
#[derive(Debug)]
pub(crate) struct Sampler {
    settings: Settings,
    exclusion: Option<Exclusion>,
    /// Open window, in tens of seconds since 1970.
    window: Option<i64>,
    compass: HeadingTrack,
    gyro: HeadingTrack,
    satellite: HeadingTrack,
    rate_of_turn: (f64, u32),
    details: DetailReadings,
    position: Option<LastValue<Position>>,
    /// Set if the open window has a place by dead reckoning.
    is_reckoned: bool,
    speed: Option<LastValue<f64>>,
    turns: TurnTracker,
    /// Last window with gyro or satellite compass; the first window before there is one.
    referenced: Option<i64>,
    builder: SampleBuilder,
    samples: Vec<Sample>,
    settled: Vec<Window>,
    tally: Tally,
}

/// Last steady heading, and the time when the compass has come to rest.
#[derive(Debug, Default)]
struct TurnTracker {
    /// Heading that a turn is measured from, unwound.
    anchor: Option<f64>,
    /// First window that may be settled.
    settled_from: Option<i64>,
    /// Last window that had a heading.
    seen: Option<i64>,
}

impl Sampler {
    /// Creates a sampler without any signal.
    pub(crate) fn new(settings: Settings, exclusion: Option<Exclusion>) -> Sampler {
        Sampler {
            settings,
            exclusion,
            window: None,
            compass: HeadingTrack::default(),
            gyro: HeadingTrack::default(),
            satellite: HeadingTrack::default(),
            rate_of_turn: (0.0, 0),
            details: DetailReadings::default(),
            position: None,
            is_reckoned: false,
            speed: None,
            turns: TurnTracker::default(),
            referenced: None,
            builder: SampleBuilder::default(),
            samples: Vec::new(),
            settled: Vec::new(),
            tally: Tally::default(),
        }
    }

    /// Applies new limits from the open window on.
    pub(crate) fn set_settings(&mut self, settings: Settings) {
        self.settings = settings;
    }

    /// Begins or ends an exclusion, from the open window on.
    pub(crate) fn set_exclusion(&mut self, exclusion: Option<Exclusion>) {
        self.exclusion = exclusion;
    }

    /// Applies a signal of an instrument.
    pub(crate) fn apply(&mut self, signal: Signal) {
        match signal {
            Signal::Time(now) => self.advance(window_of(now)),
            Signal::Jump(now) => self.jump(window_of(now)),
            Signal::Compass(heading) => self.compass.add(heading.degrees()),
            Signal::Gyro(from) => self.gyro.add_from(from.source, from.heading.degrees()),
            Signal::GyroInvalid => self.gyro.invalidate(),
            Signal::Satellite(from) => {
                self.satellite.add_from(from.source, from.heading.degrees());
            }
            Signal::SatelliteInvalid => self.satellite.invalidate(),
            Signal::Refused(Instrument::Compass, refusal) => self.compass.refuse(refusal),
            Signal::Refused(Instrument::Gyro, refusal) => self.gyro.refuse(refusal),
            Signal::Refused(Instrument::Satellite, refusal) => self.satellite.refuse(refusal),
            Signal::Position(position) => {
                self.position = self.last_value(position);
            }
            Signal::Reckoned(position) => {
                self.position = self.last_value(position);
                self.is_reckoned = true;
            }
            Signal::Speed(knots) if SPEED_KN.contains(&knots) => {
                self.speed = self.last_value(knots);
            }
            Signal::RateOfTurn(rate) if RATE_OF_TURN_DEG_MIN.contains(&rate) => {
                self.rate_of_turn = (self.rate_of_turn.0 + rate, self.rate_of_turn.1 + 1);
            }
            Signal::Course(course) => self.details.add_course(course),
            Signal::Roll(degrees) => self.details.add_roll(degrees),
            Signal::Temperature(celsius) => self.details.add_temperature(celsius),
            Signal::Speed(_) | Signal::RateOfTurn(_) | Signal::WaterSpeed(_) => {}
        }
    }

    /// Takes the finished samples.
    pub(crate) fn take_samples(&mut self) -> Vec<Sample> {
        std::mem::take(&mut self.samples)
    }

    /// Returns whether there are finished samples.
    pub(crate) fn has_samples(&self) -> bool {
        !self.samples.is_empty()
    }

    /// Takes the windows accepted since the last call, oldest first.
    pub(crate) fn take_settled(&mut self) -> Vec<Window> {
        std::mem::take(&mut self.settled)
    }

    /// Makes a sample of the windows settled so far, and begins another.
    pub(crate) fn cut_sample(&mut self) {
        self.samples.extend(self.builder.finish());
    }

    /// Takes the windows by outcome since the last call.
    pub(crate) fn take_tally(&mut self) -> Tally {
        self.tally.take()
    }

    /// Finishes the open sample, as when the agent stops. The open window is dropped.
    pub(crate) fn finish(&mut self) {
        self.samples.extend(self.builder.finish());
        self.reset(None);
    }

    fn advance(&mut self, now: i64) {
        let Some(open) = self.window else {
            self.reset(Some(now));
            return;
        };
        if now <= open {
            return;
        }
        self.close(open);
        self.window = Some(now);
        let missed = now - open - 1;
        if missed == 0 {
            return;
        }
        self.tally.add(Outcome::NoTime, missed as u64);
        for track in [&mut self.compass, &mut self.gyro, &mut self.satellite] {
            track.forget();
        }
        self.samples.extend(self.builder.expire(now));
    }

    fn jump(&mut self, now: i64) {
        if self.window.is_some() {
            self.tally.add(Outcome::Clock, 1);
        }
        self.samples.extend(self.builder.finish());
        self.reset(Some(now));
    }

    /// Discards everything open and begins at a window.
    fn reset(&mut self, window: Option<i64>) {
        self.window = window;
        self.compass.forget();
        self.gyro.forget();
        self.satellite.forget();
        self.rate_of_turn = (0.0, 0);
        self.details = DetailReadings::default();
        self.position = None;
        self.is_reckoned = false;
        self.speed = None;
        self.turns = TurnTracker::default();
        self.referenced = None;
    }

    fn close(&mut self, index: i64) {
        let outcome = match self.evaluate(index) {
            Ok(window) => {
                self.settled.push(window);
                let finished = self.builder.add(window, self.settings.sample_s);
                self.samples.extend(finished);
                Outcome::Accepted
            }
            Err(reason) => {
                self.samples.extend(self.builder.expire(index));
                reason
            }
        };
        self.tally.add(outcome, 1);
        self.compass.close();
        self.gyro.close();
        self.satellite.close();
        self.rate_of_turn = (0.0, 0);
        self.details = DetailReadings::default();
        self.is_reckoned = false;
    }

    /// Returns the means of the window, or the first reason to reject it.
    fn evaluate(&mut self, index: i64) -> Result<Window, Outcome> {
        let rate = self.rate_of_turn_deg_min();
        let turning = rate.is_some_and(|r| r.abs() > self.settings.max_rate_of_turn_deg_min);
        let settled = self.track_turns(index, turning);
        self.note_reference(index);
        if let Some(exclusion) = self.exclusion {
            return Err(exclusion.outcome());
        }
        if let Some(refusal) = self.compass.refusal() {
            return Err(Outcome::of_refusal(refusal));
        }
        let compass = self.compass.span().ok_or(Outcome::NoCompass)?;
        let (gyro, satellite) = (self.gyro.span(), self.satellite.span());
        // A refused reference is no reason to do without one.
        let refusal = self.gyro.refusal().or(self.satellite.refusal());
        let refusal = refusal.filter(|_| gyro.or(satellite).is_none());
        let details = self.details.means();
        let by_course = gyro.or(satellite).is_none() && refusal.is_none();
        if by_course && !(self.is_unreferenced(index) && details.has_course()) {
            return Err(Outcome::NoReference);
        }
        let position = LastValue::if_fresh(self.position, index).ok_or(Outcome::NoPosition)?;
        if is_weak(position, start_of(index)?) {
            return Err(Outcome::HighLatitude);
        }
        let enough = |span: &HeadingSpan| span.readings >= MIN_READINGS;
        let (gyro, satellite) = (gyro.filter(enough), satellite.filter(enough));
        let needs_reference = !by_course && refusal.is_none();
        if !enough(&compass) || (needs_reference && gyro.or(satellite).is_none()) {
            return Err(Outcome::Sparse);
        }
        let sog_kn = LastValue::if_fresh(self.speed, index).ok_or(Outcome::NoSpeed)?;
        if sog_kn < self.settings.min_sog_kn {
            return Err(Outcome::Slow);
        }
        if turning {
            return Err(Outcome::Turning);
        }
        if !settled {
            return Err(Outcome::Settling);
        }
        if self.heading_track().swing_deg() > 2.0 * self.settings.max_swing_deg {
            return Err(Outcome::Swinging);
        }
        if let Some(refusal) = refusal {
            return Err(Outcome::of_refusal(refusal));
        }
        let degrees = |span: HeadingSpan| wrap_360(span.mean);
        Ok(Window {
            index,
            compass_deg: degrees(compass),
            gyro_deg: gyro.map(degrees),
            satellite_deg: satellite.map(degrees),
            position,
            is_reckoned: self.is_reckoned,
            sog_kn,
            rate_of_turn_deg_min: rate,
            details,
            gyro_source: gyro.and(self.gyro.source()),
            satellite_source: satellite.and(self.satellite.source()),
        })
    }

    /// Records that a window has gyro or satellite compass.
    fn note_reference(&mut self, index: i64) {
        let has_reference = self.gyro.span().or(self.satellite.span()).is_some();
        if has_reference || self.referenced.is_none() {
            self.referenced = Some(index);
        }
    }

    /// Returns true if the ship has had neither gyro nor satellite compass for long.
    fn is_unreferenced(&self, index: i64) -> bool {
        let since = self.referenced.unwrap_or(index);
        index - since >= UNREFERENCED_WINDOWS
    }

    /// Records turns and gaps. Returns whether the compass has come to rest.
    fn track_turns(&mut self, index: i64, turning: bool) -> bool {
        let Some(span) = self.heading_track().span() else {
            return false;
        };
        let heading = span.mean;
        let settle_windows = (i64::from(self.settings.settle_s) + WINDOW_S - 1) / WINDOW_S;
        let turns = &mut self.turns;
        let blind = turns
            .seen
            .is_none_or(|seen| index - seen > MAX_BLIND_WINDOWS);
        let turned = turns
            .anchor
            .is_none_or(|anchor| wrap_180(heading - anchor).abs() > TURN_DEG);
        turns.seen = Some(index);
        if blind || turning || turned {
            turns.anchor = Some(heading);
            turns.settled_from = Some(index + 1 + settle_windows);
            return false;
        }
        let settled_from = turns.settled_from.unwrap_or(index);
        if index == settled_from {
            turns.anchor = Some(heading);
        }
        index >= settled_from
    }

    /// Returns the best heading for detecting turns and swings.
    fn heading_track(&self) -> &HeadingTrack {
        [&self.gyro, &self.satellite]
            .into_iter()
            .find(|track| track.span().is_some())
            .unwrap_or(&self.compass)
    }

    /// Returns a value with the open window; `None` without one.
    fn last_value<T>(&self, value: T) -> Option<LastValue<T>> {
        let window = self.window?;
        Some(LastValue { value, window })
    }

    /// Returns the mean of the rate-of-turn indicator, or the change of the heading.
    fn rate_of_turn_deg_min(&self) -> Option<f64> {
        let (sum, readings) = self.rate_of_turn;
        if readings > 0 {
            return Some(sum / f64::from(readings));
        }
        Some(self.heading_track().moved_deg()? * 60.0 / WINDOW_S as f64)
    }
}

fn window_of(time: Timestamp) -> i64 {
    time.micros().div_euclid(WINDOW_MICROS)
}

fn start_of(window: i64) -> Result<Timestamp, Outcome> {
    let micros = window.saturating_mul(WINDOW_MICROS);
    Timestamp::from_micros(micros).map_err(|_| Outcome::Clock)
}

/// Last value of a signal, and the window in which it was received.
#[derive(Clone, Copy, Debug)]
struct LastValue<T> {
    value: T,
    window: i64,
}

impl<T> LastValue<T> {
    /// Returns the value if it is recent enough for a window.
    fn if_fresh(last: Option<LastValue<T>>, window: i64) -> Option<T> {
        let last = last?;
        (window - last.window < FIX_VALID_WINDOWS).then_some(last.value)
    }
}

#[cfg(test)]
mod tests;
