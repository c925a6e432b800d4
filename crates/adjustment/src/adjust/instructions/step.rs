//! A step of a plan.

use crate::binnacle::{BarSetting, HeelingSetting, PairSetting, Setting, Tray};
use serde::{Deserialize, Serialize};
use std::fmt;

/// Kind of corrector.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Serialize, Deserialize)]
#[cfg_attr(feature = "openapi", derive(utoipa::ToSchema))]
#[cfg_attr(feature = "openapi", schema(as = MovedCorrector))]
#[serde(rename_all = "snake_case")]
pub enum Corrector {
    /// Flinders bar.
    Flinders,
    /// Spheres, boxes or plates.
    Quadrantal,
    /// Vertical magnets.
    Heeling,
    /// Fore-and-aft magnets.
    ForeAndAft,
    /// Athwartship magnets.
    Athwartship,
}

/// Action of a step.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Serialize, Deserialize)]
#[cfg_attr(feature = "openapi", derive(utoipa::ToSchema))]
#[cfg_attr(feature = "openapi", schema(as = StepAction))]
#[serde(rename_all = "snake_case")]
pub enum Action {
    /// Fitted.
    Fit,
    /// Taken out.
    TakeOut,
    /// Moved to another place unchanged.
    Move,
    /// Turned or exchanged, perhaps also moved.
    Change,
}

/// Place of a corrector.
#[derive(Clone, Debug, PartialEq, Serialize, Deserialize)]
#[cfg_attr(feature = "openapi", derive(utoipa::ToSchema))]
#[cfg_attr(feature = "openapi", schema(as = CorrectorPlace))]
#[serde(tag = "place", rename_all = "snake_case")]
pub enum Place {
    /// Magnets of an axis.
    Magnets(Tray),
    /// Spheres, boxes or plates.
    Pair(PairSetting),
    /// Flinders bar.
    Bar(BarSetting),
    /// Vertical magnets.
    Bucket(HeelingSetting),
}

/// One movement with its check on the spot.
#[derive(Clone, Debug, PartialEq, Serialize, Deserialize)]
#[cfg_attr(feature = "openapi", derive(utoipa::ToSchema))]
#[cfg_attr(feature = "openapi", schema(as = PlanStep))]
pub struct Step {
    /// Number, from 1.
    pub number: u32,
    /// Kind of corrector.
    pub corrector: Corrector,
    /// Action.
    pub action: Action,
    /// Place before; none when it is fitted.
    #[cfg_attr(feature = "openapi", schema(required))]
    pub from: Option<Place>,
    /// Place afterwards; none when it is taken out.
    #[cfg_attr(feature = "openapi", schema(required))]
    pub to: Option<Place>,
    /// Instruction in a sentence.
    pub words: String,
    /// Check before the step.
    #[cfg_attr(feature = "openapi", schema(required))]
    pub check: Option<String>,
    /// Predicted compass heading at the berth afterwards, degrees.
    pub expected_compass_deg: f64,
    /// Predicted turn of the compass, degrees, clockwise positive.
    pub change_deg: f64,
    /// Tolerance of the turn, degrees.
    pub tolerance_deg: f64,
    /// Visible: the compass shows the step on this heading.
    pub seen: bool,
    /// Setting before.
    pub setting_before: Setting,
    /// Setting afterwards.
    pub setting_after: Setting,
}

impl fmt::Display for Corrector {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        f.write_str(match self {
            Corrector::Flinders => "Flinders bar",
            Corrector::Quadrantal => "quadrantal correctors",
            Corrector::Heeling => "heeling magnets",
            Corrector::ForeAndAft => "fore-and-aft magnets",
            Corrector::Athwartship => "athwartship magnets",
        })
    }
}
