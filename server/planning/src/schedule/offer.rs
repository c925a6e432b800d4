//! `/schedule/offer`: work orders for a planned job, offered to its firm.
//!
//! Invariants: a compass has one order under way at a time. A firm gets no job for whose hours it
//! has no team. A job is offered whole or not at all, and the fees of its orders add up to
//! the job's fee in the plan.

use super::plan::{Job, Plan};
use super::store;
use axum::extract::{FromRef, State};
use axum::http::StatusCode;
use binnacle_orders::api;
use binnacle_orders::dispatch;
use binnacle_orders::firms::{self, Terms};
use binnacle_orders::work_orders::{self, NewOffer, NewOrder};
use binnacle_platform::access::Writer;
use binnacle_platform::app::App;
use binnacle_platform::audit::RequestContext;
use binnacle_platform::error::{Error, Problem, Result};
use binnacle_platform::http::{Json, Valid, optional_text};
use binnacle_platform::ids::{CompassId, FirmId, OrderId};
use binnacle_schedule::input::JobState;
use serde::{Deserialize, Serialize};
use std::collections::BTreeMap;
use utoipa::ToSchema;
use utoipa_axum::router::OpenApiRouter;
use utoipa_axum::routes;

pub(super) fn router<S>() -> OpenApiRouter<S>
where
    App: FromRef<S>,
    S: Clone + Send + Sync + 'static,
{
    OpenApiRouter::new().routes(routes!(offer_job))
}

/// A planned job to be offered to its firm.
#[derive(Clone, Debug, Deserialize, ToSchema)]
#[serde(deny_unknown_fields)]
#[schema(as = NewScheduleOffer, example = json!({
    "version": 7, "compass_id": "0199aa00-0000-7000-8000-000000000002",
    "answer_within_hours": 48, "text": "Two compasses; gangway on the starboard side."
}))]
struct NewScheduleOffer {
    /// Version of the plan that the offer is based on; a newer one may differ.
    version: i64,
    /// A compass of the job; the job's other compasses are offered too.
    compass_id: CompassId,
    /// Time for the firm to reply, 1 to 720 hours; 48 by default.
    #[schema(minimum = 1, maximum = 720)]
    answer_within_hours: Option<u32>,
    /// Firms to offer it to next, in this order, when the firm declines or does not reply.
    #[serde(default)]
    then: Vec<FirmId>,
    /// Message to the firms.
    #[schema(max_length = 200)]
    text: Option<String>,
}

/// Orders that were offered.
#[derive(Serialize, ToSchema)]
#[schema(as = ScheduleOffered)]
struct Offered {
    /// One order for each compass of the job.
    orders: Vec<OfferedOrder>,
}

/// An order that was offered.
#[derive(Serialize, ToSchema)]
#[schema(as = ScheduleOfferedOrder)]
struct OfferedOrder {
    /// The order.
    order_id: OrderId,
    /// The compass.
    compass_id: CompassId,
}

/// Offer a planned job to its firm
///
/// Creates a work order for each compass of the job. From then on the plan keeps the job in place
/// unless there is cause to move it. An order that every firm declined is cancelled.
#[utoipa::path(post, path = "/schedule/offer", tag = "adjusting", request_body = NewScheduleOffer,
    responses((status = 201, body = Offered), (status = 401, body = Problem),
              (status = 403, body = Problem),
              (status = 404, description = "No job of the plan is for that compass", body = Problem),
              (status = 409, description = "There is a newer plan, the job has already been offered, an \
                             order under way differs, or the firm has no team left \
                             that day", body = Problem),
              (status = 422, body = Problem)))]
