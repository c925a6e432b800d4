//! Selection of samples as entries of a deviation book: one in each watch, and one after each large
//! alteration of course.
//!
//! Invariants: the entries of a watch depend on that watch's samples alone, so that a book read in
//! parts equals the book read whole. No two of these entries have the same time.

use binnacle_compass::angle::wrap_180;
use binnacle_compass::result::SampleDiagnostic;
use serde::Serialize;
use utoipa::ToSchema;

/// A watch, microseconds: they begin at 00, 04, 08, 12, 16 and 20 hours UTC.
const WATCH_MICROS: i64 = 4 * 3_600 * 1_000_000;
/// An alteration of course of so much is large, degrees.
const LARGE_DEG: f64 = 20.0;

/// Occasion of an entry.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Serialize, ToSchema)]
#[serde(rename_all = "snake_case")]
#[schema(as = BookOccasion)]
pub(super) enum Occasion {
    /// A watch: its first settled stretch of heading.
    Watch,
    /// An alteration of course by 20° or more since the entry before.
    Alteration,
    /// An azimuth that an officer observed.
    Azimuth,
}

/// Selects entries from samples in order of time, which begin with a watch's first.
pub(super) fn select_entries(samples: Vec<SampleDiagnostic>) -> Vec<(Occasion, SampleDiagnostic)> {
    let mut chosen: Vec<(Occasion, SampleDiagnostic)> = Vec::new();
    for sample in samples {
        if sample.deviation_deg.is_none() {
            continue;
        }
        let last = chosen.last().map(|(_, last)| last);
        if let Some(occasion) = occasion(&sample, last) {
            chosen.push((occasion, sample));
        }
    }
    chosen
}

fn occasion(sample: &SampleDiagnostic, last: Option<&SampleDiagnostic>) -> Option<Occasion> {
    let watch = |of: &SampleDiagnostic| of.sample.time.micros().div_euclid(WATCH_MICROS);
    let Some(last) = last.filter(|last| watch(last) == watch(sample)) else {
        return Some(Occasion::Watch);
    };
    let heading_deg = |of: &SampleDiagnostic| of.sample.compass.degrees();
    let altered_deg = wrap_180(heading_deg(sample) - heading_deg(last)).abs();
    let is_later = sample.sample.time > last.sample.time;
    (is_later && altered_deg >= LARGE_DEG).then_some(Occasion::Alteration)
}

#[cfg(test)]
mod tests {
    use super::*;

    /// Returns a sample at a number of minutes after midnight.
    fn sample(minute: u32, compass_deg: f64) -> SampleDiagnostic {
        let (hour, minute) = (minute / 60, minute % 60);
        serde_json::from_value(serde_json::json!({
            "time": format!("2026-11-21T{hour:02}:{minute:02}:00Z"), "lat": 43.0, "lon": -3.0,
            "compass_deg": compass_deg, "gyro_deg": 90.0, "satellite_deg": null, "sog_kn": 12.0,
            "rate_of_turn_deg_min": 0.0, "spread_deg": 0.1, "windows": 60, "variation_deg": 0.4,
            "h_nt": 24000.0, "z_nt": 39000.0, "deviation_deg": 1.0, "predicted_deg": null,
            "residual_deg": null, "weight": 1.0, "used": true, "reason": null,
        }))
        .unwrap()
    }

    fn chosen(samples: &[(u32, f64)]) -> Vec<(u32, Occasion)> {
        let all = samples
            .iter()
            .map(|(minute, compass)| sample(*minute, *compass));
        let midnight = sample(0, 0.0).sample.time;
        let minute = |found: &SampleDiagnostic| {
            (found.sample.time.seconds_since(midnight) / 60.0).round() as u32
        };
        let entries = select_entries(all.collect());
        entries
            .iter()
            .map(|(occasion, found)| (minute(found), *occasion))
            .collect()
    }

    #[test]
    fn a_steady_course_is_entered_once_a_watch() {
        let steady: Vec<(u32, f64)> = (0..60).map(|i| (5 + 10 * i, 90.0)).collect();
        let watches = [
            (5, Occasion::Watch),
            (245, Occasion::Watch),
            (485, Occasion::Watch),
        ];
        assert_eq!(chosen(&steady), watches);
    }

    #[test]
    fn a_large_alteration_is_entered_also_across_north_and_back() {
        use Occasion::{Alteration, Watch};
        let found = chosen(&[(5, 350.0), (15, 9.9), (25, 10.0), (35, 355.0), (45, 349.9)]);
        assert_eq!(found, [(5, Watch), (25, Alteration), (45, Alteration)]);
    }

    #[test]
    fn what_tells_no_deviation_is_no_observation() {
        let mut blind = sample(5, 90.0);
        blind.deviation_deg = None;
        let entries = select_entries(vec![blind, sample(15, 90.0)]);
        assert_eq!(entries.len(), 1);
        assert_eq!(entries[0].1.sample.time, sample(15, 90.0).sample.time);
        assert!(select_entries(Vec::new()).is_empty());
    }

    #[test]
    fn two_samples_of_one_instant_make_one_entry() {
        assert_eq!(chosen(&[(5, 90.0), (5, 180.0)]), [(5, Occasion::Watch)]);
    }

    #[test]
    fn a_book_read_by_watches_is_the_book_read_whole() {
        for turns_deg in [3.0, 7.0, 11.0, 19.9, 20.1, 47.0, 170.0, 181.0] {
            let samples: Vec<(u32, f64)> = (0..144)
                .map(|i| (10 * i, (turns_deg * f64::from(i)).rem_euclid(360.0)))
                .collect();
            let by_watches = (0..6).flat_map(|watch| {
                let own = samples.iter().filter(|(minute, _)| minute / 240 == watch);
                chosen(&own.copied().collect::<Vec<_>>())
            });
            assert_eq!(
                by_watches.collect::<Vec<_>>(),
                chosen(&samples),
                "{turns_deg}"
            );
        }
    }
}
