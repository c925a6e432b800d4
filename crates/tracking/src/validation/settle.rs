//! Settled samples of a raw recording: means over steady stretches of a minute or more.
//!
//! The agent does this on board, with more care (swing, rate of turn, plausible instruments).
//! This is enough to try a recording that has one row a second.

use super::ten_seconds::{TenSeconds, mean_sample, ten_seconds};
use binnacle_compass::model::ReferenceGrade;
use binnacle_compass::sample::Sample;
use serde::Serialize;

/// Median interval of rows up to which a recording is raw, seconds.
const RAW_INTERVAL_S: f64 = 30.0;
/// Samples into which a recording is cut where it can be, and their length in tens of seconds:
/// one minute at least, ten at most, as the agent's.
const WANTED_SAMPLES: usize = 120;
const SHORTEST: usize = 6;
const LONGEST: usize = 60;
/// Change of heading within a sample, degrees.
const STEADY_DEG: f64 = 7.5;
/// Change of heading in the minute before a sample, degrees, and that minute in tens of seconds:
/// the bowl's liquid comes to rest.
const TURN_DEG: f64 = 10.0;
const REST: i64 = 6;
/// Tens of seconds with readings that are enough of that minute.
const ENOUGH_REST: usize = 3;
/// Tens of seconds without a reading that end a sample.
const GAP: i64 = 3;
/// Speed below which a vessel is at rest, knots: quay steel, and no course over ground.
const AT_REST_KN: f64 = 1.0;

/// Settled samples of a recording, and the time that gave none.
#[derive(Clone, Debug, Default, PartialEq, Serialize)]
pub struct Settled {
    /// Rows of the recording.
    pub rows: u64,
    /// Greatest length of a sample, seconds; none where the rows are settled samples already.
    pub sample_s: Option<u32>,
    /// Minutes of the recording with readings.
    pub minutes: f64,
    /// Minutes that became samples.
    pub minutes_settled: f64,
    /// Minutes at rest.
    pub minutes_at_rest: f64,
    /// Minutes without a reference heading, and without a course over ground where no row has one.
    pub minutes_without_reference: f64,
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
    let all = ten_seconds(&rows);
    let longest = (all.len() / WANTED_SAMPLES).clamp(SHORTEST, LONGEST);
    let grade = ReferenceGrade::of(&rows);
    let compared = all.iter().filter(|t| t.has_reference(grade));
    let compared: Vec<&TenSeconds> = compared.collect();
    let moving: Vec<&TenSeconds> = compared
        .iter()
        .copied()
        .filter(|t| !is_at_rest(t))
        .collect();
    let minutes = |tens: usize| tens as f64 / 6.0;
    let (samples, tens_settled) = cut(&moving, longest);
    Settled {
        rows: count,
        sample_s: Some(longest as u32 * 10),
        minutes: minutes(all.len()),
        minutes_settled: minutes(tens_settled),
        minutes_at_rest: minutes(compared.len() - moving.len()),
        minutes_without_reference: minutes(all.len() - compared.len()),
        samples,
    }
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

fn is_at_rest(tens: &TenSeconds) -> bool {
    tens.sog_kn.is_some_and(|kn| kn < AT_REST_KN)
}

/// Cuts steady stretches into samples. Returns them with the tens of seconds in them.
fn cut(tens: &[&TenSeconds], longest: usize) -> (Vec<Sample>, usize) {
    let (mut samples, mut settled) = (Vec::new(), 0);
    let mut begin = 0;
    while begin < tens.len() {
        if !is_at_ease(&tens[..begin], tens[begin]) {
            begin += 1;
            continue;
        }
        let steady = steady(&tens[begin..], longest);
        if steady < SHORTEST {
            begin += 1;
            continue;
        }
        if let Some(sample) = mean_sample(&tens[begin..begin + steady]) {
            samples.push(sample);
            settled += steady;
        }
        begin += steady;
    }
    (samples, settled)
}

/// Returns true if the heading was near this one for the minute before.
fn is_at_ease(before: &[&TenSeconds], now: &TenSeconds) -> bool {
    let since = before.partition_point(|t| now.index - t.index > REST);
    let minute = &before[since..];
    minute.len() >= ENOUGH_REST && minute.iter().all(|t| t.turned_deg(now) <= TURN_DEG)
}

/// Returns the tens of seconds that keep the first one's heading without a gap.
fn steady(tens: &[&TenSeconds], longest: usize) -> usize {
    let keeps = |k: usize| {
        tens[k].index - tens[k - 1].index <= GAP && tens[k].turned_deg(tens[0]) <= STEADY_DEG
    };
    1 + (1..tens.len().min(longest))
        .take_while(|k| keeps(*k))
        .count()
}

#[cfg(test)]
mod tests {
    use super::*;
    use binnacle_compass::angle::{CompassHeading, CourseOverGround, TrueHeading, wrap_180};
    use binnacle_compass::position::Position;
    use binnacle_compass::time::Timestamp;

