//! Second reading of the magnetometer, after the steps: it confirms the correctors even if the
//! compass cannot show them on the berth's heading.
//!
//! Invariants: the reading is optional, and its result is kept. One that confirms the plan updates
//! the model and the residuals. One that does not blocks completion until the field is read as
//! predicted, a plan is made from this reading, or other settings are reported.

use crate::berth_session::berth_reading::check_reading_ranges;
use crate::berth_session::plan::require_current_reading;
use crate::berth_session::plan_slots::CorrectorPlanSlots;
use crate::berth_session::second_reading::{SecondReading, as_first_reading};
use crate::berth_session::steps::require_after_last_step;
use crate::work_orders::events::OrderEvent;
use crate::work_orders::order::Order;
use crate::work_orders::order_state::OrderState;
use crate::work_orders::payload::recorded_second_reading::PARTS_WITH_VERTICAL;
use crate::work_orders::state::State;
use crate::work_orders::{load_order, prepare_update};
use axum::extract::{FromRef, State as Shared};
use binnacle_adjustment::adjust::{ReadingForm, SecondReadingForm};
use binnacle_platform::access::PartyWriter;
use binnacle_platform::app::App;
use binnacle_platform::audit::RequestContext;
use binnacle_platform::error::{Error, Problem, Result};
use binnacle_platform::http::{Id, Json, Valid};
use binnacle_platform::idempotency::Key;
use binnacle_platform::ids::OrderId;
use utoipa_axum::router::OpenApiRouter;
use utoipa_axum::routes;

pub(crate) fn router<S>() -> OpenApiRouter<S>
where
    App: FromRef<S>,
    CorrectorPlanSlots: FromRef<S>,
    S: Clone + Send + Sync + 'static,
{
    OpenApiRouter::new().routes(routes!(read_field_again))
}

/// Send the magnetometer reading after the steps
///
/// It finds slips that the compass cannot show on the berth's heading. It is optional: without it
/// such a slip can only be found at sea.
#[utoipa::path(post, path = "/work-orders/{id}/second-reading", tag = "adjusting",
    params(("id" = OrderId, Path), Key), request_body = SecondReadingForm,
    responses((status = 200, body = Order), (status = 401, body = Problem),
              (status = 403, body = Problem), (status = 404, body = Problem),
              (status = 409, description = "A step is not done, or nothing was moved", body = Problem),
              (status = 422, body = Problem)))]
async fn read_field_again(
    Shared(app): Shared<App>,
    Shared(slots): Shared<CorrectorPlanSlots>,
    request: RequestContext,
    writer: PartyWriter,
    Id(id): Id<OrderId>,
    key: Key,
    Valid(given): Valid<SecondReadingForm>,
) -> Result<Json<Order>> {
    let update = prepare_update(&app, request, writer, id, key, "second reading", &given)?;
    let (stored, done) = update.load().await?;
    if done.is_some() {
        return load_order(&app, writer.tenant, id).await;
    }
    let mut state = stored.state();
    state.restore_first_reading();
    require_steps_done(&state)?;
    let plan_request = state.plan_request()?;
    require_current_reading(&app, &stored.summary, &plan_request).await?;
    let second = SecondReading::new(given, &plan_request)?;
    let form = second.form.clone();
    check_reading_ranges(&form, app.clock.now().into())?;
    require_after_last_step(&stored, form.at.into())?;
    require_vertical_part(&state, &form)?;
    // A slip is only suspected in steps that nobody has inspected since.
    let inspected_steps = state.inspected_steps;
    let steps = state.steps[inspected_steps..].to_vec();
    let planned = state.plan.is_some();
    let judge = move || second.judge(&plan_request, &steps, inspected_steps, planned);
    let (mut judged, basis) = slots.run(judge).await?;
    judged.reading_to_plan_from = basis
        .map(|basis| as_first_reading(basis, form))
        .transpose()?;
    if let Some(mut change) = update.begin(&stored).await? {
        change
            .append(OrderEvent::SecondReading(Box::new(judged)))
            .await?;
        change.commit().await?;
    }
    load_order(&app, writer.tenant, id).await
}

fn require_steps_done(state: &OrderState) -> Result<()> {
    if let Some(step) = state.next_step() {
        let number = step.number;
        return Err(Error::WrongState(format!("step {number} is not done")));
    }
    let is_moved = state.state == State::Measured && state.has_moved_correctors();
    if state.state == State::Adjusting || is_moved {
        return Ok(());
    }
    Err(Error::WrongState(
        "no corrector was moved since the berth was read".to_owned(),
    ))
}

/// Refuses a reading without the part of the field that contradicted the steps.
fn require_vertical_part(state: &OrderState, form: &ReadingForm) -> Result<()> {
    let contradiction = state.contradicting_reading();
    let was_whole =
        contradiction.is_some_and(|second| second.result.parts.len() == PARTS_WITH_VERTICAL);
    if form.down.is_some() || !was_whole {
        return Ok(());
    }
    Err(Error::Invalid {
        field: "down",
        detail: "is required: the last reading did not confirm the steps, and had a vertical part"
            .to_owned(),
    })
}
