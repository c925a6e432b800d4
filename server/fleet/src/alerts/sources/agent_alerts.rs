//! Source of alerts: reports of the ship's agent that compass and gyro have parted.
//!
//! Invariants:
//!
//! - Revisions may arrive late, repeatedly and in any order; the highest of each alert counts.
//! - The alert that the agent reported last is the one that is open or over.
//! - An analysis neither raises it nor changes its text.

use crate::adjustments;
use crate::alerts::causes::{AgentReports, Facts, Source, evaluate};
use crate::alerts::change::PendingChange;
use crate::alerts::clearing::{ADJUSTED, NOT_JUDGED, OVER};
use crate::alerts::publish::publish_changes;
use crate::alerts::reconcile::reconcile;
use crate::alerts::store;
use binnacle_compass::time::Timestamp;
use binnacle_platform::db::{Result as DbResult, Tx, execute, rows};
use binnacle_platform::error::Result;
use binnacle_platform::events::Event;
use binnacle_platform::ids::{CompassId, VesselId};
use binnacle_platform::time::Time;
use binnacle_wire::alert::{ShipAlert, ShipAlertState, Suspect};

/// Number of reports that are read, the latest first.
const MOST_REPORTS: i64 = 64;

/// Records the agent's alerts that came in a batch.
pub async fn record_agent_alerts(
    tx: &mut Tx,
    vessel: VesselId,
    compass: CompassId,
    alerts: &[ShipAlert],
    now: Time,
) -> Result<Option<Event>> {
    if alerts.is_empty() {
        return Ok(None);
    }
    store::lock(tx, vessel, compass).await?;
    for alert in alerts {
        insert(tx, vessel, compass, alert).await?;
    }
    let until = alerts.iter().map(|alert| alert.at).max();
    let changes = reconcile_reports(tx, vessel, compass, until, now).await?;
    publish_changes(tx, vessel, &changes, now).await
}

/// Reconciles the compass's alert of this source with the agent's reports.
///
/// `until` is the time to which samples, reports or the clock tell. The compass's alerts are
/// locked.
pub(super) async fn reconcile_reports(
    tx: &mut Tx,
    vessel: VesselId,
    compass: CompassId,
    until: Option<Timestamp>,
    now: Time,
) -> Result<Vec<PendingChange>> {
    let known = store::known_of(tx, vessel, compass, Source::Agent).await?;
    let reports = list(tx, vessel, compass).await?;
    let Some(last) = reports.first() else {
        return Ok(Vec::new());
    };
    let adjusted = adjustments::last_adjusted_at(tx, vessel, compass).await?;
    let is_before = adjusted.is_some_and(|adjusted| Time(last.at) < adjusted);
    // A card from before an adjustment cannot judge the compass after it, but it can the gyro.
    let is_void = is_before && last.suspect() != Suspect::Gyro;
    let desired = if is_void {
        Vec::new()
    } else {
        evaluate(Facts::AgentReports(&AgentReports {
            reports: &reports,
            known: known.first(),
            until,
        }))
    };
    let reason = match last.state {
        _ if is_void => ADJUSTED,
        ShipAlertState::NotJudged => NOT_JUDGED,
        _ => OVER,
    };
    reconcile(tx, vessel, compass, &known, &desired, |_| reason, now).await
}

async fn insert(
    tx: &mut Tx,
    vessel: VesselId,
    compass: CompassId,
    alert: &ShipAlert,
) -> Result<()> {
    execute!(
        tx,
        "INSERT INTO ship_alerts (vessel_id, compass_id, id, revision, at, alert)
         VALUES ($1, $2, $3, $4, $5, $6)
         ON CONFLICT (vessel_id, compass_id, id) DO UPDATE
         SET revision = excluded.revision, at = excluded.at, alert = excluded.alert
         WHERE excluded.revision > ship_alerts.revision",
        vessel,
        compass,
        alert.id,
        i64::from(alert.revision),
        Time(alert.at),
        serde_json::to_string(alert)?
    )?;
    Ok(())
}

/// Lists the agent's reports, the latest first.
async fn list(tx: &mut Tx, vessel: VesselId, compass: CompassId) -> Result<Vec<ShipAlert>> {
    let found: DbResult<Vec<(String,)>> = rows!(
        in tx,
        (String,),
        "SELECT alert FROM ship_alerts WHERE vessel_id = $1 AND compass_id = $2
         ORDER BY at DESC, id DESC LIMIT $3",
        vessel,
        compass,
        MOST_REPORTS
    );
    Ok(found?
        .into_iter()
        .map(|(text,)| serde_json::from_str(&text))
        .collect::<std::result::Result<_, _>>()?)
}
