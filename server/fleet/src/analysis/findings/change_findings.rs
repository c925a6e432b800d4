//! Changes that an analysis found, with their effect at the ship's present place.
//!
//! Invariants:
//!
//! - A change that began an epoch, or ended when one began, names it.
//! - Its size is for the place of the last sample where models exist on both sides of it, otherwise
//!   for the place where it was found.
//! - Ships mostly return to the same waters: those of the last weeks stand for those to come.

use binnacle_compass::angle::CompassHeading;
use binnacle_compass::logbook::LogbookEntry;
use binnacle_compass::model::Model;
use binnacle_compass::result::{Analysis, Cause, Change};
use binnacle_compass::ship::EarthField;
use binnacle_compass::time::Timestamp;
use serde::{Deserialize, Serialize};

/// Error of dates in the logbook, seconds. People enter the time of noticing, or of the plan.
const REPORTED_WITHIN_S: f64 = 2.0 * 86_400.0;
/// Step of compass heading in the comparison of two models, degrees.
const STEP_DEG: u32 = 5;
/// Period whose waters stand for those to come, seconds.
const TRADE_S: f64 = 60.0 * 86_400.0;
/// Interval between the places that are compared, seconds.
const PLACES_S: f64 = 86_400.0;

/// A change, with the particulars that alerts and the timeline need.
#[derive(Clone, Debug, PartialEq, Serialize, Deserialize)]
pub struct ChangeFinding {
    /// The change itself.
    #[serde(flatten)]
    pub change: Change,
    /// Index of the epoch that it began.
    #[serde(default)]
    pub epoch: Option<usize>,
    /// Index of the epoch that began when it was over.
    #[serde(default)]
    pub epoch_ended: Option<usize>,
    /// True where work in the logbook explains it.
    #[serde(default)]
    pub expected: bool,
    /// Its effect on the measured deviation, degrees, on the heading where that is greatest;
    /// none where it is not known.
    #[serde(default)]
    pub size_deg: Option<f64>,
    /// Its effect on the waters of the last sixty days, which stand for those to come.
    #[serde(default)]
    pub size_ahead_deg: Option<f64>,
}

/// Returns the changes that an analysis found.
pub(super) fn found_changes(analysis: &Analysis, logbook: &[LogbookEntry]) -> Vec<ChangeFinding> {
    let changes = analysis.changes.iter();
    changes
        .map(|change| found(change, analysis, logbook))
        .collect()
}

fn found(change: &Change, analysis: &Analysis, logbook: &[LogbookEntry]) -> ChangeFinding {
    let epochs = &analysis.epochs;
    let begun_at = |time: Timestamp| epochs.iter().position(|epoch| epoch.from == Some(time));
    // Neither a disturbance nor a reference begins an epoch, even at the same time.
    let is_boundary = change.confirmed && change.cause.changes_deviation();
    let epoch = Some(change.from).filter(|_| is_boundary).and_then(begun_at);
    let sides = epoch.and_then(|after| {
        let before = epochs.get(after.checked_sub(1)?)?.model.as_ref()?;
        Some((before, epochs[after].model.as_ref()?))
    });
    let size_here_deg = sides
        .zip(analysis.last_place)
        .and_then(|((before, after), place)| {
            let earth = EarthField {
                h_nt: place.h_nt,
                z_nt: place.z_nt,
            };
            difference_deg(before, after, earth)
        });
    let size_ahead_deg = sides.and_then(|(before, after)| {
        let differences =
            waters_ahead(analysis).filter_map(|earth| difference_deg(before, after, earth));
        differences.reduce(f64::max)
    });
    ChangeFinding {
        epoch,
        epoch_ended: change.ended.filter(|_| is_boundary).and_then(begun_at),
        expected: change.cause == Cause::AdjustmentOrRepair && is_reported(change, logbook),
        size_deg: size_here_deg
            .or(change.deviation_change_deg.map(f64::abs))
            .or(change.disturbed_deg),
        size_ahead_deg,
        change: change.clone(),
    }
}

/// Tells whether the logbook reports work around that time.
fn is_reported(change: &Change, logbook: &[LogbookEntry]) -> bool {
    logbook
        .iter()
        .filter(|entry| entry.kind.ends_an_epoch())
        .any(|entry| {
            let until = entry.to.unwrap_or(entry.from);
            change.from_earliest.seconds_since(until) < REPORTED_WITHIN_S
                && entry.from.seconds_since(change.from_latest) < REPORTED_WITHIN_S
        })
}

