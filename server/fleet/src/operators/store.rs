//! Operators in the database.

use super::Operator;
use binnacle_platform::db::{Db, Result, Tx, execute, row, rows};
use binnacle_platform::ids::OperatorId;
use binnacle_platform::time::Time;
use uuid::Uuid;

/// Creates an operator.
pub async fn create(tx: &mut Tx, name: &str, now: Time) -> Result<OperatorId> {
    let id = OperatorId::new();
    insert(tx, id, name, now).await?;
    Ok(id)
}

pub(super) async fn insert(tx: &mut Tx, id: OperatorId, name: &str, now: Time) -> Result<()> {
    execute!(
        tx,
        "INSERT INTO operators (id, name, created_at) VALUES ($1, $2, $3)",
        id,
        name,
        now
    )?;
    Ok(())
}

/// Tells whether an operator exists.
pub async fn exists(tx: &mut Tx, id: OperatorId) -> Result<bool> {
    let found = row!(
        in tx,
        (OperatorId,),
        "SELECT id FROM operators WHERE id = $1 ORDER BY id",
        id
    )?;
    Ok(found.is_some())
}

/// Lists all operators.
pub async fn all(db: &Db) -> Result<Vec<OperatorId>> {
    let found = rows!(db, (OperatorId,), "SELECT id FROM operators ORDER BY id")?;
    Ok(found.into_iter().map(|(id,)| id).collect())
}

pub(super) async fn list(db: &Db, after: Option<Uuid>, limit: i64) -> Result<Vec<Operator>> {
    rows!(
        db,
        Operator,
        "SELECT id, name, created_at FROM operators WHERE id > $1 ORDER BY id LIMIT $2",
        after.unwrap_or_default(),
        limit
    )
}

pub(super) async fn find(db: &Db, id: OperatorId) -> Result<Option<Operator>> {
    row!(
        db,
        Operator,
        "SELECT id, name, created_at FROM operators WHERE id = $1 ORDER BY id",
        id
    )
}
