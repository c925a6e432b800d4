//! Companies with a fleet: the tenants.

use crate::db::{Result, Tx, execute, row};
use crate::ids::OperatorId;
use crate::time::Time;

/// Creates an operator.
pub async fn create(tx: &mut Tx, name: &str, now: Time) -> Result<OperatorId> {
    let id = OperatorId::new();
    execute!(
        tx,
        "INSERT INTO operators (id, name, created_at) VALUES ($1, $2, $3)",
        id,
        name,
        now
    )?;
    Ok(id)
}

/// Whether there is such an operator.
pub async fn exists(tx: &mut Tx, id: OperatorId) -> Result<bool> {
    let found = row!(
        in tx,
        (OperatorId,),
        "SELECT id FROM operators WHERE id = $1 ORDER BY id",
        id
    )?;
    Ok(found.is_some())
}
