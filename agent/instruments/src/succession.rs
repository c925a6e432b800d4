//! Succession of headings: what stands in for a better source that is silent.
//!
//! A repeater goes on saying the last heading when its compass has died, or runs into it when it
//! smooths. An instrument on a ship goes to and fro, and serves once it has.

use binnacle_compass::angle::wrap_180;
use binnacle_observation::Source;
use std::time::Duration;
use tokio::time::Instant;

/// Smallest change that counts, degrees: half a digit of an ordinary heading.
const LEAST_DEG: f64 = 0.05;
/// Changes of direction. The filter of a repeater may overshoot and come back, which is one.
const TURNS: u32 = 2;
/// Limit on sources that are watched.
const MAX_SOURCES: usize = 16;
/// Silence after which a source is watched no more.
const FORGOTTEN_AFTER: Duration = Duration::from_mins(1);

/// Sources that would stand in for better ones, with their motion since those fell silent.
#[derive(Debug, Default)]
pub(super) struct Succession {
    sources: Vec<Successor>,
}

#[derive(Debug)]
struct Successor {
    source: Source,
    heard: Instant,
    motion: OwnMotion,
}

impl Succession {
    /// Records that a better source than this one is alive.
    pub(super) fn note_better(&mut self, source: &Source) {
        self.sources.retain(|known| known.source != *source);
    }

    /// Applies a heading in degrees that no better source gives. Returns whether its source has
    /// moved by itself since there is none.
    pub(super) fn has_moved(&mut self, source: &Source, heading_deg: f64, now: Instant) -> bool {
        self.sources
            .retain(|known| known.source == *source || known.is_heard(now));
        let place = self
            .sources
            .iter()
            .position(|known| known.source == *source);
        let place = place.unwrap_or(self.sources.len());
        if place == MAX_SOURCES {
            return false;
        }
        if place == self.sources.len() {
            self.sources.push(Successor {
                source: source.clone(),
                heard: now,
                motion: OwnMotion::default(),
            });
        }
        let successor = &mut self.sources[place];
        successor.heard = now;
        successor.motion.observe(heading_deg);
        successor.motion.is_shown()
    }

    /// Returns the sources that have not moved by themselves.
    pub(super) fn still(&self, now: Instant) -> impl Iterator<Item = &Source> {
        let still = self.sources.iter();
        let still = still.filter(move |known| known.is_heard(now) && !known.motion.is_shown());
        still.map(|known| &known.source)
    }
}

impl Successor {
    fn is_heard(&self, now: Instant) -> bool {
        now.saturating_duration_since(self.heard) <= FORGOTTEN_AFTER
    }
}

/// Changes of a heading to and fro.
#[derive(Debug, Default)]
struct OwnMotion {
    last_deg: Option<f64>,
    is_to_starboard: Option<bool>,
    turns: u32,
}

impl OwnMotion {
    fn observe(&mut self, heading_deg: f64) {
        let change_deg = wrap_180(heading_deg - self.last_deg.unwrap_or(heading_deg));
        if self.last_deg.is_some() && change_deg.abs() < LEAST_DEG {
            return;
        }
        if self.last_deg.replace(heading_deg).is_none() {
            return;
        }
        let before = self.is_to_starboard.replace(change_deg > 0.0);
        if before.is_some_and(|before| before != (change_deg > 0.0)) {
            self.turns = self.turns.saturating_add(1);
        }
    }

    fn is_shown(&self) -> bool {
        self.turns >= TURNS
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    fn has_moved(headings: impl IntoIterator<Item = f64>) -> bool {
        let mut motion = OwnMotion::default();
        for heading in headings {
            motion.observe(heading);
        }
        motion.is_shown()
    }

    #[test]
    fn an_instrument_goes_to_and_fro_across_north_in_whole_degrees_and_in_a_turn() {
        assert!(has_moved([359.9, 0.0, 359.9, 0.1]));
        assert!(has_moved([90.0, 91.0, 91.0, 90.0, 90.0, 91.0]));
        assert!(has_moved(
            (0..200).map(|t| f64::from(t) + 4.0 * (f64::from(t) / 2.0).sin())
        ));
    }

    #[test]
    fn a_repeater_of_a_dead_compass_stands_still_or_runs_into_the_last_heading() {
        let settling = |swing: f64| {
            (0..200).map(move |t| {
                let t = f64::from(t) / 20.0;
                90.0 + 8.0 * (-t).exp() * (1.0 - swing * t)
            })
        };
        assert!(!has_moved([90.0; 200]));
        assert!(!has_moved(settling(0.0)));
        assert!(!has_moved(settling(2.0)));
        assert!(!has_moved((0..200).map(|t| 90.0 + 1e-9 * f64::from(t % 2))));
    }

    #[test]
    fn its_motion_counts_from_the_last_reading_of_the_better_source() {
        let source = Source::of_sentence("a".into(), *b"II", *b"HDG");
        let now = Instant::now();
        let mut succession = Succession::default();
        let moves = [90.0, 91.0, 90.0, 91.0];
        let moved = moves.map(|deg| succession.has_moved(&source, deg, now));
        assert_eq!(moved, [false, false, false, true]);
        succession.note_better(&source);
        assert!(!succession.has_moved(&source, 90.0, now));
        assert_eq!(succession.still(now).collect::<Vec<_>>(), [&source]);
        let later = now + FORGOTTEN_AFTER + Duration::from_secs(1);
        assert_eq!(succession.still(later).count(), 0);
    }
}
