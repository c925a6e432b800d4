//! The vessel's clock: time of its GNSS receivers, as far as it is plausible.
//!
//! Invariants:
//!
//! - Time never runs backwards unannounced, and one wrong stamp does not move it: a jump counts
//!   when a second stamp confirms it.
//! - On board, a jump that the computer's clock does not confirm is uncertain: of seconds where the
//!   time has run in step with the monotonic clock ([`pace`]), of ten minutes otherwise. Time stands
//!   still, so nothing is sampled. It goes on when the receiver returns to its old time, when the
//!   server's or the computer's time decides, or when the new time has lasted without
//!   contradiction: for a day, or after a jump of less than ten minutes for as long as the old one.
//!   A receiver that has learnt its leap seconds jumps by less than a minute.
//! - A receiver whose position is not trusted ranks behind all that are. On board its new time is
//!   never accepted for having lasted.
//! - On board, the first stamp after a restart is uncertain too where the checkpoint contradicts it
//!   ([`super::clock_checkpoint`]).
//! - On board, a date that lags by a multiple of 1,024 weeks, after which GPS week numbers start
//!   from 0 again (IS-GPS-200, 20.3.3.3.1.1), is corrected.
//! - Recorded and accelerated data work: without [`GnssClock::set_reference`] no other clock is
//!   consulted, and every jump is accepted.

mod pace;

use super::clock_checkpoint::ClockCheckpoint;
use binnacle_compass::time::Timestamp;
use pace::Pace;
use tokio::time::Instant;

/// Largest difference between two receivers, or two sentences.
const RECEIVER_TOLERANCE_S: f64 = 2.0;
/// Largest step that counts as mere silence.
const MAX_STEP_S: f64 = 600.0;
/// Time within which a second stamp confirms a jump.
const CONFIRM_S: f64 = 60.0;
/// Error of another clock up to which it may decide.
const ARBITRATION_TOLERANCE_S: f64 = 3_600.0;
/// Duration after which an uncontradicted new time is accepted at the latest.
const ACCEPT_AFTER_S: f64 = 86_400.0;
/// Error of the computer's quartz, as a share of the elapsed time.
const QUARTZ_DRIFT: f64 = 0.01;
/// 1980-01-06, the start of GPS time, to 2100-01-01.
const PLAUSIBLE_MICROS: std::ops::Range<i64> = 315_964_800_000_000..4_102_444_800_000_000;
const ROLL_OVER_S: f64 = 1_024.0 * 7.0 * 86_400.0;
/// Largest difference between the known time and a corrected date: the computer's battery may be
/// empty for as long.
const YEAR_S: f64 = 366.0 * 86_400.0;

/// Effect of a time stamp on the clock.
#[derive(Clone, Copy, Debug, PartialEq)]
pub enum Step {
    /// No effect.
    Held,
    /// Time advanced.
    Advanced(Timestamp),
    /// Time jumped: everything open is void.
    Jumped(Timestamp),
}

/// Trust in a receiver, by its positions.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Trust {
    /// The ship can be where it says.
    Trusted,
    /// The ship cannot be there, or could not of late.
    NotTrusted,
}

/// Source of a time stamp.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum TimeSource {
    /// A receiver of a rank, 0 being the best.
    Receiver(usize, Trust),
    /// The recording itself, which ranks behind every receiver.
    Recording,
}

/// One clock from ranked sources of time.
#[derive(Debug)]
pub struct GnssClock {
    now: Option<Timestamp>,
    candidate: Option<Timestamp>,
    stale_s: f64,
    /// Ranks of receivers.
    receivers: usize,
    /// Place of the active source among all, the best being 0.
    active: usize,
    /// First stamp of each place since the active source was heard.
    waiting: Vec<Option<Timestamp>>,
    reference: Option<ReferenceClock>,
    pace: Pace,
    /// Checkpoint from before the restart, until there is a first stamp.
    checkpoint: Option<ClockCheckpoint>,
    unconfirmed: Option<UnconfirmedJump>,
    rolled_over: bool,
}

