//! Samples in order of time, each with the earth's field around it.

use super::logbook_rules::{exclusion_by_entry, exclusion_by_kind};
use crate::fit::HeadingReading;
use crate::gyro_speed_error::gyro_speed_error_deg;
use binnacle_compass::angle::{TrueHeading, Variation};
use binnacle_compass::field::{FieldAt, FieldModel};
use binnacle_compass::logbook::LogbookEntry;
use binnacle_compass::model::ReferenceGrade;
use binnacle_compass::result::{LastPlace, SampleDiagnostic, SampleReason};
use binnacle_compass::sample::{Sample, sort_distinct};
use binnacle_compass::settings::{AnalysisSettings, GyroSpeedError};
use binnacle_compass::ship::{EarthField, WEAKEST_H_NT};
use binnacle_compass::time::Timestamp;

const DAY_MICROS: i64 = 86_400_000_000;

/// A sample with what the analysis derives from it.
#[derive(Clone)]
pub struct Reading {
    /// Gyro heading, corrected for speed error.
    pub gyro: Option<TrueHeading>,
    /// Variation there and then; none outside the field model's years.
    pub variation: Option<Variation>,
    /// Earth's field there and then; none outside the field model's years.
    pub earth: Option<EarthField>,
    /// Diagnosis so far.
    pub diagnostic: SampleDiagnostic,
}

impl Reading {
    /// Returns the sample itself.
    pub fn sample(&self) -> &Sample {
        &self.diagnostic.sample
    }

    /// Returns the place with its field; none outside the field model's years.
    pub fn place(&self) -> Option<LastPlace> {
        let (variation, earth) = self.variation.zip(self.earth)?;
        Some(LastPlace {
            time: self.sample().time,
            position: self.sample().position,
            variation_deg: variation.degrees_east(),
            h_nt: earth.h_nt,
            z_nt: earth.z_nt,
        })
    }
}

/// Returns the distinct samples in order of time, with the field and the reasons against
/// their use that need no fit, for a reference of some grade.
pub fn readings(
    samples: &[Sample],
    logbook: &[LogbookEntry],
    settings: &AnalysisSettings,
    grade: ReferenceGrade,
) -> Vec<Reading> {
    let mut sorted = samples.to_vec();
    sort_distinct(&mut sorted);
    let excluding = logbook
        .iter()
        .filter(|e| exclusion_by_kind(e.kind).is_some());
    // An end in the future, or in a mistaken year, does not count.
    let excluding: Vec<LogbookEntry> = sorted.last().map_or_else(Vec::new, |last| {
        excluding.map(|entry| entry.as_of(last.time)).collect()
    });
    let mut field = DailyField::new(settings.field_model);
    sorted
        .into_iter()
        .map(|sample| {
            let mut reading = reading(sample, &mut field, settings, grade);
            // The first reason in their order, whatever the order of the entries.
            let reported = excluding
                .iter()
                .filter_map(|entry| exclusion_by_entry(entry, &sample));
            let reason = &mut reading.diagnostic.reason;
            *reason = reason.or(reported.min());
            reading
        })
        .collect()
}

fn reading(
    sample: Sample,
    field: &mut DailyField,
    settings: &AnalysisSettings,
    grade: ReferenceGrade,
) -> Reading {
    let found = field.at(&sample);
    let variation = found.map(|f| f.declination());
    let earth = found.map(|f| f.for_ship());
    let reason = match earth {
        _ if sample.position_reckoned => Some(SampleReason::GnssInterference),
        _ if !has_reference(&sample, grade) => Some(SampleReason::NoReference),
        None => Some(SampleReason::OutsideFieldModel),
        Some(earth) if earth.h_nt < WEAKEST_H_NT => Some(SampleReason::FieldTooWeak),
        Some(_) => None,
    };
    Reading {
        gyro: corrected_gyro(&sample, settings.gyro_speed_error),
        variation,
        earth,
        diagnostic: SampleDiagnostic {
            sample,
            variation_deg: variation.map(Variation::degrees_east),
            h_nt: earth.map(|e| e.h_nt),
            z_nt: earth.map(|e| e.z_nt),
            deviation_deg: None,
            predicted_deg: None,
            residual_deg: None,
            weight: 0.0,
            used: false,
            reason,
        },
    }
}

fn has_reference(sample: &Sample, grade: ReferenceGrade) -> bool {
    match grade {
        ReferenceGrade::Heading => sample.gyro.or(sample.satellite).is_some(),
        ReferenceGrade::CourseOverGround => sample.cog.is_some() && sample.sog_kn.is_some(),
    }
}

fn corrected_gyro(sample: &Sample, speed_error: GyroSpeedError) -> Option<TrueHeading> {
    let gyro = sample.gyro?;
    let (GyroSpeedError::Uncorrected, Some(sog_kn)) = (speed_error, sample.sog_kn) else {
        return Some(gyro);
    };
    let error = gyro_speed_error_deg(gyro, sog_kn, sample.position.lat_deg());
    TrueHeading::new(gyro.degrees() - error).or(Some(gyro))
}

/// Returns the headings of a reading; none without a reference or a field.
pub fn heading_reading(reading: &Reading) -> Option<HeadingReading> {
    let sample = reading.sample();
    let (variation, earth) = reading.variation.zip(reading.earth)?;
    if reading.gyro.is_none() && sample.satellite.is_none() {
        return None;
    }
    Some(HeadingReading {
        time: Some(sample.time),
        position: Some(sample.position),
        compass: sample.compass,
        gyro: reading.gyro,
        satellite: sample.satellite,
        unnamed: None,
        variation,
        h_nt: earth.h_nt,
        z_nt: earth.z_nt,
        sog_kn: sample.sog_kn,
        windows: sample.windows,
        spread_deg: sample.spread_deg,
        weight: 1.0,
    })
}

/// Field model at noon of the last day asked for: the field changes by far less in half a
/// day than the model's error.
struct DailyField {
    model: FieldModel,
    day: Option<i64>,
    at_noon: Option<FieldAt>,
}

impl DailyField {
    fn new(model: FieldModel) -> DailyField {
        DailyField {
            model,
            day: None,
            at_noon: None,
        }
    }

    fn at(&mut self, sample: &Sample) -> Option<binnacle_compass::field::Field> {
        let day = sample.time.micros().div_euclid(DAY_MICROS);
        if self.day != Some(day) {
            self.day = Some(day);
            self.at_noon = Timestamp::from_micros(day * DAY_MICROS + DAY_MICROS / 2)
                .ok()
                .and_then(|noon| FieldAt::from_time(self.model, noon).ok());
        }
        self.at_noon.as_ref()?.at(sample.position, 0.0).ok()
    }
}
