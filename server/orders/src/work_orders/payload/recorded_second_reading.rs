//! Second reading of the magnetometer, after the steps, with its result.

use crate::work_orders::payload::recorded_reading::RecordedReading;
use crate::work_orders::refusal::Refusal;
use binnacle_adjustment::adjust::{FieldComponent, SecondReadingForm, UpdatedPrediction};
use binnacle_adjustment::binnacle::Setting;
use serde::{Deserialize, Serialize};
use utoipa::ToSchema;

/// Number of parts in a reading with a vertical part.
pub(crate) const PARTS_WITH_VERTICAL: usize = 3;

/// Second reading, with its result.
#[derive(Clone, Debug, Serialize, Deserialize)]
pub(crate) struct RecordedSecondReading {
    /// Values as sent.
    pub given: SecondReadingForm,
    /// Result.
    #[serde(flatten)]
    pub result: SecondReadingResult,
    /// Updated prediction, if the reading allows one.
    #[serde(rename = "learnt")]
    pub prediction: Option<UpdatedPrediction>,
    /// Reading to replan from, if the residuals are beyond the limits.
    #[serde(rename = "anew")]
    pub reading_to_plan_from: Option<Box<RecordedReading>>,
}

impl RecordedSecondReading {
    /// Returns whether the reading contradicts the settings of the correctors.
    pub(crate) fn is_contradiction(&self) -> bool {
        self.result.verdict != SecondReadingVerdict::AsPlanned
    }
}

/// Result of a second reading.
#[derive(Clone, Debug, Serialize, Deserialize, ToSchema)]
#[schema(as = SecondReadingSaid)]
pub(crate) struct SecondReadingResult {
    /// Verdict.
    pub verdict: SecondReadingVerdict,
    /// Verdict in words.
    pub words: String,
    /// Parts forward, to starboard and, if read both times, down.
    pub parts: Vec<FieldComponent>,
    /// Number of the suspected step, of all steps since the first reading, from 1.
    #[serde(default, skip_serializing_if = "Option::is_none")]
    pub step: Option<u32>,
    /// Setting of the correctors with that slip.
    #[serde(default, skip_serializing_if = "Option::is_none")]
    pub setting: Option<Setting>,
    /// Worst residual predicted now, degrees.
    #[serde(default, skip_serializing_if = "Option::is_none")]
    pub worst_residual_deg: Option<f64>,
    /// Widest 95 % band now, degrees.
    #[serde(default, skip_serializing_if = "Option::is_none")]
    pub widest_band_deg: Option<f64>,
    /// Values beyond the limits.
    #[serde(default, skip_serializing_if = "Vec::is_empty")]
    #[schema(required = false)]
    pub refusals: Vec<Refusal>,
    /// Mistakes, each of which alone would explain the reading.
    #[serde(default, skip_serializing_if = "Vec::is_empty")]
    #[schema(required = false)]
    pub could_be: Vec<String>,
}

/// Verdict of a second reading.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Serialize, Deserialize, ToSchema)]
#[serde(rename_all = "snake_case")]
#[schema(as = SecondReadingVerdict)]
pub(crate) enum SecondReadingVerdict {
    /// The correctors do what was planned.
    AsPlanned,
    /// They seem to, but the residuals are beyond the limits, or no plan was followed: read
    /// again, or replan from this reading.
    Replan,
    /// A step is suspected: inspect it, and report the settings.
    Slip,
    /// Nothing explains the reading: read again.
    Unexplained,
}
