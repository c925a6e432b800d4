//! Expiry of offers: an offer without an answer lapses, and the next firm receives one.

use crate::dispatch::offer_sequence::send_next_offers;
use crate::work_orders::events::{Lapsed, OrderEvent, RetimeLapsed};
use crate::work_orders::offers::OfferState;
use crate::work_orders::order_update::Change;
use crate::work_orders::payload::exchange::Exchange;
use crate::work_orders::store;
use binnacle_platform::app::App;
use binnacle_platform::error::Result;
use binnacle_platform::ids::{OrderId, VesselId};
use std::time::Duration;
use tracing::{error, info};

/// Interval between checks for overdue answers.
const POLL_INTERVAL: Duration = Duration::from_secs(20);
/// Orders per batch.
const BATCH_SIZE: i64 = 100;

/// Checks for overdue answers until the server stops.
pub async fn watch(app: App) {
    while !app.stopping.is_cancelled() {
        if let Err(error) = lapse(&app).await {
            error!(?error, "overdue answers cannot be checked");
        }
        tokio::select! {
            () = app.stopping.cancelled() => {}
            () = tokio::time::sleep(POLL_INTERVAL) => {}
        }
    }
}

/// Lapses overdue offers and proposals; returns the number of orders that changed. A failure of
/// one order delays no other.
pub async fn lapse(app: &App) -> Result<usize> {
    let mut went_on = 0;
    loop {
        let overdue = store::list_overdue(&app.db, app.clock.now().into(), BATCH_SIZE).await?;
        let found = overdue.len();
        let before = went_on;
        for (vessel, order) in overdue {
            match lapse_order(app, vessel, order).await {
                Ok(is_new) => went_on += usize::from(is_new),
                Err(error) => error!(?error, %order, "an overdue answer cannot lapse"),
            }
        }
        if found < BATCH_SIZE as usize || went_on == before {
            return Ok(went_on);
        }
    }
}

async fn lapse_order(app: &App, vessel: VesselId, order: OrderId) -> Result<bool> {
    let mut change = Change::by_server(app, vessel, order).await?;
    let offers = change.stored.state().offers;
    let overdue: Vec<_> = offers
        .all
        .into_iter()
        .filter(|offer| offer.answer_by.is_some_and(|by| by < change.now))
        .collect();
    if overdue.is_empty() {
        // Another server was faster, or the answer arrived after all.
        return Ok(false);
    }
    for offer in overdue {
        let between = Exchange::with(offer.firm());
        // The firm keeps the order, whether or not another time is agreed on.
        let lapsed = if offer.state == OfferState::Accepted {
            OrderEvent::RetimeLapsed(RetimeLapsed(between))
        } else {
            OrderEvent::Lapsed(Lapsed(between))
        };
        info!(%order, firm = %offer.firm_id, "an offer has lapsed");
        change.append(lapsed).await?;
    }
    send_next_offers(&mut change).await?;
    change.commit().await?;
    Ok(true)
}
