//! A step of a plan.

use crate::binnacle::{BarSetting, HeelingSetting, PairSetting, Setting, Tray};
use serde::{Deserialize, Serialize};
use std::fmt;

/// What is moved.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Serialize, Deserialize)]
#[serde(rename_all = "snake_case")]
pub enum Corrector {
    /// The Flinders bar.
    Flinders,
    /// Spheres, boxes or plates.
    Quadrantal,
    /// The vertical magnets.
    Heeling,
    /// Fore-and-aft magnets.
    ForeAndAft,
    /// Athwartship magnets.
    Athwartship,
}

/// What is done with it.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Serialize, Deserialize)]
#[serde(rename_all = "snake_case")]
pub enum Action {
    /// It comes in.
    Fit,
    /// It comes out.
    TakeOut,
    /// It comes to another place as it is.
    Move,
    /// It, or its magnets, are turned or exchanged, perhaps also moved.
    Change,
}

/// Where something stands.
#[derive(Clone, Debug, PartialEq, Serialize, Deserialize)]
#[serde(tag = "place", rename_all = "snake_case")]
pub enum Place {
    /// Magnets of an axis.
    Magnets(Tray),
    /// Spheres, boxes or plates.
    Pair(PairSetting),
    /// A Flinders bar.
    Bar(BarSetting),
    /// Vertical magnets.
    Bucket(HeelingSetting),
}

/// One movement, to be checked on the spot.
#[derive(Clone, Debug, PartialEq, Serialize, Deserialize)]
pub struct Step {
    /// From 1.
    pub number: u32,
    /// What is moved.
    pub corrector: Corrector,
    /// What is done with it.
    pub action: Action,
    /// Where it was; none when it comes in.
    pub from: Option<Place>,
    /// Where it will be; none when it comes out.
    pub to: Option<Place>,
    /// All of it in a sentence.
    pub words: String,
    /// What to see to before.
    pub check: Option<String>,
    /// What the compass will then read at the berth, degrees.
    pub expected_compass_deg: f64,
    /// By how much it will have turned, degrees, clockwise positive.
    pub change_deg: f64,
    /// How far off it may be, degrees.
    pub tolerance_deg: f64,
    /// Whether on this heading the compass shows the step at all.
    pub seen: bool,
    /// How the correctors stood before.
    pub setting_before: Setting,
    /// How they stand then.
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
