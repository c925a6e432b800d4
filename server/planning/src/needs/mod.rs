//! Adjustment needs: due dates of compasses and their causes.
//!
//! Invariants: a need is computed on each request from stored data. Only the history of the
//! deviation at the vessel's position is stored. The rules belong to `binnacle_schedule`.

mod facts;
mod load;
mod need;
mod order;
mod over_limit_since;
mod prediction;

pub use facts::Facts;
pub use load::{load_facts, store_deviation_histories};
pub use need::{Need, find_need};

use crate::schedule_settings;
use axum::extract::{FromRef, State};
use binnacle_fleet::vessels;
use binnacle_platform::access::Reader;
use binnacle_platform::app::App;
use binnacle_platform::error::{Problem, Result};
use binnacle_platform::http::{Id, Json, Page, Params};
use binnacle_platform::ids::{CompassId, OperatorId, VesselId};
use need::{Filter, NeedList, day_number};
use utoipa_axum::router::OpenApiRouter;
use utoipa_axum::routes;

/// Returns the routes of this part.
pub fn router<S>() -> OpenApiRouter<S>
where
    App: FromRef<S>,
    S: Clone + Send + Sync + 'static,
{
    OpenApiRouter::new()
        .routes(routes!(list_needs))
        .routes(routes!(list_vessel_needs))
}

/// List the fleet's needs
///
/// Date by which the rules for the vessel require each compass to be adjusted. Deviation
/// predicted over a limit, a change of the ship's magnetism, or an adjustment that headings
/// at sea do not confirm brings it forward.
#[utoipa::path(get, path = "/needs", tag = "adjusting", params(Filter, Page),
    responses((status = 200, body = NeedList), (status = 401, body = Problem)))]
async fn list_needs(
    State(app): State<App>,
    reader: Reader,
    Params(filter): Params<Filter>,
    page: Page,
) -> Result<Json<NeedList>> {
    list_page(&app, reader.operator, None, &filter, &page).await
}

/// List a vessel's needs
#[utoipa::path(get, path = "/vessels/{id}/needs", tag = "adjusting",
    params(("id" = VesselId, Path), Filter, Page),
    responses((status = 200, body = NeedList), (status = 401, body = Problem),
              (status = 404, body = Problem)))]
async fn list_vessel_needs(
    State(app): State<App>,
    reader: Reader,
    Id(vessel): Id<VesselId>,
    Params(filter): Params<Filter>,
    page: Page,
) -> Result<Json<NeedList>> {
    vessels::must_be_in_fleet(&app.db, reader.operator, vessel).await?;
    list_page(&app, reader.operator, Some(vessel), &filter, &page).await
}

async fn list_page(
    app: &App,
    operator: OperatorId,
    vessel: Option<VesselId>,
    filter: &Filter,
    page: &Page,
) -> Result<Json<NeedList>> {
    let after = page.after_time()?.map(|(day, id)| (day, CompassId(id)));
    let facts = load_facts(app, operator, vessel).await?;
    let terms = schedule_settings::terms(&app.db, operator).await?;
    let today = app.clock.now().to_chrono().date_naive();
    let mut needs: Vec<Need> = facts
        .iter()
        .filter_map(|facts| find_need(facts, &terms, today))
        .filter(|need| filter.urgency.is_none_or(|only| need.urgency == only))
        .filter(|need| filter.due_by.is_none_or(|last| need.due_on <= last))
        .filter(|need| after.is_none_or(|after| (day_number(need.due_on), need.compass_id) > after))
        .collect();
    needs.sort_by_key(|need| (need.due_on, need.compass_id));
    let listed = page.cut(needs, Need::cursor);
    Ok(Json(NeedList {
        items: listed.items,
        next: listed.next,
    }))
}
