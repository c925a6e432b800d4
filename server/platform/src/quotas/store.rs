//! Limits in the database.

use super::Quota;
use crate::db::{self, Tx, execute, row};
use crate::error::{Error, Result};
use crate::ids::OperatorId;
use crate::tenants::Tenant;

/// Returns a tenant's limit.
pub(super) async fn limit(tx: &mut Tx, tenant: Tenant, quota: &Quota) -> db::Result<i64> {
    let found = row!(
        in tx,
        (i64,),
        "SELECT most FROM quotas WHERE operator_id = $1 AND name = $2 ORDER BY name",
        tenant.operator(),
        quota.name
    )?;
    Ok(found.map_or(quota.most, |(most,)| most))
}

/// Sets an operator's limit; none for the one by default.
///
/// # Errors
/// [`Error::NotFound`] when there is no such operator.
pub(crate) async fn set(
    tx: &mut Tx,
    operator: OperatorId,
    quota: &Quota,
    most: Option<i64>,
) -> Result<()> {
    let known = row!(
        in &mut *tx,
        (OperatorId,),
        "SELECT id FROM operators WHERE id = $1 ORDER BY id",
        operator
    )?;
    known.ok_or(Error::NotFound("operator"))?;
    match most {
        Some(most) => execute!(
            tx,
            "INSERT INTO quotas (operator_id, name, most) VALUES ($1, $2, $3)
             ON CONFLICT (operator_id, name) DO UPDATE SET most = excluded.most",
            operator,
            quota.name,
            most
        )?,
        None => execute!(
            tx,
            "DELETE FROM quotas WHERE operator_id = $1 AND name = $2",
            operator,
            quota.name
        )?,
    };
    Ok(())
}
