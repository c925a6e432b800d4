//! New port calls for orders without one, whose own was withdrawn or never known.
//!
//! Invariants: an order is linked to a call of its own port only, and only if its time lies in it.
//! Parties that were notified of the lost call are notified of the new one.

use crate::dispatch::port_call_changes::CallUpdate;
use crate::dispatch::{call_links, port_call_changes};
use crate::firms::named_port;
use crate::work_orders::payload::port_call::{Alongside, CallChange, CallFit};
use crate::work_orders::store;
use binnacle_platform::db::Tx;
use binnacle_platform::error::Result;
use binnacle_platform::events::Event;
use binnacle_platform::ids::{CallId, OrderId, VesselId};
use binnacle_platform::time::Time;

/// Port call to which orders may be linked.
#[derive(Clone, Debug)]
pub struct NewCall {
    /// The call's id.
    pub id: CallId,
    /// Port and times of the call.
    pub alongside: Alongside,
}

/// Links orders without a call to new calls of a vessel, whose row is locked. Returns the live
/// events, to be published after the commit.
///
/// # Errors
/// Fails when the database cannot be written.
pub async fn attach_new_calls(
    tx: &mut Tx,
    vessel: VesselId,
    new: &[NewCall],
    by: &str,
    now: Time,
) -> Result<Vec<Event>> {
    let mut events = Vec::new();
    if new.is_empty() {
        return Ok(events);
    }
    for order in port_call_changes::under_way(tx, vessel).await? {
        if !order.is_unlinked {
            continue;
        }
        let Some((port, lost)) = port_and_lost_call(tx, vessel, order.id).await? else {
            continue;
        };
        let lies_in = |call: &&NewCall| {
            let fit = call.alongside.fit(&port, order.hours());
            matches!(fit, CallFit::Fits | CallFit::OtherHour)
        };
        let Some(call) = new.iter().find(lies_in) else {
            continue;
        };
        call_links::link(tx, vessel, order.id, call.id).await?;
        if let Some(lost) = lost {
            let update = CallUpdate {
                call_id: lost.call_id,
                then_id: call.id,
                was: lost.is.unwrap_or(lost.was),
                is: Some(call.alongside.clone()),
            };
            events.extend(
                port_call_changes::announce_update(tx, vessel, order.id, &update, by, now).await?,
            );
        }
    }
    Ok(events)
}

/// Port of an order, if its words name one, and the change of its earlier call.
async fn port_and_lost_call(
    tx: &mut Tx,
    vessel: VesselId,
    order: OrderId,
) -> Result<Option<(String, Option<CallChange>)>> {
    let stored = store::lock(tx, vessel, order).await?;
    let state = stored.state();
    let named = || named_port(&stored.summary.port).map(|port| port.code.to_string());
    let port = state.port.or_else(named);
    Ok(port.map(|port| (port, state.call_change)))
}
