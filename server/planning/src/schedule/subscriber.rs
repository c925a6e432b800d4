//! Handlers of events that change the schedule's input: each requests a new schedule.

use super::store;
use crate::event_kinds::PORT_CALL;
use binnacle_fleet::event_kinds::{LOGBOOK, MODEL};
use binnacle_fleet::particulars::ParticularsChanged;
use binnacle_fleet::vessel_api::ServiceChanged;
use binnacle_orders::event_kinds::WORK_ORDER;
use binnacle_orders::firms::TermsChanged;
use binnacle_platform::db::Tx;
use binnacle_platform::error::Result;
use binnacle_platform::events::{EventStored, Kind};
use futures_util::future::BoxFuture;

/// Requests a new schedule after an event of a vessel that changes the input.
pub fn on_vessel_event<'a>(tx: &'a mut Tx, stored: &'a EventStored) -> BoxFuture<'a, Result<()>> {
    Box::pin(async move {
        let event = &stored.event;
        // A firm's copy of an event changes nothing more.
        if event.firm_id.is_none() && changes_input(&event.kind) {
            store::request_schedule(tx, event.operator_id, stored.at).await?;
        }
        Ok(())
    })
}

/// Requests a new schedule when a vessel leaves or enters service.
pub fn on_service_change<'a>(
    tx: &'a mut Tx,
    change: &'a ServiceChanged,
) -> BoxFuture<'a, Result<()>> {
    Box::pin(async move { Ok(store::request_schedule(tx, change.operator, change.at).await?) })
}

/// Requests a new schedule when an operator's terms with a firm change.
pub fn on_terms_change<'a>(tx: &'a mut Tx, change: &'a TermsChanged) -> BoxFuture<'a, Result<()>> {
    Box::pin(async move { Ok(store::request_schedule(tx, change.operator, change.at).await?) })
}

/// Requests a new schedule when the particulars of a vessel change.
pub fn on_particulars_change<'a>(
    tx: &'a mut Tx,
    change: &'a ParticularsChanged,
) -> BoxFuture<'a, Result<()>> {
    Box::pin(async move { Ok(store::request_schedule(tx, change.operator, change.at).await?) })
}

/// Returns whether a schedule depends on events of this kind.
fn changes_input(kind: &Kind) -> bool {
    let input = [MODEL, LOGBOOK, WORK_ORDER, PORT_CALL];
    input.contains(kind)
}
