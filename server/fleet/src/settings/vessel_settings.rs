//! Settings of a vessel, as they are stored and shown.

use super::alert_limits::AlertLimits;
use binnacle_compass::settings::AnalysisSettings;
use binnacle_wire::messages::Settings;
use serde::{Deserialize, Serialize};
use utoipa::ToSchema;

/// A vessel's settings.
#[derive(Clone, Debug, Serialize, Deserialize, ToSchema)]
pub struct VesselSettings {
    /// Settings of its agents; `version` rises with every change and is ignored in a request.
    pub agent: Settings,
    /// Settings of the analysis of its samples.
    pub analysis: AnalysisSettings,
    /// Limits beyond which alerts are raised; the defaults if absent.
    #[serde(default)]
    pub alerts: AlertLimits,
}
