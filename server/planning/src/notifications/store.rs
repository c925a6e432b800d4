//! Notifications, notification settings and recorded needs in the database.

use super::notification::{Filter, Notification};
use super::settings::Settings;
use binnacle_fleet::alerts;
use binnacle_platform::db::{Db, Result as DbResult, Tx, execute, row, rows};
use binnacle_platform::error::Result;
use binnacle_platform::ids::{CompassId, NotificationId, OperatorId, UserId, VesselId};
use binnacle_platform::notices::Notice;
use binnacle_platform::time::Time;
use uuid::Uuid;

/// Retention of notifications, seconds.
const RETENTION_S: f64 = 90.0 * 86_400.0;

/// Returns a person's settings, or the defaults.
pub(super) async fn find_settings(db: &Db, user: UserId) -> Result<Settings> {
    let found = row!(
        db,
        (String,),
        "SELECT settings FROM notification_settings WHERE user_id = $1 ORDER BY user_id",
        user
    )?;
    Ok(found.map_or_else(
        || Ok(Settings::default()),
        |(text,)| serde_json::from_str(&text),
    )?)
}

/// Stores a person's settings.
pub(super) async fn put_settings(
    tx: &mut Tx,
    user: UserId,
    settings: &Settings,
    now: Time,
) -> Result<()> {
    execute!(
        tx,
        "INSERT INTO notification_settings (user_id, settings, changed_at) VALUES ($1, $2, $3)
         ON CONFLICT (user_id) DO UPDATE
         SET settings = excluded.settings, changed_at = excluded.changed_at",
        user,
        serde_json::to_string(settings)?,
        now
    )?;
    Ok(())
}

pub(super) async fn insert(
    tx: &mut Tx,
    user: UserId,
    notice: &Notice,
    mail_at: Option<Time>,
    now: Time,
) -> DbResult<()> {
    // Of the things of a vessel, work orders and alerts are those with notices of their own.
    let (order, alert) = match notice.kind {
        alerts::NOTICE_KIND => (None, notice.about),
        _ => (notice.about, None),
    };
    execute!(
        tx,
        "INSERT INTO notifications (user_id, id, kind, urgent, subject, text, path, vessel_id,
                                    order_id, alert_id, created_at, mail_at)
         VALUES ($1, $2, $3, $4, $5, $6, $7, $8, $9, $10, $11, $12)",
        user,
        NotificationId::new(),
        notice.kind.name(),
        notice.urgent,
        notice.subject.as_str(),
        notice.text.as_str(),
        notice.path.as_str(),
        notice.vessel,
        order,
        alert,
        now,
        mail_at
    )?;
    Ok(())
}

/// Returns a page of notifications, the newest first, older than an id.
pub(super) async fn list(
    db: &Db,
    user: UserId,
    filter: &Filter,
    before: Option<Uuid>,
    limit: i64,
) -> DbResult<Vec<Notification>> {
    rows!(
        db,
        Notification,
        "SELECT id, kind, urgent, subject, text, path, vessel_id, order_id, alert_id, created_at,
                read_at
         FROM notifications
         WHERE user_id = $1 AND id < $2
           AND ($3 IS NULL OR (read_at IS NULL) = $3)
           AND ($4 IS NULL OR kind = $4)
         ORDER BY id DESC
         LIMIT $5",
        user,
        before.unwrap_or(Uuid::max()),
        filter.unread,
        filter.kind.as_deref(),
        limit
    )
}

/// Returns the number of a person's unread notifications.
pub(super) async fn count_unread(db: &Db, user: UserId) -> DbResult<i64> {
    let found = row!(
        db,
        (i64,),
        "SELECT COUNT(*) FROM notifications WHERE user_id = $1 AND read_at IS NULL",
        user
    )?;
    Ok(found.map_or(0, |(unread,)| unread))
}

/// Marks a notification as read or unread; false when the person has no such one.
pub(super) async fn mark(
    tx: &mut Tx,
    user: UserId,
    id: NotificationId,
    read_at: Option<Time>,
) -> DbResult<bool> {
    let marked = execute!(
        tx,
        "UPDATE notifications SET read_at = $3 WHERE user_id = $1 AND id = $2",
        user,
        id,
        read_at
    )?;
    Ok(marked > 0)
}

/// Marks notifications up to one as read, or all.
pub(super) async fn mark_read(
    tx: &mut Tx,
    user: UserId,
    until: Option<NotificationId>,
    now: Time,
) -> DbResult<()> {
    execute!(
        tx,
        "UPDATE notifications SET read_at = $3
         WHERE user_id = $1 AND id <= $2 AND read_at IS NULL",
        user,
        until.map_or(Uuid::max(), |id| id.0),
        now
    )?;
    Ok(())
}

