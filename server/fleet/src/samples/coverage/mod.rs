//! Coverage of a compass's samples, and advice on where to sail next.

use crate::analysis::{self, Covered};
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

pub(super) fn router<S>() -> OpenApiRouter<S>
where
    App: FromRef<S>,
    S: Clone + Send + Sync + 'static,
{
    OpenApiRouter::new().routes(routes!(find_coverage))
}

/// Show the coverage of a compass's samples and where more would help most
#[utoipa::path(get, path = "/vessels/{id}/coverage", tag = "fleet",
    params(("id" = VesselId, Path), WhichCompass),
    responses((status = 200, body = Covered), (status = 401, body = Problem),
              (status = 404, body = Problem)))]
async fn find_coverage(
    State(app): State<App>,
    reader: Reader,
    Id(id): Id<VesselId>,
    Params(which): Params<WhichCompass>,
) -> Result<Json<Covered>> {
    vessels::must_be_in_fleet(&app.db, reader.operator, id).await?;
    let compass = compasses::find(&app.db, id, which.compass).await?;
    Ok(Json(analysis::coverage(&app.db, id, compass.id).await?))
}
