//! A compass that stands still while the ship turns: its card has jammed, or its
//! sensor repeats itself.
//!
//! What always holds: a reference that is wild now and then turns no ship; readings of a
//! steady course before the first turn are not held against the compass unless they are
//! the same to the last.

use super::SampleReason;
use super::reading::Reading;
use crate::angle::{TrueHeading, wrap_180};
use crate::change::{Cause, CauseProbability, Change};
use crate::sample::Sample;
use std::ops::Range;

/// Readings no further apart than this are the same. A sound compass wanders by more
/// between two means of ten minutes on a steady course.
const SAME_DEG: f64 = 0.15;
/// A jammed card trembles by less than this about where it stands; so does a sound one
/// on a steady course.
const TREMBLES_DEG: f64 = 1.0;
/// A card that has moved by more, or so often in a row, stands there no longer.
const JUMPS_DEG: f64 = 2.5;
const LEFT_READINGS: usize = 3;
/// What is a turn of the ship by her gyro or satellite compass, and how many show
/// that a compass that repeats itself does not follow. A reference that steps and comes
/// back makes two.
const TURN_DEG: f64 = 5.0;
const TURNS: usize = 3;
/// By how much more than from heading to heading a card is off that jammed in a turn.
const ASKEW_DEG: f64 = 15.0;
/// What a jammed card did not follow before such a turn.
const SLIGHT_TURN_DEG: f64 = 1.5;
/// Of a card that trembles, turns count between courses that were kept for so many
/// readings, by all references: wild ones come singly. No strike comes just at a turn and
/// undoes it, so that by two references one is enough. By one there must be more of them,
/// for it may be that which errs.
const COURSE_READINGS: usize = 3;
const TURNS_BY_BOTH: usize = 1;
const TURNS_BY_ONE: usize = 4;

/// Marks the readings of a stuck compass; tells each time that it stuck.
pub(super) fn mark_stuck(readings: &mut [Reading]) -> Vec<Change> {
    let mut changes = Vec::new();
    let mut from = 0;
    let mut look_from = 0;
    while from < readings.len() {
        let mut found = None;
        if from >= look_from {
            let stood = standing(&readings[from..]);
            found = trembling(readings, from..from + stood);
            // What holds for all of them holds for the later ones, too: so much is
            // looked at again that the work does not grow as the square.
            look_from = from + stood.div_ceil(2);
        }
        let same = from..from + same(&readings[from..]);
        let found = found.or_else(|| repeating(readings, same.clone()));
        from = same.end;
        if let Some(stuck) = found {
            changes.push(told(readings, &stuck));
            from = stuck.all.end.max(from);
            for reading in &mut readings[stuck.all] {
                let reason = &mut reading.diagnostic.reason;
                *reason = reason.or(Some(SampleReason::CompassStuck));
            }
        }
    }
    changes
}

/// Readings of a compass that did not follow the ship.
struct Stuck {
    all: Range<usize>,
    /// The reading that showed it.
    showed: usize,
    turns: usize,
    trembles: bool,
}

/// Those of a compass that reads the same, if the ship turned often.
fn repeating(readings: &[Reading], same: Range<usize>) -> Option<Stuck> {
    let turns = || turns(&readings[same.clone()]);
    let showed = same.start + turns().nth(TURNS - 1)?;
    Some(Stuck {
        showed,
        turns: turns().count(),
        trembles: false,
        all: same,
    })
}

/// How many readings from the first on are the same.
fn same(readings: &[Reading]) -> usize {
    let off = |reading: &Reading| apart_deg(&readings[0], reading);
    readings
        .iter()
        .position(|reading| off(reading) > SAME_DEG)
        .unwrap_or(readings.len())
}

fn apart_deg(a: &Reading, b: &Reading) -> f64 {
    wrap_180(b.sample().compass.degrees() - a.sample().compass.degrees()).abs()
}

/// Those of a compass that trembles about one heading, if the ship kept to several.
fn trembling(readings: &[Reading], stands: Range<usize>) -> Option<Stuck> {
    let stood = &readings[stands.clone()];
    let courses = courses(stood);
    let by_both = stood.iter().filter(|reading| {
        let sample = reading.sample();
        sample.gyro.is_some() && sample.satellite.is_some()
    });
    let enough = if 2 * by_both.count() > stood.len() {
        TURNS_BY_BOTH
    } else {
        TURNS_BY_ONE
    };
    let showed = stands.start + courses.get(enough)? + COURSE_READINGS - 1;
    // On the first course it may have been sound.
    let mut first = stands.start + courses[1];
    let (course, turned) = (&stood[courses[0]], first);
    let is_stuck = |k: usize| {
        has_parted(SLIGHT_TURN_DEG, course, &readings[k])
            || apart_deg(&readings[turned], &readings[k]) < SAME_DEG
    };
    let before = (stands.start..first).rev().take_while(|&k| is_stuck(k));
    first = before.last().unwrap_or(first);
    let sound = stands.start.checked_sub(1).map(|k| &readings[k]);
    if sound.is_some_and(|sound| has_parted(ASKEW_DEG, sound, course)) {
        first = stands.start;
    }
    // Readings from before it jammed have no part in where it stands.
    let end = stands.end.max(first + standing(&readings[first..]));
    let kept = self::courses(&readings[first..end]).len();
    Some(Stuck {
        all: first..end,
        showed,
        turns: kept.max(courses.len() - 1),
        trembles: (first..end).any(|k| apart_deg(&readings[first], &readings[k]) > SAME_DEG),
    })
}

