//! Idempotency keys of requests to an order.
//!
//! Invariants: a key and its entry are stored in one transaction, and are kept as long as the
//! order. A key belongs to the operator or to one firm.

use crate::work_orders::summary::Summary;
use binnacle_platform::db::{Db, Tx, execute, row};
use binnacle_platform::error::{Error, Result};
use binnacle_platform::idempotency::Key;
use binnacle_platform::tenants::Tenant;
use uuid::Uuid;

/// Returns the entry id to write under: `wanted`, or that of the same request before. The caller
/// holds the order's lock.
///
/// # Errors
/// Fails when the key was used for another request to this order.
pub(crate) async fn once(
    key: &Key,
    tx: &mut Tx,
    tenant: Tenant,
    order: &Summary,
    request_hash: &[u8],
    wanted: Uuid,
) -> Result<Uuid> {
    let Some(key_hash) = key.hash() else {
        return Ok(wanted);
    };
    let known = row!(
        in &mut *tx,
        KnownRequest,
        "SELECT request_hash, entry_id FROM work_order_keys
         WHERE vessel_id = $1 AND order_id = $2 AND tenant_id = $3 AND key_hash = $4
         ORDER BY key_hash",
        order.vessel_id,
        order.id,
        tenant.id(),
        key_hash.as_slice()
    )?;
    if let Some(known) = known {
        return known.entry_of(request_hash);
    }
    execute!(
        tx,
        "INSERT INTO work_order_keys (vessel_id, order_id, tenant_id, key_hash, request_hash,
                                      entry_id)
         VALUES ($1, $2, $3, $4, $5, $6)",
        order.vessel_id,
        order.id,
        tenant.id(),
        key_hash.as_slice(),
        request_hash,
        wanted
    )?;
    Ok(wanted)
}

/// Finds the entry that the same request wrote before.
///
/// # Errors
/// Fails when the key was used for another request to this order.
pub(crate) async fn find(
    key: &Key,
    db: &Db,
    tenant: Tenant,
    order: &Summary,
    request_hash: &[u8],
) -> Result<Option<Uuid>> {
    let Some(key_hash) = key.hash() else {
        return Ok(None);
    };
    let known = row!(
        db,
        KnownRequest,
        "SELECT request_hash, entry_id FROM work_order_keys
         WHERE vessel_id = $1 AND order_id = $2 AND tenant_id = $3 AND key_hash = $4
         ORDER BY key_hash",
        order.vessel_id,
        order.id,
        tenant.id(),
        key_hash.as_slice()
    )?;
    known.map(|known| known.entry_of(request_hash)).transpose()
}

/// Request that a key was used for before.
#[derive(sqlx::FromRow)]
struct KnownRequest {
    request_hash: Vec<u8>,
    entry_id: Uuid,
}

impl KnownRequest {
    /// Returns the entry that the request wrote.
    ///
    /// # Errors
    /// Fails when the key was used for another request.
    fn entry_of(self, request_hash: &[u8]) -> Result<Uuid> {
        if self.request_hash == request_hash {
            Ok(self.entry_id)
        } else {
            Err(Error::KeyReused)
        }
    }
}
