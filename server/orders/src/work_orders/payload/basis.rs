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

/// What a plan rests on.
#[derive(Clone, Debug, Serialize, Deserialize)]
pub(crate) struct Basis {
    /// The ship's model.
    pub model: ModelUsed,
    /// The earth's field at the berth: variation, degrees, east positive.
    pub variation_deg: f64,
    /// Its horizontal part, nT.
    pub h_nt: f64,
    /// Its vertical part, nT, down positive.
    pub z_nt: f64,
    /// Which model of the earth's field says so.
    pub field_model: String,
    /// The binnacle's revision.
    pub binnacle_revision: i64,
    /// The binnacle, with its correctors as they stood.
    pub binnacle: Binnacle,
    /// Where the vessel trades, from her own track.
    pub waters: Vec<Water>,
    /// Whether magnetic cargo is on board, by the logbook or the reading.
    pub cargo_on_board: bool,
    /// What the compass's last adjustment told of λ.
    #[serde(default)]
    pub earlier: Option<PreviousBerth>,
    /// Whether the model has learnt from a reading at this berth.
    #[serde(default)]
    pub is_updated_here: bool,
}

/// The model that a plan rests on.
#[derive(Clone, Debug, Serialize, Deserialize)]
pub(crate) struct ModelUsed {
    /// Its id.
    pub id: ModelId,
    /// Counts the compass's models from 1.
    pub version: i64,
    /// SHA-256 of everything that it was made from.
    pub input_hash: String,
    /// The estimator that made it.
    pub estimator: String,
    /// The time of its last sample.
    pub data_until: Time,
    /// The time of the last heading behind it, where an adjustment foretold it and no
    /// heading at sea has confirmed that.
    #[serde(default)]
    pub headings_until: Option<Time>,
    /// The model with its covariance.
    pub model: Model,
}

/// λ at an earlier berth.
#[derive(Clone, Debug, Serialize, Deserialize)]
pub(crate) struct PreviousBerth {
    /// As it was told.
    pub lambda: EarlierLambda,
    /// How the correctors stood then.
    pub stood: Setting,
}

impl PreviousBerth {
    /// With the correctors as this binnacle has them.
    pub(crate) fn set_as(&self, binnacle: &Binnacle) -> Option<EarlierLambda> {
        self.lambda.adapted_to(binnacle, &self.stood)
    }
}

impl Basis {
    /// The earth's field at the berth.
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
