//! Guard against receivers that lie: jamming and spoofing give positions that the ship cannot be
//! at, or that move as she does not.
//!
//! Invariants:
//!
//! - A fix is trusted if the ship can be there by dead reckoning from the last trusted fix, and
//!   from two some minutes ago: a false track may begin where she is. She is reckoned on from the
//!   earliest of them.
//! - While fixes are not trusted, neither are speed, course and satellite compass of the
//!   receivers. The reckoned place serves instead, with its error.
//! - It ends when fixes have agreed with the reckoning for minutes. A track elsewhere that moves
//!   as the ship does becomes the trusted one when it has lasted longer than the one before, or a
//!   day: the first fix may have been the false one.

mod reckoning;

pub(crate) use reckoning::{ReckonedPlace, offset};

use super::roles::{Instrument, ReferenceHeading, Refusal, Signal};
use binnacle_compass::angle::TrueHeading;
use binnacle_compass::position::Position;
use binnacle_compass::time::Timestamp;
use reckoning::{Motion, Reckoning, Speed};
use tokio::time::Instant;

/// Time over which motion is compared with the reckoning, seconds.
const TRACK_S: f64 = 300.0;
/// Time after which fixes that agree with the reckoning are trusted again, seconds: no circle looks
/// like a straight run for two of the times above.
const RECOVERED_S: f64 = 2.0 * TRACK_S;
/// Time after which a track elsewhere is accepted, seconds.
const ACCEPT_AFTER_S: f64 = 86_400.0;
/// Age up to which a heading or speed serves, seconds.
const FRESH_S: f64 = 15.0;
/// Silence of the receiver after which its speed is the last one's, seconds.
const SILENT_S: f64 = 15.0;

/// Interference with the receivers, as it goes on.
#[derive(Clone, Copy, Debug, PartialEq)]
pub(crate) struct Interference {
    /// Ship's time when it began.
    pub(crate) since: Option<Timestamp>,
    /// Last place that was trusted.
    pub(crate) place: Position,
}

/// State of the guard.
#[derive(Debug, Default)]
pub(crate) struct GnssGuard {
    clock: GuardClock,
    /// Reckoning from the last trusted fix.
    from_last: Option<Reckoning>,
    /// Reckonings from trusted fixes some minutes ago, the later one first.
    from_earlier: [Option<Reckoning>; 2],
    /// Time since which fixes have been trusted without a break, or before the interference.
    trusted_s: f64,
    /// Fixes that are not trusted.
    elsewhere: Option<Track>,
    interference: Option<Interference>,
    gyro: Option<Dated>,
    corrected: Option<Dated>,
    water_speed: Option<Dated>,
    ground_speed: Option<Dated>,
    heard_fix_s: f64,
}

/// Number and its time by the guard's clock, seconds.
#[derive(Clone, Copy, Debug)]
struct Dated {
    value: f64,
    at_s: f64,
}

/// Track of fixes that are not trusted, as far as it moves as the ship does.
#[derive(Clone, Copy, Debug)]
struct Track {
    /// Reckoning from one of its fixes, some minutes ago at most.
    from: Reckoning,
    lasted_s: f64,
}

/// Clock of the guard: the ship's time as it advances, and the computer's where it does not.
#[derive(Debug, Default)]
struct GuardClock {
    seconds: f64,
    ship: Option<Timestamp>,
    computer: Option<Instant>,
    /// Seconds counted by the computer since the ship's time advanced.
    since_ship_s: f64,
}

impl GuardClock {
    /// Advances to a moment. Returns the seconds passed.
    fn advance(&mut self, ship: Option<Timestamp>, now: Instant) -> f64 {
        let last = self.computer.replace(now).unwrap_or(now);
        let mut passed_s = now.saturating_duration_since(last).as_secs_f64();
        self.since_ship_s += passed_s;
        if self.ship != ship {
            if let (Some(before), Some(ship)) = (self.ship, ship) {
                // Recorded time runs fast.
                passed_s += (ship.seconds_since(before) - self.since_ship_s).max(0.0);
            }
            self.ship = ship;
            self.since_ship_s = 0.0;
        }
        self.seconds += passed_s;
        passed_s
    }
}

impl GnssGuard {
    /// Advances to a moment by the ship's time and the computer's.
    pub(crate) fn advance(&mut self, ship: Option<Timestamp>, now: Instant) {
        let passed_s = self.clock.advance(ship, now);
        if passed_s <= 0.0 {
            return;
        }
        let motion = self.motion();
        if let Some(track) = &mut self.elsewhere {
            track.from.advance(passed_s, motion);
            track.lasted_s += passed_s;
        }
        let reckonings = self.from_last.iter_mut();
        for reckoning in reckonings.chain(self.from_earlier.iter_mut().flatten()) {
            reckoning.advance(passed_s, motion);
        }
        if self.interference.is_none() {
            self.trusted_s += passed_s;
        }
    }

