//! Faults of a reference that the other one showed.

use super::evidence::LASTED;
use crate::analyse::reading::{Reading, heading_reading};
use crate::observation::Observation;
use binnacle_compass::result::{Cause, CauseProbability, Change, Epoch};
use binnacle_compass::time::Timestamp;

/// Readings with a dropped reference, among as many and one more, that make a fault. Wild
/// readings come singly.
const FAULT_ROWS: usize = 3;
/// Sound readings in a row that end a fault: in port nothing shows its end.
const SOUND_ROWS: usize = 9;
const DAY_S: f64 = 86_400.0;
/// Time within which a card that jams again was not free in between: a steady course hides
/// it.
const JAMS_AGAIN_S: f64 = 3.0 * DAY_S;

/// Use of the references of a reading.
pub(super) struct ReferenceUse {
    time: Timestamp,
    /// True if both were read.
    both: bool,
    /// Share of the gyro in the reference heading; none where neither was trusted.
    gyro_share: Option<f64>,
}

impl ReferenceUse {
    /// Returns the use of a reading's references; none without a reference.
    pub(super) fn from_reading(
        reading: &Reading,
        observation: Option<&Observation>,
    ) -> Option<ReferenceUse> {
        let read = heading_reading(reading)?;
        Some(ReferenceUse {
            time: reading.sample().time,
            both: read.gyro.is_some() && read.satellite.is_some(),
            gyro_share: observation.map(|o| o.gyro_share),
        })
    }
}

/// Reading of which a reference was dropped.
struct DroppedReading {
    /// Index among all readings.
    index: usize,
    time: Timestamp,
    /// Verdict of the magnetic compass on the references.
    verdict: &'static str,
}

/// Adds the stretches over which a reference was dropped.
pub(super) fn dropped_references(all: &[ReferenceUse], changes: &mut Vec<Change>) {
    let mut dropped: Vec<DroppedReading> = Vec::new();
    for (index, use_of) in all.iter().enumerate() {
        let verdict = match use_of.gyro_share {
            None => "neither can be confirmed",
            Some(share) if use_of.both && share < 0.01 => "the gyro had failed",
            Some(share) if use_of.both && share > 0.99 => "the satellite compass had failed",
            Some(_) => continue,
        };
        dropped.push(DroppedReading {
            index,
            time: use_of.time,
            verdict,
        });
    }
    let spells = dropped.chunk_by(|a, b| b.index - a.index <= SOUND_ROWS);
    for spell in spells.filter_map(tail_from_first_dropped_run) {
        let (first, last) = (&spell[0], &spell[spell.len() - 1]);
        let before = first.index.checked_sub(1).map(|i| all[i].time);
        let goes_on = last.index + SOUND_ROWS >= all.len();
        changes.push(Change {
            from: first.time,
            from_earliest: before.unwrap_or(first.time),
            from_latest: first.time,
            detected_at: spell[FAULT_ROWS - 1].time,
            confirmed: true,
            withdrawn: false,
            cause: Cause::ReferenceFault,
            causes: vec![CauseProbability {
                cause: Cause::ReferenceFault,
                probability: 1.0,
            }],
            evidence: vec![format!(
                "gyro and satellite compass differed in {} samples; by the magnetic compass, {}",
                spell.len(),
                first.verdict
            )],
            deviation_change_deg: None,
            step: None,
            ended: (!goes_on).then_some(last.time),
        });
    }
}

/// Returns the spell from the first readings dropped in a row.
fn tail_from_first_dropped_run(spell: &[DroppedReading]) -> Option<&[DroppedReading]> {
    let in_a_row = |those: &[DroppedReading]| {
        let between = those.last().map(|last| last.index - those[0].index);
        between.is_some_and(|rows| rows <= FAULT_ROWS)
    };
    let first = spell.windows(FAULT_ROWS).position(in_a_row)?;
    Some(&spell[first..])
}

/// Merges faults of the references that follow closely, or were found in two ways, and
/// likewise those of the compass. `changes` are in order of time.
pub(crate) fn merge_faults(changes: &mut Vec<Change>, epochs: &[Epoch]) {
    merge(changes, epochs, Cause::ReferenceFault);
    merge(changes, epochs, Cause::CompassFault);
}

fn merge(changes: &mut Vec<Change>, epochs: &[Epoch], cause: Cause) {
    let mut kept: Vec<Change> = Vec::with_capacity(changes.len());
    let mut into: Option<usize> = None;
    for change in changes.drain(..) {
        let begins_epoch = epochs.iter().any(|epoch| epoch.from == Some(change.from));
        if change.cause != cause || begins_epoch {
            kept.push(change);
            continue;
        }
        let earlier = into.map(|into| &mut kept[into]);
        if let Some(earlier) = earlier.filter(|earlier| is_soon_after(&change, earlier)) {
            merge_into(earlier, change);
        } else {
            into = Some(kept.len());
            kept.push(change);
        }
    }
    *changes = kept;
}

/// Returns true if a fault began soon after the end of an earlier one.
fn is_soon_after(later: &Change, earlier: &Change) -> bool {
    let long_s = match earlier.cause {
        Cause::CompassFault => JAMS_AGAIN_S,
        _ => DAY_S,
    };
    earlier
        .ended
        .is_none_or(|end| later.from.seconds_since(end) < long_s)
}

fn merge_into(earlier: &mut Change, later: Change) {
    let began_together = later.from.seconds_since(earlier.from) < DAY_S;
    earlier.ended = match (earlier.ended, later.ended) {
        (Some(a), Some(b)) => Some(a.max(b)),
        // A reference's step has no end of its own, but its fault may.
        (None, Some(end)) if earlier.cause == Cause::ReferenceFault && began_together => Some(end),
        (Some(end), None) if earlier.cause == Cause::ReferenceFault => Some(end),
        _ => None,
    };
    earlier.detected_at = earlier.detected_at.min(later.detected_at);
    // The duration of each part is not that of the fault.
    earlier.evidence.retain(|line| !line.starts_with(LASTED));
    for line in later.evidence {
        let is_present = earlier
            .evidence
            .iter()
            .any(|line_before| differs_in_figures_only(line_before, &line));
        if !is_present && !line.starts_with(LASTED) {
            earlier.evidence.push(line);
        }
    }
}

/// Returns true if two lines differ in figures only.
fn differs_in_figures_only(a: &str, b: &str) -> bool {
    let words = |line: &str| line.replace(|c: char| c.is_ascii_digit(), "");
    words(a) == words(b)
}
