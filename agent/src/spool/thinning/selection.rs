//! Selection of the samples to keep, by heading, time and length.

use binnacle_compass::angle::TrueHeading;
use binnacle_compass::sample::Sample;
use binnacle_wire::batch::Thinned;
use std::collections::BTreeMap;

const BIN_DEG: f64 = 10.0;

/// Sample quota per 10° sector and time window, per thinning level: seconds of the window, samples.
///
/// Six an hour cost the estimate nothing, two an hour some 5 % of its error (the study behind
/// docs/science.md). The last level leaves a vessel that is offline for years with a sample per
/// sector and day.
const LEVELS: [(i64, usize); 5] = [
    (3_600, 6),
    (3_600, 2),
    (3_600, 1),
    (6 * 3_600, 1),
    (24 * 3_600, 1),
];
/// Highest thinning level; 0 is a batch that was not thinned.
pub(super) const MAX_LEVEL: i64 = 5;

/// Splits samples into those to keep and the count of those to drop.
pub(super) fn thin(samples: Vec<Sample>, level: i64) -> (Vec<Sample>, Thinned) {
    let keep = select_rows(samples.iter(), level);
    let dropped = samples.iter().zip(&keep).filter(|(_, keep)| !**keep);
    let dropped = dropped.fold(Thinned::default(), |all, (sample, _)| {
        add(all, thinned_sample(sample))
    });
    let kept = samples.into_iter().zip(keep).filter(|(_, keep)| *keep);
    (kept.map(|(sample, _)| sample).collect(), dropped)
}

/// Selects the samples with the most windows per sector and time window, the earliest of equals.
pub(super) fn select_rows<'a>(samples: impl Iterator<Item = &'a Sample>, level: i64) -> Vec<bool> {
    let index = usize::try_from(level - 1).unwrap_or_default();
    let (seconds, most) = LEVELS[index.min(LEVELS.len() - 1)];
    let mut groups: BTreeMap<(i64, i64), Vec<(u16, usize)>> = BTreeMap::new();
    let mut rows = 0;
    for sample in samples {
        let reference = sample.gyro.or(sample.satellite);
        let heading_deg = reference.map_or(sample.compass.degrees(), TrueHeading::degrees);
        let time = sample.time.micros().div_euclid(seconds * 1_000_000);
        let bin = (heading_deg / BIN_DEG).floor() as i64;
        let group = groups.entry((time, bin)).or_default();
        group.push((sample.windows, rows));
        rows += 1;
    }
    let mut keep = vec![false; rows];
    for group in groups.values_mut() {
        group.sort_by_key(|(windows, row)| (std::cmp::Reverse(*windows), *row));
        for (_, row) in group.iter().take(most) {
            keep[*row] = true;
        }
    }
    keep
}

pub(super) fn thinned_sample(sample: &Sample) -> Thinned {
    Thinned {
        samples: 1,
        windows: u64::from(sample.windows),
    }
}

pub(in crate::spool) fn add(a: Thinned, b: Thinned) -> Thinned {
    Thinned {
        samples: a.samples.saturating_add(b.samples),
        windows: a.windows.saturating_add(b.windows),
    }
}
