//! A compass's timeline: its epochs, what changed between them and why, and the
//! deviation in each of them.
//!
//! What always holds: the timeline is what the last analysis found; all curves are of
//! one place, where the last sample was taken, so that they can be compared.

mod schema;
mod store;
mod timeline;

use crate::access::Reader;
use crate::analysis;
use crate::app::App;
use crate::compasses::{self, WhichCompass};
use crate::error::{Problem, Result};
use crate::http::{Id, Json, Params};
use crate::ids::VesselId;
use crate::vessels;
use axum::extract::State;
use timeline::{Timeline, timeline};
use utoipa_axum::router::OpenApiRouter;
use utoipa_axum::routes;

/// The routes of this part.
pub fn router() -> OpenApiRouter<App> {
    OpenApiRouter::new().routes(routes!(list_changes))
}

/// See what changed a compass's deviation, when and why
///
/// The whole of it, in order of time: the epochs of constant magnetism with their
/// deviation on 36 headings where the ship was last, and the changes that were
/// found, also what passed again or was a reference's fault. Before the first
/// analysis both lists are empty.
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
        analysis::sharpen(&app.db, id, &mut analysed.findings).await?;
    }
    let versions = store::versions(&app.db, id, compass.id).await?;
    Ok(Json(timeline(compass.id, analysed, &versions)))
}