async fn offer_job(
    State(app): State<App>,
    request: RequestContext,
    writer: Writer,
    Valid(new): Valid<NewScheduleOffer>,
) -> Result<(StatusCode, Json<Offered>)> {
    let text = optional_text("text", new.text.as_deref())?;
    let plan = store::find_current(&app.db, writer.operator).await?;
    let job = find_job(plan.as_ref(), &new)?;
    let terms = firms::of_operator(&app.db, writer.operator).await?;
    let terms: BTreeMap<FirmId, Terms> = terms
        .into_iter()
        .filter_map(|firm| Some((firm.id, firm.terms?)))
        .collect();
    let mut tx = request.begin().await?;
    for compass in &job.compasses {
        work_orders::lock_compass(&mut tx, job.vessel_id, compass.compass_id).await?;
    }
    let (mut orders, mut pending) = (Vec::new(), Vec::new());
    for order in &job.instead_of {
        let (open, events) = api::cancel_declined(&app, tx, writer, job.vessel_id, *order).await?;
        tx = open;
        pending.extend(events);
    }
    for (nth, compass) in job.compasses.iter().enumerate() {
        let fees = |(firm, terms): (&FirmId, &Terms)| (*firm, split_fee(job, *firm, terms, nth));
        let offer = NewOffer {
            firms: std::iter::once(job.firm_id)
                .chain(new.then.iter().copied().filter(|firm| *firm != job.firm_id))
                .collect(),
            answer_within_hours: new.answer_within_hours.unwrap_or(48),
            at_once: false,
            text: text.clone(),
            fees_eur: terms.iter().map(fees).collect(),
            teams: BTreeMap::from([(job.firm_id, job.team.clone())]),
        };
        let id = OrderId::new();
        dispatch::link_once(&mut tx, job.vessel_id, id, job.call_id).await?;
        let order = new_order(job, compass.compass_id, offer);
        let (open, events) = api::write(&app, &request, tx, writer, id, order).await?;
        tx = open;
        pending.extend(events);
        orders.push(OfferedOrder {
            order_id: id,
            compass_id: compass.compass_id,
        });
    }
    tx.commit().await?;
    for event in pending {
        app.publish(event);
    }
    app.work.notify_one();
    Ok((StatusCode::CREATED, Json(Offered { orders })))
}

/// Returns a firm's fee for the nth compass of a job. The first bears the fee of the visit. The
/// fees of the planned firm add up to the plan's.
fn split_fee(job: &Job, firm: FirmId, terms: &Terms, nth: usize) -> f64 {
    let extra = f64::from(terms.extra_compass_eur);
    if firm != job.firm_id {
        return if nth == 0 {
            f64::from(terms.fee_eur)
        } else {
            extra
        };
    }
    #[allow(clippy::cast_precision_loss, reason = "a ship has few compasses")]
    let compasses = job.compasses.len() as f64;
    // The terms may have changed since the plan.
    let extra = extra.min(job.fee_eur / compasses);
    if nth == 0 {
        job.fee_eur - extra * (compasses - 1.0)
    } else {
        extra
    }
}

/// Returns the job to offer, if the plan still has it as proposed.
fn find_job<'a>(plan: Option<&'a Plan>, new: &NewScheduleOffer) -> Result<&'a Job> {
    let refused = |why: String| Err(Error::WrongState(why));
    let plan = plan.ok_or(Error::NotFound("plan"))?;
    if plan.version != new.version {
        return refused(format!("the current plan has version {}", plan.version));
    }
    let job = plan.job_of(new.compass_id).ok_or(Error::NotFound("job"))?;
    if job.state != JobState::Proposed {
        return refused("the job has already been offered".to_owned());
    }
    Ok(job)
}

/// Returns the order of one compass of a job.
fn new_order(job: &Job, compass_id: CompassId, offer: NewOffer) -> NewOrder {
    NewOrder {
        vessel_id: job.vessel_id,
        compass_id,
        port: format!("{} ({})", job.port_name, job.port),
        berth: job.berth.clone(),
        planned_at: job.from,
        // A plan of an older release has the hours of the day.
        planned_until: (!job.team.is_empty()).then_some(job.to),
        adjuster_name: None,
        adjuster_licence: None,
        firm: None,
        offer: Some(offer),
        limits: None,
    }
}
