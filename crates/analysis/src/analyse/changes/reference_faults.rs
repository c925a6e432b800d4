//! Faults of a reference that the other one showed.

use super::evidence::LASTED;
use crate::analyse::reading::{Reading, heading_reading};
use crate::observation::Observation;
use binnacle_compass::result::{Cause, CauseProbability, Change, Epoch};
use binnacle_compass::time::Timestamp;

/// So many readings with a dropped reference among as many and one more are a fault. Wild
/// readings come singly.
const FAULT_ROWS: usize = 3;
/// It is over when so many in a row are sound: in port nothing shows that it is.
const SOUND_ROWS: usize = 9;
const DAY_S: f64 = 86_400.0;
/// A card that jams again so soon was not free in between: a steady course hides it.
const JAMS_AGAIN_S: f64 = 3.0 * DAY_S;

/// What a reading tells of its references.
pub(super) struct Seen {
    time: Timestamp,
    /// True if both were read.
    both: bool,
    /// The gyro's share in what was believed; none where nothing was.
    gyro_share: Option<f64>,
}

impl Seen {
    /// None without a reference.
    pub(super) fn of(reading: &Reading, observation: Option<&Observation>) -> Option<Seen> {
        let read = heading_reading(reading)?;
        Some(Seen {
            time: reading.sample().time,
            both: read.gyro.is_some() && read.satellite.is_some(),
            gyro_share: observation.map(|o| o.gyro_share),
        })
    }
}

/// Stretches over which a reference was dropped.
pub(super) fn faults(all: &[Seen], changes: &mut Vec<Change>) {
    let mut dropped: Vec<(usize, Timestamp, &'static str)> = Vec::new();
    for (index, seen) in all.iter().enumerate() {
        let which = match seen.gyro_share {
            None => "neither could be shown to be right",
            Some(share) if seen.both && share < 0.01 => "the gyro had failed",
            Some(share) if seen.both && share > 0.99 => "the satellite compass had failed",
            Some(_) => continue,
        };
        dropped.push((index, seen.time, which));
    }
    let spells = dropped.chunk_by(|a, b| b.0 - a.0 <= SOUND_ROWS);
    for spell in spells.filter_map(since_it_was_dense) {
        let (first, last) = (&spell[0], &spell[spell.len() - 1]);
        let before = first.0.checked_sub(1).map(|i| all[i].time);
        let goes_on = last.0 + SOUND_ROWS >= all.len();
        changes.push(Change {
            from: first.1,
            from_earliest: before.unwrap_or(first.1),
            from_latest: first.1,
            detected_at: spell[FAULT_ROWS - 1].1,
            confirmed: true,
            withdrawn: false,
            cause: Cause::ReferenceFault,
            causes: vec![CauseProbability {
                cause: Cause::ReferenceFault,
                probability: 1.0,
            }],
            evidence: vec![format!(
                "gyro and satellite compass parted in {} samples; held against the magnetic \
                 compass, {}",
                spell.len(),
                first.2
            )],
            deviation_change_deg: None,
            step: None,
            ended: (!goes_on).then_some(last.1),
        });
    }
}

/// The spell from where readings were dropped in a row, if they ever were.
fn since_it_was_dense<T>(spell: &[(usize, Timestamp, T)]) -> Option<&[(usize, Timestamp, T)]> {
    let in_a_row = |those: &[(usize, Timestamp, T)]| {
        let between = those.last().map(|last| last.0 - those[0].0);
        between.is_some_and(|rows| rows <= FAULT_ROWS)
    };
    let first = spell.windows(FAULT_ROWS).position(in_a_row)?;
    Some(&spell[first..])
}

/// Puts faults of the references that follow closely on each other, or are found in two
/// ways, together; and those of the compass. `changes` are in order of time.
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
            take_in(earlier, change);
        } else {
            into = Some(kept.len());
            kept.push(change);
        }
    }
    *changes = kept;
}

/// Returns true if a fault began before an earlier one was over for long.
fn is_soon_after(later: &Change, earlier: &Change) -> bool {
    let long_s = match earlier.cause {
        Cause::CompassFault => JAMS_AGAIN_S,
        _ => DAY_S,
    };
    earlier
        .ended
        .is_none_or(|end| later.from.seconds_since(end) < long_s)
}

fn take_in(earlier: &mut Change, later: Change) {
    let began_together = later.from.seconds_since(earlier.from) < DAY_S;
    earlier.ended = match (earlier.ended, later.ended) {
        (Some(a), Some(b)) => Some(a.max(b)),
        // A reference's step has no end of its own; what it was part of may.
        (None, Some(end)) if earlier.cause == Cause::ReferenceFault && began_together => Some(end),
        (Some(end), None) if earlier.cause == Cause::ReferenceFault => Some(end),
        _ => None,
    };
    earlier.detected_at = earlier.detected_at.min(later.detected_at);
    // How long each part lasted is not how long the fault did.
    earlier.evidence.retain(|line| !line.starts_with(LASTED));
    for line in later.evidence {
        let is_told = earlier
            .evidence
            .iter()
            .any(|told| is_of_a_kind(told, &line));
        if !is_told && !line.starts_with(LASTED) {
            earlier.evidence.push(line);
        }
    }
}

/// Returns true if two lines say the same but for figures.
fn is_of_a_kind(a: &str, b: &str) -> bool {
    let words = |line: &str| line.replace(|c: char| c.is_ascii_digit(), "");
    words(a) == words(b)
}
