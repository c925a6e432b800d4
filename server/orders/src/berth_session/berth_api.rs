//! Handlers of the berth session: reading, plan, steps and corrector settings.

use crate::berth_session::as_found::{require_as_found, require_record_as_found};
use crate::berth_session::berth_reading::{check, check_reading_ranges};
use crate::berth_session::plan::{
    PlanChoice, offer_plans, refuse_magnetic_cargo, require_current_reading,
};
use crate::berth_session::plan_slots::CorrectorPlanSlots;
use crate::berth_session::position_check;
use crate::berth_session::second_reading::explains_second_reading;
use crate::berth_session::steps::{CorrectorReport, StepReading, judge, revise_strength};
use crate::work_orders::events::{CorrectorMove, OrderEvent};
use crate::work_orders::order::Order;
use crate::work_orders::payload::chosen_plan::ChosenPlan;
use crate::work_orders::payload::plan_basis::Basis;
use crate::work_orders::payload::recorded_reading::RecordedReading;
use crate::work_orders::refusal::not_adjustable;
use crate::work_orders::state::State;
use crate::work_orders::store::StoredOrder;
use crate::work_orders::{load_order, prepare_update, store};
use axum::extract::{FromRef, State as Shared};
use binnacle_adjustment::adjust::{Outcome, ReadingForm};
use binnacle_compass::angle::wrap_180;
use binnacle_platform::access::{PartyReader, PartyWriter};
use binnacle_platform::app::App;
use binnacle_platform::audit::RequestContext;
use binnacle_platform::db::DomainEvent;
use binnacle_platform::error::{Error, Problem, Result};
use binnacle_platform::http::{Id, Json, Valid, ValidOrNone, degrees, optional_text};
use binnacle_platform::idempotency::Key;
use binnacle_platform::ids::{OrderId, VesselId};
use binnacle_platform::time::Time;
use utoipa_axum::router::OpenApiRouter;
use utoipa_axum::routes;
use uuid::Uuid;

/// States in which a berth session may take place. An order without a firm may be measured as
/// soon as it is planned.
pub(crate) const BERTH_STATES: [State; 4] = [
    State::Planned,
    State::OnBoard,
    State::Measured,
    State::Adjusting,
];

/// Credible reading of the heading at the berth.
pub struct BerthHeadingRead {
    /// The vessel.
    pub vessel: VesselId,
    /// Time of the reading.
    pub at: Time,
    /// True heading, degrees.
    pub heading_deg: f64,
}

impl DomainEvent for BerthHeadingRead {}

pub(crate) fn router<S>() -> OpenApiRouter<S>
where
    App: FromRef<S>,
    CorrectorPlanSlots: FromRef<S>,
    S: Clone + Send + Sync + 'static,
{
    OpenApiRouter::new()
        .routes(routes!(read_berth))
        .routes(routes!(find_plan, choose_plan))
        .routes(routes!(read_step))
        .routes(routes!(set_correctors))
}

/// Send the reading at the berth
///
/// The unit is named, never guessed. An implausible reading is kept in the log and refused, with
/// the mistakes that would explain it.
#[utoipa::path(post, path = "/work-orders/{id}/berth-reading", tag = "adjusting",
    params(("id" = OrderId, Path), Key), request_body = ReadingForm,
    responses((status = 200, body = Order), (status = 401, body = Problem),
              (status = 403, body = Problem),
              (status = 404, description = "Also when the compass has no model yet", body = Problem),
              (status = 409, description = "Also when the compass has no binnacle yet, or its record was changed after the correctors were confirmed as found", body = Problem),
              (status = 422, description = "Also when the reading is refused", body = Problem)))]
