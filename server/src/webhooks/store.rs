//! Webhooks in the database.

use super::webhook::{NewWebhook, Webhook};
use crate::db::{Db, Result as DbResult, Tx, execute, row, rows};
use crate::error::{Error, Result};
use crate::ids::{OperatorId, WebhookId};
use crate::time::Time;
use uuid::Uuid;

pub(super) async fn list(
    db: &Db,
    operator: OperatorId,
    after: Option<Uuid>,
    limit: i64,
) -> DbResult<Vec<Webhook>> {
    rows!(
        db,
        Webhook,
        "SELECT w.id, w.url, w.kinds, w.enabled, w.created_at,
                (SELECT COUNT(*) FROM webhook_deliveries d
                 WHERE d.webhook_id = w.id AND d.state = 'pending') AS pending,
                (SELECT COUNT(*) FROM webhook_deliveries d
                 WHERE d.webhook_id = w.id AND d.state = 'dead') AS dead
         FROM webhooks w
         WHERE w.operator_id = $1 AND w.id > $2
         ORDER BY w.id
         LIMIT $3",
        operator,
        after.unwrap_or_default(),
        limit
    )
}

/// A webhook of the operator's.
///
/// # Errors
/// [`Error::NotFound`] when there is none.
pub(super) async fn must_find(db: &Db, operator: OperatorId, id: WebhookId) -> Result<Webhook> {
    row!(
        db,
        Webhook,
        "SELECT w.id, w.url, w.kinds, w.enabled, w.created_at,
                (SELECT COUNT(*) FROM webhook_deliveries d
                 WHERE d.webhook_id = w.id AND d.state = 'pending') AS pending,
                (SELECT COUNT(*) FROM webhook_deliveries d
                 WHERE d.webhook_id = w.id AND d.state = 'dead') AS dead
         FROM webhooks w
         WHERE w.operator_id = $1 AND w.id = $2
         ORDER BY w.id",
        operator,
        id
    )?
    .ok_or(Error::NotFound("webhook"))
}

pub(super) async fn insert(
    tx: &mut Tx,
    operator: OperatorId,
    id: WebhookId,
    new: &NewWebhook,
    secret: &str,
    now: Time,
) -> Result<()> {
    execute!(
        tx,
        "INSERT INTO webhooks (id, operator_id, url, secret, kinds, enabled, created_at,
                               last_number)
         VALUES ($1, $2, $3, $4, $5, $6, $7, 0)",
        id,
        operator,
        new.url.as_str(),
        secret,
        serde_json::to_string(&new.kinds)?,
        new.enabled,
        now
    )?;
    Ok(())
}

/// A webhook's secret, for the one answer that shows it.
pub(super) async fn secret(tx: &mut Tx, operator: OperatorId, id: WebhookId) -> Result<String> {
    let found = row!(
        in tx,
        (String,),
        "SELECT secret FROM webhooks WHERE operator_id = $1 AND id = $2 ORDER BY id",
        operator,
        id
    )?;
    let (secret,) = found.ok_or(Error::NotFound("webhook"))?;
    Ok(secret)
}

/// Changes a webhook; its secret stays.
///
/// # Errors
/// [`Error::NotFound`] when the operator has no such webhook.
pub(super) async fn change(
    tx: &mut Tx,
    operator: OperatorId,
    id: WebhookId,
    wanted: &NewWebhook,
) -> Result<()> {
    let changed = execute!(
        tx,
        "UPDATE webhooks SET url = $3, kinds = $4, enabled = $5
         WHERE operator_id = $1 AND id = $2",
        operator,
        id,
        wanted.url.as_str(),
        serde_json::to_string(&wanted.kinds)?,
        wanted.enabled
    )?;
    must_be_one(changed)
}

/// Removes a webhook with its deliveries.
///
/// # Errors
/// [`Error::NotFound`] when the operator has no such webhook.
pub(super) async fn delete(tx: &mut Tx, operator: OperatorId, id: WebhookId) -> Result<()> {
    let deleted = execute!(
        tx,
        "DELETE FROM webhooks WHERE operator_id = $1 AND id = $2",
        operator,
        id
    )?;
    must_be_one(deleted)
}

fn must_be_one(touched: u64) -> Result<()> {
    if touched == 0 {
        return Err(Error::NotFound("webhook"));
    }
    Ok(())
}
