//! Guard against receivers that lie: jamming and spoofing give positions that the ship cannot be
//! at, or that move as she does not.
//!
//! Invariants:
//!
//! - Each receiver is judged by itself. Its fix is trusted if the ship can be there by dead
//!   reckoning from its last trusted fix, and from two some minutes ago: a false track may begin
//!   where she is. She is reckoned on from the earliest of them.
//! - Of the receivers that are heard and trusted the first one by the order of the roles is used.
//!   Speed and course of another one are not.
//! - While fixes are heard and none is trusted, there is interference: the reckoned place serves
//!   instead, with its error. A satellite compass is not used while the first receiver is not
//!   trusted.
//! - A receiver is trusted again when its fixes have agreed with the reckoning for minutes. A track
//!   elsewhere that moves as the ship does becomes a trusted one when it has lasted longer than
//!   what speaks against it, or a day: the first fix may have been the false one.
//! - The first fix after a restart is held against the place before it, by the time passed since,
//!   and not before the ship's time is known.

mod place_checkpoint;
mod receiver;
mod reckoning;

pub use place_checkpoint::PlaceCheckpoint;
pub use reckoning::{ReckonedPlace, offset};

use super::gnss_clock::Trust;
use super::roles::{GnssSource, Instrument, ReferenceHeading, Refusal, Signal};
use binnacle_compass::angle::TrueHeading;
use binnacle_compass::position::Position;
use binnacle_compass::time::Timestamp;
use receiver::{Evidence, Receiver};
use reckoning::{Motion, Reckoning, Speed};
use tokio::time::Instant;

/// Time over which motion is compared with the reckoning, seconds.
const TRACK_S: f64 = 300.0;
/// Age up to which a heading or speed serves, seconds.
const FRESH_S: f64 = 15.0;
/// Silence of the receiver after which its speed is the last one's, seconds.
const SILENT_S: f64 = 15.0;
/// Receivers that are judged: senders of datagrams may be many.
const MAX_RECEIVERS: usize = 16;

/// Interference with the receivers, as it goes on.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Interference {
    /// Ship's time when it began.
    pub since: Option<Timestamp>,
    /// Last place that was trusted.
    pub place: Position,
}

/// State of the guard.
#[derive(Debug)]
pub struct GnssGuard {
    /// Silence after which the next receiver is used, seconds.
    stale_s: f64,
    clock: GuardClock,
    receivers: Vec<Receiver>,
    interference: Option<Interference>,
    /// Reckoning from before a restart, until a receiver is used.
    before: Option<Before>,
    gyro: Option<Dated>,
    corrected: Option<Dated>,
    water_speed: Option<Dated>,
    ground_speed: Option<Dated>,
    /// Time of the latest fix that was used.
    heard_fix_s: f64,
}

/// Reckoning from before a restart.
#[derive(Clone, Copy, Debug)]
struct Before {
    reckoning: Reckoning,
    /// Longest time for which a receiver had been trusted, seconds.
    trusted_s: f64,
    is_time_known: bool,
}

/// Number and its time by the guard's clock, seconds.
#[derive(Clone, Copy, Debug)]
struct Dated {
    value: f64,
    at_s: f64,
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
    /// Creates a guard that has heard nothing; `stale_s` is the silence limit of the position.
    pub fn new(stale_s: f64) -> GnssGuard {
        GnssGuard {
            stale_s,
            clock: GuardClock::default(),
            receivers: Vec::new(),
            interference: None,
            before: None,
            gyro: None,
            corrected: None,
            water_speed: None,
            ground_speed: None,
            heard_fix_s: 0.0,
        }
    }

    /// Returns the ship's place, to be saved at a computer's time; `None` if it is not known.
    pub fn checkpoint(&self, computer: Timestamp) -> Option<PlaceCheckpoint> {
        let place = self.place()?;
        let trusted_s = self.receivers.iter().map(|receiver| receiver.trusted_s);
        let before_s = self.before.map_or(0.0, |before| before.trusted_s);
        Some(PlaceCheckpoint {
            position: place.position,
            radius_nm: place.radius_nm,
            trusted_s: trusted_s.fold(before_s, f64::max),
            ship: self.clock.ship,
            computer,
        })
    }