    /// Applies a signal. Returns those to use in its place.
    pub(crate) fn apply(&mut self, signal: Signal) -> [Option<Signal>; 2] {
        let at_s = self.clock.seconds;
        let dated = |value: f64| Some(Dated { value, at_s });
        match signal {
            Signal::Position(fix) => {
                self.heard_fix_s = at_s;
                return self.fix(fix);
            }
            Signal::Gyro(ReferenceHeading { heading, .. }) => {
                self.gyro = dated(heading.degrees());
            }
            Signal::WaterSpeed(kn) => self.water_speed = dated(kn),
            Signal::Speed(_) | Signal::Course(_) if self.interference.is_some() => {
                return [None; 2];
            }
            Signal::Speed(kn) => self.ground_speed = dated(kn),
            Signal::Satellite(_) if self.interference.is_some() => {
                let refusal = Refusal::Interference;
                return [Some(Signal::Refused(Instrument::Satellite, refusal)), None];
            }
            _ => {}
        }
        [Some(signal), None]
    }

    /// Records the corrected heading, which serves where there is no gyro.
    pub(crate) fn note_corrected(&mut self, heading: Option<TrueHeading>) {
        let at_s = self.clock.seconds;
        self.corrected = heading.map(|heading| Dated {
            value: heading.degrees(),
            at_s,
        });
    }

    /// Returns the interference, if there is any.
    pub(crate) fn interference(&self) -> Option<Interference> {
        self.interference
    }

    /// Returns the ship's place now.
    pub(crate) fn place(&self) -> Option<ReckonedPlace> {
        self.from_last.as_ref().map(Reckoning::place)
    }

    fn fix(&mut self, fix: Position) -> [Option<Signal>; 2] {
        let trusted = [Some(Signal::Position(fix)), None];
        let Some(from_last) = self.from_last else {
            self.trust(fix);
            return trusted;
        };
        let mut earlier = self.from_earlier.iter().flatten();
        let is_possible = from_last.allows(fix) && earlier.all(|from| from.allows(fix));
        if self.interference.is_none() && is_possible {
            self.trust(fix);
            return trusted;
        }
        if self.interference.is_none() {
            let [later, earliest] = self.from_earlier;
            let start = earliest.or(later).unwrap_or(from_last);
            self.interference = Some(Interference {
                since: self.clock.ship,
                place: start.place().position,
            });
            // What the receivers gave of late may have been false already.
            self.from_last = Some(start);
            self.from_earlier = [None; 2];
        }
        if self.is_over(fix) {
            self.interference = None;
            self.elsewhere = None;
            self.trust(fix);
            return trusted;
        }
        let reckoned = self.from_last.unwrap_or(from_last).place();
        let speed_kn = match self.motion().speed {
            Speed::Read(kn) | Speed::Last(kn) => Some(kn),
            Speed::Unknown => None,
        };
        [
            Some(Signal::Reckoned(reckoned.position)),
            speed_kn.map(Signal::Speed),
        ]
    }

    /// Follows a fix that is not trusted. Returns whether its track has come to be.
    fn is_over(&mut self, fix: Position) -> bool {
        let follows = self.elsewhere.filter(|track| track.from.allows(fix));
        let Some(mut track) = follows else {
            self.elsewhere = Some(Track {
                from: Reckoning::from_fix(fix),
                lasted_s: 0.0,
            });
            return false;
        };
        let is_where_she_is = self.from_last.is_none_or(|from| from.allows(fix));
        let needed_s = if is_where_she_is {
            RECOVERED_S
        } else {
            self.trusted_s.clamp(RECOVERED_S, ACCEPT_AFTER_S)
        };
        if track.lasted_s >= needed_s {
            if !is_where_she_is {
                self.trusted_s = track.lasted_s;
            }
            return true;
        }
        if track.from.seconds >= TRACK_S {
            track.from = Reckoning::from_fix(fix);
        }
        self.elsewhere = Some(track);
        false
    }

    fn trust(&mut self, fix: Position) {
        self.from_last = Some(Reckoning::from_fix(fix));
        let [later, _] = self.from_earlier;
        if later.is_none_or(|from| from.seconds >= TRACK_S) {
            self.from_earlier = [Some(Reckoning::from_fix(fix)), later];
        }
    }

    /// Returns the ship's motion by what is known of it now.
    fn motion(&self) -> Motion {
        let now_s = self.clock.seconds;
        let fresh = |dated: Option<Dated>| {
            let fresh = dated.filter(|dated| now_s - dated.at_s <= FRESH_S);
            fresh.map(|dated| dated.value)
        };
        let hears_receiver = self.interference.is_none() && now_s - self.heard_fix_s <= SILENT_S;
        let by_receiver = fresh(self.ground_speed).filter(|_| hears_receiver);
        // A log that fails reads too little.
        let read = [by_receiver, fresh(self.water_speed)].into_iter().flatten();
        let last = self.water_speed.or(self.ground_speed);
        let speed = match (read.reduce(f64::max), last) {
            (Some(kn), _) => Speed::Read(kn),
            (None, Some(last)) => Speed::Last(last.value),
            (None, None) => Speed::Unknown,
        };
        Motion {
            headings_deg: [fresh(self.gyro), fresh(self.corrected)],
            speed,
        }
    }
}

#[cfg(test)]
mod tests;
