//! Settled samples of a raw recording: means over steady windows of a minute or more.
//!
//! The agent does this on board, with more care (swing, rate of turn, plausible instruments).
//! This is enough to try a recording that has one row a second.

use super::ten_seconds::{TenSeconds, mean_sample, ten_seconds};
use binnacle_compass::angle::wrap_180;
use binnacle_compass::sample::Sample;
use serde::Serialize;

/// Median interval of rows up to which a recording is raw, seconds.
const RAW_INTERVAL_S: f64 = 30.0;
/// Windows into which a recording is cut, and their length in tens of seconds: one minute at
/// least, ten at most, as the agent's samples.
const WANTED_WINDOWS: i64 = 120;
const SHORTEST: i64 = 6;
const LONGEST: i64 = 60;
/// Change of heading within a window, degrees.
const STEADY_DEG: f64 = 5.0;
/// Change of heading since a minute before the window, degrees: the bowl's liquid comes to rest.
const TURN_DEG: f64 = 10.0;
const REST: i64 = 6;
/// Speed below which a vessel is at rest, knots: quay steel, and no course over ground.
const AT_REST_KN: f64 = 1.0;

/// Settled samples of a recording, and windows that gave none.
#[derive(Clone, Debug, Default, PartialEq, Serialize)]
pub struct Settled {
    /// Rows of the recording.
    pub rows: u64,
    /// Length of a window, seconds; none where the rows are settled samples already.
    pub window_s: Option<u32>,
    /// Windows that became samples.
    pub windows_settled: u64,
    /// Windows left out: turning, or within a minute of a turn or of the beginning.
    pub windows_turning: u64,
    /// Windows left out: at rest.
    pub windows_at_rest: u64,
    /// Windows left out: headings in less than half of their tens of seconds.
    pub windows_sparse: u64,
    /// Settled samples, in order of time.
    #[serde(skip)]
    pub samples: Vec<Sample>,
}

/// Settles the rows of a recording, in any order. Rows that are further apart than half a
/// minute count as settled samples and stay as they are.
pub fn settle(rows: &[Sample]) -> Settled {
    let mut rows = rows.to_vec();
    rows.sort_by_key(|row| row.time);
    let count = rows.len() as u64;
    if !is_raw(&rows) {
        return Settled {
            rows: count,
            samples: rows,
            ..Settled::default()
        };
    }
    let tens = ten_seconds(&rows);
    let (Some(first), Some(last)) = (tens.first(), tens.last()) else {
        return Settled::default();
    };
    let length = ((last.index - first.index + 1) / WANTED_WINDOWS).clamp(SHORTEST, LONGEST);
    let mut settled = Settled {
        rows: count,
        window_s: Some(length as u32 * 10),
        ..Settled::default()
    };
    let mut begin = 0;
    while begin < tens.len() {
        let window = tens[begin].index.div_euclid(length);
        let end = begin + tens[begin..].partition_point(|t| t.index.div_euclid(length) == window);
        settled.add(&tens[..begin], &tens[begin..end], length);
        begin = end;
    }
    settled
}

fn is_raw(rows: &[Sample]) -> bool {
    let mut intervals: Vec<f64> = rows
        .windows(2)
        .map(|pair| pair[1].time.seconds_since(pair[0].time))
        .collect();
    intervals.sort_by(f64::total_cmp);
    let middle = intervals.get(intervals.len() / 2);
    middle.is_some_and(|seconds| *seconds <= RAW_INTERVAL_S)
}

impl Settled {
    fn add(&mut self, before: &[TenSeconds], window: &[TenSeconds], length: i64) {
        let compared: Vec<&TenSeconds> = window.iter().filter(|t| t.has_reference()).collect();
        if (compared.len() as i64) * 2 < length {
            self.windows_sparse += 1;
        } else if compared
            .iter()
            .all(|t| t.sog_kn.is_some_and(|kn| kn < AT_REST_KN))
        {
            self.windows_at_rest += 1;
        } else if !is_steady(before, window) {
            self.windows_turning += 1;
        } else if let Some(sample) = mean_sample(&compared) {
            self.windows_settled += 1;
            self.samples.push(sample);
        }
    }
}