async fn read_berth(
    Shared(app): Shared<App>,
    request: RequestContext,
    writer: PartyWriter,
    Id(id): Id<OrderId>,
    key: Key,
    Valid(given): Valid<ReadingForm>,
) -> Result<Json<Order>> {
    let update = prepare_update(&app, request, writer, id, key, "berth reading", &given)?;
    let (stored, done) = update.load().await?;
    if let Some(entry) = done {
        repeat_refusal(&stored, entry)?;
        return load_order(&app, writer.tenant, id).await;
    }
    refuse_moved_correctors(&stored)?;
    check_reading_ranges(&given, app.clock.now().into())?;
    position_check::check_reading_age(&given, app.clock.now().into())?;
    let (vessel, compass) = (stored.summary.vessel_id, stored.summary.compass_id);
    let basis = Basis::load(&app, vessel, compass, &given).await?;
    require_record_as_found(&stored.state(), &basis.binnacle)?;
    let implausible_position =
        position_check::check_position(&app, &stored.summary, &given).await?;
    let (checked, refusal) = match (check(&given, &basis)?, implausible_position) {
        (Ok(checked), None) => (Some(checked), None),
        (Ok(_), Some(implausible_position)) => (None, Some(implausible_position)),
        (Err(refusal), implausible_position) => {
            (None, Some(refusal.with_cause(implausible_position)))
        }
    };
    let read = RecordedReading {
        given,
        basis: Some(basis),
        checked,
        refusal: refusal.clone(),
    };
    if let Some(mut change) = update.begin(&stored).await? {
        if refusal.is_none() {
            let (at, heading_deg) = (Time(read.given.at), read.given.heading_true_deg);
            let read = BerthHeadingRead {
                vessel,
                at,
                heading_deg,
            };
            change.tx.publish(&read).await?;
        }
        change
            .append(OrderEvent::BerthReading(Box::new(read)))
            .await?;
        change.commit().await?;
    }
    match refusal {
        Some(refusal) => Err(not_adjustable(vec![refusal])),
        None => load_order(&app, writer.tenant, id).await,
    }
}

/// Refuses a reading again that is sent a second time.
fn repeat_refusal(stored: &StoredOrder, entry: Uuid) -> Result<()> {
    let mut found = stored.log.iter().filter(|known| known.id == entry);
    let refusal = found.find_map(|known| match &known.content {
        OrderEvent::BerthReading(read) => read.refusal.clone(),
        _ => None,
    });
    refusal.map_or(Ok(()), |refusal| Err(not_adjustable(vec![refusal])))
}

/// Refuses a reading after correctors were moved: the model describes their earlier settings.
fn refuse_moved_correctors(stored: &StoredOrder) -> Result<()> {
    stored.require_state(
        &BERTH_STATES,
        "the berth is read between going on board and completion",
    )?;
    if stored.state().has_moved_correctors() {
        return Err(Error::WrongState(
            "correctors were moved since the reading, and the model does not describe their \
                present settings: a reading of the magnetometer after the steps is a second \
                reading. To start over, put the correctors back, report this under \
                corrector-settings, and read again; or cancel the order, which records their \
                settings, and order the adjustment anew"
                .to_owned(),
        ));
    }
    Ok(())
}

/// See the available plans
///
/// Based on the last reading and the present settings of the correctors. Nothing is stored.
#[utoipa::path(get, path = "/work-orders/{id}/plan", tag = "adjusting",
    params(("id" = OrderId, Path)),
    responses((status = 200, body = Outcome), (status = 401, body = Problem),
              (status = 404, body = Problem),
              (status = 409, description = "There is no reading to plan from, or the correctors are not confirmed as found", body = Problem),
              (status = 422, description = "There is no plan; the refusals name the cures", body = Problem)))]
async fn find_plan(
    Shared(app): Shared<App>,
    Shared(slots): Shared<CorrectorPlanSlots>,
    reader: PartyReader,
    Id(id): Id<OrderId>,
) -> Result<Json<Outcome>> {
    let stored = store::find(&app.db, reader.tenant, id).await?;
    stored.require_state(&BERTH_STATES, "there is nothing to plan")?;
    let state = stored.state();
    let plan_request = state.plan_request()?;
    require_as_found(&state)?;
    require_current_reading(&app, &stored.summary, &plan_request).await?;
    Ok(Json(
        offer_plans(&app, &slots, &stored.summary, plan_request).await?,
    ))
}

