//! What is done at the berth: the reading, the plan, its steps.

use crate::berth_session::berth_reading::{Read, check, must_be_numbers};
use crate::berth_session::plan::{
    Choice, Planned, calculate, must_be_without_cargo, must_still_hold, offer,
};
use crate::berth_session::planning_inputs::Basis;
use crate::berth_session::position_check;
use crate::berth_session::second_reading::is_explained_by;
use crate::berth_session::steps::{Moved, Stand, StepRead, judge, learn_anew};
use crate::work_orders::log_entry::Content;
use crate::work_orders::order::{Order, State};
use crate::work_orders::order_update;
use crate::work_orders::refusal::not_adjustable;
use crate::work_orders::shown;
use crate::work_orders::store::{self, Whole};
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

/// In which states something is done at the berth; an order that no firm has is read as
/// soon as it is planned.
const AT_BERTH: [State; 4] = [
    State::Planned,
    State::OnBoard,
    State::Measured,
    State::Adjusting,
];

/// The heading at the berth was read, and the reading is credible.
pub struct BerthHeadingRead {
    /// The vessel.
    pub vessel: VesselId,
    /// When.
    pub at: Time,
    /// True heading, degrees.
    pub heading_deg: f64,
}

impl DomainEvent for BerthHeadingRead {}

pub(crate) fn router<S>() -> OpenApiRouter<S>
where
    App: FromRef<S>,
    S: Clone + Send + Sync + 'static,
{
    OpenApiRouter::new()
        .routes(routes!(read_berth))
        .routes(routes!(find_plan, choose_plan))
        .routes(routes!(read_step))
        .routes(routes!(set_correctors))
}

/// Send what was read at the berth
///
/// The unit is named, never guessed. What cannot be true is kept in the log and refused,
/// with the mistakes that would explain it.
#[utoipa::path(post, path = "/work-orders/{id}/berth-reading", tag = "adjusting",
    params(("id" = OrderId, Path), Key), request_body = ReadingForm,
    responses((status = 200, body = Order), (status = 401, body = Problem),
              (status = 403, body = Problem),
              (status = 404, description = "Also when the compass has no model yet", body = Problem),
              (status = 409, description = "Also when the compass has no binnacle yet", body = Problem),
              (status = 422, description = "Also when the reading is refused", body = Problem)))]
async fn read_berth(
    Shared(app): Shared<App>,
    request: RequestContext,
    writer: PartyWriter,
    Id(id): Id<OrderId>,
    key: Key,
    Valid(given): Valid<ReadingForm>,
) -> Result<Json<Order>> {
    let update = order_update(&app, request, writer, id, key, "berth reading", &given)?;
    let (whole, done) = update.look().await?;
    if let Some(entry) = done {
        must_not_be_refused(&whole, entry)?;
        return shown(&app, writer.tenant, id).await;
    }
    must_not_be_moved(&whole)?;
    must_be_numbers(&given, app.clock.now().into())?;
    position_check::must_be_of_now(&given, app.clock.now().into())?;
    let (vessel, compass) = (whole.summary.vessel_id, whole.summary.compass_id);
    let basis = Basis::load(&app, vessel, compass, &given).await?;
    let doubt = position_check::doubt(&app, (vessel, compass), &whole.summary.port, &given).await?;
    let (checked, refusal) = match (check(&given, &basis)?, doubt) {
        (Ok(checked), None) => (Some(checked), None),
        (Ok(_), Some(doubt)) => (None, Some(doubt)),
        (Err(refusal), doubt) => (None, Some(refusal.doubted(doubt))),
    };
    let read = Read {
        given,
        basis: Some(basis),
        checked,
        refusal: refusal.clone(),
    };
    if let Some(mut change) = update.begin(&whole).await? {
        if refusal.is_none() {
            let (at, heading_deg) = (Time(read.given.at), read.given.heading_true_deg);
            let read = BerthHeadingRead {
                vessel,
                at,
                heading_deg,
            };
            change.tx.publish(&read).await?;
        }
        change.append(Content::BerthReading(Box::new(read))).await?;
        change.commit().await?;
    }
    match refusal {
        Some(refusal) => Err(not_adjustable(vec![refusal])),
        None => shown(&app, writer.tenant, id).await,
    }
}

/// A reading that was sent again is refused again.
fn must_not_be_refused(whole: &Whole, entry: Uuid) -> Result<()> {
    let mut found = whole.log.iter().filter(|known| known.id == entry);
    let refusal = found.find_map(|known| match &known.content {
        Content::BerthReading(read) => read.refusal.clone(),
        _ => None,
    });
    refusal.map_or(Ok(()), |refusal| Err(not_adjustable(vec![refusal])))
}

