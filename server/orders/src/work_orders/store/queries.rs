//! Queries of orders and their logs.
//!
//! Invariant: an order is found only by its operator, or by a firm that has an open offer or
//! proposal, or has the order.

use crate::work_orders::state::State;
use crate::work_orders::store::stored_order::StoredOrder;
use crate::work_orders::summary::{Filter, Summary};
use binnacle_platform::db::{self, Db, Tx, execute, row, rows};
use binnacle_platform::error::{Error, Result};
use binnacle_platform::ids::{CompassId, FirmId, OperatorId, OrderId, PhotoId, VesselId};
use binnacle_platform::signing_keys::Seal;
use binnacle_platform::tenants::Tenant;
use binnacle_platform::time::Time;
use futures_util::future::BoxFuture;
use uuid::Uuid;

/// Summaries of orders as a firm (`$1`) or, if that is null, an operator sees them.
macro_rules! summary_sql {
    ($rest:literal) => {
        concat!(
            "SELECT p.id AS operator_id, p.name AS operator_name, o.vessel_id,
                    v.name AS vessel_name, o.id, o.compass_id, c.name AS compass_name,
                    CASE f.state WHEN 'open' THEN 'offered' WHEN 'proposed' THEN 'proposed'
                                 ELSE o.state END AS state,
                    o.port, o.berth, o.planned_at, o.planned_at + o.job_us AS planned_until,
                    o.agreed_utc_offset_s, o.adjuster_name, o.adjuster_licence, o.firm,
                    o.firm_id, o.created_at, o.created_by, o.completed_at, o.last_seq,
                    o.last_sha256, o.call_fit,
                    CASE WHEN f.firm_id IS NULL THEN o.answer_by ELSE f.answer_by END
                        AS answer_by,
                    EXISTS (SELECT 1 FROM binnacles b
                            WHERE b.vessel_id = o.vessel_id AND b.compass_id = o.compass_id)
                        AS has_binnacle
             FROM work_orders o
             JOIN vessels v ON v.id = o.vessel_id
             JOIN operators p ON p.id = v.operator_id
             JOIN compasses c ON c.vessel_id = o.vessel_id AND c.id = o.compass_id
             LEFT JOIN work_order_offers f ON f.vessel_id = o.vessel_id AND f.order_id = o.id
                                          AND f.firm_id = $1 ",
            $rest
        )
    };
}

/// Part of the orders to list.
pub(crate) struct ListedOrders {
    /// Vessel and state.
    pub(crate) filter: Filter,
    /// First instant of the jobs, and the first after it, microseconds since 1970.
    pub(crate) planned: (i64, i64),
    /// Id before which the list begins.
    pub(crate) before: Option<Uuid>,
    /// Maximum number of orders.
    pub(crate) limit: i64,
}

/// Lists orders, the newest first.
pub(crate) async fn list(db: &Db, tenant: Tenant, asked: &ListedOrders) -> Result<Vec<Summary>> {
    let filter = &asked.filter;
    let found = rows!(
        db,
        Summary,
        summary_sql!(
            "WHERE (v.operator_id = $2 OR f.state IN ('open', 'proposed', 'accepted'))
               AND o.id < $3
               AND ($4 IS NULL OR o.vessel_id = $4)
               AND ($5 IS NULL OR $5 = CASE f.state WHEN 'open' THEN 'offered'
                                                    WHEN 'proposed' THEN 'proposed'
                                                    ELSE o.state END)
               AND o.planned_at >= $6 AND o.planned_at < $7
             ORDER BY o.id DESC
             LIMIT $8"
        ),
        tenant.firm(),
        tenant.operator(),
        asked.before.unwrap_or(Uuid::max()),
        filter.vessel,
        filter.state,
        asked.planned.0,
        asked.planned.1,
        asked.limit
    )?;
    Ok(found.into_iter().map(Summary::with_local_times).collect())
}

/// Finds the summary of an order that the tenant sees.
///
/// # Errors
/// [`Error::NotFound`] when there is none.
pub(crate) async fn find_summary(db: &Db, tenant: Tenant, id: OrderId) -> Result<Summary> {
    row!(
        db,
        Summary,
        summary_sql!(
            "WHERE (v.operator_id = $2 OR f.state IN ('open', 'proposed', 'accepted'))
               AND o.id = $3
             ORDER BY o.id"
        ),
        tenant.firm(),
        tenant.operator(),
        id
    )?
    .map(Summary::with_local_times)
    .ok_or(Error::NotFound("work order"))
}

/// Finds the vessel of the order with an id, for any tenant.
pub(crate) fn find_vessel(tx: &mut Tx, order: Uuid) -> BoxFuture<'_, db::Result<Option<VesselId>>> {
    Box::pin(async move {
        let found = row!(
            in tx,
            (VesselId,),
            "SELECT vessel_id FROM work_orders WHERE id = $1 ORDER BY vessel_id",
            order
        )?;
        Ok(found.map(|(vessel,)| vessel))
    })
}

/// Finds the vessel of an order that a firm was once offered, whether or not it still sees it.
pub(crate) async fn find_vessel_for_firm(db: &Db, firm: FirmId, id: OrderId) -> Result<VesselId> {
    let found = row!(
        db,
        (VesselId,),
        "SELECT vessel_id FROM work_order_offers
         WHERE firm_id = $1 AND order_id = $2 AND state <> 'waiting'
         ORDER BY vessel_id",
        firm,
        id
    )?;
    let (vessel,) = found.ok_or(Error::NotFound("work order"))?;
    Ok(vessel)
}

