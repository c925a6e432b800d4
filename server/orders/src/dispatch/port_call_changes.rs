//! Changes of a port call while an order is planned at it.
//!
//! Invariants: the operator and every firm with an open offer or the order are notified in the
//! transaction of the change. The agreed time stands until both agree on another.

use crate::dispatch::call_links;
use crate::work_orders::events::{CallMoved, OrderEvent};
use crate::work_orders::log::entry::Author;
use crate::work_orders::offers::Offer;
use crate::work_orders::payload::hours::Hours;
use crate::work_orders::payload::port_call::{Alongside, CallChange, CallFit};
use crate::work_orders::publish::OrderBefore;
use crate::work_orders::{publish, store};
use binnacle_platform::db::{Tx, execute, rows};
use binnacle_platform::error::Result;
use binnacle_platform::events::Event;
use binnacle_platform::ids::{CallId, OrderId, VesselId};
use binnacle_platform::time::Time;
use uuid::Uuid;

/// Change of a call that is about to be stored.
pub struct CallUpdate {
    /// The call before.
    pub call_id: CallId,
    /// The call afterwards; another one if a file renames it.
    pub then_id: CallId,
    /// Stay before.
    pub was: Alongside,
    /// Stay afterwards; `None` if withdrawn.
    pub is: Option<Alongside>,
}

/// Order that may be planned at a call.
#[derive(sqlx::FromRow)]
pub(crate) struct AffectedOrder {
    pub(crate) id: OrderId,
    planned_at: Time,
    planned_until: Time,
    call_id: Option<CallId>,
    /// True without a link to a valid call.
    pub(crate) is_unlinked: bool,
}

impl AffectedOrder {
    /// Hours of the job.
    pub(crate) fn hours(&self) -> Hours {
        Hours::new(self.planned_at, Some(self.planned_until))
    }
}

/// Announces changes of calls of one vessel, whose row is locked. Returns the live events, to be
/// published after the commit.
///
/// # Errors
/// Fails when the database cannot be written.
pub async fn announce_call_updates(
    tx: &mut Tx,
    vessel: VesselId,
    updates: &[CallUpdate],
    by: &str,
    now: Time,
) -> Result<Vec<Event>> {
    if updates.is_empty() {
        return Ok(Vec::new());
    }
    let mut events = Vec::new();
    for order in under_way(tx, vessel).await? {
        let at = |update: &&CallUpdate| {
            let is_then = update.was.eta <= order.planned_at && order.planned_at <= update.was.etd;
            order.call_id == Some(update.call_id) || order.is_unlinked && is_then
        };
        if let Some(update) = updates.iter().find(at) {
            call_links::link(tx, vessel, order.id, update.then_id).await?;
            events.extend(announce_update(tx, vessel, order.id, update, by, now).await?);
        }
    }
    Ok(events)
}

/// Lists the orders of a vessel that may be planned at a call, and locks them until the
/// transaction ends.
pub(crate) async fn under_way(tx: &mut Tx, vessel: VesselId) -> Result<Vec<AffectedOrder>> {
    // This serialises with agreements on another time.
    execute!(
        &mut *tx,
        "UPDATE work_orders SET state = state
         WHERE vessel_id = $1
           AND state IN ('offered', 'proposed', 'accepted', 'on_board', 'measured', 'adjusting')",
        vessel
    )?;
    Ok(rows!(
        in &mut *tx,
        AffectedOrder,
        "SELECT o.id, o.planned_at, o.planned_at + o.job_us AS planned_until, l.call_id,
                CASE WHEN c.id IS NULL OR c.withdrawn_at IS NOT NULL THEN TRUE ELSE FALSE END
                    AS is_unlinked
         FROM work_orders o
         LEFT JOIN schedule_orders l ON l.vessel_id = o.vessel_id AND l.order_id = o.id
         LEFT JOIN port_calls c ON c.vessel_id = l.vessel_id AND c.id = l.call_id
         WHERE o.vessel_id = $1
           AND o.state IN ('offered', 'proposed', 'accepted', 'on_board', 'measured', 'adjusting')
         ORDER BY o.id",
        vessel
    )?)
}

pub(crate) async fn announce_update(
    tx: &mut Tx,
    vessel: VesselId,
    order: OrderId,
    update: &CallUpdate,
    by: &str,
    now: Time,
) -> Result<Vec<Event>> {
    let mut stored = store::lock(tx, vessel, order).await?;
    let state = stored.state();
    let before = OrderBefore::from_order(&stored);
    // The order's port is that of its first known call.
    let port = state.port.as_ref().unwrap_or(&update.was.port);
    let hours = stored.summary.hours();
    let fit = update
        .is
        .as_ref()
        .map_or(CallFit::NoCall, |is| is.fit(port, hours));
    let call = CallChange {
        call_id: update.then_id,
        was: update.was.clone(),
        is: update.is.clone(),
        fit,
        by: by.to_owned(),
    };
    let seen = |offer: &&Offer| offer.state.is_seen();
    for offer in state.offers.all.iter().filter(seen) {
        let moved = CallMoved::new(offer.firm(), call.clone(), hours);
        let moved = OrderEvent::CallMoved(Box::new(moved));
        store::append(
            tx,
            &mut stored,
            Uuid::now_v7(),
            &Author::server(),
            now,
            moved,
        )
        .await?;
    }
    publish::publish_changes(tx, &stored, &before, now).await
}
