//! Receivers: the common part of webhooks and mail recipients. Each has a row in the queue's
//! table of receivers, with the same id.

use super::delivery::Channel;
use crate::db::{Result as DbResult, Tx, execute};
use crate::error::{Error, Result};
use crate::tenants::Tenant;
use uuid::Uuid;

/// Creates a receiver; its channel stores the rest.
pub async fn insert(
    tx: &mut Tx,
    tenant: impl Into<Tenant>,
    id: Uuid,
    channel: Channel,
    enabled: bool,
) -> DbResult<()> {
    let (tenant, by) = (tenant.into(), tx.token());
    execute!(
        tx,
        "INSERT INTO receivers (id, operator_id, firm_id, channel, enabled, last_number,
                                made_by_token)
         VALUES ($1, $2, $3, $4, $5, 0, $6)",
        id,
        tenant.operator(),
        tenant.firm(),
        channel,
        enabled,
        by
    )?;
    Ok(())
}

/// Creates an enabled receiver, unless one with the id exists.
pub async fn ensure(tx: &mut Tx, tenant: Tenant, id: Uuid, channel: Channel) -> DbResult<()> {
    execute!(
        tx,
        "INSERT INTO receivers (id, operator_id, firm_id, channel, enabled, last_number)
         VALUES ($1, $2, $3, $4, TRUE, 0)
         ON CONFLICT (id) DO NOTHING",
        id,
        tenant.operator(),
        tenant.firm(),
        channel
    )?;
    Ok(())
}

/// Removes a receiver, if it exists, with its deliveries.
pub async fn forget(tx: &mut Tx, id: Uuid) -> DbResult<()> {
    execute!(tx, "DELETE FROM receivers WHERE id = $1", id)?;
    Ok(())
}

/// Enables or pauses the messages to a receiver.
pub async fn enable(
    tx: &mut Tx,
    tenant: impl Into<Tenant>,
    id: Uuid,
    enabled: bool,
) -> DbResult<()> {
    let tenant = tenant.into();
    execute!(
        tx,
        "UPDATE receivers SET enabled = $4
         WHERE (operator_id = $1 OR firm_id = $2) AND id = $3",
        tenant.operator(),
        tenant.firm(),
        id,
        enabled
    )?;
    Ok(())
}

/// Removes a receiver with its deliveries and its channel's data.
///
/// # Errors
/// [`Error::NotFound`] when the tenant has no such receiver on the channel.
pub async fn delete(
    tx: &mut Tx,
    tenant: impl Into<Tenant>,
    id: Uuid,
    channel: Channel,
) -> Result<()> {
    let tenant = tenant.into();
    let deleted = execute!(
        tx,
        "DELETE FROM receivers
         WHERE (operator_id = $1 OR firm_id = $2) AND id = $3 AND channel = $4",
        tenant.operator(),
        tenant.firm(),
        id,
        channel
    )?;
    if deleted == 0 {
        return Err(Error::NotFound("receiver"));
    }
    Ok(())
}
