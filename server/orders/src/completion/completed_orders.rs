//! Adjustments completed within a period, for reports.

use crate::work_orders::offers::Offer;
use crate::work_orders::state::State;
use crate::work_orders::store;
use binnacle_platform::db::{Db, rows};
use binnacle_platform::error::Result;
use binnacle_platform::ids::{CompassId, FirmId, OperatorId, OrderId, VesselId};
use binnacle_platform::tenants::Tenant;
use binnacle_platform::time::Time;

/// Completed adjustment.
#[derive(Clone, Debug)]
pub struct CompletedOrder {
    /// The order.
    pub order_id: OrderId,
    /// The vessel.
    pub vessel_id: VesselId,
    /// Its name.
    pub vessel_name: String,
    /// The compass.
    pub compass_id: CompassId,
    /// Its name.
    pub compass_name: String,
    /// The port.
    pub port: String,
    /// Time of completion.
    pub completed_at: Time,
    /// The firm's name.
    pub firm: Option<String>,
    /// The firm, if the order was offered to one.
    pub firm_id: Option<FirmId>,
    /// Present state.
    pub state: State,
    /// Contradiction by headings at sea, whatever the present state.
    pub disproved: bool,
    /// Agreed fee, as offered or proposed, euros.
    pub agreed_eur: Option<f64>,
}

/// Period of completed adjustments.
#[derive(Clone, Copy, Debug)]
pub struct CompletionPeriod {
    /// Begin.
    pub from: Time,
    /// End.
    pub until: Time,
    /// Time of the last report: earlier completions that reached the server after it are
    /// included.
    pub late_since: Option<Time>,
    /// Time of the knowledge: later arrivals are left out.
    pub known_at: Time,
}

/// Lists an operator's orders completed within a period, in order.
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
        let has_passed_at_sea = state
            .verification
            .is_some_and(|verification| verification.has_passed());
        let summary = stored.summary;
        let disproved = match summary.state {
            State::Failed => true,
            State::Closed => !has_passed_at_sea,
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