/// The model knows the correctors as they stood: what was moved since spoils a reading.
fn must_not_be_moved(whole: &Whole) -> Result<()> {
    whole.must_be(
        &AT_BERTH,
        "the berth is read between going on board and completion",
    )?;
    if whole.standing().was_moved() {
        return Err(Error::WrongState(
            "correctors were moved since the reading, and the model does not know them so: what \
             the magnetometer reads after the steps is a second reading. To begin again, put \
             them back as they stood, say so under corrector-settings, and read again; or cancel \
             the order, which notes how they stand, and let headings at sea make a model"
                .to_owned(),
        ));
    }
    Ok(())
}

/// See what the planner offers
///
/// From the last reading, and from how the correctors stand now. Nothing is kept.
#[utoipa::path(get, path = "/work-orders/{id}/plan", tag = "adjusting",
    params(("id" = OrderId, Path)),
    responses((status = 200, body = Outcome), (status = 401, body = Problem),
              (status = 404, body = Problem),
              (status = 409, description = "There is no reading to plan from", body = Problem),
              (status = 422, description = "There is no plan, and what would cure that", body = Problem)))]
async fn find_plan(
    Shared(app): Shared<App>,
    reader: PartyReader,
    Id(id): Id<OrderId>,
) -> Result<Json<Outcome>> {
    let whole = store::whole(&app.db, reader.tenant, id).await?;
    whole.must_be(&AT_BERTH, "there is nothing to plan")?;
    let prepared = whole.standing().prepared()?;
    must_still_hold(&app, &whole.summary, &prepared).await?;
    Ok(Json(offer(&app, &whole.summary, prepared).await?))
}

/// Choose a plan
#[utoipa::path(post, path = "/work-orders/{id}/plan", tag = "adjusting",
    params(("id" = OrderId, Path), Key), request_body = Choice,
    responses((status = 200, body = Order), (status = 401, body = Problem),
              (status = 403, body = Problem), (status = 404, body = Problem),
              (status = 409, description = "There is no reading to plan from", body = Problem),
              (status = 422, description = "There is no plan, and what would cure that", body = Problem)))]
async fn choose_plan(
    Shared(app): Shared<App>,
    request: RequestContext,
    writer: PartyWriter,
    Id(id): Id<OrderId>,
    key: Key,
    ValidOrNone(choice): ValidOrNone<Choice>,
) -> Result<Json<Order>> {
    let update = order_update(&app, request, writer, id, key, "plan", &choice)?;
    let (whole, done) = update.look().await?;
    if done.is_some() {
        return shown(&app, writer.tenant, id).await;
    }
    whole.must_be(&AT_BERTH, "there is nothing to plan")?;
    let prepared = whole.standing().prepared()?;
    must_still_hold(&app, &whole.summary, &prepared).await?;
    let outcome = offer(&app, &whole.summary, prepared).await?;
    let offered = outcome.plans.len();
    let planned = Planned::of(outcome, choice.plan.unwrap_or(1));
    let planned = planned.ok_or_else(|| Error::Invalid {
        field: "plan",
        detail: format!("there are plans 1 to {offered}"),
    })?;
    if let Some(mut change) = update.begin(&whole).await? {
        change.append(Content::Plan(Box::new(planned))).await?;
        change.commit().await?;
    }
    shown(&app, writer.tenant, id).await
}

/// Send what the compass reads after a step
///
/// The step is confirmed, or there is a new plan from what was read.
#[utoipa::path(post, path = "/work-orders/{id}/steps/{n}", tag = "adjusting",
    params(("id" = OrderId, Path), ("n" = u32, Path), Key), request_body = StepRead,
    responses((status = 200, body = Order), (status = 401, body = Problem),
              (status = 403, body = Problem), (status = 404, body = Problem),
              (status = 409, description = "It is not the step to do now", body = Problem),
              (status = 422, body = Problem)))]
