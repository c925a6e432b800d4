//! Settings of a vessel: sampling and sending of its agents, analysis of its samples, limits of its
//! alerts.
//!
//! Invariants: a change makes a new version, which agents get with their next downlink, and
//! enqueues an analysis. Without a row the defaults apply, as version 0.

mod alert_limits;
mod store;
mod vessel_settings;

pub use alert_limits::AlertLimits;
pub use store::find;
pub use vessel_settings::VesselSettings;

use crate::analysis_queue;
use crate::vessels;
use axum::extract::{FromRef, State};
use binnacle_platform::access::{Reader, Writer};
use binnacle_platform::app::App;
use binnacle_platform::audit::RequestContext;
use binnacle_platform::error::{Error, Problem, Result};
use binnacle_platform::http::{Id, IfMatch, Valid, Version, Versioned};
use binnacle_platform::ids::VesselId;
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

/// See a vessel's settings
#[utoipa::path(get, path = "/vessels/{id}/settings", tag = "fleet",
    params(("id" = VesselId, Path)),
    responses((status = 200, body = VesselSettings, headers(("ETag" = String, description = "Version of what can be edited"))), (status = 401, body = Problem),
              (status = 404, body = Problem)))]
async fn find_settings(
    State(app): State<App>,
    reader: Reader,
    Id(id): Id<VesselId>,
) -> Result<Versioned<VesselSettings>> {
    vessels::must_be_in_fleet(&app.db, reader.operator, id).await?;
    versioned(find(&app.db, id).await?)
}

/// Change a vessel's settings
#[utoipa::path(put, path = "/vessels/{id}/settings", tag = "fleet",
    params(("id" = VesselId, Path), IfMatch), request_body = VesselSettings,
    responses((status = 200, body = VesselSettings, headers(("ETag" = String, description = "Version of what can be edited"))), (status = 401, body = Problem),
              (status = 403, body = Problem), (status = 404, body = Problem),
              (status = 422, body = Problem)))]
async fn change_settings(
    State(app): State<App>,
    request: RequestContext,
    writer: Writer,
    Id(id): Id<VesselId>,
    if_match: IfMatch,
    Valid(new): Valid<VesselSettings>,
) -> Result<Versioned<VesselSettings>> {
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
    vessels::lock(&mut tx, writer.operator, id).await?;
    if_match.check(&Version::of(&store::find_in(&mut tx, id).await?)?)?;
    store::change(&mut tx, id, &new, now).await?;
    analysis_queue::enqueue(&mut tx, id, now, 0.0).await?;
    tx.commit().await?;
    app.work.notify_one();
    versioned(find(&app.db, id).await?)
}

fn versioned(settings: VesselSettings) -> Result<Versioned<VesselSettings>> {
    let version = Version::of(&settings)?;
    Ok(Versioned(settings, version))
}
