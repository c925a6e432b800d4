//! End of a transaction that changes port calls: events are stored, then published.

use crate::event_kinds;
use binnacle_platform::app::App;
use binnacle_platform::db::Tx;
use binnacle_platform::error::Result;
use binnacle_platform::events::{self, Event};
use binnacle_platform::ids::VesselId;
use binnacle_platform::time::Time;

/// Commits changes of some vessels' calls and publishes their events, with those of work orders
/// that follow from them.
pub(super) async fn commit(
    app: &App,
    mut tx: Tx,
    vessels: &[VesselId],
    mut pending: Vec<Event>,
    now: Time,
) -> Result<()> {
    for vessel in vessels {
        pending.push(events::insert(&mut tx, *vessel, event_kinds::PORT_CALL, now).await?);
    }
    tx.commit().await?;
    for event in pending {
        app.publish(event);
    }
    Ok(())
}
