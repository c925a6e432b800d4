//! Alerts: what people must know of a compass, from the first sign to the end.
//!
//! What always holds:
//!
//! - An alert is raised, acknowledged and cleared, and kept for good. A compass has
//!   one open alert of each cause: what goes on is updated, not repeated.
//! - An alert clears itself when its cause is over. One that a person cleared comes
//!   back only when its cause does, gets worse, or happens again.
//! - A vessel out of service has none that is open.
//! - It is about one event. Another one of its cause clears it, with what people said
//!   of it, and raises the next.
//! - It comes from an analysis, in the transaction that stores the analysis, from the
//!   ship herself or what her batches show, in the one that stores the batch, or from
//!   the clock, when a vessel falls silent.
//! - Every change is stored together with what tells people of it.

mod after_adjustment;
mod agent_alerts;
mod alert;
mod change_rules;
mod duplicate_agent;
mod job_at_risk;
mod limits;
mod reconcile;
mod rules;
mod store;

pub use after_adjustment::list_in_force;
pub use agent_alerts::record_agent_alerts;
pub use alert::{Alert, Cause, DesiredAlert, EventWindow, Evidence, Severity, State};
pub use duplicate_agent::{check_duplicate_agent, end_duplicate_agent};
pub use job_at_risk::reconcile_jobs_at_risk;
pub use limits::AlertLimits;
pub use reconcile::{
    AlertChange, check_silence, check_timed, end_all, reconcile_analysis, summarize, watch,
};
pub use rules::{find_desired, silence};
pub use store::{OpenAlert, OpenCount, count_open};

use crate::access::{Reader, Writer};
use crate::app::App;
use crate::error::{Error, Problem, Result};
use crate::http::{Id, Json, Page, Params, Valid, ValidOrNone, text};
use crate::ids::AlertId;
use crate::outbox::Kind;
use crate::session;
use alert::{Acknowledgement, AlertList, Clearing, Filter};
use axum::extract::State as Shared;
use reconcile::PendingChange;
use store::Remark;
use utoipa_axum::router::OpenApiRouter;
use utoipa_axum::routes;

/// The routes of this part.
pub fn router() -> OpenApiRouter<App> {
    OpenApiRouter::new()
        .routes(routes!(list_alerts))
        .routes(routes!(find_alert))
        .routes(routes!(acknowledge_alert))
        .routes(routes!(clear_alert))
}

/// List the fleet's alerts
#[utoipa::path(get, path = "/alerts", tag = "alerts", params(Filter, Page),
    responses((status = 200, body = AlertList), (status = 401, body = Problem)))]
async fn list_alerts(
    Shared(app): Shared<App>,
    reader: Reader,
    Params(filter): Params<Filter>,
    page: Page,
) -> Result<Json<AlertList>> {
    let before = page.after_id()?;
    let found = store::list(&app.db, reader.operator, &filter, before, page.fetch()).await?;
    let listed = page.cut(found, |alert| alert.id.to_string());
    Ok(Json(AlertList {
        items: listed.items,
        next: listed.next,
    }))
}

/// See an alert
#[utoipa::path(get, path = "/alerts/{id}", tag = "alerts", params(("id" = AlertId, Path)),
    responses((status = 200, body = Alert), (status = 401, body = Problem),
              (status = 404, body = Problem)))]
async fn find_alert(
    Shared(app): Shared<App>,
    reader: Reader,
    Id(id): Id<AlertId>,
) -> Result<Json<Alert>> {
    Ok(Json(store::must_find(&app.db, reader.operator, id).await?))
}

/// Acknowledge an alert
///
/// Someone knows and sees to it. Acknowledging it again changes nothing.
#[utoipa::path(post, path = "/alerts/{id}/acknowledge", tag = "alerts",
    params(("id" = AlertId, Path)), request_body = Option<Acknowledgement>,
    responses((status = 200, body = Alert), (status = 401, body = Problem),
              (status = 403, body = Problem), (status = 404, body = Problem),
              (status = 410, description = "The alert is cleared", body = Problem)))]
async fn acknowledge_alert(
    Shared(app): Shared<App>,
    writer: Writer,
    Id(id): Id<AlertId>,
    ValidOrNone(acknowledgement): ValidOrNone<Acknowledgement>,
) -> Result<Json<Alert>> {
    let note = acknowledgement.note.filter(|note| !note.trim().is_empty());
    let note = note.map(|note| text("note", &note)).transpose()?;
    let alert = change(&app, writer, id, note, Kind::AlertAcknowledged).await?;
    if alert.state == State::Cleared {
        return Err(Error::Gone("this alert is cleared"));
    }
    Ok(Json(alert))
}

/// Clear an alert
///
/// It comes back only when its cause does, or gets worse. Clearing it again changes
/// nothing.
#[utoipa::path(post, path = "/alerts/{id}/clear", tag = "alerts",
    params(("id" = AlertId, Path)), request_body = Clearing,
    responses((status = 200, body = Alert), (status = 401, body = Problem),
              (status = 403, body = Problem), (status = 404, body = Problem)))]
async fn clear_alert(
    Shared(app): Shared<App>,
    writer: Writer,
    Id(id): Id<AlertId>,
    Valid(clearing): Valid<Clearing>,
) -> Result<Json<Alert>> {
    let reason = Some(text("reason", &clearing.reason)?);
    Ok(Json(
        change(&app, writer, id, reason, Kind::AlertCleared).await?,
    ))
}

/// Changes an alert in a person's name, if that changes anything.
async fn change(
    app: &App,
    writer: Writer,
    id: AlertId,
    words: Option<String>,
    became: Kind,
) -> Result<Alert> {
    let alert = store::must_find(&app.db, writer.operator, id).await?;
    let now = app.clock.now().into();
    let vessel = alert.vessel_id;
    let mut tx = app.db.begin().await?;
    let word = Remark {
        by: session::name_of(&mut tx, writer.user).await?,
        text: words,
        at: now,
    };
    store::lock(&mut tx, vessel, alert.compass_id).await?;
    let changed = match became {
        Kind::AlertAcknowledged => store::acknowledge(&mut tx, vessel, id, &word).await?,
        _ => store::clear(&mut tx, vessel, id, &word).await?,
    };
    if changed {
        let event =
            reconcile::publish_changes(&mut tx, vessel, &[PendingChange::of(id, became)], now)
                .await?;
        tx.commit().await?;
        if let Some(event) = event {
            app.publish(event);
        }
    }
    store::must_find(&app.db, writer.operator, id).await
}