/// Returns true if the heading is steady in a window and in the minute before.
fn is_steady(before: &[TenSeconds], window: &[TenSeconds]) -> bool {
    let first = &window[0];
    let turned = |t: &TenSeconds| wrap_180(t.steadiest_deg() - first.steadiest_deg()).abs();
    let rest = before.iter().rev();
    let rest = rest.take_while(|t| first.index - t.index <= REST);
    let rest: Vec<f64> = rest.map(turned).collect();
    rest.len() as i64 * 2 >= REST
        && rest.iter().all(|deg| *deg <= TURN_DEG)
        && window.iter().all(|t| turned(t) <= STEADY_DEG)
}

#[cfg(test)]
mod tests {
    use super::*;
    use binnacle_compass::angle::{CompassHeading, TrueHeading};
    use binnacle_compass::position::Position;
    use binnacle_compass::time::Timestamp;

    /// Returns a row a second: the true heading of each, with a compass that reads 3° less.
    fn recording(headings: &[f64]) -> Vec<Sample> {
        let start = Timestamp::parse("2026-01-01T00:00:00Z").unwrap();
        let position = Position::new(43.0, -3.0).unwrap();
        let row = |(k, deg): (usize, &f64)| Sample {
            satellite: TrueHeading::new(*deg),
            sog_kn: Some(8.0),
            ..Sample::new(
                start.plus_seconds(k as f64),
                position,
                CompassHeading::new(deg - 3.0).unwrap(),
            )
        };
        headings.iter().enumerate().map(row).collect()
    }

    #[test]
    fn minutes_on_one_heading_become_samples_and_a_turn_does_not() {
        let mut headings = vec![359.0; 300];
        headings.extend((0..60).map(|k| 359.0 + f64::from(k)));
        headings.extend([59.0; 300]);
        let settled = settle(&recording(&headings));
        assert_eq!(settled.window_s, Some(60));
        // Five minutes on each heading; the first of each is the minute of rest.
        assert_eq!(settled.windows_settled, 8, "{settled:?}");
        assert_eq!(settled.windows_turning, 3);
        for sample in &settled.samples {
            let off = sample.satellite.unwrap().degrees() - sample.compass.degrees();
            assert!((wrap_180(off) - 3.0).abs() < 1e-9);
            assert_eq!(sample.windows, 6);
        }
    }

    #[test]
    fn rows_ten_minutes_apart_stay_as_they_are() {
        let mut rows = recording(&[10.0; 20]);
        for (k, row) in rows.iter_mut().enumerate() {
            row.time = row.time.plus_seconds(600.0 * k as f64);
        }
        let settled = settle(&rows);
        assert_eq!(settled.window_s, None);
        assert_eq!(settled.samples, rows);
    }

    #[test]
    fn a_vessel_at_rest_gives_no_samples() {
        let mut rows = recording(&[10.0; 600]);
        for row in &mut rows {
            row.sog_kn = Some(0.2);
        }
        let settled = settle(&rows);
        assert_eq!((settled.windows_settled, settled.windows_at_rest), (0, 10));
    }

    #[test]
    fn rows_without_a_reference_are_counted_as_sparse() {
        let mut rows = recording(&[10.0; 600]);
        for row in &mut rows {
            row.satellite = None;
        }
        let settled = settle(&rows);
        assert_eq!((settled.windows_settled, settled.windows_sparse), (0, 10));
    }

    #[test]
    fn nothing_and_one_row_are_no_panic() {
        assert_eq!(settle(&[]).samples.len(), 0);
        assert_eq!(settle(&recording(&[10.0])).samples.len(), 1);
    }
}
