//! Settings of a vessel: sampling and sending of its agents, analysis of its samples, limits of its
//! alerts.
//!
//! Invariants: a change makes a new version, which agents get with their next downlink, and
//! enqueues an analysis. Without a row the defaults apply, as version 0.

mod alert_limits;
mod store;

pub use alert_limits::AlertLimits;
pub use store::find;

use crate::analysis_queue;
use crate::vessels;
use axum::extract::{FromRef, State};
use binnacle_compass::settings::AnalysisSettings;
use binnacle_platform::access::{Reader, Writer};
use binnacle_platform::app::App;
use binnacle_platform::audit::RequestContext;
use binnacle_platform::error::{Error, Problem, Result};
use binnacle_platform::http::{Id, Json, Valid};
use binnacle_platform::ids::VesselId;
use binnacle_wire::messages::Settings;
use serde::{Deserialize, Serialize};
use utoipa::ToSchema;
use utoipa_axum::router::OpenApiRouter;
use utoipa_axum::routes;

/// Returns the routes.
pub fn router<S>() -> OpenApiRouter<S>
where
    App: FromRef<S>,
    S: Clone + Send + Sync + 'static,
{
    OpenApiRouter::new().routes(routes!(find_settings, change_settings))
}

/// A vessel's settings.
#[derive(Clone, Debug, Serialize, Deserialize, ToSchema)]
pub struct VesselSettings {
    /// Settings of its agents; `version` rises with every change and is ignored in a request.
    #[schema(value_type = AgentSettings)]
    pub agent: Settings,
    /// Settings of the analysis of its samples.
    #[schema(value_type = ReadingSettings)]
    pub analysis: AnalysisSettings,
    /// Limits beyond which alerts are raised; the defaults if absent.
    #[serde(default)]
    pub alerts: AlertLimits,
}

/// Settings of an agent's sampling and sending.
#[derive(ToSchema)]
#[allow(dead_code, reason = "describes binnacle_wire::messages::Settings")]
pub struct AgentSettings {
    /// Rises with every change; 0 are the defaults.
    version: u32,
    /// Speed over ground below which nothing is sampled, knots.
    min_sog_kn: f64,
    /// Rate of turn above which a window is refused, degrees a minute.
    max_rate_of_turn_deg_min: f64,
    /// Seconds after a turn in which nothing is sampled.
    settle_s: u32,
    /// Greatest swing of heading to either side within 30 s, degrees.
    max_swing_deg: f64,
    /// The longest stretch that one sample is the mean of, seconds.
    sample_s: u32,
    /// A batch is sealed when its first sample is this old, seconds.
    seal_s: u32,
}

/// Settings of an analysis.
#[derive(ToSchema)]
#[allow(
    dead_code,
    reason = "describes binnacle_compass::settings::AnalysisSettings"
)]
pub struct ReadingSettings {
    /// The model of the earth's field.
    #[schema(value_type = FieldModelSchema)]
    field_model: FieldModelSchema,
    /// Correction of the gyro's speed error by the gyro itself.
    #[schema(value_type = GyroSpeedErrorSchema)]
    gyro_speed_error: GyroSpeedErrorSchema,
    /// Standard deviation of a reference's constant error, degrees.
    reference_constant_sd_deg: f64,
}

/// Correction of the gyro's speed error by the gyro itself.
#[derive(Serialize, ToSchema)]
#[serde(rename_all = "snake_case")]
#[schema(as = GyroSpeedError)]
#[allow(
    dead_code,
    reason = "describes binnacle_compass::settings::GyroSpeedError"
)]
pub enum GyroSpeedErrorSchema {
    /// It does.
    Corrected,
    /// It does not: the analysis does.
    Uncorrected,
}

/// The model of the earth's field.
#[derive(Serialize, ToSchema)]
#[serde(rename_all = "lowercase")]
#[schema(as = FieldModel)]
#[allow(dead_code, reason = "describes binnacle_compass::field::FieldModel")]
pub enum FieldModelSchema {
    /// International Geomagnetic Reference Field, 1900 to 2030.
    Igrf14,
    /// World Magnetic Model, 2025 to 2030.
    Wmm2025,
}

/// See a vessel's settings
#[utoipa::path(get, path = "/vessels/{id}/settings", tag = "fleet",
    params(("id" = VesselId, Path)),
    responses((status = 200, body = VesselSettings), (status = 401, body = Problem),
              (status = 404, body = Problem)))]
async fn find_settings(
    State(app): State<App>,
    reader: Reader,
    Id(id): Id<VesselId>,
) -> Result<Json<VesselSettings>> {
    vessels::must_be_in_fleet(&app.db, reader.operator, id).await?;
    Ok(Json(find(&app.db, id).await?))
}

/// Change a vessel's settings
#[utoipa::path(put, path = "/vessels/{id}/settings", tag = "fleet",
    params(("id" = VesselId, Path)), request_body = VesselSettings,
    responses((status = 200, body = VesselSettings), (status = 401, body = Problem),
              (status = 403, body = Problem), (status = 404, body = Problem),
              (status = 422, body = Problem)))]
async fn change_settings(
    State(app): State<App>,
    request: RequestContext,
    writer: Writer,
    Id(id): Id<VesselId>,
    Valid(new): Valid<VesselSettings>,
) -> Result<Json<VesselSettings>> {
    vessels::must_be_in_fleet(&app.db, writer.operator, id).await?;
    if !(0.0..=10.0).contains(&new.analysis.reference_constant_sd_deg) {
        return Err(Error::Invalid {
            field: "analysis.reference_constant_sd_deg",
            detail: format!(
                "{} is outside 0 to 10",
                new.analysis.reference_constant_sd_deg
            ),
        });
    }
    new.alerts.checked()?;
    let now = app.clock.now().into();
    let mut tx = request.begin().await?;
    store::change(&mut tx, id, &new, now).await?;
    analysis_queue::enqueue(&mut tx, id, now, 0.0).await?;
    tx.commit().await?;
    app.work.notify_one();
    Ok(Json(find(&app.db, id).await?))
}