/// Lists orders with an overdue answer, the longest overdue first.
pub(crate) async fn list_overdue(
    db: &Db,
    now: Time,
    limit: i64,
) -> Result<Vec<(VesselId, OrderId)>> {
    Ok(rows!(
        db,
        (VesselId, OrderId),
        "SELECT vessel_id, id FROM work_orders
         WHERE answer_by < $1
         ORDER BY answer_by, id
         LIMIT $2",
        now,
        limit
    )?)
}

/// Locks an order of a vessel, and loads it as its operator sees it.
pub(crate) async fn lock(tx: &mut Tx, vessel: VesselId, id: OrderId) -> Result<StoredOrder> {
    execute!(
        &mut *tx,
        "UPDATE work_orders SET state = state WHERE vessel_id = $1 AND id = $2",
        vessel,
        id
    )?;
    let summary = row!(
        in &mut *tx,
        Summary,
        summary_sql!("WHERE o.vessel_id = $2 AND o.id = $3 ORDER BY o.id"),
        None::<FirmId>,
        vessel,
        id
    )?
    .map(Summary::with_local_times)
    .ok_or(Error::NotFound("work order"))?;
    let lines = rows!(
        in tx,
        (String,),
        "SELECT line FROM work_order_entries
         WHERE vessel_id = $1 AND order_id = $2
         ORDER BY seq",
        vessel,
        id
    )?;
    StoredOrder::read(summary, lines)
}

/// Finds an order that the tenant sees, with its log.
pub(crate) async fn find(db: &Db, tenant: Tenant, id: OrderId) -> Result<StoredOrder> {
    let summary = find_summary(db, tenant, id).await?;
    let lines = rows!(
        db,
        (String,),
        "SELECT line FROM work_order_entries
         WHERE vessel_id = $1 AND order_id = $2
         ORDER BY seq",
        summary.vessel_id,
        id
    )?;
    StoredOrder::read(summary, lines)
}

/// Original line of an order's log.
#[derive(sqlx::FromRow)]
pub(crate) struct StoredLine {
    /// Number of the entry, from 1.
    pub(crate) seq: i64,
    pub(crate) line: String,
    /// SHA-256 of the line, hexadecimal.
    pub(crate) sha256: String,
    seal_key: Option<String>,
    seal: Option<String>,
}

impl StoredLine {
    /// Returns the server's signature; none of a line from before servers signed.
    pub(crate) fn seal(&self) -> Option<Seal> {
        let (key, signature) = self.seal_key.clone().zip(self.seal.clone())?;
        Some(Seal { key, signature })
    }
}

/// Lists the original lines of an order's log after a number.
pub(crate) async fn list_lines(
    db: &Db,
    vessel: VesselId,
    id: OrderId,
    after: Option<i64>,
    limit: i64,
) -> Result<Vec<StoredLine>> {
    Ok(rows!(
        db,
        StoredLine,
        "SELECT seq, line, sha256, seal_key, seal FROM work_order_entries
         WHERE vessel_id = $1 AND order_id = $2 AND seq > $3
         ORDER BY seq
         LIMIT $4",
        vessel,
        id,
        after.unwrap_or(0),
        limit
    )?)
}

/// Finds the compass's last completed order. One that was closed after headings at sea had
/// contradicted it still counts as failed.
pub(crate) async fn find_last_completed(
    tx: &mut Tx,
    vessel: VesselId,
    compass: CompassId,
) -> Result<Option<(OrderId, State, Time)>> {
    Ok(row!(
        in tx,
        (OrderId, State, Time),
        "SELECT id,
                CASE WHEN state = 'closed' AND verified_at IS NULL THEN 'failed' ELSE state END,
                completed_at
         FROM work_orders
         WHERE vessel_id = $1 AND compass_id = $2 AND completed_at IS NOT NULL
         ORDER BY completed_at DESC, id DESC
         LIMIT 1",
        vessel,
        compass
    )?)
}

/// Finds the names of an operator's vessel and of one of its compasses.
///
/// # Errors
/// [`Error::NotFound`] when there is no such vessel or compass.
pub(crate) async fn find_names(
    tx: &mut Tx,
    operator: OperatorId,
    vessel: VesselId,
    compass: CompassId,
) -> Result<(String, String)> {
    let found = row!(
        in &mut *tx,
        (String,),
        "SELECT name FROM vessels WHERE operator_id = $1 AND id = $2 ORDER BY id",
        operator,
        vessel
    )?;
    let (vessel_name,) = found.ok_or(Error::NotFound("vessel"))?;
    let found = row!(
        in tx,
        (String,),
        "SELECT name FROM compasses WHERE vessel_id = $1 AND id = $2 ORDER BY id",
        vessel,
        compass
    )?;
    let (compass_name,) = found.ok_or(Error::NotFound("compass"))?;
    Ok((vessel_name, compass_name))
}

/// Finds the signed record; `None` before the order is completed.
pub(crate) async fn find_record(db: &Db, vessel: VesselId, id: OrderId) -> Result<Option<String>> {
    let found = row!(
        db,
        (Option<String>,),
        "SELECT record FROM work_orders WHERE vessel_id = $1 AND id = $2 ORDER BY id",
        vessel,
        id
    )?;
    Ok(found.and_then(|(record,)| record))
}

/// Finds a photograph's media type and bytes.
pub(crate) async fn find_photo(
    db: &Db,
    vessel: VesselId,
    order: OrderId,
    id: PhotoId,
) -> Result<Option<(String, Vec<u8>)>> {
    Ok(row!(
        db,
        (String, Vec<u8>),
        "SELECT media_type, bytes FROM work_order_photos
         WHERE vessel_id = $1 AND order_id = $2 AND id = $3
         ORDER BY id",
        vessel,
        order,
        id
    )?)
}