/// Returns the earth's fields in the waters of the last weeks, a day apart.
fn waters_ahead(analysis: &Analysis) -> impl Iterator<Item = EarthField> {
    let since = analysis
        .data_until
        .map(|until| until.plus_seconds(-TRADE_S));
    let mut next = since;
    let samples = analysis.samples.iter();
    samples.filter_map(move |s| {
        next.filter(|next| s.sample.time >= *next)?;
        let earth = EarthField {
            h_nt: s.h_nt?,
            z_nt: s.z_nt?,
        };
        next = Some(s.sample.time.plus_seconds(PLACES_S));
        Some(earth)
    })
}

/// Returns the greatest difference of two models in a field, degrees.
fn difference_deg(before: &Model, after: &Model, earth: EarthField) -> Option<f64> {
    let deviation_deg = |model: &Model, compass| {
        let predicted = model.deviation(compass, earth).ok()?;
        Some(predicted.deviation.degrees_east())
    };
    let headings = (0..360).step_by(STEP_DEG as usize);
    let differences = headings.filter_map(|heading_deg| {
        let compass = CompassHeading::new(f64::from(heading_deg))?;
        Some((deviation_deg(after, compass)? - deviation_deg(before, compass)?).abs())
    });
    differences.reduce(f64::max)
}

#[cfg(test)]
mod tests {
    use super::*;
    use binnacle_analysis::fleet_prior::ShipPrior;
    use binnacle_compass::model::{Parameters, ReferenceGrade};
    use binnacle_compass::sample::Sample;
    use binnacle_compass::settings::AnalysisSettings;

    /// Returns a sample of a ship on the meridian of Greenwich.
    fn sample(time: &str, lat: f64) -> Sample {
        serde_json::from_value(serde_json::json!({
            "time": time, "lat": lat, "lon": 0.0, "compass_deg": 10.0, "gyro_deg": 12.0,
            "satellite_deg": null, "sog_kn": 12.0, "rate_of_turn_deg_min": 0.0,
            "spread_deg": 0.3, "windows": 60,
        }))
        .unwrap()
    }

    fn with_bx(bx_nt: f64) -> Model {
        Model {
            parameters_over_lambda: Parameters {
                bx_nt,
                ..Parameters::from_array([0.0; 7])
            },
            constant_deg: 0.0,
            covariance: None,
            identifiable: None,
            rms_deg: None,
            samples_used: 0,
            samples_rejected: 0,
            quality: None,
            reference_grade: ReferenceGrade::Heading,
            mean_h_nt: None,
            needles: None,
        }
    }

    #[test]
    fn the_waters_ahead_are_those_of_sixty_days_a_day_apart() {
        let samples = [
            sample("2026-06-01T00:00:00Z", 70.0),
            sample("2026-09-20T00:00:00Z", 57.0),
            sample("2026-09-20T05:00:00Z", 56.0),
            sample("2026-10-20T00:00:00Z", 0.0),
        ];
        let analysis = binnacle_tracking::analyse(&binnacle_tracking::Input {
            samples: &samples,
            logbook: &[],
            azimuths: &[],
            prior: &ShipPrior::population(),
            settings: AnalysisSettings::default(),
        });
        let there: Vec<EarthField> = waters_ahead(&analysis).collect();
        let met = |k: usize| analysis.samples[k].h_nt;
        let h_nt: Vec<Option<f64>> = there.iter().map(|earth| Some(earth.h_nt)).collect();
        assert_eq!(h_nt, [met(1), met(3)]);
    }

    #[test]
    fn models_part_by_the_step_over_the_horizontal_field() {
        let parted = |h_nt| {
            let earth = EarthField { h_nt, z_nt: 0.0 };
            difference_deg(&with_bx(0.0), &with_bx(2000.0), earth).unwrap()
        };
        let expected = |h_nt: f64| (2000.0 / h_nt).asin().to_degrees();
        for h_nt in [12_000.0, 30_000.0] {
            assert!((parted(h_nt) - expected(h_nt)).abs() < 0.02, "{h_nt}");
        }
    }
}
