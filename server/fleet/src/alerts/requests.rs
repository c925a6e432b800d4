//! Requests about alerts, and pages of them.

use super::alert::{Alert, State};
use binnacle_platform::ids::VesselId;
use binnacle_platform::severity::Severity;
use serde::{Deserialize, Serialize};
use utoipa::{IntoParams, ToSchema};

/// A page of alerts.
#[derive(Serialize, ToSchema)]
pub(super) struct AlertList {
    /// The newest first.
    pub items: Vec<Alert>,
    /// `after` of the next page.
    #[schema(required)]
    pub next: Option<String>,
}

/// Filter of a list of alerts.
#[derive(Clone, Copy, Debug, Deserialize, IntoParams)]
#[into_params(parameter_in = Query)]
pub(super) struct Filter {
    /// Only of this vessel.
    pub vessel: Option<VesselId>,
    /// Only in this state.
    pub state: Option<State>,
    /// Only those that are not cleared (`true`), or only those that are (`false`).
    pub open: Option<bool>,
    /// Only of this severity or worse.
    pub severity: Option<Severity>,
}

/// Acknowledgement of an alert.
#[derive(Debug, Default, Deserialize, ToSchema)]
#[serde(deny_unknown_fields)]
pub(super) struct Acknowledgement {
    /// A note in the person's own words.
    #[schema(max_length = 200, example = "Master informed; azimuth taken")]
    pub note: Option<String>,
}

/// Clearing of an alert.
#[derive(Debug, Deserialize, ToSchema)]
#[serde(deny_unknown_fields)]
pub(super) struct Clearing {
    /// The reason.
    #[schema(min_length = 1, max_length = 200, example = "Adjusted at Algeciras")]
    pub reason: String,
}