/// Time outside the receivers, as the computer knows it.
#[derive(Clone, Copy, Debug)]
struct ReferenceClock {
    /// Time of the server or the computer when it was set.
    time: Timestamp,
    set_at: Instant,
    /// Receive time of the current stamp.
    heard_at: Instant,
    /// Time when the clock was last confirmed.
    valid_at: Instant,
}

impl ReferenceClock {
    /// Returns the reference time now.
    fn now(&self) -> Timestamp {
        let passed = self.heard_at.saturating_duration_since(self.set_at);
        self.time.plus_seconds(passed.as_secs_f64())
    }

    /// Returns the seconds since the clock was last confirmed.
    fn since_valid_s(&self) -> f64 {
        let passed = self.heard_at.saturating_duration_since(self.valid_at);
        passed.as_secs_f64()
    }
}

/// A jump that nothing confirms.
#[derive(Clone, Copy, Debug)]
struct UnconfirmedJump {
    /// Set if the first stamp was uncertain already.
    is_first: bool,
    jump_s: f64,
    last: Timestamp,
    /// Duration by the receiver's own time.
    lasted_s: f64,
    /// Duration after which it is accepted if nothing contradicts it.
    needed_s: f64,
}

impl GnssClock {
    /// Creates a clock that has not been set, with receivers of rank 0 to `receivers - 1`.
    pub fn new(receivers: usize, stale_s: f64) -> GnssClock {
        let recording = 2 * receivers;
        GnssClock {
            now: None,
            candidate: None,
            stale_s,
            receivers,
            active: recording,
            waiting: vec![None; recording + 1],
            reference: None,
            pace: Pace::default(),
            checkpoint: None,
            unconfirmed: None,
            rolled_over: false,
        }
    }

    /// Returns GNSS time, once it is known.
    pub fn now(&self) -> Option<Timestamp> {
        self.now
    }

    /// Returns GNSS time as it runs on while a jump is uncertain: by the seconds that the receiver
    /// has counted since.
    pub fn running(&self) -> Option<Timestamp> {
        let lasted_s = self.unconfirmed.map_or(0.0, |jump| jump.lasted_s);
        self.now.map(|now| now.plus_seconds(lasted_s))
    }

    /// Sets the computer's time as the reference for jumps.
    pub fn set_reference(&mut self, time: Timestamp, now: Instant) {
        self.reference = Some(ReferenceClock {
            time,
            set_at: now,
            heard_at: now,
            valid_at: now,
        });
    }

    /// Sets the checkpoint that the first stamp is checked against.
    pub fn restore_checkpoint(&mut self, checkpoint: ClockCheckpoint) {
        self.checkpoint = Some(checkpoint);
    }

    /// Returns whether its time is uncertain.
    pub fn is_uncertain(&self) -> bool {
        self.unconfirmed.is_some()
    }

    /// Corrects the reference by the server's time, which the computer may not know.
    pub fn correct_reference(&mut self, time: Timestamp, now: Instant) {
        if let Some(reference) = &mut self.reference {
            (reference.time, reference.set_at) = (time, now);
        }
    }

    /// Sets the receive time of the stamps that follow.
    pub fn set_receive_time(&mut self, heard_at: Instant) {
        if let Some(reference) = &mut self.reference {
            reference.heard_at = heard_at;
        }
    }

    /// Describes the fault of the receiver's time.
    pub fn problem(&self) -> Option<String> {
        if let Some(unconfirmed) = self.unconfirmed {
            let offset = if unconfirmed.jump_s.abs() < MAX_STEP_S {
                format!("{:+.0} s", unconfirmed.jump_s)
            } else if unconfirmed.jump_s.abs() < 2.0 * ACCEPT_AFTER_S {
                format!("{:+.1} h", unconfirmed.jump_s / 3_600.0)
            } else {
                format!("{:+.0} days", unconfirmed.jump_s / 86_400.0)
            };
            let what = if unconfirmed.is_first {
                format!("differs by {offset} from this computer's clock or spool")
            } else {
                format!("jumped by {offset}")
            };
            return Some(format!(
                "the receiver's time {what}: nothing is sampled until it is clear which time is right"
            ));
        }
        self.rolled_over.then(|| {
            "the receiver's date is 1024 weeks behind, after a roll-over of the GNSS weeks: it \
             is corrected here"
                .to_owned()
        })
    }