/// Choose a plan
#[utoipa::path(post, path = "/work-orders/{id}/plan", tag = "adjusting",
    params(("id" = OrderId, Path), Key), request_body = PlanChoice,
    responses((status = 200, body = Order), (status = 401, body = Problem),
              (status = 403, body = Problem), (status = 404, body = Problem),
              (status = 409, description = "There is no reading to plan from, or the correctors are not confirmed as found", body = Problem),
              (status = 422, description = "There is no plan; the refusals name the cures", body = Problem)))]
async fn choose_plan(
    Shared(app): Shared<App>,
    Shared(slots): Shared<CorrectorPlanSlots>,
    request: RequestContext,
    writer: PartyWriter,
    Id(id): Id<OrderId>,
    key: Key,
    ValidOrNone(choice): ValidOrNone<PlanChoice>,
) -> Result<Json<Order>> {
    let update = prepare_update(&app, request, writer, id, key, "plan", &choice)?;
    let (stored, done) = update.load().await?;
    if done.is_some() {
        return load_order(&app, writer.tenant, id).await;
    }
    stored.require_state(&BERTH_STATES, "there is nothing to plan")?;
    let state = stored.state();
    let plan_request = state.plan_request()?;
    require_as_found(&state)?;
    require_current_reading(&app, &stored.summary, &plan_request).await?;
    let outcome = offer_plans(&app, &slots, &stored.summary, plan_request).await?;
    let offered = outcome.plans.len();
    let planned = ChosenPlan::from_outcome(outcome, choice.plan.unwrap_or(1));
    let planned = planned.ok_or_else(|| Error::Invalid {
        field: "plan",
        detail: format!("there are plans 1 to {offered}"),
    })?;
    if let Some(mut change) = update.begin(&stored).await? {
        change.append(OrderEvent::Plan(Box::new(planned))).await?;
        change.commit().await?;
    }
    load_order(&app, writer.tenant, id).await
}

/// Send the compass reading after a step
///
/// The step is confirmed, or a new plan follows from the reading.
#[utoipa::path(post, path = "/work-orders/{id}/steps/{n}", tag = "adjusting",
    params(("id" = OrderId, Path), ("n" = u32, Path), Key), request_body = StepReading,
    responses((status = 200, body = Order), (status = 401, body = Problem),
              (status = 403, body = Problem), (status = 404, body = Problem),
              (status = 409, description = "It is not the next step", body = Problem),
              (status = 422, body = Problem)))]
async fn read_step(
    Shared(app): Shared<App>,
    Shared(slots): Shared<CorrectorPlanSlots>,
    request: RequestContext,
    writer: PartyWriter,
    Id((id, number)): Id<(OrderId, u32)>,
    key: Key,
    Valid(read): Valid<StepReading>,
) -> Result<Json<Order>> {
    let update = prepare_update(
        &app,
        request,
        writer,
        id,
        key,
        &format!("step {number}"),
        &read,
    )?;
    let (stored, done) = update.load().await?;
    if done.is_some() {
        return load_order(&app, writer.tenant, id).await;
    }
    let state = stored.state();
    let wrong = |detail: String| Error::WrongState(detail);
    let next = state.next_step().cloned();
    let step = next.ok_or_else(|| wrong("there is no step to do now".to_owned()))?;
    if step.number != number {
        return Err(wrong(format!("the step to do now is {}", step.number)));
    }
    let after_deg = degrees("after_deg", read.after_deg, 0.0, 360.0)?;
    let before_deg = read.before_deg.or(state.compass_deg);
    let before_deg = before_deg.ok_or_else(|| Error::Invalid {
        field: "before_deg",
        detail: "is required: neither the berth reading nor an earlier step gives the compass \
            reading before this step"
            .to_owned(),
    })?;
    degrees("before_deg", before_deg, 0.0, 360.0)?;
    require_still_compass(before_deg, state.compass_deg)?;
    let plan_request = state.plan_request()?;
    refuse_magnetic_cargo(&app, &stored.summary, &plan_request).await?;
    let judged = slots
        .run(move || judge(&plan_request, step, before_deg, after_deg))
        .await?;
    if let Some(mut change) = update.begin(&stored).await? {
        change.append(OrderEvent::Step(Box::new(judged))).await?;
        change.commit().await?;
    }
    load_order(&app, writer.tenant, id).await
}

