//! Tags of vessels: groups that an operator forms as it likes.
//!
//! Invariant: a tag has no blanks around it, and a vessel has each once.

use crate::vessels;
use axum::extract::{FromRef, State};
use binnacle_platform::access::Writer;
use binnacle_platform::app::App;
use binnacle_platform::audit::RequestContext;
use binnacle_platform::db::{Db, Result as DbResult, execute, rows};
use binnacle_platform::error::{Error, Problem, Result};
use binnacle_platform::http::{Id, Json, Valid, text};
use binnacle_platform::ids::{OperatorId, VesselId};
use serde::{Deserialize, Serialize};
use std::collections::BTreeSet;
use utoipa::ToSchema;
use utoipa_axum::router::OpenApiRouter;
use utoipa_axum::routes;

/// Maximum number of a vessel's tags.
const MAX_TAGS: usize = 20;
/// Maximum length of a tag, characters.
const MAX_CHARS: usize = 40;

/// Returns the routes.
pub fn router<S>() -> OpenApiRouter<S>
where
    App: FromRef<S>,
    S: Clone + Send + Sync + 'static,
{
    OpenApiRouter::new().routes(routes!(put_tags))
}

/// Tags of a vessel.
#[derive(Debug, Serialize, Deserialize, ToSchema)]
#[serde(deny_unknown_fields)]
#[schema(as = VesselTags, example = json!({ "tags": ["Atlantic", "tanker"] }))]
struct Tags {
    /// In alphabetical order: 20 at most, of 40 characters at most.
    #[schema(max_items = 20)]
    tags: BTreeSet<String>,
}

/// Set a vessel's tags
///
/// In place of those that it had. The fleet's overview shows them.
#[utoipa::path(put, path = "/vessels/{id}/tags", tag = "fleet",
    params(("id" = VesselId, Path)), request_body = Tags,
    responses((status = 200, body = Tags), (status = 401, body = Problem),
              (status = 403, body = Problem), (status = 404, body = Problem),
              (status = 422, body = Problem)))]
async fn put_tags(
    State(app): State<App>,
    request: RequestContext,
    writer: Writer,
    Id(id): Id<VesselId>,
    Valid(given): Valid<Tags>,
) -> Result<Json<Tags>> {
    vessels::must_be_in_fleet(&app.db, writer.operator, id).await?;
    let mut tags = BTreeSet::new();
    for tag in &given.tags {
        let tag = text("tags", tag)?;
        if tag.chars().count() > MAX_CHARS {
            return Err(invalid(format!(
                "{tag:?} is longer than {MAX_CHARS} characters"
            )));
        }
        tags.insert(tag);
    }
    if tags.len() > MAX_TAGS {
        return Err(invalid(format!("are more than {MAX_TAGS}")));
    }
    let mut tx = request.begin().await?;
    vessels::lock(&mut tx, writer.operator, id).await?;
    execute!(&mut tx, "DELETE FROM vessel_tags WHERE vessel_id = $1", id)?;
    for tag in &tags {
        execute!(
            &mut tx,
            "INSERT INTO vessel_tags (vessel_id, tag) VALUES ($1, $2)",
            id,
            tag.as_str()
        )?;
    }
    tx.commit().await?;
    Ok(Json(Tags { tags }))
}

fn invalid(detail: String) -> Error {
    Error::Invalid {
        field: "tags",
        detail,
    }
}

/// Lists the tags of an operator's vessels in a range of ids.
pub(crate) async fn of_fleet(
    db: &Db,
    operator: OperatorId,
    first: VesselId,
    last: VesselId,
) -> DbResult<Vec<(VesselId, String)>> {
    rows!(
        db,
        (VesselId, String),
        "SELECT t.vessel_id, t.tag FROM vessel_tags t
         JOIN vessels v ON v.id = t.vessel_id
         WHERE v.operator_id = $1 AND v.id BETWEEN $2 AND $3
         ORDER BY t.vessel_id, t.tag",
        operator,
        first,
        last
    )
}
