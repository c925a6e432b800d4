//! A compass that stands still while the ship turns: its card has jammed, or its
//! sensor repeats itself.

use super::SampleReason;
use super::reading::Reading;
use crate::angle::{TrueHeading, wrap_180};
use crate::change::{Cause, CauseProbability, Change};
use std::ops::Range;

/// Readings no further apart than this are the same. A sound compass wanders by more
/// between two means of ten minutes on a steady course.
const SAME_DEG: f64 = 0.15;
/// What is a turn of the ship by her gyro or satellite compass, and how many show
/// that the compass does not follow. A reference that steps and comes back makes two.
const TURN_DEG: f64 = 5.0;
const TURNS: usize = 3;

/// Marks the readings of a stuck compass; tells each time that it stuck.
pub(super) fn mark_stuck(readings: &mut [Reading]) -> Vec<Change> {
    let mut changes = Vec::new();
    let mut from = 0;
    while from < readings.len() {
        let to = from + same(&readings[from..]);
        let showed = turns(&readings[from..to]).nth(TURNS - 1);
        if let Some(showed) = showed {
            changes.push(told(readings, from..to, from + showed));
            for reading in &mut readings[from..to] {
                let reason = &mut reading.diagnostic.reason;
                *reason = reason.or(Some(SampleReason::CompassStuck));
            }
        }
        from = to;
    }
    changes
}

/// How many readings from the first on are the same.
fn same(readings: &[Reading]) -> usize {
    let first = readings[0].sample().compass.degrees();
    let off = |reading: &Reading| wrap_180(reading.sample().compass.degrees() - first).abs();
    readings
        .iter()
        .position(|reading| off(reading) > SAME_DEG)
        .unwrap_or(readings.len())
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

fn told(readings: &[Reading], stuck: Range<usize>, showed: usize) -> Change {
    let from = readings[stuck.start].sample().time;
    let last = readings[stuck.end - 1].sample().time;
    let before = stuck
        .start
        .checked_sub(1)
        .map(|i| readings[i].sample().time);
    let heading = readings[stuck.start].sample().compass.degrees();
    let turns = turns(&readings[stuck.clone()]).count();
    Change {
        from,
        from_earliest: before.unwrap_or(from),
        from_latest: from,
        detected_at: readings[showed].sample().time,
        confirmed: true,
        cause: Cause::CompassFault,
        causes: vec![CauseProbability {
            cause: Cause::CompassFault,
            probability: 1.0,
        }],
        evidence: vec![format!(
            "the compass read {heading:.1} degrees in {} samples in a row while the ship turned {turns} \
             times by gyro or satellite compass",
            stuck.len()
        )],
        deviation_change_deg: None,
        step: None,
        ended: (stuck.end < readings.len()).then_some(last),
    }
}