    /// Goes on from the place before a restart, given the computer's time now. A computer that has
    /// lost its time since does not know how long ago that was.
    pub fn restore(&mut self, saved: PlaceCheckpoint, computer: Timestamp) {
        let passed_s = computer.seconds_since(saved.computer);
        if passed_s < 0.0 {
            return;
        }
        let mut reckoning = Reckoning::from_place(saved.position, saved.radius_nm);
        reckoning.advance(passed_s, Motion::default());
        // The ship's time shows whether it was longer.
        (self.clock.ship, self.clock.since_ship_s) = (saved.ship, passed_s);
        self.before = Some(Before {
            reckoning,
            trusted_s: saved.trusted_s,
            is_time_known: saved.ship.is_none(),
        });
    }

    /// Advances to a moment by the ship's time and the computer's.
    pub fn advance(&mut self, ship: Option<Timestamp>, now: Instant) {
        let before = self.before.as_mut();
        if let Some(before) = before.filter(|before| !before.is_time_known) {
            if ship.is_none() {
                self.clock.advance(self.clock.ship, now);
                return;
            }
            before.is_time_known = true;
        }
        let passed_s = self.clock.advance(ship, now);
        if passed_s <= 0.0 {
            return;
        }
        let motion = self.motion();
        for receiver in &mut self.receivers {
            receiver.advance(passed_s, motion);
        }
        if let Some(before) = &mut self.before {
            before.reckoning.advance(passed_s, motion);
        }
    }

    /// Applies a signal, of a receiver if one gave it. Returns those to use in its place.
    pub fn apply(
        &mut self,
        signal: Signal,
        receiver: Option<GnssSource<'_>>,
    ) -> [Option<Signal>; 2] {
        let at_s = self.clock.seconds;
        let dated = |value: f64| Some(Dated { value, at_s });
        match (signal, receiver) {
            (Signal::Position(fix), Some(receiver)) => return self.fix(fix, receiver),
            (Signal::Speed(_) | Signal::Course(_), Some(receiver)) if !self.uses(receiver) => {
                return [None; 2];
            }
            (Signal::Speed(kn), _) => self.ground_speed = dated(kn),
            (Signal::Gyro(ReferenceHeading { heading, .. }), _) => {
                self.gyro = dated(heading.degrees());
            }
            (Signal::WaterSpeed(kn), _) => self.water_speed = dated(kn),
            (Signal::Satellite(_), _) if self.is_disturbed() => {
                let refusal = Refusal::Interference;
                return [Some(Signal::Refused(Instrument::Satellite, refusal)), None];
            }
            _ => {}
        }
        [Some(signal), None]
    }

    /// Returns the trust in a receiver by its fixes so far. One that gives none is trusted as those
    /// of its selection are.
    pub fn trust(&self, receiver: GnssSource<'_>) -> Trust {
        let is_trusted = match self.find(receiver) {
            Some(index) => self.receivers[index].is_trusted,
            None => self.trusts_selection(receiver.rank),
        };
        if is_trusted {
            Trust::Trusted
        } else {
            Trust::NotTrusted
        }
    }

    /// Records the corrected heading, which serves where there is no gyro.
    pub fn note_corrected(&mut self, heading: Option<TrueHeading>) {
        let at_s = self.clock.seconds;
        self.corrected = heading.map(|heading| Dated {
            value: heading.degrees(),
            at_s,
        });
    }

    /// Returns the interference, if there is any.
    pub fn interference(&self) -> Option<Interference> {
        self.interference
    }

    /// Returns the ship's place now.
    pub fn place(&self) -> Option<ReckonedPlace> {
        self.ship().map(Reckoning::place)
    }

    /// Describes the receivers that are not trusted while another one is used.
    pub fn problems(&self) -> impl Iterator<Item = String> {
        let used = self.used().map(|used| &self.receivers[used].source);
        let refused = self
            .receivers
            .iter()
            .filter(|receiver| !receiver.is_trusted && self.is_heard(receiver));
        used.into_iter().flat_map(move |used| {
            refused.clone().map(move |receiver| {
                let source = &receiver.source;
                format!(
                    "position: {source} is not trusted: the vessel cannot be where it says; \
                     {used} is used"
                )
            })
        })
    }

    fn fix(&mut self, fix: Position, of: GnssSource<'_>) -> [Option<Signal>; 2] {
        if self.before.is_some_and(|before| !before.is_time_known) {
            return [None; 2];
        }
        let Some(index) = self.hear(fix, of) else {
            return [None; 2];
        };
        if self.receivers[index].is_trusted {
            self.receivers[index].follow(fix);
        }
        if !self.receivers[index].is_trusted {
            let evidence = self.evidence(index);
            self.receivers[index].recover(fix, evidence);
        }
        let used = self.used();
        if used == Some(index) {
            self.interference = None;
            self.before = None;
            self.heard_fix_s = self.clock.seconds;
            return [Some(Signal::Position(fix)), None];
        }
        let reckoned = self.place().filter(|_| used.is_none());
        let Some(reckoned) = reckoned else {
            return [None; 2];
        };
        self.interference.get_or_insert(Interference {
            since: self.clock.ship,
            place: reckoned.position,
        });
        let speed_kn = match self.motion().speed {
            Speed::Read(kn) | Speed::Last(kn) => Some(kn),
            Speed::Unknown => None,
        };
        [
            Some(Signal::Reckoned(reckoned.position)),
            speed_kn.map(Signal::Speed),
        ]
    }

