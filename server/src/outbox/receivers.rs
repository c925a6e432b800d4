//! What webhooks and mail recipients have in common: a row of their own in the
//! queue's terms, under the same id.

use super::delivery::Channel;
use crate::db::{Result as DbResult, Tx, execute};
use crate::error::{Error, Result};
use crate::ids::OperatorId;
use uuid::Uuid;

/// Makes a receiver; what it is besides is its channel's business.
pub async fn insert(
    tx: &mut Tx,
    operator: OperatorId,
    id: Uuid,
    channel: Channel,
    enabled: bool,
) -> DbResult<()> {
    execute!(
        tx,
        "INSERT INTO receivers (id, operator_id, channel, enabled, last_number)
         VALUES ($1, $2, $3, $4, 0)",
        id,
        operator,
        channel,
        enabled
    )?;
    Ok(())
}

/// Has messages sent to a receiver, or kept waiting.
pub async fn enable(tx: &mut Tx, operator: OperatorId, id: Uuid, enabled: bool) -> DbResult<()> {
    execute!(
        tx,
        "UPDATE receivers SET enabled = $3 WHERE operator_id = $1 AND id = $2",
        operator,
        id,
        enabled
    )?;
    Ok(())
}

/// Removes a receiver with its deliveries and what its channel knows of it.
///
/// # Errors
/// [`Error::NotFound`] when the operator has no such receiver on the channel.
pub async fn delete(tx: &mut Tx, operator: OperatorId, id: Uuid, channel: Channel) -> Result<()> {
    let deleted = execute!(
        tx,
        "DELETE FROM receivers WHERE operator_id = $1 AND id = $2 AND channel = $3",
        operator,
        id,
        channel
    )?;
    if deleted == 0 {
        return Err(Error::NotFound("receiver"));
    }
    Ok(())
}
