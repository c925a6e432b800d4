//! Adjustments that were completed in a time, for reports.

use super::find::whole;
use super::order::State;
use crate::db::{Db, rows};
use crate::error::Result;
use crate::ids::{CompassId, FirmId, OperatorId, OrderId, VesselId};
use crate::tenants::Tenant;
use crate::time::Time;

/// An adjustment that was completed.
#[derive(Clone, Debug)]
pub struct Done {
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
    /// The fee that was agreed on, euros.
    pub agreed_eur: Option<f64>,
}

/// An operator's orders that were completed from a time until another, in order.
pub async fn done(db: &Db, operator: OperatorId, from: Time, until: Time) -> Result<Vec<Done>> {
    let found = rows!(
        db,
        (OrderId,),
        "SELECT o.id FROM work_orders o
         JOIN vessels v ON v.id = o.vessel_id
         WHERE v.operator_id = $1 AND o.completed_at >= $2 AND o.completed_at < $3
         ORDER BY o.completed_at, o.id",
        operator,
        from,
        until
    )?;
    let mut done = Vec::with_capacity(found.len());
    for (order,) in found {
        let whole = whole(db, Tenant::Operator(operator), order).await?;
        let terms = whole
            .standing()
            .offers
            .holder()
            .and_then(|offer| offer.terms.clone());
        let summary = whole.summary;
        let Some(completed_at) = summary.completed_at else {
            continue;
        };
        done.push(Done {
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
            agreed_eur: terms.and_then(|terms| terms.fee_eur),
        });
    }
    Ok(done)
}
