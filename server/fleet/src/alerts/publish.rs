//! Publication of changed alerts to dashboards, webhooks, mail and notifications.
//!
//! Invariant: it is part of the transaction that changes the alert.

use super::announcement::{announcement, message, notices};
use super::change::{AlertChange, PendingChange};
use super::store;
use crate::event_kinds;
use binnacle_platform::db::Tx;
use binnacle_platform::error::Result;
use binnacle_platform::events::{self, Event};
use binnacle_platform::ids::{DeliveryId, VesselId};
use binnacle_platform::mail::Announcement;
use binnacle_platform::outbox::Message;
use binnacle_platform::time::Time;
use binnacle_platform::{mail, webhooks};
use tracing::info;

/// Publishes changes of a vessel's alerts.
pub(super) async fn publish_changes(
    tx: &mut Tx,
    vessel: VesselId,
    pending: &[PendingChange],
    now: Time,
) -> Result<Option<Event>> {
    if pending.is_empty() {
        return Ok(None);
    }
    let mut changes = Vec::new();
    for PendingChange { alert, kind, was } in pending {
        let Some(kind) = *kind else {
            continue;
        };
        info!(%vessel, %alert, kind = format_args!("Alert{kind:?}"), "an alert changed");
        changes.push(AlertChange {
            id: DeliveryId::new(),
            kind,
            alert: store::read(tx, vessel, *alert).await?,
            was: *was,
        });
    }
    let event = events::insert(tx, vessel, event_kinds::ALERT, now).await?;
    let operator = event.operator_id;
    let messages: Vec<Message> = changes.iter().map(|one| message(one, now)).collect();
    webhooks::announce(tx, operator.into(), &messages, now).await?;
    let announcements: Vec<Announcement> = changes.iter().filter_map(announcement).collect();
    mail::announce(tx, operator, &announcements, now).await?;
    tx.publish(&notices(operator, &changes, now)).await?;
    Ok(Some(event))
}
