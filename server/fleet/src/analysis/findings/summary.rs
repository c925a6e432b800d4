//! Summary of one compass's analysis.

use super::change_findings::{ChangeFinding, found_changes};
use crate::deviation::{self, WorstHeading};
use crate::models::LeftOut;
use binnacle_compass::angle::wrap_180;
use binnacle_compass::logbook::LogbookEntry;
use binnacle_compass::result::{Analysis, Epoch, FitError, LastPlace, SampleDiagnostic};
use binnacle_compass::ship::EarthField;
use binnacle_compass::time::Timestamp;
use serde::{Deserialize, Serialize};

/// Time before the last sample in which a failed reference counts, seconds.
const LATELY_S: f64 = 86_400.0;

/// Findings about one compass.
#[derive(Clone, Debug, Default, PartialEq, Serialize, Deserialize)]
pub struct Findings {
    /// Time of the last sample.
    pub data_until: Option<Timestamp>,
    /// The current epoch's first sample.
    pub epoch_data_from: Option<Timestamp>,
    /// The greatest deviation by the current epoch's model, at the last place.
    pub worst: Option<WorstHeading>,
    /// The widest half of the 95 % band there, over all headings, degrees.
    pub widest_band95_deg: Option<f64>,
    /// Reason for which the current epoch has no model.
    pub refusal: Option<String>,
    /// Samples of the current epoch that the logbook leaves out.
    #[serde(default)]
    pub left_out: LeftOut,
    /// Gyro less satellite compass, degrees, where they differ throughout by more than any
    /// alignment explains.
    pub references_disagree_deg: Option<f64>,
    /// Recent comparison of both; none unless one of them failed.
    pub failed_lately: Option<FailedLately>,
    /// Changes of the ship's magnetism, real or apparent, in order of time.
    #[serde(default)]
    pub changes: Vec<ChangeFinding>,
    /// Effects of logbook entries on the samples, a sentence each.
    #[serde(default)]
    pub notices: Vec<String>,
    /// Beginning of the current epoch.
    #[serde(default)]
    pub epoch_from: Option<Timestamp>,
    /// Place of the last sample.
    #[serde(default)]
    pub last_place: Option<LastPlace>,
}

/// Samples in which gyro and satellite compass departed from their usual difference, within a
/// day before the last sample.
#[derive(Clone, Debug, PartialEq, Serialize, Deserialize)]
pub struct FailedLately {
    /// Time of the first of them.
    pub from: Timestamp,
    /// Their number.
    pub samples: u64,
    /// Number of samples with both.
    pub of: u64,
    /// Departure of the last one from the usual difference, degrees.
    pub departure_deg: f64,
    /// Times that the gyro was dropped in the current epoch.
    pub gyro_dropped: u64,
    /// Times that the satellite compass was dropped in the current epoch.
    pub satellite_dropped: u64,
}

impl Findings {
    /// Summarizes an analysis.
    pub fn from_analysis(analysis: &Analysis, logbook: &[LogbookEntry]) -> Findings {
        let Some(epoch) = analysis.current_epoch() else {
            return Findings::default();
        };
        let at_last_place = epoch.model.as_ref().zip(analysis.last_place);
        let rows = at_last_place.and_then(|(model, place)| {
            let earth = EarthField {
                h_nt: place.h_nt,
                z_nt: place.z_nt,
            };
            deviation::table(model, earth, 5.0).ok()
        });
        Findings {
            data_until: analysis.data_until,
            epoch_data_from: epoch.data_from,
            worst: rows.as_deref().and_then(deviation::worst_of),
            widest_band95_deg: rows
                .iter()
                .flatten()
                .filter_map(|row| row.band95_deg)
                .reduce(f64::max),
            refusal: epoch.refusal.as_ref().map(ToString::to_string),
            left_out: LeftOut::from_analysis(analysis),
            references_disagree_deg: match epoch.refusal {
                Some(FitError::ReferencesDisagree { offset_deg, .. }) => Some(offset_deg),
                _ => None,
            },
            failed_lately: failed_lately(epoch, &analysis.samples),
            changes: found_changes(analysis, logbook),
            notices: analysis.notices.clone(),
            epoch_from: epoch.from,
            last_place: analysis.last_place,
        }
    }
}

fn failed_lately(epoch: &Epoch, samples: &[SampleDiagnostic]) -> Option<FailedLately> {
    let check = epoch.references?;
    if check.gyro_dropped + check.satellite_dropped == 0 {
        return None;
    }
    let usual_deg = check.offset_deg?;
    let last = samples.last()?.sample.time;
    let since = epoch.from.into_iter().chain([last.plus_seconds(-LATELY_S)]);
    let since = since.max()?;
    let (mut pairs, mut failed) = (0, Vec::new());
    for diagnostic in samples {
        let sample = &diagnostic.sample;
        let Some((gyro, satellite)) = sample.gyro.zip(sample.satellite) else {
            continue;
        };
        if sample.time < since {
            continue;
        }
        pairs += 1;
        let departure_deg = wrap_180(gyro.degrees() - satellite.degrees() - usual_deg);
        if departure_deg.abs() > check.failed_beyond_deg {
            failed.push((sample.time, departure_deg));
        }
    }
    let (from, _) = *failed.first()?;
    let (_, departure_deg) = *failed.last()?;
    Some(FailedLately {
        from,
        samples: failed.len() as u64,
        of: pairs,
        departure_deg,
        gyro_dropped: check.gyro_dropped,
        satellite_dropped: check.satellite_dropped,
    })
}
