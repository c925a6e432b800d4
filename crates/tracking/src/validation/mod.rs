//! Validation of the method on anyone's own recording: what was predicted before it was used,
//! and what the model of one part says of another.
//!
//! One reference stands behind both parts, so that an error of it which lasts, or depends on
//! the heading alone, shows in none of this.

mod held_out;
mod reference_noise;
mod residual;
mod settle;
mod ten_seconds;

pub use held_out::{HeldOut, Sector};
pub use settle::{Settled, settle};

use crate::report::{Input, analyse, refused_references};
use binnacle_compass::result::{
    Analysis, Change, Epoch, FitError, PredictionCoverage, SampleDiagnostic, SampleReason,
};
use binnacle_compass::sample::Sample;
use binnacle_compass::time::Timestamp;
use held_out::held_out;
use serde::Serialize;

/// Days with samples from which odd days are held against even ones.
const NEEDED_DAYS: usize = 4;
const DAY_MICROS: i64 = 86_400_000_000;

/// Outcome of a validation.
#[derive(Clone, Debug, PartialEq, Serialize)]
pub struct Validation {
    /// Rows of the recording, and the settled samples made of them.
    pub settled: Settled,
    /// Samples used.
    pub used: u64,
    /// Samples that were not used, by reason.
    pub refused: Vec<Refused>,
    /// Predictions of samples before they were used.
    pub predictions: PredictionCoverage,
    /// Changes of the ship's magnetism that were found. A model from before such a change does
    /// not hold after it.
    pub changes: Vec<Change>,
    /// Reason for which the whole recording has no model.
    pub refusal: Option<FitError>,
    /// Longest stretch without a change or an entry that ends an epoch: the parts are its parts.
    pub stretch: Stretch,
    /// Parts held against each other.
    pub parts: Vec<PartCheck>,
}

/// Samples that were not used for one reason.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Serialize)]
pub struct Refused {
    /// Reason.
    pub reason: SampleReason,
    /// Number of samples.
    pub samples: u64,
}

/// Samples used between two changes.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq, Serialize)]
pub struct Stretch {
    /// Time of the first sample; none without any.
    pub from: Option<Timestamp>,
    /// Time of the last sample.
    pub to: Option<Timestamp>,
    /// Number of samples.
    pub samples: u64,
}

/// Part of a recording.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Serialize)]
#[serde(rename_all = "snake_case")]
pub enum Part {
    /// Samples up to the middle one.
    FirstHalf,
    /// Samples from the middle one on.
    SecondHalf,
    /// First, third, fifth … UTC day with samples.
    OddDays,
    /// Second, fourth, sixth … UTC day with samples.
    EvenDays,
}

/// Check of one part by the model of another.
#[derive(Clone, Debug, PartialEq, Serialize)]
pub struct PartCheck {
    /// Part of which the model is.
    pub model_of: Part,
    /// Part that was predicted.
    pub predicted: Part,
    /// Outcome; none where the first part has no model.
    pub held_out: Option<HeldOut>,
    /// Reason for which there is none.
    pub refusal: Option<FitError>,
}

/// Validates the method on a recording: raw rows, or settled samples.
pub fn validate(input: &Input<'_>) -> Validation {
    let settled = settle(input.samples);
    // Rows of every second show more of the references than their means do.
    let is_raw = settled.sample_s.is_some();
    if let Some(refusal) = is_raw.then(|| refused_references(input)).flatten() {
        return without_references(settled, refusal);
    }
    let analysis = analyse(&Input {
        samples: &settled.samples,
        ..*input
    });
    let stretch = longest_stretch(&analysis);
    let mut parts = Vec::new();
    for (one, other) in [
        (Part::FirstHalf, Part::SecondHalf),
        (Part::OddDays, Part::EvenDays),
    ] {
        if one == Part::OddDays && days(&stretch).len() < NEEDED_DAYS {
            continue;
        }
        parts.push(check(one, other, input, &stretch));
        parts.push(check(other, one, input, &stretch));
    }
    let changes = analysis.changes.iter();
    Validation {
        used: analysis.samples.iter().filter(|s| s.used).count() as u64,
        refused: refused(&analysis.samples),
        predictions: analysis.predictions.unwrap_or_default(),
        changes: changes
            .filter(|c| c.confirmed && c.cause.changes_deviation())
            .cloned()
            .collect(),
        refusal: analysis.current_epoch().and_then(|e| e.refusal.clone()),
        stretch: Stretch {
            from: stretch.first().map(|s| s.sample.time),
            to: stretch.last().map(|s| s.sample.time),
            samples: stretch.len() as u64,
        },
        parts,
        settled,
    }
}

