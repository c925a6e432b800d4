//! HTTP API of alerts.

use super::alert::{Alert, State};
use super::change::{ChangeKind, PendingChange};
use super::handling;
use super::publish::publish_changes;
use super::requests::{Acknowledgement, AlertList, Clearing, Filter};
use super::store::{self, Remark};
use axum::extract::{FromRef, State as Shared};
use binnacle_platform::access::{Reader, Writer};
use binnacle_platform::app::App;
use binnacle_platform::audit::RequestContext;
use binnacle_platform::error::{Error, Problem, Result};
use binnacle_platform::http::{Id, Json, Page, Params, Period, Valid, ValidOrNone, text};
use binnacle_platform::ids::AlertId;
use binnacle_platform::session;
use utoipa_axum::router::OpenApiRouter;
use utoipa_axum::routes;

/// Returns the routes.
pub fn router<S>() -> OpenApiRouter<S>
where
    App: FromRef<S>,
    S: Clone + Send + Sync + 'static,
{
    OpenApiRouter::new()
        .routes(routes!(list_alerts))
        .routes(routes!(find_alert))
        .routes(routes!(acknowledge_alert))
        .routes(routes!(clear_alert))
        .merge(handling::router())
}

/// List the fleet's alerts
///
/// `from` and `to` are about the time since when the alert holds.
#[utoipa::path(get, path = "/alerts", tag = "alerts", params(Filter, Period, Page),
    responses((status = 200, body = AlertList), (status = 401, body = Problem),
              (status = 422, body = Problem)))]
async fn list_alerts(
    Shared(app): Shared<App>,
    reader: Reader,
    Params(filter): Params<Filter>,
    Params(period): Params<Period>,
    page: Page,
) -> Result<Json<AlertList>> {
    let asked = store::ListedAlerts {
        filter,
        since: period.micros()?,
        before: page.after_id()?,
        limit: page.fetch(),
    };
    let found = store::list(&app.db, reader.operator, &asked).await?;
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
/// Records that someone is dealing with it. Acknowledging it again changes nothing.
#[utoipa::path(post, path = "/alerts/{id}/acknowledge", tag = "alerts",
    params(("id" = AlertId, Path)), request_body = Option<Acknowledgement>,
    responses((status = 200, body = Alert), (status = 401, body = Problem),
              (status = 403, body = Problem), (status = 404, body = Problem),
              (status = 410, description = "The alert is cleared", body = Problem)))]
async fn acknowledge_alert(
    Shared(app): Shared<App>,
    writer: Writer,
    request: RequestContext,
    Id(id): Id<AlertId>,
    ValidOrNone(acknowledgement): ValidOrNone<Acknowledgement>,
) -> Result<Json<Alert>> {
    let note = acknowledgement.note.filter(|note| !note.trim().is_empty());
    let note = note.map(|note| text("note", &note)).transpose()?;
    let alert = change(&app, &request, writer, id, note, ChangeKind::Acknowledged).await?;
    if alert.state == State::Cleared {
        return Err(Error::Gone("this alert is cleared"));
    }
    Ok(Json(alert))
}

/// Clear an alert
///
/// It is raised again only when its cause recurs or gets worse. Clearing it again changes
/// nothing.
#[utoipa::path(post, path = "/alerts/{id}/clear", tag = "alerts",
    params(("id" = AlertId, Path)), request_body = Clearing,
    responses((status = 200, body = Alert), (status = 401, body = Problem),
              (status = 403, body = Problem), (status = 404, body = Problem)))]
async fn clear_alert(
    Shared(app): Shared<App>,
    writer: Writer,
    request: RequestContext,
    Id(id): Id<AlertId>,
    Valid(clearing): Valid<Clearing>,
) -> Result<Json<Alert>> {
    let reason = Some(text("reason", &clearing.reason)?);
    Ok(Json(
        change(&app, &request, writer, id, reason, ChangeKind::Cleared).await?,
    ))
}

/// Changes an alert in a person's name, if that changes anything.
async fn change(
    app: &App,
    request: &RequestContext,
    writer: Writer,
    id: AlertId,
    remark: Option<String>,
    kind: ChangeKind,
) -> Result<Alert> {
    let alert = store::must_find(&app.db, writer.operator, id).await?;
    let now = app.clock.now().into();
    let vessel = alert.vessel_id;
    let mut tx = request.begin().await?;
    let remark = Remark {
        by: session::name_of(&mut tx, writer.user).await?,
        text: remark,
        at: now,
    };
    store::lock(&mut tx, vessel, alert.compass_id).await?;
    let has_changed = match kind {
        ChangeKind::Acknowledged => store::acknowledge(&mut tx, vessel, id, &remark).await?,
        _ => store::clear(&mut tx, vessel, id, &remark).await?,
    };
    if has_changed {
        let pending = [PendingChange::from_kind(id, kind)];
        let event = publish_changes(&mut tx, vessel, &pending, now).await?;
        tx.commit().await?;
        if let Some(event) = event {
            app.publish(event);
        }
    }
    store::must_find(&app.db, writer.operator, id).await
}