/// Largest turn of a compass at the berth without an action, degrees.
const STILL_TOLERANCE_DEG: f64 = 3.0;

/// Refuses a first reading that differs from the last one: predicted turns hold for the heading
/// of the berth reading alone.
fn require_still_compass(before_deg: f64, last_deg: Option<f64>) -> Result<()> {
    let Some(last_deg) = last_deg else {
        return Ok(());
    };
    let turned_deg = wrap_180(before_deg - last_deg);
    if turned_deg.abs() <= STILL_TOLERANCE_DEG {
        return Ok(());
    }
    Err(Error::Invalid {
        field: "before_deg",
        detail: format!(
            "is {:.1} degrees off the last reading of {last_deg:.1}: read it again; if the ship \
                has swung, wait until it lies as at the berth reading",
            turned_deg.abs()
        ),
    })
}

/// Report the settings of the correctors
///
/// Settings other than the plan's require a new plan.
#[utoipa::path(post, path = "/work-orders/{id}/corrector-settings", tag = "adjusting",
    params(("id" = OrderId, Path), Key), request_body = CorrectorReport,
    responses((status = 200, body = Order), (status = 401, body = Problem),
              (status = 403, body = Problem), (status = 404, body = Problem),
              (status = 409, description = "Not before the berth was read", body = Problem),
              (status = 422, body = Problem)))]
async fn set_correctors(
    Shared(app): Shared<App>,
    Shared(slots): Shared<CorrectorPlanSlots>,
    request: RequestContext,
    writer: PartyWriter,
    Id(id): Id<OrderId>,
    key: Key,
    Valid(report): Valid<CorrectorReport>,
) -> Result<Json<Order>> {
    let update = prepare_update(
        &app,
        request,
        writer,
        id,
        key,
        "corrector settings",
        &report,
    )?;
    let (stored, done) = update.load().await?;
    if done.is_some() {
        return load_order(&app, writer.tenant, id).await;
    }
    let what = "correctors are set between the reading and the completion";
    stored.require_state(&[State::Measured, State::Adjusting], what)?;
    let mut report = corrector_move(&stored, report, app.clock.now().into())?;
    report.revised_strength = revise_strength(&slots, &stored.state(), &report).await?;
    report.explains_reading = explains_second_reading(&slots, &stored.state(), &report).await?;
    if let Some(mut change) = update.begin(&stored).await? {
        let content = OrderEvent::CorrectorSettings(Box::new(report));
        change.append(content).await?;
        change.commit().await?;
    }
    load_order(&app, writer.tenant, id).await
}

fn corrector_move(
    stored: &StoredOrder,
    report: CorrectorReport,
    now: binnacle_platform::time::Time,
) -> Result<CorrectorMove> {
    let state = stored.state();
    let wrong = || Error::WrongState("the berth has not been read yet".to_owned());
    let binnacle = state.binnacle.as_ref().ok_or_else(wrong)?;
    binnacle
        .with_setting(report.setting.clone())
        .map_err(binnacle_fleet::binnacles::invalid_binnacle)?;
    let compass_deg = report.compass_deg;
    Ok(CorrectorMove {
        before: state.setting().ok_or_else(wrong)?.clone(),
        after: report.setting,
        compass_deg: compass_deg
            .map(|deg| degrees("compass_deg", deg, 0.0, 360.0))
            .transpose()?,
        note: optional_text("note", report.note.as_deref())?,
        explains_reading: false,
        revised_strength: None,
        at: now,
    })
}