/// Returns the outcome for a recording whose references cannot be used.
fn without_references(settled: Settled, refusal: FitError) -> Validation {
    Validation {
        used: 0,
        refused: vec![Refused {
            reason: SampleReason::ReferenceFailed,
            samples: settled.samples.len() as u64,
        }],
        predictions: PredictionCoverage::default(),
        changes: Vec::new(),
        refusal: Some(refusal),
        stretch: Stretch::default(),
        parts: Vec::new(),
        settled,
    }
}

/// Returns the samples used of the epoch that has most.
fn longest_stretch(analysis: &Analysis) -> Vec<&SampleDiagnostic> {
    let of = |epoch: &Epoch| -> Vec<&SampleDiagnostic> {
        let within = analysis.samples.iter().filter(|s| {
            let time = s.sample.time;
            s.used
                && epoch.from.is_none_or(|from| time > from)
                && epoch.to.is_none_or(|to| time <= to)
        });
        within.collect()
    };
    let stretches = analysis.epochs.iter().map(of);
    stretches.max_by_key(Vec::len).unwrap_or_default()
}

fn check(
    model_of: Part,
    predicted: Part,
    input: &Input<'_>,
    stretch: &[&SampleDiagnostic],
) -> PartCheck {
    let days = days(stretch);
    let of = |part: Part| {
        let day_of = |sample: &SampleDiagnostic| days.partition_point(|d| *d < day(&sample.sample));
        let indexed = stretch.iter().enumerate();
        let within = indexed.filter(move |(index, sample)| match part {
            Part::FirstHalf => *index < stretch.len() / 2,
            Part::SecondHalf => *index >= stretch.len() / 2,
            Part::OddDays => day_of(sample).is_multiple_of(2),
            Part::EvenDays => !day_of(sample).is_multiple_of(2),
        });
        within.map(|(_, sample)| *sample)
    };
    let samples: Vec<Sample> = of(model_of).map(|s| s.sample).collect();
    let learnt = analyse(&Input {
        samples: &samples,
        ..*input
    });
    let (held_out, refusal) = match held_out(&learnt, of(predicted)) {
        Ok(held_out) => (Some(held_out), None),
        Err(refusal) => (None, Some(refusal)),
    };
    PartCheck {
        model_of,
        predicted,
        held_out,
        refusal,
    }
}

fn day(sample: &Sample) -> i64 {
    sample.time.micros().div_euclid(DAY_MICROS)
}

/// Returns the days with samples, in order.
fn days(samples: &[&SampleDiagnostic]) -> Vec<i64> {
    let mut days: Vec<i64> = samples.iter().map(|s| day(&s.sample)).collect();
    days.dedup();
    days
}

fn refused(samples: &[SampleDiagnostic]) -> Vec<Refused> {
    let mut refused: Vec<Refused> = Vec::new();
    for reason in samples.iter().filter(|s| !s.used).filter_map(|s| s.reason) {
        match refused.iter_mut().find(|known| known.reason == reason) {
            Some(known) => known.samples += 1,
            None => refused.push(Refused { reason, samples: 1 }),
        }
    }
    refused.sort_by_key(|refused| std::cmp::Reverse(refused.samples));
    refused
}
