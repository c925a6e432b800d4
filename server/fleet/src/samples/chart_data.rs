//! Summary of a compass's samples for a chart: dots, and means over time.
//!
//! Invariant: means and counts cover all samples; only the dots are a selection.

use binnacle_compass::result::SampleDiagnostic;
use binnacle_compass::time::Timestamp;
use binnacle_platform::time::Time;
use serde::Serialize;
use std::collections::BTreeMap;
use utoipa::ToSchema;

/// More dots than this only blacken a picture.
const MOST_DOTS: usize = 1_200;
const DAY_MICROS: i64 = 86_400_000_000;
/// Longer than this is drawn by weeks.
const LONGEST_BY_DAYS: i64 = 31 * DAY_MICROS;

/// A compass's samples as a picture shows them.
#[derive(Serialize, ToSchema)]
pub(super) struct SamplePicture {
    /// Number of samples with a measured deviation.
    samples: usize,
    /// Number of those with a residual, in an epoch with a model.
    with_residual: usize,
    /// Time of the first with a residual.
    #[schema(required)]
    first: Option<Time>,
    /// Time of the last with a residual.
    #[schema(required)]
    last: Option<Time>,
    /// Root mean square of the residuals that carried weight, degrees.
    #[schema(required)]
    rms_deg: Option<f64>,
    /// Length of an interval, days: 1 up to 31 days, 7 beyond.
    interval_days: i64,
    /// The residuals that carried weight, by interval from the first one's UTC day; those
    /// without any are left out.
    intervals: Vec<ResidualInterval>,
    /// Samples that have a measured deviation, evenly picked where there are more than 1,200.
    dots: SampleDots,
}

/// The residuals of an interval.
#[derive(Debug, PartialEq, Serialize, ToSchema)]
pub(super) struct ResidualInterval {
    /// Its first instant.
    from: Time,
    /// Number of residuals.
    samples: usize,
    /// Their mean, degrees.
    mean_deg: f64,
    /// Their root mean square, degrees.
    rms_deg: f64,
}

/// Samples in order of time, a column each and all of one length, rounded to what a picture
/// can show.
#[derive(Default, Serialize, ToSchema)]
pub(super) struct SampleDots {
    /// Seconds since the beginning of 1970, UTC.
    unix_s: Vec<i64>,
    /// Degrees east.
    lon: Vec<f64>,
    /// Mean raw compass heading.
    compass_deg: Vec<f64>,
    /// Reference less variation less compass, degrees.
    deviation_deg: Vec<f64>,
    /// Measured less predicted, degrees; none where no model predicts.
    residual_deg: Vec<Option<f64>>,
    /// True for those that carried weight in a model.
    used: Vec<bool>,
}

/// Summarizes samples in order of time.
pub(super) fn summarize(samples: &[SampleDiagnostic]) -> SamplePicture {
    let measured: Vec<&SampleDiagnostic> = samples
        .iter()
        .filter(|found| found.deviation_deg.is_some())
        .collect();
    let predicted: Vec<&SampleDiagnostic> = measured
        .iter()
        .copied()
        .filter(|found| found.residual_deg.is_some())
        .collect();
    let time = |found: &&SampleDiagnostic| Time(found.sample.time);
    let weighed: Vec<(i64, f64)> = predicted
        .iter()
        .filter(|found| found.used)
        .filter_map(|found| Some((found.sample.time.micros(), found.residual_deg?)))
        .collect();
    let interval_days = match (weighed.first(), weighed.last()) {
        (Some(&(first, _)), Some(&(last, _))) if last - midnight(first) > LONGEST_BY_DAYS => 7,
        _ => 1,
    };
    SamplePicture {
        samples: measured.len(),
        with_residual: predicted.len(),
        first: predicted.first().map(time),
        last: predicted.last().map(time),
        rms_deg: rms(weighed.iter().map(|&(_, residual)| residual)),
        interval_days,
        intervals: intervals(&weighed, interval_days * DAY_MICROS),
        dots: dots(&measured),
    }
}

fn intervals(weighed: &[(i64, f64)], long: i64) -> Vec<ResidualInterval> {
    let Some(&(first, _)) = weighed.first() else {
        return Vec::new();
    };
    let begin = midnight(first);
    let mut groups: BTreeMap<i64, Vec<f64>> = BTreeMap::new();
    for &(at, residual) in weighed {
        groups
            .entry((at - begin) / long)
            .or_default()
            .push(residual);
    }
    let interval = |(index, residuals): (i64, Vec<f64>)| {
        Some(ResidualInterval {
            from: Time(Timestamp::from_micros(begin + index * long).ok()?),
            samples: residuals.len(),
            mean_deg: mean(residuals.iter().copied())?,
            rms_deg: rms(residuals.iter().copied())?,
        })
    };
    groups.into_iter().filter_map(interval).collect()
}

