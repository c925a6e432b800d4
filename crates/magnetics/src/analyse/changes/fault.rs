//! Faults of a reference that the other one showed.

use super::Found;
use crate::analyse::reading::{Reading, heading_reading};
use crate::change::{Cause, CauseProbability, Change};
use crate::fit::Observation;
use crate::time::Timestamp;

/// So many readings with a dropped reference among as many and one more are a fault. Wild
/// readings come singly.
const FAULT_ROWS: usize = 3;
/// It is over when so many in a row are sound: in port nothing shows that it is.
const SOUND_ROWS: usize = 9;
const DAY_S: f64 = 86_400.0;

/// What a reading tells of its references.
pub(super) struct Seen {
    time: Timestamp,
    /// Whether both were read.
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
/// ways, together; and those of the compass.
pub(super) fn merge_faults(found: &mut Found) {
    merge(found, Cause::ReferenceFault);
    merge(found, Cause::CompassFault);
}

fn merge(found: &mut Found, cause: Cause) {
    let mut order: Vec<usize> = (0..found.changes.len())
        .filter(|&i| found.changes[i].cause == cause)
        .filter(|&i| found.boundaries.iter().all(|b| b.change != i))
        .collect();
    order.sort_by_key(|&i| found.changes[i].from);
    let mut into: Option<usize> = None;
    let mut gone = Vec::new();
    for i in order {
        let (from, ended) = (found.changes[i].from, found.changes[i].ended);
        let earlier = into.map(|into| &mut found.changes[into]);
        match earlier {
            Some(earlier)
                if earlier
                    .ended
                    .is_none_or(|end| from.seconds_since(end) < DAY_S) =>
            {
                earlier.ended = match (earlier.ended, ended) {
                    (Some(a), Some(b)) => Some(a.max(b)),
                    // A reference's step has no end of its own; what it was part of may.
                    (one, other) if cause == Cause::ReferenceFault => one.or(other),
                    _ => None,
                };
                let detected_at = found.changes[i].detected_at;
                let told = found.changes[i].evidence.clone();
                if let Some(earlier) = into.map(|into| &mut found.changes[into]) {
                    earlier.detected_at = earlier.detected_at.min(detected_at);
                    for line in told {
                        if !earlier.evidence.contains(&line) {
                            earlier.evidence.push(line);
                        }
                    }
                }
                gone.push(i);
            }
            _ => into = Some(i),
        }
    }
    gone.sort_unstable();
    for i in gone.into_iter().rev() {
        found.changes.remove(i);
        for boundary in &mut found.boundaries {
            if boundary.change > i {
                boundary.change -= 1;
            }
        }
        if let Some(ended) = found.perhaps.as_mut().filter(|ended| ended.change > i) {
            ended.change -= 1;
        }
    }
}
