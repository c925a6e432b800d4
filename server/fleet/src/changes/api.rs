//! HTTP API of the timeline.

use super::store;
use super::timeline::{Timeline, timeline};
use crate::analysis;
use crate::compasses::{self, WhichCompass};
use crate::vessels;
use axum::extract::{FromRef, State};
use binnacle_platform::access::Reader;
use binnacle_platform::app::App;
use binnacle_platform::error::{Problem, Result};
use binnacle_platform::http::{Id, Json, Params};
use binnacle_platform::ids::VesselId;
use utoipa_axum::router::OpenApiRouter;
use utoipa_axum::routes;

/// Returns the routes.
pub fn router<S>() -> OpenApiRouter<S>
where
    App: FromRef<S>,
    S: Clone + Send + Sync + 'static,
{
    OpenApiRouter::new().routes(routes!(list_changes))
}

/// List the changes of a compass's deviation, with time and cause
///
/// The answer is the whole timeline in order of time: the epochs of constant magnetism with
/// their deviation on 36 headings at the last place, and the changes that were found. These
/// include disturbances that passed and faults of a reference. Before the first analysis both
/// lists are empty.
#[utoipa::path(get, path = "/vessels/{id}/changes", tag = "fleet",
    params(("id" = VesselId, Path), WhichCompass),
    responses((status = 200, body = Timeline), (status = 401, body = Problem),
              (status = 404, body = Problem)))]
async fn list_changes(
    State(app): State<App>,
    reader: Reader,
    Id(id): Id<VesselId>,
    Params(which): Params<WhichCompass>,
) -> Result<Json<Timeline>> {
    vessels::must_be_in_fleet(&app.db, reader.operator, id).await?;
    let compass = compasses::find(&app.db, id, which.compass).await?;
    let mut analysed = store::find(&app.db, id, compass.id).await?;
    if let Some(analysed) = &mut analysed {
        analysis::compare_with_fleet(&app.db, id, &mut analysed.findings).await?;
    }
    let versions = store::versions(&app.db, id, compass.id).await?;
    Ok(Json(timeline(compass.id, analysed, &versions)))
}
