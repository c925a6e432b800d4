//! Links between orders and port calls.
//!
//! Port calls are written elsewhere: this module only reads them.

use crate::work_orders::order_update::Change;
use crate::work_orders::payload::port_call::Alongside;
use anyhow::Context;
use binnacle_platform::db::{Tx, execute, row};
use binnacle_platform::error::Result;
use binnacle_platform::ids::{CallId, OrderId, VesselId};
use binnacle_platform::time::Time;
use binnacle_schedule::ports::PortCode;

/// Port call, as far as orders need it.
#[derive(Debug, sqlx::FromRow)]
pub(crate) struct KnownCall {
    /// The call's id.
    pub(crate) id: CallId,
    /// UN/LOCODE of the port.
    pub(crate) port: String,
    eta: Time,
    etd: Time,
}

impl KnownCall {
    /// Port and times of the stay.
    ///
    /// # Errors
    /// Fails when the stored port is not a port code.
    pub(crate) fn alongside(&self) -> Result<Alongside> {
        let port = PortCode::parse(&self.port).context("a stored port")?;
        Ok(Alongside::new(port, self.eta, self.etd))
    }
}

/// Finds the call of a vessel at a time.
pub(crate) async fn call_at(tx: &mut Tx, vessel: VesselId, at: Time) -> Result<Option<KnownCall>> {
    Ok(row!(
        in tx,
        KnownCall,
        "SELECT id, port, eta, etd FROM port_calls
         WHERE vessel_id = $1 AND eta <= $2 AND etd > $2 AND withdrawn_at IS NULL
         ORDER BY eta, id
         LIMIT 1",
        vessel,
        at
    )?)
}

/// Links an order to a call, unless it has one.
pub async fn link_once(tx: &mut Tx, vessel: VesselId, order: OrderId, call: CallId) -> Result<()> {
    execute!(
        tx,
        "INSERT INTO schedule_orders (vessel_id, order_id, call_id) VALUES ($1, $2, $3)
         ON CONFLICT (vessel_id, order_id) DO NOTHING",
        vessel,
        order,
        call
    )?;
    Ok(())
}

/// Links an order to a call, instead of any other.
pub(crate) async fn link(
    tx: &mut Tx,
    vessel: VesselId,
    order: OrderId,
    call: CallId,
) -> Result<()> {
    execute!(
        tx,
        "INSERT INTO schedule_orders (vessel_id, order_id, call_id) VALUES ($1, $2, $3)
         ON CONFLICT (vessel_id, order_id) DO UPDATE SET call_id = excluded.call_id",
        vessel,
        order,
        call
    )?;
    Ok(())
}

/// Returns the port of an order's linked call.
pub(crate) async fn linked_port(
    tx: &mut Tx,
    vessel: VesselId,
    order: OrderId,
) -> Result<Option<String>> {
    let found = row!(
        in tx,
        (String,),
        "SELECT c.port FROM schedule_orders l
         JOIN port_calls c ON c.vessel_id = l.vessel_id AND c.id = l.call_id
         WHERE l.vessel_id = $1 AND l.order_id = $2
         ORDER BY c.id",
        vessel,
        order
    )?;
    Ok(found.map(|(port,)| port))
}

/// Links an order to the call at its new time.
pub(crate) async fn link_call_at(change: &mut Change<'_>, at: Time) -> Result<()> {
    let (vessel, id) = (change.stored.summary.vessel_id, change.stored.summary.id);
    if let Some(call) = call_at(&mut change.tx, vessel, at).await? {
        link(&mut change.tx, vessel, id, call.id).await?;
    }
    Ok(())
}
