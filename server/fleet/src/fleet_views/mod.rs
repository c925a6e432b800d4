//! Saved views of the fleet, each user's own, on whatever device.

use axum::extract::{FromRef, State};
use binnacle_platform::access::Caller;
use binnacle_platform::app::App;
use binnacle_platform::audit::RequestContext;
use binnacle_platform::db::{execute, rows};
use binnacle_platform::error::{Error, Problem, Result};
use binnacle_platform::http::{Json, Valid, is_control, text};
use serde::{Deserialize, Serialize};
use std::collections::BTreeMap;
use utoipa::ToSchema;
use utoipa_axum::router::OpenApiRouter;
use utoipa_axum::routes;

/// Maximum number of a user's views.
const MAX_VIEWS: usize = 50;
/// Maximum length of a view's search, characters.
const MAX_SEARCH_CHARS: usize = 1000;

/// Returns the routes.
pub fn router<S>() -> OpenApiRouter<S>
where
    App: FromRef<S>,
    S: Clone + Send + Sync + 'static,
{
    OpenApiRouter::new().routes(routes!(list_views, put_views))
}

/// A saved view.
#[derive(Clone, Debug, Serialize, Deserialize, ToSchema, sqlx::FromRow)]
#[serde(deny_unknown_fields)]
#[schema(as = FleetView, example = json!({ "name": "Tankers", "search": "?tag=tanker" }))]
struct View {
    /// Its name.
    #[schema(min_length = 1, max_length = 200)]
    name: String,
    /// Search, filter and order, as in the address of the dashboard's fleet page.
    #[schema(max_length = 1000)]
    search: String,
}

/// A user's saved views.
#[derive(Debug, Serialize, Deserialize, ToSchema)]
#[serde(deny_unknown_fields)]
#[schema(as = FleetViewList)]
struct ViewList {
    /// In the order of their names; 50 at most.
    items: Vec<View>,
}

/// List your saved views of the fleet
#[utoipa::path(get, path = "/me/fleet-views", tag = "fleet",
    responses((status = 200, body = ViewList), (status = 401, body = Problem)))]
async fn list_views(State(app): State<App>, caller: Caller) -> Result<Json<ViewList>> {
    caller.party()?;
    find(&app, &caller).await
}

/// Save your views of the fleet
///
/// In place of those that were saved.
#[utoipa::path(put, path = "/me/fleet-views", tag = "fleet", request_body = ViewList,
    responses((status = 200, body = ViewList), (status = 401, body = Problem),
              (status = 403, body = Problem), (status = 422, body = Problem)))]
async fn put_views(
    State(app): State<App>,
    request: RequestContext,
    caller: Caller,
    Valid(given): Valid<ViewList>,
) -> Result<Json<ViewList>> {
    caller.party()?;
    caller.must_not_only_read()?;
    if given.items.len() > MAX_VIEWS {
        let detail = format!("are more than {MAX_VIEWS}");
        return Err(Error::Invalid {
            field: "items",
            detail,
        });
    }
    let mut views = BTreeMap::new();
    for view in given.items {
        if view.search.chars().count() > MAX_SEARCH_CHARS {
            return Err(Error::Invalid {
                field: "search",
                detail: format!("is longer than {MAX_SEARCH_CHARS} characters"),
            });
        }
        if view.search.chars().any(is_control) {
            return Err(Error::Invalid {
                field: "search",
                detail: "has control characters".to_owned(),
            });
        }
        let name = text("name", &view.name)?;
        if views.contains_key(&name) {
            return Err(Error::Invalid {
                field: "name",
                detail: format!("{name} stands twice"),
            });
        }
        views.insert(name, view.search);
    }
    let user = caller.user.user_id;
    let mut tx = request.begin().await?;
    // Another browser of the same user waits.
    execute!(&mut tx, "UPDATE users SET name = name WHERE id = $1", user)?;
    execute!(&mut tx, "DELETE FROM fleet_views WHERE user_id = $1", user)?;
    for (name, search) in views {
        execute!(
            &mut tx,
            "INSERT INTO fleet_views (user_id, name, search) VALUES ($1, $2, $3)",
            user,
            name,
            search
        )?;
    }
    tx.commit().await?;
    find(&app, &caller).await
}

async fn find(app: &App, caller: &Caller) -> Result<Json<ViewList>> {
    let items = rows!(
        app.db,
        View,
        "SELECT name, search FROM fleet_views WHERE user_id = $1 ORDER BY name",
        caller.user.user_id
    )?;
    Ok(Json(ViewList { items }))
}