async fn read_step(
    Shared(app): Shared<App>,
    request: RequestContext,
    writer: PartyWriter,
    Id((id, number)): Id<(OrderId, u32)>,
    key: Key,
    Valid(read): Valid<StepRead>,
) -> Result<Json<Order>> {
    let update = order_update(
        &app,
        request,
        writer,
        id,
        key,
        &format!("step {number}"),
        &read,
    )?;
    let (whole, done) = update.look().await?;
    if done.is_some() {
        return shown(&app, writer.tenant, id).await;
    }
    let standing = whole.standing();
    let wrong = |detail: String| Error::WrongState(detail);
    let next = standing.next_step().cloned();
    let step = next.ok_or_else(|| wrong("there is no step to do now".to_owned()))?;
    if step.number != number {
        return Err(wrong(format!("the step to do now is {}", step.number)));
    }
    let after_deg = degrees("after_deg", read.after_deg, 0.0, 360.0)?;
    let before_deg = read.before_deg.or(standing.compass_deg);
    let before_deg = before_deg.ok_or_else(|| Error::Invalid {
        field: "before_deg",
        detail: "give what the compass read before the step: neither the berth's reading nor a \
                 step before has said so"
            .to_owned(),
    })?;
    degrees("before_deg", before_deg, 0.0, 360.0)?;
    must_lie_still(before_deg, standing.compass_deg)?;
    let prepared = standing.prepared()?;
    must_be_without_cargo(&app, &whole.summary, &prepared).await?;
    let judged = calculate(&app, move || judge(&prepared, step, before_deg, after_deg)).await?;
    if let Some(mut change) = update.begin(&whole).await? {
        change.append(Content::Step(Box::new(judged))).await?;
        change.commit().await?;
    }
    shown(&app, writer.tenant, id).await
}

/// At a berth a compass that nothing was done to turns by no more, degrees.
const LIES_STILL_DEG: f64 = 3.0;

/// What a step turns the compass by is foretold for the heading on which the berth was read.
fn must_lie_still(before_deg: f64, last_deg: Option<f64>) -> Result<()> {
    let Some(last_deg) = last_deg else {
        return Ok(());
    };
    let turned_deg = wrap_180(before_deg - last_deg);
    if turned_deg.abs() <= LIES_STILL_DEG {
        return Ok(());
    }
    Err(Error::Invalid {
        field: "before_deg",
        detail: format!(
            "is {:.1} degrees off the {last_deg:.1} that it read last: read it once more; if the \
             ship has swung, wait until she lies as she did when the berth was read",
            turned_deg.abs()
        ),
    })
}

/// Say how the correctors stand
///
/// When they stand otherwise than the plan has it, there has to be another plan.
#[utoipa::path(post, path = "/work-orders/{id}/corrector-settings", tag = "adjusting",
    params(("id" = OrderId, Path), Key), request_body = Stand,
    responses((status = 200, body = Order), (status = 401, body = Problem),
              (status = 403, body = Problem), (status = 404, body = Problem),
              (status = 409, description = "Not before the berth was read", body = Problem),
              (status = 422, body = Problem)))]
async fn set_correctors(
    Shared(app): Shared<App>,
    request: RequestContext,
    writer: PartyWriter,
    Id(id): Id<OrderId>,
    key: Key,
    Valid(stand): Valid<Stand>,
) -> Result<Json<Order>> {
    let update = order_update(&app, request, writer, id, key, "corrector settings", &stand)?;
    let (whole, done) = update.look().await?;
    if done.is_some() {
        return shown(&app, writer.tenant, id).await;
    }
    let what = "correctors are set between the reading and the completion";
    whole.must_be(&[State::Measured, State::Adjusting], what)?;
    let mut moved = moved(&whole, stand, app.clock.now().into())?;
    moved.learnt_anew = learn_anew(&app, &whole.standing(), &moved).await?;
    moved.explains_reading = is_explained_by(&app, &whole.standing(), &moved).await?;
    if let Some(mut change) = update.begin(&whole).await? {
        let content = Content::CorrectorSettings(Box::new(moved));
        change.append(content).await?;
        change.commit().await?;
    }
    shown(&app, writer.tenant, id).await
}

fn moved(whole: &Whole, stand: Stand, now: binnacle_platform::time::Time) -> Result<Moved> {
    let standing = whole.standing();
    let wrong = || Error::WrongState("the berth has not been read yet".to_owned());
    let binnacle = standing.binnacle.as_ref().ok_or_else(wrong)?;
    binnacle
        .with_setting(stand.setting.clone())
        .map_err(binnacle_fleet::binnacles::invalid_binnacle)?;
    let compass_deg = stand.compass_deg;
    Ok(Moved {
        before: standing.setting().ok_or_else(wrong)?.clone(),
        after: stand.setting,
        compass_deg: compass_deg
            .map(|deg| degrees("compass_deg", deg, 0.0, 360.0))
            .transpose()?,
        note: optional_text("note", stand.note.as_deref())?,
        explains_reading: false,
        learnt_anew: None,
        at: now,
    })
}