fn dots(measured: &[&SampleDiagnostic]) -> SampleDots {
    let drawn = measured.len().min(MOST_DOTS);
    let mut dots = SampleDots::default();
    for index in 0..drawn {
        let found = measured[index * measured.len() / drawn];
        dots.unix_s
            .push(found.sample.time.micros().div_euclid(1_000_000));
        dots.lon
            .push(rounded(found.sample.position.lon_deg(), 10.0));
        dots.compass_deg
            .push(rounded(found.sample.compass.degrees(), 10.0));
        dots.deviation_deg
            .push(rounded(found.deviation_deg.unwrap_or_default(), 100.0));
        dots.residual_deg
            .push(found.residual_deg.map(|residual| rounded(residual, 100.0)));
        dots.used.push(found.used);
    }
    dots
}

fn midnight(micros: i64) -> i64 {
    micros - micros.rem_euclid(DAY_MICROS)
}

fn rounded(value: f64, parts: f64) -> f64 {
    (value * parts).round() / parts
}

fn mean(values: impl Iterator<Item = f64>) -> Option<f64> {
    let (count, sum) = values.fold((0.0, 0.0), |(count, sum), value| (count + 1.0, sum + value));
    (count > 0.0).then(|| sum / count)
}

fn rms(values: impl Iterator<Item = f64>) -> Option<f64> {
    mean(values.map(|value| value * value)).map(f64::sqrt)
}

#[cfg(test)]
mod tests {
    use super::*;
    use serde_json::json;

    const DAY_S: f64 = 86_400.0;

    /// Returns a sample at a time after the beginning of 12 October. One without a residual is of
    /// an epoch without a model.
    fn sample(after_s: f64, residual_deg: Option<f64>, used: bool) -> SampleDiagnostic {
        let begin = Timestamp::parse("2026-10-12T00:00:00Z").unwrap();
        let diagnostic = json!({
            "time": begin.plus_seconds(after_s), "lat": 43.126, "lon": -8.449,
            "compass_deg": 90.04, "gyro_deg": 90.0, "satellite_deg": null, "sog_kn": 12.0,
            "rate_of_turn_deg_min": 0.0, "spread_deg": 0.1, "windows": 60,
            "variation_deg": -1.0, "h_nt": null, "z_nt": null, "deviation_deg": 2.344,
            "predicted_deg": null, "residual_deg": residual_deg, "weight": 1.0, "used": used,
            "reason": null,
        });
        serde_json::from_value(diagnostic).unwrap()
    }

    #[test]
    fn means_are_by_day_of_what_carried_weight() {
        let samples = [
            sample(0.4 * DAY_S, Some(1.0), true),
            sample(0.5 * DAY_S, Some(90.0), false),
            sample(0.6 * DAY_S, Some(-3.0), true),
            sample(0.7 * DAY_S, None, false),
            sample(2.0 * DAY_S, Some(0.5), true),
        ];
        let found = summarize(&samples);
        assert_eq!((found.samples, found.with_residual), (5, 4));
        assert_eq!(found.interval_days, 1);
        let of = |index: usize| {
            let interval = &found.intervals[index];
            (interval.from.day(), interval.samples, interval.mean_deg)
        };
        assert_eq!(of(0), ("2026-10-12".to_owned(), 2, -1.0));
        assert_eq!(of(1), ("2026-10-14".to_owned(), 1, 0.5));
        assert!((found.intervals[0].rms_deg - 5.0_f64.sqrt()).abs() < 1e-12);
        assert_eq!(found.dots.residual_deg[3], None);
        assert_eq!(found.dots.lon.first(), Some(&-8.4));
        assert_eq!(found.dots.deviation_deg.first(), Some(&2.34));
    }

    #[test]
    fn beyond_a_month_means_are_by_week() {
        let found = |days: f64| {
            summarize(&[
                sample(0.9 * DAY_S, Some(1.0), true),
                sample(days * DAY_S, Some(1.0), true),
            ])
        };
        assert_eq!(found(31.0).interval_days, 1);
        let long = found(31.1);
        assert_eq!(long.interval_days, 7);
        assert_eq!(long.intervals[1].from.day(), "2026-11-09");
    }

    #[test]
    fn a_picture_has_no_more_dots_than_the_eye_distinguishes() {
        let many: Vec<SampleDiagnostic> = (0..3_000)
            .map(|i| sample(600.0 * f64::from(i), Some(0.1), true))
            .collect();
        let found = summarize(&many);
        assert_eq!((found.samples, found.dots.used.len()), (3_000, MOST_DOTS));
        assert_eq!(found.dots.unix_s[1] - found.dots.unix_s[0], 1_200);
        assert_eq!(summarize(&[]).dots.used.len(), 0);
        assert_eq!(summarize(&[]).rms_deg, None);
    }
}