    /// Applies a time stamp from a source.
    pub fn observe(&mut self, source: TimeSource, stamp: Timestamp) -> Step {
        let place = self.place(source);
        if !PLAUSIBLE_MICROS.contains(&stamp.micros()) || place >= self.waiting.len() {
            return Step::Held;
        }
        let without_rollover = self.without_rollover(stamp);
        if !self.accept_source(place, without_rollover) {
            return Step::Held;
        }
        self.rolled_over = without_rollover != stamp;
        let step = match self.unconfirmed {
            Some(unconfirmed) => self.resolve_jump(unconfirmed, without_rollover),
            None => self.apply(without_rollover),
        };
        if let Some(reference) = &mut self.reference
            && self.unconfirmed.is_none()
            && self.candidate.is_none()
        {
            reference.valid_at = reference.heard_at;
        }
        step
    }

    fn without_rollover(&self, stamp: Timestamp) -> Timestamp {
        let Some(reference) = self.reference else {
            return stamp;
        };
        let reference_time = reference.now();
        if stamp.seconds_since(reference_time).abs() <= YEAR_S {
            // The vessel's clock is wrong, if any: a receiver may have counted a cycle too many.
            return stamp;
        }
        let noted = self
            .checkpoint
            .map_or(reference_time, |checkpoint| checkpoint.ship);
        let known = self.now.unwrap_or(reference_time.max(noted));
        let behind_s = known.seconds_since(stamp);
        let cycles = (behind_s / ROLL_OVER_S).round();
        if cycles < 1.0 || (behind_s - cycles * ROLL_OVER_S).abs() > YEAR_S {
            return stamp;
        }
        stamp.plus_seconds(cycles * ROLL_OVER_S)
    }

    /// Returns whether a source may set the clock: the active one and better ones may, a worse one
    /// when the active one has been silent for long by the worse one's own time.
    fn accept_source(&mut self, place: usize, stamp: Timestamp) -> bool {
        if place > self.active && self.now.is_some() {
            let since = *self.waiting[place].get_or_insert(stamp);
            if stamp.seconds_since(since).abs() < self.stale_s {
                return false;
            }
        }
        self.active = place;
        self.waiting.fill(None);
        true
    }

    /// Returns the place of a source among all: receivers that are trusted, those that are not, and
    /// the recording.
    fn place(&self, source: TimeSource) -> usize {
        match source {
            TimeSource::Receiver(rank, Trust::Trusted) => rank,
            TimeSource::Receiver(rank, Trust::NotTrusted) => self.receivers + rank,
            TimeSource::Recording => 2 * self.receivers,
        }
    }

    /// Returns whether the active source is a receiver that is not trusted.
    fn is_distrusted(&self) -> bool {
        (self.receivers..2 * self.receivers).contains(&self.active)
    }

    fn apply(&mut self, stamp: Timestamp) -> Step {
        let Some(now) = self.now else {
            return self.initialise(stamp);
        };
        let step_s = stamp.seconds_since(now);
        if (0.0..=MAX_STEP_S).contains(&step_s) && !self.is_early_or_back(stamp, step_s) {
            self.candidate = None;
            if step_s == 0.0 {
                return Step::Held;
            }
            self.advance(stamp);
            return Step::Advanced(stamp);
        }
        if (-RECEIVER_TOLERANCE_S..0.0).contains(&step_s) {
            return Step::Held;
        }
        let confirmed = self
            .candidate
            .replace(stamp)
            .is_some_and(|candidate| (0.0..=CONFIRM_S).contains(&stamp.seconds_since(candidate)));
        if !confirmed {
            return Step::Held;
        }
        self.candidate = None;
        if self.is_plausible_step(stamp, step_s) {
            return self.jump(stamp);
        }
        let passed_s = self.reference.map_or(0.0, |known| known.since_valid_s());
        let jump_s = step_s - passed_s;
        let needed_s = if jump_s.abs() < MAX_STEP_S {
            self.pace.lasted_s().clamp(MAX_STEP_S, ACCEPT_AFTER_S)
        } else {
            ACCEPT_AFTER_S
        };
        let unconfirmed = UnconfirmedJump {
            is_first: false,
            jump_s,
            last: stamp,
            lasted_s: 0.0,
            needed_s,
        };
        self.unconfirmed = Some(unconfirmed);
        self.resolve_jump(unconfirmed, stamp)
    }

