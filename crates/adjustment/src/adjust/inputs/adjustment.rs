//! Input of a plan.

use super::limits::Limits;
use super::vertical_reading::VerticalReading;
use crate::berth::BerthReading;
use crate::binnacle::{Binnacle, Setting};
use binnacle_compass::model::Model;
use binnacle_compass::ship::EarthField;
use binnacle_compass::time::Timestamp;
use serde::{Deserialize, Serialize};

/// Everything that a plan rests on.
#[derive(Clone, Debug)]
pub struct Adjustment<'a> {
    /// The ship's model, fitted while the correctors stood as `binnacle` says.
    pub model: &'a Model,
    /// The earth's field at the berth.
    pub earth: EarthField,
    /// What the magnetometer read in the bowl's place, correctors as they were.
    pub reading: &'a BerthReading,
    /// Relative standard deviation of the magnetometer's scale.
    pub scale_sd: f64,
    /// What the compass reads at the berth with the correctors as they stand now, degrees.
    pub compass_deg: Option<f64>,
    /// Vertical field there, if it was read.
    pub vertical: Option<VerticalReading>,
    /// The binnacle with its correctors as they stood for model and reading.
    pub binnacle: &'a Binnacle,
    /// How they stand now, where they were moved since.
    pub now: Option<&'a Setting>,
    /// Where the vessel trades: what the search makes small. Limits hold at the berth as well.
    pub waters: &'a [Water],
    /// What the model and the ship are like.
    pub circumstances: Circumstances,
    /// What a plan must keep to.
    pub limits: Limits,
}

/// A place where the vessel trades.
#[derive(Clone, Debug, PartialEq, Serialize, Deserialize)]
pub struct Water {
    /// What it is called.
    pub name: String,
    /// Horizontal field, nT.
    pub h_nt: f64,
    /// Vertical field, nT, down positive.
    pub z_nt: f64,
    /// How much of her time she is there; only ratios count.
    pub weight: f64,
}

/// What the model and the ship are like at the berth.
#[derive(Clone, Copy, Debug, Default, PartialEq)]
pub struct Circumstances {
    /// Days since the model's last sample.
    pub model_age_days: Option<f64>,
    /// Whether magnetic cargo is on board that the model does not know.
    pub cargo_on_board: bool,
    /// λ as an earlier berth of the same compass told it.
    pub earlier_lambda: Option<EarlierLambda>,
    /// Whether the model has learnt from a reading at this berth: then its covariance has what
    /// may have become of the ship before it.
    pub is_updated_here: bool,
}

/// λ as an earlier berth of the same compass told it.
#[derive(Clone, Copy, Debug, PartialEq, Serialize, Deserialize)]
pub struct EarlierLambda {
    /// When that berth was read.
    pub at: Timestamp,
    /// λ with the correctors set in one way: as they were, or as they are now.
    pub lambda: f64,
    /// Its standard error, the magnetometer's scale and the ship's drift until then in it.
    pub standard_error: f64,
}

impl Adjustment<'_> {
    /// How the correctors stand now.
    pub fn standing(&self) -> &Setting {
        self.now.unwrap_or(&self.binnacle.setting)
    }
}

impl Water {
    /// Its field.
    pub fn earth(&self) -> EarthField {
        EarthField {
            h_nt: self.h_nt,
            z_nt: self.z_nt,
        }
    }
}