    fn start() -> Timestamp {
        Timestamp::parse("2026-01-01T00:00:00Z").unwrap()
    }

    /// Returns true on the second heading of the recording with a turn.
    fn is_after(sample: &Sample) -> bool {
        sample
            .satellite
            .is_some_and(|heading| (50.0..70.0).contains(&heading.degrees()))
    }

    /// Returns a row a second: the true heading of each, with a compass that reads 3° less.
    fn recording(headings: &[f64]) -> Vec<Sample> {
        let position = Position::new(43.0, -3.0).unwrap();
        let row = |(k, deg): (usize, &f64)| Sample {
            satellite: TrueHeading::new(*deg),
            sog_kn: Some(8.0),
            ..Sample::new(
                start().plus_seconds(k as f64),
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
        assert_eq!(settled.sample_s, Some(60));
        // Eleven minutes, and one of rest at the beginning and after the turn.
        assert!((settled.minutes - 11.0).abs() < 1e-9, "{settled:?}");
        assert!((7.0..9.0).contains(&settled.minutes_settled), "{settled:?}");
        let first = &settled.samples[0];
        assert!(first.time.seconds_since(start()) >= 60.0, "{first:?}");
        let after: Vec<&Sample> = settled.samples.iter().filter(|s| is_after(s)).collect();
        assert!(after.iter().all(|s| s.time.seconds_since(start()) > 420.0));
        for sample in &settled.samples {
            let off = sample.satellite.unwrap().degrees() - sample.compass.degrees();
            assert!((wrap_180(off) - 3.0).abs() < 1e-9);
            assert!(sample.windows <= 6);
        }
    }

    #[test]
    fn rows_ten_minutes_apart_stay_as_they_are() {
        let mut rows = recording(&[10.0; 20]);
        for (k, row) in rows.iter_mut().enumerate() {
            row.time = row.time.plus_seconds(600.0 * k as f64);
        }
        let settled = settle(&rows);
        assert_eq!(settled.sample_s, None);
        assert_eq!(settled.samples, rows);
    }

    #[test]
    fn a_vessel_at_rest_gives_no_samples() {
        let mut rows = recording(&[10.0; 600]);
        for row in &mut rows {
            row.sog_kn = Some(0.2);
        }
        let settled = settle(&rows);
        assert_eq!(settled.samples.len(), 0);
        assert!((settled.minutes_at_rest - 10.0).abs() < 1e-9, "{settled:?}");
    }

    #[test]
    fn rows_without_a_reference_are_counted_as_such() {
        let mut rows = recording(&[10.0; 600]);
        for row in &mut rows {
            row.satellite = None;
        }
        let settled = settle(&rows);
        assert_eq!(settled.samples.len(), 0);
        assert!((settled.minutes_without_reference - 10.0).abs() < 1e-9);
    }

    #[test]
    fn rows_with_a_course_alone_become_samples_of_the_course() {
        let mut rows = recording(&[10.0; 600]);
        for row in &mut rows {
            row.satellite = None;
            row.cog = CourseOverGround::new(14.0);
        }
        let settled = settle(&rows);
        assert!(settled.minutes_settled > 7.0, "{settled:?}");
        let sample = settled.samples[0];
        assert!((sample.cog.unwrap().degrees() - 14.0).abs() < 1e-9);
        assert_eq!(sample.gyro.or(sample.satellite), None);
    }

    #[test]
    fn nothing_and_one_row_are_no_panic() {
        assert_eq!(settle(&[]).samples.len(), 0);
        assert_eq!(settle(&recording(&[10.0])).samples.len(), 1);
    }
}