/// Returns the notifications that wait for mail: id, kind and urgency.
pub(super) async fn list_waiting_for_mail(
    tx: &mut Tx,
    user: UserId,
) -> DbResult<Vec<(NotificationId, String, bool)>> {
    rows!(
        in tx,
        (NotificationId, String, bool),
        "SELECT id, kind, urgent FROM notifications
         WHERE user_id = $1 AND mail_at IS NOT NULL
         ORDER BY id",
        user
    )
}

/// Changes the time of a notification's mail.
pub(super) async fn reschedule_mail(
    tx: &mut Tx,
    user: UserId,
    id: NotificationId,
    mail_at: Option<Time>,
) -> DbResult<()> {
    execute!(
        tx,
        "UPDATE notifications SET mail_at = $3 WHERE user_id = $1 AND id = $2",
        user,
        id,
        mail_at
    )?;
    Ok(())
}

/// Returns the people to whom mail is due.
pub(super) async fn list_due_people(db: &Db, now: Time) -> DbResult<Vec<(UserId,)>> {
    rows!(
        db,
        (UserId,),
        "SELECT DISTINCT user_id FROM notifications WHERE mail_at <= $1 ORDER BY user_id",
        now
    )
}

/// Takes a person's due notifications for mail; no other process gets them.
pub(super) async fn take_due(tx: &mut Tx, user: UserId, now: Time) -> DbResult<Vec<Notification>> {
    let mut taken = rows!(
        in tx,
        Notification,
        "UPDATE notifications SET mail_at = NULL
         WHERE user_id = $1 AND mail_at <= $2
         RETURNING id, kind, urgent, subject, text, path, vessel_id, order_id, alert_id,
                   created_at, read_at",
        user,
        now
    )?;
    // RETURNING guarantees no order.
    taken.sort_by_key(|notification| notification.id);
    Ok(taken)
}

/// Deletes notifications past their retention.
pub(super) async fn prune(db: &Db, now: Time) -> DbResult<()> {
    let mut tx = db.begin().await?;
    execute!(
        &mut tx,
        "DELETE FROM notifications WHERE created_at < $1",
        Time(now.0.plus_seconds(-RETENTION_S))
    )?;
    tx.commit().await
}

/// Last recorded state of a compass's need.
#[derive(Clone, Debug, PartialEq, sqlx::FromRow)]
pub(super) struct RecordedNeed {
    pub(super) vessel_id: VesselId,
    pub(super) compass_id: CompassId,
    pub(super) due_on: String,
    pub(super) urgency: String,
    pub(super) reason: String,
}

/// Returns the last recorded needs of an operator's compasses.
pub(super) async fn list_recorded_needs(
    db: &Db,
    operator: OperatorId,
) -> DbResult<Vec<RecordedNeed>> {
    rows!(
        db,
        RecordedNeed,
        "SELECT t.vessel_id, t.compass_id, t.due_on, t.urgency, t.reason FROM needs_told t
         JOIN vessels v ON v.id = t.vessel_id
         WHERE v.operator_id = $1
         ORDER BY t.vessel_id, t.compass_id",
        operator
    )
}

/// Records a compass's need; false when another process was faster.
pub(super) async fn record_need(
    tx: &mut Tx,
    before: Option<&RecordedNeed>,
    current: &RecordedNeed,
    now: Time,
) -> DbResult<bool> {
    let recorded = match before {
        None => execute!(
            tx,
            "INSERT INTO needs_told (vessel_id, compass_id, due_on, urgency, reason, version,
                                     changed_at)
             VALUES ($1, $2, $3, $4, $5, 1, $6)
             ON CONFLICT (vessel_id, compass_id) DO NOTHING",
            current.vessel_id,
            current.compass_id,
            current.due_on.as_str(),
            current.urgency.as_str(),
            current.reason.as_str(),
            now
        )?,
        Some(before) => execute!(
            tx,
            "UPDATE needs_told
             SET due_on = $6, urgency = $7, reason = $8, version = version + 1, changed_at = $9
             WHERE vessel_id = $1 AND compass_id = $2
               AND due_on = $3 AND urgency = $4 AND reason = $5",
            current.vessel_id,
            current.compass_id,
            before.due_on.as_str(),
            before.urgency.as_str(),
            before.reason.as_str(),
            current.due_on.as_str(),
            current.urgency.as_str(),
            current.reason.as_str(),
            now
        )?,
    };
    Ok(recorded > 0)
}

/// Deletes the recorded need of a compass that has none any more.
pub(super) async fn delete_recorded_need(tx: &mut Tx, ended: &RecordedNeed) -> DbResult<()> {
    execute!(
        tx,
        "DELETE FROM needs_told WHERE vessel_id = $1 AND compass_id = $2",
        ended.vessel_id,
        ended.compass_id
    )?;
    Ok(())
}
