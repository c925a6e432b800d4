//! Basis of a plan: model, earth's field, binnacle and waters at the time of the reading.

use binnacle_adjustment::adjust::{EarlierLambda, Water};
use binnacle_adjustment::binnacle::{Binnacle, Setting};
use binnacle_compass::angle::Variation;
use binnacle_compass::model::Model;
use binnacle_compass::ship::EarthField;
use binnacle_platform::error::Result;
use binnacle_platform::ids::ModelId;
use binnacle_platform::time::Time;
use serde::{Deserialize, Serialize};

/// Basis of a plan.
#[derive(Clone, Debug, Serialize, Deserialize)]
pub(crate) struct Basis {
    /// The ship's model.
    pub model: ModelUsed,
    /// Variation at the berth, degrees, east positive.
    pub variation_deg: f64,
    /// Horizontal field there, nT.
    pub h_nt: f64,
    /// Vertical field there, nT, down positive.
    pub z_nt: f64,
    /// Model of the earth's field.
    pub field_model: String,
    /// Revision of the binnacle.
    pub binnacle_revision: i64,
    /// Binnacle, with the settings at the time of the reading.
    pub binnacle: Binnacle,
    /// Waters in which the vessel sails, by its own track.
    pub waters: Vec<Water>,
    /// Magnetic cargo on board, by the logbook or the reading.
    pub cargo_on_board: bool,
    /// Estimate of λ by the compass's last adjustment.
    #[serde(default)]
    pub earlier: Option<PreviousBerth>,
    /// True if the model includes a reading at this berth.
    #[serde(default)]
    pub is_updated_here: bool,
}

/// Model that a plan rests on.
#[derive(Clone, Debug, Serialize, Deserialize)]
pub(crate) struct ModelUsed {
    /// Its id.
    pub id: ModelId,
    /// Version, from 1 for each compass.
    pub version: i64,
    /// SHA-256 of its input.
    pub input_hash: String,
    /// Estimator.
    pub estimator: String,
    /// Time of its last sample.
    pub data_until: Time,
    /// Time of the last heading behind a predicted model that no heading at sea has confirmed.
    #[serde(default)]
    pub headings_until: Option<Time>,
    /// The model with its covariance.
    pub model: Model,
}

/// Estimate of λ at an earlier berth.
#[derive(Clone, Debug, Serialize, Deserialize)]
pub(crate) struct PreviousBerth {
    /// The estimate.
    pub lambda: EarlierLambda,
    /// Setting of the correctors at that time.
    #[serde(rename = "stood")]
    pub setting: Setting,
}

impl PreviousBerth {
    /// Adapts the estimate to the settings of this binnacle.
    pub(crate) fn set_as(&self, binnacle: &Binnacle) -> Option<EarlierLambda> {
        self.lambda.adapted_to(binnacle, &self.setting)
    }
}

impl Basis {
    /// Earth's field at the berth.
    pub(crate) fn earth(&self) -> EarthField {
        EarthField {
            h_nt: self.h_nt,
            z_nt: self.z_nt,
        }
    }

    /// Variation at the berth.
    pub(crate) fn variation(&self) -> Result<Variation> {
        Ok(Variation::try_from(self.variation_deg).map_err(anyhow::Error::from)?)
    }
}
