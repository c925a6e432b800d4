//! Rows far from the others in time: a wrong date, or a vessel not sampled for long.

use crate::observation::Observation;
use binnacle_compass::model::Caution;
use binnacle_compass::time::Timestamp;
use serde::{Deserialize, Serialize};

/// Time without a sample after which the vessel may be another.
const LONG_S: f64 = 365.0 * 86_400.0;
/// Number of rows before such a time below which they say nothing of the vessel after it,
/// and the ratio of the others to them from which a clock was wrong.
const FEW: usize = 12;
const OUTNUMBERED: usize = 10;

/// Leaves out the few rows long before all others.
pub(super) fn leave_out_early(observations: &[Observation], usable: &mut Vec<usize>) {
    let Some(times) = in_order(usable.iter().map(|&i| &observations[i])) else {
        return;
    };
    let most = (times.len() / (OUTNUMBERED + 1)).min(FEW - 1);
    let is_gap = |pair: &[Timestamp]| pair[1].seconds_since(pair[0]) > LONG_S;
    let Some(last) = times.windows(2).take(most).rposition(is_gap) else {
        return;
    };
    let begin = times[last + 1];
    usable.retain(|&i| observations[i].time.is_none_or(|time| time >= begin));
}

/// Last long time without a row, among rows in order of time.
#[derive(Clone, Copy, Debug, Default, PartialEq, Serialize, Deserialize)]
pub struct Gaps {
    ends: Option<(Timestamp, Timestamp)>,
    long_s: Option<f64>,
}

impl Gaps {
    /// Adds the next row.
    pub fn add(&mut self, time: Timestamp) {
        self.append(&Gaps {
            ends: Some((time, time)),
            long_s: None,
        });
    }

    /// Adds later rows.
    pub fn append(&mut self, later: &Gaps) {
        let Some((begin, end)) = later.ends else {
            return;
        };
        let (first, last) = self.ends.unwrap_or((begin, begin));
        let between_s = Some(begin.seconds_since(last)).filter(|gap| *gap > LONG_S);
        self.long_s = later.long_s.or(between_s).or(self.long_s);
        self.ends = Some((first, end));
    }

    /// Returns a caution for the last long time without a row.
    pub fn caution(&self) -> Option<Caution> {
        let (_, last) = self.ends?;
        Some(Caution::LongGap {
            days: self.long_s? / 86_400.0,
            last,
        })
    }
}

/// Returns a caution for the last long time without a row.
pub(super) fn long_gap(rows: &[Observation]) -> Option<Caution> {
    let mut gaps = Gaps::default();
    for time in in_order(rows.iter())? {
        gaps.add(time);
    }
    gaps.caution()
}

/// Returns the times in order; none where any is missing.
fn in_order<'a>(rows: impl Iterator<Item = &'a Observation>) -> Option<Vec<Timestamp>> {
    let mut times: Vec<Timestamp> = rows.map(|o| o.time).collect::<Option<_>>()?;
    times.sort_unstable();
    Some(times)
}
