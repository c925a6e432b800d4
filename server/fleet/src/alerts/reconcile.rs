//! Reconciliation of a compass's stored alerts with the desired ones.
//!
//! Invariants:
//!
//! - A transaction that changes a compass's alerts holds their lock until it ends.
//! - An alert is about one event. Another event of its cause is another alert, whatever remarks the
//!   first one has.

use super::alert::{KnownAlert, State};
use super::causes::Source;
use super::change::{ChangeKind, PendingChange};
use super::clearing::{FOLLOWED, OUT_OF_SERVICE, OVER};
use super::desired::DesiredAlert;
use super::publish::publish_changes;
use super::store;
use crate::{compasses, vessels};
use binnacle_platform::db::Tx;
use binnacle_platform::error::Result;
use binnacle_platform::events::Event;
use binnacle_platform::ids::{CompassId, VesselId};
use binnacle_platform::time::Time;

/// Reconciles a compass's alerts of one source, and publishes the changes.
pub(super) async fn reconcile_source(
    tx: &mut Tx,
    vessel: VesselId,
    compass: CompassId,
    source: Source,
    desired: &[DesiredAlert],
    now: Time,
) -> Result<Option<Event>> {
    store::lock(tx, vessel, compass).await?;
    let known = store::known_of(tx, vessel, compass, source).await?;
    let changes = reconcile(tx, vessel, compass, &known, desired, |_| OVER, now).await?;
    publish_changes(tx, vessel, &changes, now).await
}

/// Ends all alerts of a vessel that goes out of service.
///
/// # Errors
/// Fails when the database does.
pub async fn end_all(tx: &mut Tx, vessel: VesselId, now: Time) -> Result<Vec<Event>> {
    let mut events = Vec::new();
    for compass in compasses::ids(tx, vessel).await? {
        store::lock(tx, vessel, compass).await?;
        let known = store::known(tx, vessel, compass).await?;
        let changes = reconcile(tx, vessel, compass, &known, &[], |_| OVER, now).await?;
        events.extend(publish_changes(tx, vessel, &changes, now).await?);
    }
    Ok(events)
}

/// Reconciles the known alerts with the desired ones. The compass's alerts are locked.
pub(super) async fn reconcile(
    tx: &mut Tx,
    vessel: VesselId,
    compass: CompassId,
    known: &[KnownAlert],
    desired: &[DesiredAlert],
    clearing_reason: impl Fn(&KnownAlert) -> &'static str,
    now: Time,
) -> Result<Vec<PendingChange>> {
    let in_service = vessels::is_in_service(tx, vessel).await?;
    let desired = if in_service { desired } else { &[] };
    let mut changes = Vec::new();
    for alert in known {
        if desired.iter().any(|desired| desired.cause == alert.cause) {
            continue;
        }
        let reason = if in_service {
            clearing_reason(alert)
        } else {
            OUT_OF_SERVICE
        };
        store::end(tx, vessel, alert.id, reason, now).await?;
        if alert.state != State::Cleared {
            changes.push(PendingChange::from_kind(alert.id, ChangeKind::Cleared));
        }
    }
    for desired in desired {
        let known = known.iter().find(|alert| alert.cause == desired.cause);
        changes.extend(open_or_update(tx, vessel, compass, known, desired, now).await?);
    }
    Ok(changes)
}

async fn open_or_update(
    tx: &mut Tx,
    vessel: VesselId,
    compass: CompassId,
    known: Option<&KnownAlert>,
    desired: &DesiredAlert,
    now: Time,
) -> Result<Vec<PendingChange>> {
    let raised = |alert| PendingChange::from_kind(alert, ChangeKind::Raised);
    let Some(known) = known else {
        let id = store::insert(tx, vessel, compass, desired, now).await?;
        return Ok(vec![raised(id)]);
    };
    let is_worse = desired.severity > known.severity;
    let is_another = !desired.window.includes(known.since);
    let is_cleared = known.state == State::Cleared;
    if is_another || (is_cleared && is_worse) {
        store::end(tx, vessel, known.id, FOLLOWED, now).await?;
        let cleared =
            (!is_cleared).then(|| PendingChange::from_kind(known.id, ChangeKind::Cleared));
        let id = store::insert(tx, vessel, compass, desired, now).await?;
        return Ok(cleared.into_iter().chain([raised(id)]).collect());
    }
    if is_cleared || desired.is_stored_as(known) {
        return Ok(Vec::new());
    }
    store::update(tx, vessel, known, desired, now).await?;
    let kind = match known.state {
        _ if desired.severity == known.severity => None,
        State::Acknowledged if is_worse => Some(ChangeKind::Raised),
        _ => Some(ChangeKind::Updated),
    };
    Ok(vec![PendingChange {
        alert: known.id,
        kind,
        was: (desired.severity != known.severity).then_some(known.severity),
    }])
}
