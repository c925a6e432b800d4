//! Handling of alerts by several people: assignment, comments, snoozing, and several at once.
//!
//! Invariants: none of it changes what the alert says or when it is over. A snoozed alert is
//! listed again at its time, or when it gets worse.

use super::alert::Alert;
use super::change::{ChangeKind, PendingChange};
use super::publish::publish_changes;
use super::store::{self, Remark};
use axum::extract::{FromRef, State as Shared};
use axum::http::StatusCode;
use binnacle_platform::access::{Reader, Writer};
use binnacle_platform::app::App;
use binnacle_platform::audit::RequestContext;
use binnacle_platform::db::{Db, Result as DbResult, Tx, execute, row, rows};
use binnacle_platform::error::{Error, Problem, Result};
use binnacle_platform::http::{Id, Json, Valid, optional_text, remark};
use binnacle_platform::idempotency::{self, Key};
use binnacle_platform::ids::{AlertId, OperatorId, UserId};
use binnacle_platform::session;
use binnacle_platform::time::Time;
use serde::{Deserialize, Serialize};
use utoipa::ToSchema;
use utoipa_axum::router::OpenApiRouter;
use utoipa_axum::routes;
use uuid::Uuid;

/// Maximum number of alerts of one request.
const MAX_ALERTS: usize = 200;
/// Maximum length of a comment, characters.
const MAX_COMMENT_CHARS: usize = 1000;
/// Maximum number of comments on an alert.
const MAX_COMMENTS: i64 = 200;
/// Longest time for which an alert is snoozed, seconds.
const MAX_SNOOZE_S: f64 = 90.0 * 86_400.0;

pub(super) fn router<S>() -> OpenApiRouter<S>
where
    App: FromRef<S>,
    S: Clone + Send + Sync + 'static,
{
    OpenApiRouter::new()
        .routes(routes!(acknowledge_alerts))
        .routes(routes!(assign_alert))
        .routes(routes!(snooze_alert))
        .routes(routes!(list_comments, comment_alert))
}

/// Acknowledgement of several alerts.
#[derive(Debug, Deserialize, ToSchema)]
#[serde(deny_unknown_fields)]
#[schema(example = json!({
    "alerts": ["0199aa00-0000-7000-8000-000000000001"], "note": "Masters informed"
}))]
struct Acknowledgements {
    /// The alerts, 1 to 200.
    #[schema(min_items = 1, max_items = 200)]
    alerts: Vec<AlertId>,
    /// A note in the person's own words.
    #[serde(default)]
    #[schema(max_length = 200)]
    note: Option<String>,
}

/// Result of an acknowledgement of several alerts.
#[derive(Serialize, ToSchema)]
#[schema(example = json!({ "acknowledged": 12 }))]
struct Acknowledged {
    /// Number of alerts that were raised until then.
    acknowledged: usize,
}

/// Assignment of an alert.
#[derive(Debug, Deserialize, ToSchema)]
#[serde(deny_unknown_fields)]
struct Assignment {
    /// User of the operator who is to see to it; `null` for nobody.
    #[schema(required)]
    user_id: Option<UserId>,
}

/// Snooze of an alert.
#[derive(Debug, Deserialize, ToSchema)]
#[serde(deny_unknown_fields)]
#[schema(example = json!({ "until": "2026-12-01T08:00:00Z" }))]
struct Snooze {
    /// Time until which it is not to be seen to, 90 days ahead at most; `null` ends it.
    #[schema(required)]
    until: Option<Time>,
}

/// Comment on an alert.
#[derive(Clone, Debug, Serialize, ToSchema, sqlx::FromRow)]
#[schema(as = AlertComment)]
struct Comment {
    /// Its id.
    id: Uuid,
    /// Time of the comment.
    at: Time,
    /// Name of its author.
    #[sqlx(rename = "by_name")]
    by: String,
    /// The comment.
    text: String,
}

/// Comments on an alert.
#[derive(Serialize, ToSchema)]
#[schema(as = AlertCommentList)]
struct CommentList {
    /// The earliest first.
    items: Vec<Comment>,
}

/// Comment to be written.
#[derive(Debug, Serialize, Deserialize, ToSchema)]
#[serde(deny_unknown_fields)]
#[schema(as = NewAlertComment, example = json!({ "text": "The master takes an azimuth tonight." }))]
struct NewComment {
    /// The comment.
    #[schema(min_length = 1, max_length = 1000)]
    text: String,
}

