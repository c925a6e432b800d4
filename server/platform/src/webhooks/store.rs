//! Webhooks in the database.

use super::format::Format;
use super::webhook::{Kinds, NewWebhook, Webhook};
use crate::db::{Db, Result as DbResult, Tx, execute, row, rows};
use crate::error::{Error, Result};
use crate::ids::WebhookId;
use crate::outbox::{self, Channel};
use crate::sealing::{Seals, StoredSecret};
use crate::secret::{base64url, from_base64url};
use crate::tenants::Tenant;
use crate::time::Time;
use futures_util::future::BoxFuture;
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
        "SELECT w.id, w.url, w.kinds, r.enabled, w.format, w.created_at,
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
        "SELECT w.id, w.url, w.kinds, r.enabled, w.format, w.created_at,
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
    let (secret, sealed_by) = sealed(tx.seals(), id.0, secret);
    execute!(
        tx,
        "INSERT INTO webhooks (id, operator_id, firm_id, url, secret, sealed_by, kinds, created_at,
                               format)
         VALUES ($1, $2, $3, $4, $5, $6, $7, $8, $9)",
        id,
        tenant.operator(),
        tenant.firm(),
        new.url.as_str(),
        secret,
        sealed_by,
        serde_json::to_string(&new.kinds)?,
        now,
        new.format
    )?;
    Ok(())
}

/// Returns the secret of a webhook, for the one response that shows it.
pub(super) async fn secret(tx: &mut Tx, tenant: Tenant, id: WebhookId) -> Result<String> {
    let found = row!(
        in &mut *tx,
        (String, Option<String>),
        "SELECT secret, sealed_by FROM webhooks
         WHERE (operator_id = $1 OR firm_id = $2) AND id = $3
         ORDER BY id",
        tenant.operator(),
        tenant.firm(),
        id
    )?;
    let (secret, sealed_by) = found.ok_or(Error::NotFound("webhook"))?;
    Ok(opened(tx.seals(), id.0, secret, sealed_by)?)
}

/// Returns the name of a webhook's secret, to which its seal is bound.
fn row_of(id: Uuid) -> String {
    format!("secret of the webhook {id}")
}

/// Returns a secret as its column has it, and the id of the key that sealed it.
fn sealed(seals: &Seals, id: Uuid, secret: &str) -> (String, Option<String>) {
    let stored = seals.seal(&row_of(id), secret.as_bytes());
    match stored.sealed_by {
        Some(key) => (base64url(&stored.bytes), Some(key)),
        None => (secret.to_owned(), None),
    }
}

/// Returns the secret in a column.
fn opened(seals: &Seals, id: Uuid, column: String, sealed_by: Option<String>) -> DbResult<String> {
    if sealed_by.is_none() {
        return Ok(column);
    }
    let bytes = from_base64url(&column).unwrap_or_default();
    let secret = seals.open(&row_of(id), &StoredSecret { bytes, sealed_by })?;
    String::from_utf8(secret).map_err(|error| sqlx::Error::Decode(Box::new(error)))
}

/// Seals the secrets that the present key has not sealed, and returns their number.
pub(crate) async fn reseal(tx: &mut Tx) -> DbResult<u64> {
    let current = tx.seals().current().map(str::to_owned);
    let found = rows!(
        in &mut *tx,
        (Uuid, String, Option<String>),
        "SELECT id, secret, sealed_by FROM webhooks
         WHERE COALESCE(sealed_by, '') <> COALESCE($1, '') ORDER BY id",
        current
    )?;
    let mut count = 0;
    for (id, column, sealed_by) in found {
        let secret = opened(tx.seals(), id, column, sealed_by)?;
        let (secret, sealed_by) = sealed(tx.seals(), id, &secret);
        count += execute!(
            &mut *tx,
            "UPDATE webhooks SET secret = $2, sealed_by = $3 WHERE id = $1",
            id,
            secret,
            sealed_by
        )?;
    }
    Ok(count)
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
        "UPDATE webhooks SET url = $4, kinds = $5, format = $6
         WHERE (operator_id = $1 OR firm_id = $2) AND id = $3",
        tenant.operator(),
        tenant.firm(),
        id,
        wanted.url.as_str(),
        serde_json::to_string(&wanted.kinds)?,
        wanted.format
    )?;
    if changed == 0 {
        return Err(Error::NotFound("webhook"));
    }
    Ok(())
}

/// Address of a webhook, and the form of its messages.
pub(super) struct Address {
    pub(super) url: String,
    pub(super) secret: String,
    pub(super) format: Format,
}

/// Returns a webhook's address; none if it was removed.
pub(super) async fn address(db: &Db, id: Uuid) -> DbResult<Option<Address>> {
    let found = row!(
        db,
        (String, String, Option<String>, Format),
        "SELECT url, secret, sealed_by, format FROM webhooks WHERE id = $1 ORDER BY id",
        id
    )?;
    let opened = found.map(|(url, column, sealed_by, format)| {
        let secret = opened(db.seals(), id, column, sealed_by)?;
        Ok(Address {
            url,
            secret,
            format,
        })
    });
    opened.transpose()
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

/// Counts the webhooks of a tenant.
pub(super) fn count(tx: &mut Tx, tenant: Tenant, _: Time) -> BoxFuture<'_, DbResult<i64>> {
    Box::pin(async move {
        let found = row!(
            in tx,
            (i64,),
            "SELECT COUNT(*) FROM webhooks WHERE operator_id = $1 OR firm_id = $2",
            tenant.operator(),
            tenant.firm()
        )?;
        Ok(found.map_or(0, |(count,)| count))
    })
}
