//! Handlers of events that the schedule depends on: each asks for a new schedule.

use super::store;
use binnacle_fleet::particulars::ParticularsChanged;
use binnacle_fleet::vessel_api::ServiceChanged;
use binnacle_orders::firms::TermsChanged;
use binnacle_platform::db::Tx;
use binnacle_platform::error::Result;
use binnacle_platform::events::{EventStored, Kind};
use futures_util::future::BoxFuture;

/// Asks for a new schedule after an event of a vessel that a schedule rests on.
pub fn on_vessel_event<'a>(tx: &'a mut Tx, stored: &'a EventStored) -> BoxFuture<'a, Result<()>> {
    Box::pin(async move {
        let event = &stored.event;
        // A firm's copy of an event alters nothing more.
        if event.firm_id.is_none() && alters_the_schedule(event.kind) {
            store::ask(tx, event.operator_id, stored.at).await?;
        }
        Ok(())
    })
}

/// Asks for a new schedule when a vessel goes out of service or comes back.
pub fn on_service_change<'a>(
    tx: &'a mut Tx,
    change: &'a ServiceChanged,
) -> BoxFuture<'a, Result<()>> {
    Box::pin(async move { Ok(store::ask(tx, change.operator, change.at).await?) })
}

/// Asks for a new schedule when an operator has other terms with a firm.
pub fn on_terms_change<'a>(tx: &'a mut Tx, change: &'a TermsChanged) -> BoxFuture<'a, Result<()>> {
    Box::pin(async move { Ok(store::ask(tx, change.operator, change.at).await?) })
}

/// Asks for a new schedule when rules ask something else of a vessel.
pub fn on_particulars_change<'a>(
    tx: &'a mut Tx,
    change: &'a ParticularsChanged,
) -> BoxFuture<'a, Result<()>> {
    Box::pin(async move { Ok(store::ask(tx, change.operator, change.at).await?) })
}

/// Returns whether a schedule depends on events of this kind.
fn alters_the_schedule(kind: Kind) -> bool {
    matches!(
        kind,
        Kind::Model | Kind::Logbook | Kind::WorkOrder | Kind::PortCall
    )
}
