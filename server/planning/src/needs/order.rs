//! Work order that meets a need.
//!
//! Invariant: of several open orders of a compass, the one that was opened last.

use super::scope::{CompassKey, Which};
use binnacle_orders::work_orders::State;
use binnacle_platform::db::{Db, Result, rows};
use binnacle_platform::ids::{CompassId, OrderId, VesselId};
use binnacle_platform::time::Time;
use serde::Serialize;
use std::collections::BTreeMap;
use utoipa::ToSchema;

/// Open work order of a compass.
#[derive(Clone, Debug, Serialize, ToSchema)]
#[schema(as = NeedOrder)]
pub struct OpenOrder {
    /// The order.
    pub id: OrderId,
    /// State of the order.
    pub state: State,
    /// Port, as the operator wrote it or as its UN/LOCODE.
    #[schema(example = "NLRTM")]
    pub port: String,
    /// Beginning of the work as agreed or proposed.
    pub from: Time,
    /// End of the work.
    pub until: Time,
}

/// Returns the last opened order of each compass that is not over.
pub(super) async fn load_open_orders(
    db: &Db,
    which: Which,
) -> Result<BTreeMap<CompassKey, OpenOrder>> {
    let found = rows!(
        db,
        (VesselId, CompassId, OrderId, State, String, Time, Time),
        "SELECT o.vessel_id, o.compass_id, o.id, o.state, o.port, o.planned_at,
                o.planned_at + o.job_us
         FROM work_orders o JOIN vessels v ON v.id = o.vessel_id
         WHERE v.operator_id = $1 AND v.id BETWEEN $2 AND $3
           AND o.state NOT IN ('closed', 'closed_unverified', 'cancelled')
         ORDER BY o.vessel_id, o.id",
        which.operator,
        which.first,
        which.last
    )?;
    let keyed = |(vessel, compass, id, state, port, from, until)| {
        let order = OpenOrder {
            id,
            state,
            port,
            from,
            until,
        };
        ((vessel, compass), order)
    };
    // Ids are in the order of opening: the last of a compass stays.
    Ok(found.into_iter().map(keyed).collect())
}
