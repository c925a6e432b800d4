//! Second reading of the magnetometer, after the steps, with its result.

use crate::work_orders::payload::recorded_reading::RecordedReading;
use crate::work_orders::refusal::Refusal;
use binnacle_adjustment::adjust::{FieldComponent, SecondReadingForm, UpdatedPrediction};
use binnacle_adjustment::binnacle::Setting;
use serde::{Deserialize, Serialize};
use utoipa::ToSchema;

/// Parts of a reading that has the vertical one.
pub(crate) const PARTS_WITH_VERTICAL: usize = 3;

/// A second reading as the log has it.
#[derive(Clone, Debug, Serialize, Deserialize)]
pub(crate) struct RecordedSecondReading {
    /// What was read.
    pub given: SecondReadingForm,
    /// What it told.
    #[serde(flatten)]
    pub said: SecondReadingResult,
    /// What is foretold now, where it told that.
    pub learnt: Option<UpdatedPrediction>,
    /// The reading to plan from anew, where what is left is beyond the limits.
    pub anew: Option<Box<RecordedReading>>,
}

impl RecordedSecondReading {
    /// Whether it does not confirm how the correctors stand.
    pub(crate) fn is_contradiction(&self) -> bool {
        self.said.verdict != SecondReadingVerdict::AsPlanned
    }
}

/// What a second reading told.
#[derive(Clone, Debug, Serialize, Deserialize, ToSchema)]
#[schema(as = SecondReadingSaid)]
pub(crate) struct SecondReadingResult {
    /// In a word.
    pub verdict: SecondReadingVerdict,
    /// In words.
    pub words: String,
    /// Forward, to starboard and, where it was read both times, down.
    #[schema(value_type = Vec<PartSchema>)]
    pub parts: Vec<FieldComponent>,
    /// The step that is suspected, of all that were done since the first reading, from 1.
    #[serde(default, skip_serializing_if = "Option::is_none")]
    pub step: Option<u32>,
    /// How the correctors would stand with that slip.
    #[serde(default, skip_serializing_if = "Option::is_none")]
    #[schema(value_type = Option<binnacle_fleet::binnacles::SettingSchema>)]
    pub setting: Option<Setting>,
    /// The worst residual foretold now, degrees.
    #[serde(default, skip_serializing_if = "Option::is_none")]
    pub worst_residual_deg: Option<f64>,
    /// The widest 95 % band now, degrees.
    #[serde(default, skip_serializing_if = "Option::is_none")]
    pub widest_band_deg: Option<f64>,
    /// What is beyond the limits.
    #[serde(default, skip_serializing_if = "Vec::is_empty")]
    #[schema(required = false)]
    pub refusals: Vec<Refusal>,
    /// Mistakes each of which alone would explain it.
    #[serde(default, skip_serializing_if = "Vec::is_empty")]
    #[schema(required = false)]
    pub could_be: Vec<String>,
}

/// What a second reading came to, in a word.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Serialize, Deserialize, ToSchema)]
#[serde(rename_all = "snake_case")]
#[schema(as = SecondReadingVerdict)]
pub(crate) enum SecondReadingVerdict {
    /// The correctors do what was planned.
    AsPlanned,
    /// They seem to, but what is left is beyond the limits, or no plan led here: read once
    /// more, or plan anew from this reading.
    Replan,
    /// A step is suspected: look at it, and say how the correctors stand.
    Slip,
    /// Nothing explains it: read again.
    Unexplained,
}

/// One part of the field, nT.
#[derive(ToSchema)]
#[schema(as = SecondReadingPart)]
#[allow(
    dead_code,
    clippy::struct_field_names,
    reason = "describes binnacle_adjustment::adjust::FieldComponent"
)]
struct PartSchema {
    /// What was foretold.
    expected_nt: f64,
    read_nt: f64,
    /// Of the difference.
    standard_error_nt: f64,
}
