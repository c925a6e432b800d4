//! The fleet's schedule: who adjusts which compass, where and when, kept right as ETAs,
//! needs and answers change.
//!
//! What always holds:
//!
//! - A plan is kept with what it was made from, whole, so that it can be made again to the
//!   byte on the command line; the highest version is current.
//! - Whatever changes what it rests on asks for another one in the same transaction.
//! - Solving holds no transaction, and of two who solve at once the second begins anew.

mod at_risk;
mod concurrency;
mod input;
mod offer;
mod pins;
mod plan;
mod settings;
mod solve;
mod store;
mod subscriber;

mod worker;

pub use concurrency::PlanSlots;
pub use plan::Plan;
pub use settings::terms;
pub use subscriber::{on_particulars_change, on_service_change, on_terms_change, on_vessel_event};
pub use worker::{run, step};

use axum::extract::{FromRef, State};
use axum::http::header::CONTENT_TYPE;
use axum::response::{IntoResponse, Response};
use binnacle_platform::access::{Reader, Writer};
use binnacle_platform::app::App;
use binnacle_platform::audit::RequestContext;
use binnacle_platform::error::{Error, Problem, Result};
use binnacle_platform::http::{Id, Json, Page};
use binnacle_platform::ids::OperatorId;
use binnacle_platform::time::Time;
use serde::Serialize;
use utoipa::ToSchema;
use utoipa_axum::router::OpenApiRouter;
use utoipa_axum::routes;

/// The routes of this part.
pub fn router<S>() -> OpenApiRouter<S>
where
    App: FromRef<S>,
    PlanSlots: FromRef<S>,
    S: Clone + Send + Sync + 'static,
{
    OpenApiRouter::new()
        .routes(routes!(find_schedule))
        .routes(routes!(solve_schedule))
        .routes(routes!(list_plans))
        .routes(routes!(find_schedule_plan))
        .routes(routes!(find_input))
        .merge(offer::router())
        .merge(pins::router())
        .merge(settings::router())
}

/// The current plan, and whether it is still right.
#[derive(Serialize, ToSchema)]
#[schema(as = Schedule)]
struct Current {
    /// The plan; none before the first.
    #[schema(required)]
    plan: Option<Plan>,
    /// Time of the first change that the plan does not know of. A new plan follows automatically.
    #[schema(required)]
    outdated_since: Option<Time>,
    /// Error of the last attempt to make a plan.
    #[schema(required)]
    problem: Option<String>,
}

/// A plan in a line.
#[derive(Serialize, ToSchema)]
#[schema(as = SchedulePlanSummary)]
struct PlanSummary {
    /// Counts the operator's plans from 1.
    version: i64,
    /// Time of creation.
    solved_at: Time,
    /// Cost by the weights, including everything unmet.
    cost_eur: f64,
    /// Distance of the cost from its lower bound, per cent.
    gap_percent: f64,
    /// Fees and travel that are really paid.
    paid_eur: f64,
    /// Jobs in it.
    jobs: usize,
    /// Number of needs that are not scheduled, or only late.
    unscheduled: usize,
    /// Jobs of the plan before that moved or were dropped.
    moved: usize,
}

/// A page of plans.
#[derive(Serialize, ToSchema)]
#[schema(as = SchedulePlanList)]
struct PlanList {
    /// The newest first; the last thirty are kept.
    items: Vec<PlanSummary>,
    /// `after` of the next page.
    #[schema(required)]
    next: Option<String>,
}

/// See the current schedule
#[utoipa::path(get, path = "/schedule", tag = "adjusting",
    responses((status = 200, body = Current), (status = 401, body = Problem)))]
async fn find_schedule(State(app): State<App>, reader: Reader) -> Result<Json<Current>> {
    let plan = store::current(&app.db, reader.operator).await?;
    current(&app, reader.operator, plan).await
}

async fn current(app: &App, operator: OperatorId, plan: Option<Plan>) -> Result<Json<Current>> {
    let asks = store::asks(&app.db, operator).await?;
    Ok(Json(Current {
        plan,
        outdated_since: asks.first().map(|(_, at)| *at),
        problem: store::last_error(&app.db, operator).await?,
    }))
}

/// Make the schedule anew, now
///
/// It is made by itself half a minute after something has changed; this waits for it. When
/// nothing has changed within the hour the plan stays as it is.
#[utoipa::path(post, path = "/schedule/solve", tag = "adjusting",
    responses((status = 200, body = Current), (status = 401, body = Problem),
              (status = 403, body = Problem),
              (status = 409, description = "Others make it at the same time, or the fleet is too large", body = Problem)))]
async fn solve_schedule(
    State(app): State<App>,
    State(slots): State<PlanSlots>,
    request: RequestContext,
    writer: Writer,
) -> Result<Json<Current>> {
    let plan = solve::solve(&app, &request, &slots, writer.operator).await?;
    current(&app, writer.operator, Some(plan)).await
}

/// List the last plans
#[utoipa::path(get, path = "/schedule/plans", tag = "adjusting", params(Page),
    responses((status = 200, body = PlanList), (status = 401, body = Problem)))]
async fn list_plans(State(app): State<App>, reader: Reader, page: Page) -> Result<Json<PlanList>> {
    let before = page.after_number()?;
    let found = store::versions(&app.db, reader.operator, before, page.fetch()).await?;
    let listed = page.cut(found, |plan| plan.version.to_string());
    Ok(Json(PlanList {
        items: listed.items.iter().map(PlanSummary::of).collect(),
        next: listed.next,
    }))
}

/// See one of the last plans
#[utoipa::path(get, path = "/schedule/plans/{version}", tag = "adjusting",
    params(("version" = i64, Path)),
    responses((status = 200, body = Plan), (status = 401, body = Problem),
              (status = 404, body = Problem)))]
async fn find_schedule_plan(
    State(app): State<App>,
    reader: Reader,
    Id(version): Id<i64>,
) -> Result<Json<Plan>> {
    let plan = store::find(&app.db, reader.operator, version).await?;
    Ok(Json(plan.ok_or(Error::NotFound("plan"))?))
}

/// See what the current plan was made from
///
/// As `binnacle-server schedule --input` reads it, which makes the same plan of it.
#[utoipa::path(get, path = "/schedule/input", tag = "adjusting",
    responses((status = 200, content_type = "application/json", body = Object),
              (status = 401, body = Problem),
              (status = 404, description = "There is no plan yet", body = Problem)))]
async fn find_input(State(app): State<App>, reader: Reader) -> Result<Response> {
    let input = store::input(&app.db, reader.operator).await?;
    let input = input.ok_or(Error::NotFound("plan"))?;
    Ok(([(CONTENT_TYPE, "application/json")], input).into_response())
}

impl PlanSummary {
    fn of(plan: &Plan) -> PlanSummary {
        PlanSummary {
            version: plan.version,
            solved_at: plan.solved_at,
            cost_eur: plan.cost_eur,
            gap_percent: plan.gap_percent,
            paid_eur: plan.paid_eur,
            jobs: plan.jobs.len(),
            unscheduled: plan.unscheduled.len(),
            moved: plan.against.map_or(0, |against| against.moved),
        }
    }
}
