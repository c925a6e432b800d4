//! Input of a plan.

use super::limits::Limits;
use super::vertical_reading::VerticalReading;
use crate::berth::BerthReading;
use crate::binnacle::{Binnacle, Setting};
use binnacle_compass::model::Model;
use binnacle_compass::ship::EarthField;
use binnacle_compass::time::Timestamp;
use serde::{Deserialize, Serialize};

/// Complete input of a plan.
#[derive(Clone, Debug)]
pub struct Adjustment<'a> {
    /// Model of the ship, fitted with the correctors in the setting of `binnacle`.
    pub model: &'a Model,
    /// Earth's field at the berth.
    pub earth: EarthField,
    /// Magnetometer reading in the bowl's place, with the correctors in that setting.
    pub reading: &'a BerthReading,
    /// Relative standard deviation of the magnetometer's scale.
    pub scale_sd: f64,
    /// Compass heading at the berth with the present setting of the correctors, degrees.
    pub compass_deg: Option<f64>,
    /// Vertical field at the berth, if measured.
    pub vertical: Option<VerticalReading>,
    /// Binnacle with its setting at the time of model and reading.
    pub binnacle: &'a Binnacle,
    /// Present setting, where correctors were moved since.
    pub now: Option<&'a Setting>,
    /// Trading waters, over which the search minimises; limits also hold at the berth.
    pub waters: &'a [Water],
    /// Circumstances of model and vessel.
    pub circumstances: Circumstances,
    /// Limits of a plan.
    pub limits: Limits,
}

/// A water where the vessel trades.
#[derive(Clone, Debug, PartialEq, Serialize, Deserialize)]
pub struct Water {
    /// Name of the water.
    pub name: String,
    /// Horizontal field, nT.
    pub h_nt: f64,
    /// Vertical field, nT, down positive.
    pub z_nt: f64,
    /// Relative time spent there; only ratios count.
    pub weight: f64,
}

/// Circumstances of model and vessel at the berth.
#[derive(Clone, Copy, Debug, Default, PartialEq)]
pub struct Circumstances {
    /// Days since the model's last sample.
    pub model_age_days: Option<f64>,
    /// Magnetic cargo on board that the model does not include.
    pub cargo_on_board: bool,
    /// λ of an earlier berth of the same compass.
    pub earlier_lambda: Option<EarlierLambda>,
    /// Reading after the vessel was shifted to another heading of this berth, with the same
    /// correctors.
    pub shifted: Option<BerthReading>,
    /// Model updated by a reading at this berth: its covariance then includes possible
    /// changes of the ship before the berth.
    pub is_updated_here: bool,
}

/// λ of an earlier berth of the same compass.
#[derive(Clone, Copy, Debug, PartialEq, Serialize, Deserialize)]
pub struct EarlierLambda {
    /// Time of the reading at that berth.
    pub at: Timestamp,
    /// λ for one setting of the correctors: the earlier or the present one.
    pub lambda: f64,
    /// Standard error of λ, including the magnetometer's scale and the ship's drift until
    /// then.
    pub standard_error: f64,
}

impl Adjustment<'_> {
    /// Returns the present setting of the correctors.
    pub fn standing(&self) -> &Setting {
        self.now.unwrap_or(&self.binnacle.setting)
    }
}

impl Water {
    /// Returns the earth's field in this water.
    pub fn earth(&self) -> EarthField {
        EarthField {
            h_nt: self.h_nt,
            z_nt: self.z_nt,
        }
    }
}
