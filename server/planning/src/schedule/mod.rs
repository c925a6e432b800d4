//! The fleet's schedule: firm, port call and day of each adjustment, updated as ETAs, needs and
//! orders change.
//!
//! Invariants:
//!
//! - A plan is stored with its whole input, so that the command line reproduces it to the byte.
//!   The highest version is current.
//! - A change to the input requests a new schedule in the same transaction.
//! - Solving holds no transaction. Of two concurrent solvers the second starts over.

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

/// Returns the routes of this part.
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

/// The current plan and its state.
#[derive(Serialize, ToSchema)]
#[schema(as = Schedule)]
struct CurrentSchedule {
    /// The plan; `null` before the first.
    #[schema(required)]
    plan: Option<Plan>,
    /// Time of the first change since the plan. A new plan follows automatically.
    #[schema(required)]
    outdated_since: Option<Time>,
    /// Error of the last attempt to make a plan.
    #[schema(required)]
    problem: Option<String>,
}

/// Summary of a plan.
#[derive(Serialize, ToSchema)]
#[schema(as = SchedulePlanSummary)]
struct PlanSummary {
    /// Version, counted from 1 for each operator.
    version: i64,
    /// Time of creation.
    solved_at: Time,
    /// Cost by the weights, including unmet needs.
    cost_eur: f64,
    /// Distance of the cost from its lower bound, per cent.
    gap_percent: f64,
    /// Fees and travel to be paid.
    paid_eur: f64,
    /// Number of jobs.
    jobs: usize,
    /// Number of needs that are not scheduled, or only late.
    unscheduled: usize,
    /// Number of jobs of the previous plan that moved or were dropped.
    moved: usize,
}

/// A page of plans.
#[derive(Serialize, ToSchema)]
#[schema(as = SchedulePlanList)]
struct PlanList {
    /// Plans, the newest first; the last thirty are kept.
    items: Vec<PlanSummary>,
    /// `after` of the next page.
    #[schema(required)]
    next: Option<String>,
}

/// See the current schedule
#[utoipa::path(get, path = "/schedule", tag = "adjusting",
    responses((status = 200, body = CurrentSchedule), (status = 401, body = Problem)))]
async fn find_schedule(State(app): State<App>, reader: Reader) -> Result<Json<CurrentSchedule>> {
    let plan = store::find_current(&app.db, reader.operator).await?;
    describe_plan(&app, reader.operator, plan).await
}

async fn describe_plan(
    app: &App,
    operator: OperatorId,
    plan: Option<Plan>,
) -> Result<Json<CurrentSchedule>> {
    let requests = store::list_requests(&app.db, operator).await?;
    Ok(Json(CurrentSchedule {
        plan,
        outdated_since: requests.first().map(|(_, at)| *at),
        problem: store::find_last_error(&app.db, operator).await?,
    }))
}

/// Make a new schedule now
///
/// The schedule is made automatically half a minute after a change; this request makes it at once
/// and waits for it. Without a change within the hour the plan stays.
#[utoipa::path(post, path = "/schedule/solve", tag = "adjusting",
    responses((status = 200, body = CurrentSchedule), (status = 401, body = Problem),
              (status = 403, body = Problem),
              (status = 409, description = "It is being made by others, or the fleet is too large", body = Problem)))]
async fn solve_schedule(
    State(app): State<App>,
    State(slots): State<PlanSlots>,
    request: RequestContext,
    writer: Writer,
) -> Result<Json<CurrentSchedule>> {
    let plan = solve::solve(&app, &request, &slots, writer.operator).await?;
    describe_plan(&app, writer.operator, Some(plan)).await
}

/// List the last plans
#[utoipa::path(get, path = "/schedule/plans", tag = "adjusting", params(Page),
    responses((status = 200, body = PlanList), (status = 401, body = Problem)))]
async fn list_plans(State(app): State<App>, reader: Reader, page: Page) -> Result<Json<PlanList>> {
    let before = page.after_number()?;
    let found = store::list(&app.db, reader.operator, before, page.fetch()).await?;
    let listed = page.cut(found, |plan| plan.version.to_string());
    Ok(Json(PlanList {
        items: listed.items.iter().map(PlanSummary::new).collect(),
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
    let plan = store::find_version(&app.db, reader.operator, version).await?;
    Ok(Json(plan.ok_or(Error::NotFound("plan"))?))
}

/// See the input of the current plan
///
/// `binnacle-server schedule --input` makes the same plan of it.
#[utoipa::path(get, path = "/schedule/input", tag = "adjusting",
    responses((status = 200, content_type = "application/json", body = Object),
              (status = 401, body = Problem),
              (status = 404, description = "There is no plan yet", body = Problem)))]
async fn find_input(State(app): State<App>, reader: Reader) -> Result<Response> {
    let input = store::find_input(&app.db, reader.operator).await?;
    let input = input.ok_or(Error::NotFound("plan"))?;
    Ok(([(CONTENT_TYPE, "application/json")], input).into_response())
}

impl PlanSummary {
    fn new(plan: &Plan) -> PlanSummary {
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
