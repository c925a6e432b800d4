//! Transition of a vessel out of service, or back into it.

use crate::event_kinds;
use crate::vessels::{VesselRow, set_out_of_service};
use crate::{alerts, analysis_queue};
use binnacle_platform::db::{DomainEvent, Tx};
use binnacle_platform::error::Result;
use binnacle_platform::events::{self, Event};
use binnacle_platform::ids::{OperatorId, VesselId};
use binnacle_platform::time::Time;

/// A vessel is about to go out of service, or to come back.
pub struct ServiceChanged {
    /// Operator of the vessel.
    pub operator: OperatorId,
    /// The vessel.
    pub vessel: VesselId,
    /// The vessel's name.
    pub vessel_name: String,
    /// True if it comes back.
    pub in_service: bool,
    /// Time of the change.
    pub at: Time,
}

impl DomainEvent for ServiceChanged {}

/// Takes a vessel out of service, or back into it; no change where it is so already.
///
/// # Errors
/// Fails when a subscriber refuses, as work orders do while one of the vessel's is under way.
pub(super) async fn set(
    tx: &mut Tx,
    operator: OperatorId,
    vessel: &VesselRow,
    in_service: bool,
    now: Time,
) -> Result<Vec<Event>> {
    if in_service == vessel.out_of_service_at.is_none() {
        return Ok(Vec::new());
    }
    let change = ServiceChanged {
        operator,
        vessel: vessel.id,
        vessel_name: vessel.name.clone(),
        in_service,
        at: now,
    };
    tx.publish(&change).await?;
    let mut events_out = vec![events::insert(tx, vessel.id, event_kinds::NEED, now).await?];
    if in_service {
        set_out_of_service(tx, vessel.id, None).await?;
        // It raises again the alerts whose causes still hold.
        analysis_queue::enqueue(tx, vessel.id, now, 0.0).await?;
        return Ok(events_out);
    }
    set_out_of_service(tx, vessel.id, Some(now)).await?;
    events_out.extend(alerts::end_all(tx, vessel.id, now).await?);
    Ok(events_out)
}