/// Acknowledge several alerts
///
/// Those that are acknowledged or cleared already stay as they are. All of them or none.
#[utoipa::path(post, path = "/alerts/acknowledge", tag = "alerts",
    request_body = Acknowledgements,
    responses((status = 200, body = Acknowledged), (status = 401, body = Problem),
              (status = 403, body = Problem), (status = 404, body = Problem),
              (status = 422, body = Problem)))]
async fn acknowledge_alerts(
    Shared(app): Shared<App>,
    writer: Writer,
    request: RequestContext,
    Valid(given): Valid<Acknowledgements>,
) -> Result<Json<Acknowledged>> {
    if given.alerts.is_empty() || given.alerts.len() > MAX_ALERTS {
        return Err(Error::Invalid {
            field: "alerts",
            detail: format!(
                "names {} alerts; 1 to {MAX_ALERTS} are allowed",
                given.alerts.len()
            ),
        });
    }
    let mut found = Vec::new();
    for id in given.alerts {
        found.push(store::must_find(&app.db, writer.operator, id).await?);
    }
    // Locks are taken in one order, whatever the order of the request.
    found.sort_by_key(|alert| (alert.vessel_id, alert.compass_id, alert.id));
    found.dedup_by_key(|alert| alert.id);
    let now = app.clock.now().into();
    let mut tx = request.begin().await?;
    let remark = Remark {
        by: session::name_of(&mut tx, writer.user).await?,
        text: optional_text("note", given.note.as_deref())?,
        at: now,
    };
    let (mut acknowledged, mut events) = (0, Vec::new());
    for alert in found {
        let vessel = alert.vessel_id;
        store::lock(&mut tx, vessel, alert.compass_id).await?;
        if store::acknowledge(&mut tx, vessel, alert.id, &remark).await? {
            acknowledged += 1;
            let pending = [PendingChange::from_kind(alert.id, ChangeKind::Acknowledged)];
            events.extend(publish_changes(&mut tx, vessel, &pending, now).await?);
        }
    }
    tx.commit().await?;
    for event in events {
        app.publish(event);
    }
    Ok(Json(Acknowledged { acknowledged }))
}

/// Assign an alert
///
/// To a user of your operator, who sees it among their own; or to nobody.
#[utoipa::path(put, path = "/alerts/{id}/assignee", tag = "alerts",
    params(("id" = AlertId, Path)), request_body = Assignment,
    responses((status = 200, body = Alert), (status = 401, body = Problem),
              (status = 403, body = Problem), (status = 404, body = Problem)))]
async fn assign_alert(
    Shared(app): Shared<App>,
    writer: Writer,
    request: RequestContext,
    Id(id): Id<AlertId>,
    Valid(assignment): Valid<Assignment>,
) -> Result<Json<Alert>> {
    let alert = store::must_find(&app.db, writer.operator, id).await?;
    let mut tx = request.begin().await?;
    if let Some(user) = assignment.user_id {
        must_be_colleague(&mut tx, writer.operator, user).await?;
    }
    execute!(
        &mut tx,
        "UPDATE alerts SET assigned_to = $3 WHERE vessel_id = $1 AND id = $2",
        alert.vessel_id,
        id,
        assignment.user_id
    )?;
    commit_and_publish(&app, tx, &alert).await.map(Json)
}

/// Snooze an alert
///
/// Until then it is not among those to see to. It comes back when it gets worse.
#[utoipa::path(put, path = "/alerts/{id}/snooze", tag = "alerts",
    params(("id" = AlertId, Path)), request_body = Snooze,
    responses((status = 200, body = Alert), (status = 401, body = Problem),
              (status = 403, body = Problem), (status = 404, body = Problem),
              (status = 422, body = Problem)))]
async fn snooze_alert(
    Shared(app): Shared<App>,
    writer: Writer,
    request: RequestContext,
    Id(id): Id<AlertId>,
    Valid(snooze): Valid<Snooze>,
) -> Result<Json<Alert>> {
    let now: Time = app.clock.now().into();
    let ahead_s = snooze.until.map(|until| until.0.seconds_since(now.0));
    if ahead_s.is_some_and(|ahead_s| !(0.0..=MAX_SNOOZE_S).contains(&ahead_s)) {
        return Err(Error::Invalid {
            field: "until",
            detail: "must be in the future, at most 90 days ahead".to_owned(),
        });
    }
    let alert = store::must_find(&app.db, writer.operator, id).await?;
    let mut tx = request.begin().await?;
    execute!(
        &mut tx,
        "UPDATE alerts SET snoozed_until = $3 WHERE vessel_id = $1 AND id = $2",
        alert.vessel_id,
        id,
        snooze.until
    )?;
    commit_and_publish(&app, tx, &alert).await.map(Json)
}

