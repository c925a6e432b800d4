//! One receiver, and whether its fixes are trusted.

use super::reckoning::{Motion, Reckoning};
use super::{GnssSource, TRACK_S};
use binnacle_compass::position::Position;
use binnacle_observation::Source;
use std::cmp::Ordering;

/// Time after which fixes that agree with the reckoning are trusted again, seconds: no circle looks
/// like a straight run for two of the times above.
const RECOVERED_S: f64 = 2.0 * TRACK_S;
/// Time after which a track elsewhere is accepted, seconds.
const ACCEPT_AFTER_S: f64 = 86_400.0;

/// Receiver and its reckonings.
#[derive(Debug)]
pub(super) struct Receiver {
    pub(super) source: Source,
    names_talker: bool,
    /// Best selection that its fixes match.
    pub(super) rank: usize,
    /// Time of its latest fix by the guard's clock, seconds.
    pub(super) heard_s: f64,
    pub(super) is_trusted: bool,
    /// Reckoning from its last trusted fix.
    pub(super) from_last: Option<Reckoning>,
    /// Reckonings from trusted fixes some minutes ago, the later one first.
    from_earlier: [Option<Reckoning>; 2],
    /// Time since which its fixes have been trusted without a break, or before they were not.
    pub(super) trusted_s: f64,
    /// Fixes that are not trusted.
    elsewhere: Option<Track>,
}

/// Track of fixes that are not trusted, as far as it moves as the ship does.
#[derive(Clone, Copy, Debug)]
struct Track {
    /// Reckoning from one of its fixes, some minutes ago at most.
    from: Reckoning,
    lasted_s: f64,
}

/// Evidence about a fix besides the receiver's own reckonings.
#[derive(Clone, Copy, Debug)]
pub(super) struct Evidence {
    /// Best reckoning of the ship.
    pub(super) ship: Option<Reckoning>,
    /// Longest time for which another receiver has been trusted, seconds.
    pub(super) others_trusted_s: f64,
}

impl Receiver {
    /// Creates a receiver by its first fix, which is trusted or not.
    pub(super) fn new(
        of: GnssSource<'_>,
        now_s: f64,
        is_trusted: bool,
        trusted_s: f64,
    ) -> Receiver {
        Receiver {
            source: of.source.clone(),
            names_talker: of.names_talker,
            rank: of.rank,
            heard_s: now_s,
            is_trusted,
            from_last: None,
            from_earlier: [None; 2],
            trusted_s,
            elsewhere: None,
        }
    }

    /// Returns whether an observation is of this receiver.
    pub(super) fn is_receiver(&self, of: GnssSource<'_>) -> bool {
        let own = GnssSource {
            source: &self.source,
            rank: self.rank,
            names_talker: self.names_talker,
        };
        own.is_same_receiver(of)
    }

    /// Returns the order of two receivers, the better one first.
    pub(super) fn order(&self, other: &Receiver) -> Ordering {
        let by_name = || self.source.device_order(&other.source);
        self.rank.cmp(&other.rank).then_with(by_name)
    }

    /// Goes on for some seconds.
    pub(super) fn advance(&mut self, seconds: f64, motion: Motion) {
        if let Some(track) = &mut self.elsewhere {
            track.from.advance(seconds, motion);
            track.lasted_s += seconds;
        }
        let reckonings = self.from_last.iter_mut();
        for reckoning in reckonings.chain(self.from_earlier.iter_mut().flatten()) {
            reckoning.advance(seconds, motion);
        }
        if self.is_trusted {
            self.trusted_s += seconds;
        }
    }

    /// Follows a fix of a receiver that is trusted. It is so no longer if the ship cannot be there.
    pub(super) fn follow(&mut self, fix: Position) {
        let reckonings = self.from_last.iter();
        let mut all = reckonings.chain(self.from_earlier.iter().flatten());
        if all.all(|from| from.allows(fix)) {
            self.trust(fix);
            return;
        }
        self.is_trusted = false;
        // What it gave of late may have been false already.
        let [later, earliest] = self.from_earlier;
        self.from_last = earliest.or(later).or(self.from_last);
        self.from_earlier = [None; 2];
    }

    /// Follows a fix of a receiver that is not trusted. It is trusted again once its track has come
    /// to be.
    pub(super) fn recover(&mut self, fix: Position, evidence: Evidence) {
        let follows = self.elsewhere.filter(|track| track.from.allows(fix));
        let Some(mut track) = follows else {
            self.elsewhere = Some(Track {
                from: Reckoning::from_fix(fix),
                lasted_s: 0.0,
            });
            return;
        };
        let is_where_she_is = evidence.ship.is_none_or(|from| from.allows(fix));
        let needed_s = if is_where_she_is {
            RECOVERED_S
        } else {
            let own_s = self.trusted_s.clamp(RECOVERED_S, ACCEPT_AFTER_S);
            own_s.max(evidence.others_trusted_s)
        };
        if track.lasted_s >= needed_s {
            if !is_where_she_is {
                self.trusted_s = track.lasted_s;
            }
            self.is_trusted = true;
            self.elsewhere = None;
            self.trust(fix);
            return;
        }
        if track.from.seconds >= TRACK_S {
            track.from = Reckoning::from_fix(fix);
        }
        self.elsewhere = Some(track);
    }

    fn trust(&mut self, fix: Position) {
        self.from_last = Some(Reckoning::from_fix(fix));
        let [later, _] = self.from_earlier;
        if later.is_none_or(|from| from.seconds >= TRACK_S) {
            self.from_earlier = [Some(Reckoning::from_fix(fix)), later];
        }
    }
}