    fn initialise(&mut self, stamp: Timestamp) -> Step {
        let known = match (self.checkpoint.take(), self.reference) {
            (Some(checkpoint), Some(reference)) => checkpoint.contradict(stamp, reference.now()),
            _ => None,
        };
        let Some(known) = known else {
            self.advance(stamp);
            return Step::Advanced(stamp);
        };
        self.now = Some(known);
        self.unconfirmed = Some(UnconfirmedJump {
            is_first: true,
            jump_s: stamp.seconds_since(known),
            last: stamp,
            lasted_s: 0.0,
            needed_s: ACCEPT_AFTER_S,
        });
        Step::Held
    }

    fn is_early_or_back(&self, stamp: Timestamp, step_s: f64) -> bool {
        self.reference
            .is_some_and(|reference| self.pace.is_jump(stamp, reference.heard_at, step_s))
    }

    /// Returns whether that much time may have passed since the clock was last confirmed.
    fn is_plausible_step(&self, stamp: Timestamp, step_s: f64) -> bool {
        let Some(reference) = self.reference else {
            return true;
        };
        if self.pace.is_proven() {
            return !self.pace.is_jump(stamp, reference.heard_at, step_s);
        }
        let passed_s = reference.since_valid_s();
        (step_s - passed_s).abs() <= MAX_STEP_S + QUARTZ_DRIFT * passed_s
    }

    /// Applies a stamp after an unconfirmed jump.
    fn resolve_jump(&mut self, mut unconfirmed: UnconfirmedJump, stamp: Timestamp) -> Step {
        let (Some(now), Some(reference)) = (self.now, self.reference) else {
            return self.jump(stamp);
        };
        let advanced_s = stamp.seconds_since(unconfirmed.last);
        if (0.0..=MAX_STEP_S).contains(&advanced_s) {
            unconfirmed.lasted_s += advanced_s;
        }
        unconfirmed.last = stamp;
        self.unconfirmed = Some(unconfirmed);
        let expected = now.plus_seconds(unconfirmed.lasted_s);
        let has_returned = if self.pace.is_proven() {
            self.pace.is_in_step(stamp, reference.heard_at)
        } else {
            stamp.seconds_since(expected).abs() <= MAX_STEP_S
        };
        if has_returned {
            return self.jump(stamp);
        }
        let reference_time = reference.now();
        let (new_s, old_s) = (
            stamp.seconds_since(reference_time).abs(),
            expected.seconds_since(reference_time).abs(),
        );
        // A clock that is off by as much as the jump does not decide.
        let nearer_s = new_s.min(old_s);
        let decides = nearer_s <= ARBITRATION_TOLERANCE_S && 2.0 * nearer_s < new_s.max(old_s);
        let is_accepted = if decides {
            new_s < old_s
        } else {
            unconfirmed.lasted_s >= unconfirmed.needed_s && !self.is_distrusted()
        };
        if is_accepted {
            return self.jump(stamp);
        }
        Step::Held
    }

    fn jump(&mut self, stamp: Timestamp) -> Step {
        self.unconfirmed = None;
        if !self
            .reference
            .is_some_and(|reference| self.pace.is_in_step(stamp, reference.heard_at))
        {
            self.pace = Pace::default();
        }
        self.advance(stamp);
        Step::Jumped(stamp)
    }

    fn advance(&mut self, stamp: Timestamp) {
        self.now = Some(stamp);
        if let Some(reference) = self.reference {
            self.pace.accept(stamp, reference.heard_at);
        }
    }
}

#[cfg(test)]
mod tests;
