//! Webhooks in the database.

use super::webhook::{Kinds, NewWebhook, Webhook};
use crate::db::{Db, Result as DbResult, Tx, execute, row, rows};
use crate::error::{Error, Result};
use crate::ids::WebhookId;
use crate::outbox::{self, Channel};
use crate::tenants::Tenant;
use crate::time::Time;
use uuid::Uuid;

pub(super) async fn list(
    db: &Db,
    tenant: Tenant,
    after: Option<Uuid>,
    limit: i64,
) -> DbResult<Vec<Webhook>> {
    rows!(
        db,
        Webhook,
        "SELECT w.id, w.url, w.kinds, r.enabled, w.created_at,
                (SELECT COUNT(*) FROM deliveries d
                 WHERE d.receiver_id = w.id AND d.state = 'pending') AS pending,
                (SELECT COUNT(*) FROM deliveries d
                 WHERE d.receiver_id = w.id AND d.state = 'dead') AS dead
         FROM webhooks w
         JOIN receivers r ON r.id = w.id
         WHERE (w.operator_id = $1 OR w.firm_id = $2) AND w.id > $3
         ORDER BY w.id
         LIMIT $4",
        tenant.operator(),
        tenant.firm(),
        after.unwrap_or_default(),
        limit
    )
}

/// Returns a webhook of the tenant.
///
/// # Errors
/// [`Error::NotFound`] when there is none.
pub(super) async fn must_find(db: &Db, tenant: Tenant, id: WebhookId) -> Result<Webhook> {
    row!(
        db,
        Webhook,
        "SELECT w.id, w.url, w.kinds, r.enabled, w.created_at,
                (SELECT COUNT(*) FROM deliveries d
                 WHERE d.receiver_id = w.id AND d.state = 'pending') AS pending,
                (SELECT COUNT(*) FROM deliveries d
                 WHERE d.receiver_id = w.id AND d.state = 'dead') AS dead
         FROM webhooks w
         JOIN receivers r ON r.id = w.id
         WHERE (w.operator_id = $1 OR w.firm_id = $2) AND w.id = $3
         ORDER BY w.id",
        tenant.operator(),
        tenant.firm(),
        id
    )?
    .ok_or(Error::NotFound("webhook"))
}

pub(super) async fn insert(
    tx: &mut Tx,
    tenant: Tenant,
    id: WebhookId,
    new: &NewWebhook,
    secret: &str,
    now: Time,
) -> Result<()> {
    outbox::insert(tx, tenant, id.0, Channel::Webhook, new.enabled).await?;
    execute!(
        tx,
        "INSERT INTO webhooks (id, operator_id, firm_id, url, secret, kinds, created_at)
         VALUES ($1, $2, $3, $4, $5, $6, $7)",
        id,
        tenant.operator(),
        tenant.firm(),
        new.url.as_str(),
        secret,
        serde_json::to_string(&new.kinds)?,
        now
    )?;
    Ok(())
}

/// Returns the secret of a webhook, for the one response that shows it.
pub(super) async fn secret(tx: &mut Tx, tenant: Tenant, id: WebhookId) -> Result<String> {
    let found = row!(
        in tx,
        (String,),
        "SELECT secret FROM webhooks
         WHERE (operator_id = $1 OR firm_id = $2) AND id = $3
         ORDER BY id",
        tenant.operator(),
        tenant.firm(),
        id
    )?;
    let (secret,) = found.ok_or(Error::NotFound("webhook"))?;
    Ok(secret)
}

/// Changes a webhook; its secret stays.
///
/// # Errors
/// [`Error::NotFound`] when the tenant has no such webhook.
pub(super) async fn change(
    tx: &mut Tx,
    tenant: Tenant,
    id: WebhookId,
    wanted: &NewWebhook,
) -> Result<()> {
    outbox::enable(tx, tenant, id.0, wanted.enabled).await?;
    let changed = execute!(
        tx,
        "UPDATE webhooks SET url = $4, kinds = $5
         WHERE (operator_id = $1 OR firm_id = $2) AND id = $3",
        tenant.operator(),
        tenant.firm(),
        id,
        wanted.url.as_str(),
        serde_json::to_string(&wanted.kinds)?
    )?;
    if changed == 0 {
        return Err(Error::NotFound("webhook"));
    }
    Ok(())
}

/// Returns a webhook's URL and signing secret; none if it was removed.
pub(super) async fn address(db: &Db, id: Uuid) -> DbResult<Option<(String, String)>> {
    row!(
        db,
        (String, String),
        "SELECT url, secret FROM webhooks WHERE id = $1 ORDER BY id",
        id
    )
}

/// Returns a tenant's enabled webhooks, each with the kinds of messages it receives.
pub(super) async fn list_subscriptions(tx: &mut Tx, tenant: Tenant) -> Result<Vec<(Uuid, Kinds)>> {
    let found = rows!(
        in tx,
        (Uuid, String),
        "SELECT w.id, w.kinds FROM webhooks w
         JOIN receivers r ON r.id = w.id AND r.enabled
         WHERE w.operator_id = $1 OR w.firm_id = $2
         ORDER BY w.id",
        tenant.operator(),
        tenant.firm()
    )?;
    let read = |(id, kinds)| Ok((id, Kinds::try_from(kinds)?));
    found.into_iter().map(read).collect()
}
