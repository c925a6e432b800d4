//! `/schedule/offer`: a planned job becomes work orders that are offered to its firm.
//!
//! What always holds: a compass has one order under way at a time, a firm is offered no more
//! ships on a day than it has teams for, and a job is offered whole or not at all. The fees
//! of its orders come to the fee that the plan has for the job.

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
    /// The plan that was looked at: another one may say something else.
    version: i64,
    /// A compass of the job; its others go with it.
    compass_id: CompassId,
    /// So long the firm has for an answer, 1 to 720 hours; 48 if not said.
    #[schema(minimum = 1, maximum = 720)]
    answer_within_hours: Option<u32>,
    /// Firms that are asked next, in this order, when it says no or nothing.
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
    /// An order for each compass of the job.
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
/// Writes a work order for each compass of the job. From then on the plan keeps the job
/// where it is unless there is cause. An order that every firm declined is cancelled for it.
#[utoipa::path(post, path = "/schedule/offer", tag = "adjusting", request_body = NewScheduleOffer,
    responses((status = 201, body = Offered), (status = 401, body = Problem),
              (status = 403, body = Problem),
              (status = 404, description = "No job of the plan is for that compass", body = Problem),
              (status = 409, description = "There is another plan, the job is offered already, an \
                             order under way says something else, or the firm has no team left \
                             that day", body = Problem),
              (status = 422, body = Problem)))]
async fn offer_job(
    State(app): State<App>,
    request: RequestContext,
    writer: Writer,
    Valid(new): Valid<NewScheduleOffer>,
) -> Result<(StatusCode, Json<Offered>)> {
    let text = optional_text("text", new.text.as_deref())?;
    let plan = store::current(&app.db, writer.operator).await?;
    let job = job_of(plan.as_ref(), &new)?;
    let terms = firms::of_operator(&app.db, writer.operator).await?;
    let terms: BTreeMap<FirmId, Terms> = terms
        .into_iter()
        .filter_map(|(firm, _, terms)| Some((firm, terms?)))
        .collect();
    let mut tx = request.begin().await?;
    for compass in &job.compasses {
        work_orders::lock_compass(&mut tx, job.vessel_id, compass.compass_id).await?;
    }
    let (mut orders, mut told) = (Vec::new(), Vec::new());
    for order in &job.instead_of {
        let (goes_on, news) = api::cancel_declined(&app, tx, writer, job.vessel_id, *order).await?;
        (tx, told) = (goes_on, told.into_iter().chain(news).collect());
    }
    for (nth, compass) in job.compasses.iter().enumerate() {
        let fees = |(firm, terms): (&FirmId, &Terms)| (*firm, fee(job, *firm, terms, nth));
        let offer = NewOffer {
            firms: std::iter::once(job.firm_id)
                .chain(new.then.iter().copied().filter(|firm| *firm != job.firm_id))
                .collect(),
            answer_within_hours: new.answer_within_hours.unwrap_or(48),
            at_once: false,
            text: text.clone(),
            fees_eur: terms.iter().map(fees).collect(),
        };
        let id = OrderId::new();
        dispatch::link_once(&mut tx, job.vessel_id, id, job.call_id).await?;
        let order = order_of(job, compass.compass_id, offer);
        let (goes_on, news) = api::write(&app, &request, tx, writer, id, order).await?;
        (tx, told) = (goes_on, told.into_iter().chain(news).collect());
        orders.push(OfferedOrder {
            order_id: id,
            compass_id: compass.compass_id,
        });
    }
    tx.commit().await?;
    for event in told {
        app.publish(event);
    }
    app.work.notify_one();
    Ok((StatusCode::CREATED, Json(Offered { orders })))
}

/// A firm's fee for the nth compass of a job. The first bears the visit's; those of the firm
/// that it is planned with come to what the plan has.
fn fee(job: &Job, firm: FirmId, terms: &Terms, nth: usize) -> f64 {
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
    // The terms may be others than those that it was planned by.
    let extra = extra.min(job.fee_eur / compasses);
    if nth == 0 {
        job.fee_eur - extra * (compasses - 1.0)
    } else {
        extra
    }
}

fn job_of<'a>(plan: Option<&'a Plan>, new: &NewScheduleOffer) -> Result<&'a Job> {
    let wrong = |why: String| Err(Error::WrongState(why));
    let plan = plan.ok_or(Error::NotFound("plan"))?;
    if plan.version != new.version {
        return wrong(format!("the plan is of version {} now", plan.version));
    }
    let job = plan.job_of(new.compass_id).ok_or(Error::NotFound("job"))?;
    if job.state != JobState::Proposed {
        return wrong("the job is offered already".to_owned());
    }
    Ok(job)
}

/// The order of one compass of a job.
fn order_of(job: &Job, compass_id: CompassId, offer: NewOffer) -> NewOrder {
    NewOrder {
        vessel_id: job.vessel_id,
        compass_id,
        port: format!("{} ({})", job.port_name, job.port),
        berth: job.berth.clone(),
        planned_at: job.from,
        adjuster_name: None,
        adjuster_licence: None,
        firm: None,
        offer: Some(offer),
        limits: None,
    }
}