/// How many readings from the first on stay about their mean.
fn standing(readings: &[Reading]) -> usize {
    let first = readings[0].sample().compass.degrees();
    let mut sum = 0.0;
    // Where those began that have left it by now.
    let mut left = None;
    for (count, reading) in readings.iter().enumerate().skip(1) {
        let off = wrap_180(reading.sample().compass.degrees() - first);
        let from_mean = (off - sum / count as f64).abs();
        if from_mean > TREMBLES_DEG {
            let since = *left.get_or_insert(count);
            if from_mean > JUMPS_DEG || count + 1 - since >= LEFT_READINGS {
                return since;
            }
        } else {
            left = None;
        }
        sum += off;
    }
    left.unwrap_or(readings.len())
}

/// The first readings of the courses that the ship kept to, each another than the last.
fn courses(readings: &[Reading]) -> Vec<usize> {
    let mut begun: Vec<usize> = Vec::new();
    let mut since = 0;
    for k in 1..readings.len() {
        if has_turned(&readings[since], &readings[k]) {
            since = k;
        }
        let is_kept = k + 1 == since + COURSE_READINGS;
        let last = begun.last();
        if is_kept && last.is_none_or(|&last| has_turned(&readings[last], &readings[since])) {
            begun.push(since);
        }
    }
    begun
}

/// Whether every reference that was read both times says that the ship turned, and one
/// was.
fn has_turned(a: &Reading, b: &Reading) -> bool {
    let turned = |of: fn(&Sample) -> Option<TrueHeading>| {
        let (a, b) = of(a.sample()).zip(of(b.sample()))?;
        Some(wrap_180(b.degrees() - a.degrees()).abs() > TURN_DEG)
    };
    match (turned(|s| s.gyro), turned(|s| s.satellite)) {
        (Some(gyro), Some(satellite)) => gyro && satellite,
        (one, other) => one.or(other) == Some(true),
    }
}

/// Whether the compass has left its reference by more in between.
fn has_parted(degrees: f64, a: &Reading, b: &Reading) -> bool {
    let off = |reading: &Reading| {
        let sample = reading.sample();
        let reference = sample.satellite.or(sample.gyro)?.degrees();
        Some(reference - sample.compass.degrees())
    };
    let parted = off(a).zip(off(b)).map(|(a, b)| wrap_180(b - a));
    parted.is_some_and(|parted| parted.abs() > degrees)
}

/// The later reading of each pair between which the ship turned.
fn turns(readings: &[Reading]) -> impl Iterator<Item = usize> {
    let turned = |a: Option<TrueHeading>, b: Option<TrueHeading>| {
        let turn = a.zip(b).map(|(a, b)| wrap_180(b.degrees() - a.degrees()));
        turn.is_some_and(|turn| turn.abs() > TURN_DEG)
    };
    let pairs = readings.windows(2).enumerate();
    pairs.filter_map(move |(k, pair)| {
        let (a, b) = (pair[0].sample(), pair[1].sample());
        let any = turned(a.gyro, b.gyro) || turned(a.satellite, b.satellite);
        any.then_some(k + 1)
    })
}

fn told(readings: &[Reading], found: &Stuck) -> Change {
    let stuck = &found.all;
    let from = readings[stuck.start].sample().time;
    let last = readings[stuck.end - 1].sample().time;
    let before = stuck
        .start
        .checked_sub(1)
        .map(|i| readings[i].sample().time);
    let heading = readings[stuck.start].sample().compass.degrees();
    Change {
        from,
        from_earliest: before.unwrap_or(from),
        from_latest: from,
        detected_at: readings[found.showed].sample().time,
        confirmed: true,
        withdrawn: false,
        cause: Cause::CompassFault,
        causes: vec![CauseProbability {
            cause: Cause::CompassFault,
            probability: 1.0,
        }],
        evidence: vec![format!(
            "the compass {} {heading:.1} degrees in {} samples in a row while the ship turned {} \
             times by gyro or satellite compass",
            if found.trembles {
                "trembled about"
            } else {
                "read"
            },
            stuck.len(),
            found.turns
        )],
        deviation_change_deg: None,
        step: None,
        ended: (stuck.end < readings.len()).then_some(last),
    }
}