    /// Notes that a receiver gave a fix. Returns the receiver, unless it gives its fixes in a better
    /// sentence.
    fn hear(&mut self, fix: Position, of: GnssSource<'_>) -> Option<usize> {
        let now_s = self.clock.seconds;
        let Some(index) = self.find(of) else {
            if self.receivers.len() >= MAX_RECEIVERS {
                return None;
            }
            let is_possible = self.ship().is_none_or(|ship| ship.allows(fix));
            let is_trusted = is_possible && self.interference.is_none();
            let before_s = self.before.map_or(0.0, |before| before.trusted_s);
            let trusted_s = if is_trusted { 0.0 } else { before_s };
            self.receivers
                .push(Receiver::new(of, now_s, is_trusted, trusted_s));
            return Some(self.receivers.len() - 1);
        };
        let is_heard = self.is_heard(&self.receivers[index]);
        let receiver = &mut self.receivers[index];
        if of.rank > receiver.rank && is_heard {
            return None;
        }
        (receiver.rank, receiver.heard_s) = (of.rank, now_s);
        Some(index)
    }

    fn find(&self, of: GnssSource<'_>) -> Option<usize> {
        let mut receivers = self.receivers.iter();
        receivers.position(|receiver| receiver.is_receiver(of))
    }

    fn is_heard(&self, receiver: &Receiver) -> bool {
        self.clock.seconds - receiver.heard_s <= self.stale_s
    }

    /// Returns the receiver that is used: the first one that is heard and trusted.
    fn used(&self) -> Option<usize> {
        let trusted = (0..self.receivers.len()).filter(|index| {
            let receiver = &self.receivers[*index];
            receiver.is_trusted && self.is_heard(receiver)
        });
        trusted.min_by(|one, other| self.receivers[*one].order(&self.receivers[*other]))
    }

    /// Returns whether speed and course of a receiver are used. One that gives no fixes belongs to
    /// those of its selection.
    fn uses(&self, of: GnssSource<'_>) -> bool {
        let used = self.used();
        if let Some(index) = self.find(of) {
            return used == Some(index);
        }
        self.interference.is_none()
            && used.is_none_or(|used| of.rank <= self.receivers[used].rank)
            && self.trusts_selection(of.rank)
    }

    fn trusts_selection(&self, rank: usize) -> bool {
        let mut peers = self.receivers.iter().filter(|peer| peer.rank == rank);
        peers.all(|peer| peer.is_trusted)
    }

    /// Returns whether the first receiver that is heard is not trusted: what else comes from the
    /// satellites may be false as well.
    fn is_disturbed(&self) -> bool {
        let heard = self.receivers.iter().filter(|one| self.is_heard(one));
        let first = heard.min_by(|one, other| one.order(other));
        self.interference.is_some() || first.is_some_and(|first| !first.is_trusted)
    }

    /// Returns the best reckoning of the ship: that of the receiver in use, or the one with the
    /// smallest error.
    fn ship(&self) -> Option<&Reckoning> {
        let used = self
            .used()
            .and_then(|used| self.receivers[used].from_last.as_ref());
        used.or_else(|| {
            let reckonings = self
                .receivers
                .iter()
                .filter_map(|one| one.from_last.as_ref())
                .chain(self.before.as_ref().map(|before| &before.reckoning));
            let radius_nm = |reckoning: &Reckoning| reckoning.place().radius_nm;
            reckonings.min_by(|one, other| radius_nm(one).total_cmp(&radius_nm(other)))
        })
    }

    /// Returns the evidence about the fixes of a receiver.
    fn evidence(&self, index: usize) -> Evidence {
        let others = self
            .receivers
            .iter()
            .enumerate()
            .filter(|(other, receiver)| {
                *other != index && receiver.is_trusted && self.is_heard(receiver)
            });
        let trusted_s = others.map(|(_, receiver)| receiver.trusted_s);
        Evidence {
            ship: self.ship().copied(),
            others_trusted_s: trusted_s.fold(0.0, f64::max),
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