/// List the comments on an alert
#[utoipa::path(get, path = "/alerts/{id}/comments", tag = "alerts",
    params(("id" = AlertId, Path)),
    responses((status = 200, body = CommentList), (status = 401, body = Problem),
              (status = 404, body = Problem)))]
async fn list_comments(
    Shared(app): Shared<App>,
    reader: Reader,
    Id(id): Id<AlertId>,
) -> Result<Json<CommentList>> {
    let alert = store::must_find(&app.db, reader.operator, id).await?;
    let items = comments(&app.db, &alert).await?;
    Ok(Json(CommentList { items }))
}

/// Comment on an alert
#[utoipa::path(post, path = "/alerts/{id}/comments", tag = "alerts",
    params(("id" = AlertId, Path), Key), request_body = NewComment,
    responses((status = 201, body = CommentList), (status = 401, body = Problem),
              (status = 403, body = Problem), (status = 404, body = Problem),
              (status = 409, description = "It has 200 comments", body = Problem),
              (status = 422, body = Problem)))]
async fn comment_alert(
    Shared(app): Shared<App>,
    writer: Writer,
    request: RequestContext,
    Id(id): Id<AlertId>,
    key: Key,
    Valid(new): Valid<NewComment>,
) -> Result<(StatusCode, Json<CommentList>)> {
    let request_hash = idempotency::request_hash(&format!("comment on {id}"), &new)?;
    let words = remark("text", &new.text, MAX_COMMENT_CHARS)?;
    let alert = store::must_find(&app.db, writer.operator, id).await?;
    let now: Time = app.clock.now().into();
    let comment = Uuid::now_v7();
    let mut tx = request.begin().await?;
    let made = key
        .once(&mut tx, writer.operator, &request_hash, comment, now)
        .await?;
    if made == comment {
        if count_comments(&mut tx, &alert).await? >= MAX_COMMENTS {
            let full = format!("{MAX_COMMENTS} comments are the most that an alert has");
            return Err(Error::WrongState(full));
        }
        let by = session::name_of(&mut tx, writer.user).await?;
        execute!(
            &mut tx,
            "INSERT INTO alert_comments (vessel_id, alert_id, id, at, by_name, text)
             VALUES ($1, $2, $3, $4, $5, $6)",
            alert.vessel_id,
            id,
            comment,
            now,
            by,
            words
        )?;
        commit_and_publish(&app, tx, &alert).await?;
    }
    let items = comments(&app.db, &alert).await?;
    Ok((StatusCode::CREATED, Json(CommentList { items })))
}

/// Commits a change of how an alert is handled, notifies dashboards, and returns the alert.
async fn commit_and_publish(app: &App, mut tx: Tx, alert: &Alert) -> Result<Alert> {
    let pending = [PendingChange {
        alert: alert.id,
        kind: None,
        was: None,
    }];
    let now = app.clock.now().into();
    let event = publish_changes(&mut tx, alert.vessel_id, &pending, now).await?;
    let changed = store::read(&mut tx, alert.vessel_id, alert.id).await?;
    tx.commit().await?;
    if let Some(event) = event {
        app.publish(event);
    }
    Ok(changed)
}

async fn count_comments(tx: &mut Tx, alert: &Alert) -> DbResult<i64> {
    let found = row!(
        in tx,
        (i64,),
        "SELECT COUNT(*) FROM alert_comments WHERE vessel_id = $1 AND alert_id = $2",
        alert.vessel_id,
        alert.id
    )?;
    Ok(found.map_or(0, |(comments,)| comments))
}

async fn comments(db: &Db, alert: &Alert) -> DbResult<Vec<Comment>> {
    rows!(
        db,
        Comment,
        "SELECT id, at, by_name, text FROM alert_comments
         WHERE vessel_id = $1 AND alert_id = $2
         ORDER BY at, id",
        alert.vessel_id,
        alert.id
    )
}

/// Refuses a user who is not an enabled user of the operator.
async fn must_be_colleague(tx: &mut Tx, operator: OperatorId, user: UserId) -> Result<()> {
    let found = row!(
        in tx,
        (UserId,),
        "SELECT id FROM users WHERE id = $1 AND operator_id = $2 AND disabled_at IS NULL
         ORDER BY id",
        user,
        operator
    )?;
    found.map(drop).ok_or(Error::NotFound("user"))
}
