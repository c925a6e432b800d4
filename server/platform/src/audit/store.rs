//! Audit lines in the database.

use super::{Filter, Line};
use crate::db::{Db, Result, Tx, execute, rows};
use crate::ids::{FirmId, OperatorId};
use crate::time::Time;
use uuid::Uuid;

/// Filter and tenant of the lines to list; all tenants if that is `None`.
pub(crate) struct Selection {
    pub(crate) operator: Option<OperatorId>,
    pub(crate) firm: Option<FirmId>,
    pub(crate) filter: Filter,
    pub(crate) from: Option<Time>,
    pub(crate) to: Option<Time>,
}

pub(super) async fn insert(tx: &mut Tx, line: &Line) -> Result<()> {
    execute!(
        tx,
        "INSERT INTO audit_lines (id, at, operator_id, firm_id, actor_kind, actor_id, actor_name,
                                  token_id, address, method, route, path, vessel_id, order_id,
                                  status, account, refusal)
         VALUES ($1, $2, $3, $4, $5, $6, $7, $8, $9, $10, $11, $12, $13, $14, $15, $16, $17)",
        line.id,
        line.at,
        line.operator_id,
        line.firm_id,
        line.actor_kind,
        line.actor_id,
        line.actor_name.as_str(),
        line.token_id,
        line.address.as_str(),
        line.method.as_str(),
        line.route.as_str(),
        line.path.as_str(),
        line.vessel_id,
        line.order_id,
        line.status,
        line.account.as_deref(),
        line.refusal
    )?;
    Ok(())
}

/// Records the response status of a request whose line exists.
pub(super) async fn set_status(db: &Db, id: Uuid, status: i64) -> Result<()> {
    let mut tx = db.begin().await?;
    execute!(
        &mut tx,
        "UPDATE audit_lines SET status = $2 WHERE id = $1 AND status IS NULL",
        id,
        status
    )?;
    tx.commit().await
}

/// Lists lines newest first, from before an id.
pub(crate) async fn list(
    db: &Db,
    selection: &Selection,
    before: Option<Uuid>,
    limit: i64,
) -> Result<Vec<Line>> {
    let filter = &selection.filter;
    rows!(
        db,
        Line,
        "SELECT id, at, actor_kind, actor_id, actor_name, token_id, operator_id, firm_id, address,
                method, route, path, vessel_id, order_id, status, account, refusal
         FROM audit_lines
         WHERE ($1 IS NULL OR operator_id = $1) AND ($2 IS NULL OR firm_id = $2) AND id < $3
           AND ($4 IS NULL OR actor_id = $4)
           AND ($5 IS NULL OR vessel_id = $5)
           AND ($6 IS NULL OR order_id = $6)
           AND ($7 IS NULL OR route = $7)
           AND ($8 IS NULL OR at >= $8)
           AND ($9 IS NULL OR at < $9)
           AND ($10 IS NULL OR token_id = $10)
           AND ($11 IS NULL OR (refusal IS NOT NULL) = $11)
         ORDER BY id DESC
         LIMIT $12",
        selection.operator,
        selection.firm,
        before.unwrap_or(Uuid::max()),
        filter.actor,
        filter.vessel,
        filter.order,
        filter.route.as_deref(),
        selection.from,
        selection.to,
        filter.token,
        filter.refused,
        limit
    )
}

pub(super) async fn remove_before(db: &Db, before: Time) -> Result<u64> {
    let mut tx = db.begin().await?;
    let removed = execute!(&mut tx, "DELETE FROM audit_lines WHERE at < $1", before)?;
    tx.commit().await?;
    Ok(removed)
}
