//! Adjustments that were completed in a time, for reports.

use crate::work_orders::offers::Offer;
use crate::work_orders::state::State;
use crate::work_orders::store;
use binnacle_platform::db::{Db, rows};
use binnacle_platform::error::Result;
use binnacle_platform::ids::{CompassId, FirmId, OperatorId, OrderId, VesselId};
use binnacle_platform::tenants::Tenant;
use binnacle_platform::time::Time;

/// An adjustment that was completed.
#[derive(Clone, Debug)]
pub struct CompletedOrder {
    /// The order.
    pub order_id: OrderId,
    /// The vessel.
    pub vessel_id: VesselId,
    /// Her name.
    pub vessel_name: String,
    /// The compass.
    pub compass_id: CompassId,
    /// Its name.
    pub compass_name: String,
    /// The port.
    pub port: String,
    /// When it was completed.
    pub completed_at: Time,
    /// The firm's name.
    pub firm: Option<String>,
    /// The firm, if it was offered to one.
    pub firm_id: Option<FirmId>,
    /// How it stands.
    pub state: State,
    /// Whether headings at sea have spoken against it, whatever it stands as now.
    pub disproved: bool,
    /// The fee that was agreed on, as it was offered or proposed, euros.
    pub agreed_eur: Option<f64>,
}

/// Which adjustments that were completed.
#[derive(Clone, Copy, Debug)]
pub struct CompletionPeriod {
    /// From this time on.
    pub from: Time,
    /// Until this.
    pub until: Time,
    /// Those of before too that reached the server after this: the last report that there
    /// was did not know of them.
    pub late_since: Option<Time>,
    /// As was known at this time.
    pub known_at: Time,
}

/// An operator's orders that were completed within a time, in order.
pub async fn completed_orders(
    db: &Db,
    operator: OperatorId,
    span: CompletionPeriod,
) -> Result<Vec<CompletedOrder>> {
    let found = rows!(
        db,
        (OrderId,),
        "SELECT o.id FROM work_orders o
         JOIN vessels v ON v.id = o.vessel_id
         WHERE v.operator_id = $1 AND o.completed_at < $3
           AND (o.completed_at >= $2
                OR COALESCE(o.completion_received_at, o.completed_at) > $4)
           AND COALESCE(o.completion_received_at, o.completed_at) <= $5
         ORDER BY o.completed_at, o.id",
        operator,
        span.from,
        span.until,
        span.late_since.map_or(i64::MAX, |time| time.0.micros()),
        span.known_at
    )?;
    let mut done = Vec::with_capacity(found.len());
    for (order,) in found {
        let stored = store::find(db, Tenant::Operator(operator), order).await?;
        let state = stored.state();
        let agreed_eur = state.offers.holder().and_then(Offer::fee);
        let verified = state.verification.is_some_and(|said| said.has_passed());
        let summary = stored.summary;
        let disproved = match summary.state {
            State::Failed => true,
            State::Closed => !verified,
            _ => false,
        };
        let Some(completed_at) = summary.completed_at else {
            continue;
        };
        done.push(CompletedOrder {
            order_id: summary.id,
            vessel_id: summary.vessel_id,
            vessel_name: summary.vessel_name,
            compass_id: summary.compass_id,
            compass_name: summary.compass_name,
            port: summary.port,
            completed_at,
            firm: summary.firm,
            firm_id: summary.firm_id,
            state: summary.state,
            disproved,
            agreed_eur,
        });
    }
    Ok(done)
}
