//! What the ship's agent says itself: compass and gyro have parted.
//!
//! What always holds: revisions may come late, again and in any order; the highest of
//! each alert counts, and the alert that the ship spoke of last is the one that is
//! open or over. An analysis neither raises nor clears it.

use super::alert::{AlertWanted, Cause, Dated, Evidence, Severity};
use super::look::{OVER, bring_in_line, tell};
use super::store;
use crate::db::{Result as DbResult, Tx, execute, row};
use crate::error::Result;
use crate::events::Event;
use crate::ids::{CompassId, VesselId};
use crate::time::Time;
use binnacle_wire::alert::{ShipAlert, ShipAlertState, Suspect};

/// A departure beyond this makes the compass, or the gyro, worse than none.
const CRITICAL_DEG: f64 = 10.0;

/// Takes what a batch says of the ship's own alerts.
pub async fn from_ship(
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
        keep(tx, vessel, compass, alert).await?;
    }
    let wanted: Vec<AlertWanted> = latest(tx, vessel, compass)
        .await?
        .filter(|alert| alert.state == ShipAlertState::Open)
        .map(|alert| wanted(&alert))
        .into_iter()
        .collect();
    let mut known = store::known(tx, vessel, compass).await?;
    known.retain(|alert| alert.cause == Cause::ReportedAboard);
    let news = bring_in_line(tx, vessel, compass, &known, &wanted, |_| OVER, now).await?;
    tell(tx, vessel, &news, now).await
}

async fn keep(tx: &mut Tx, vessel: VesselId, compass: CompassId, alert: &ShipAlert) -> Result<()> {
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

/// The alert that the ship spoke of last.
async fn latest(tx: &mut Tx, vessel: VesselId, compass: CompassId) -> Result<Option<ShipAlert>> {
    let found: DbResult<Option<(String,)>> = row!(
        in tx,
        (String,),
        "SELECT alert FROM ship_alerts WHERE vessel_id = $1 AND compass_id = $2
         ORDER BY at DESC, id DESC LIMIT 1",
        vessel,
        compass
    );
    let text = found?;
    Ok(text
        .map(|(text,)| serde_json::from_str(&text))
        .transpose()?)
}

fn wanted(alert: &ShipAlert) -> AlertWanted {
    let size_deg = alert.departure_deg().abs();
    let severity = if size_deg > CRITICAL_DEG {
        Severity::Critical
    } else {
        Severity::Warning
    };
    let departures = [
        ("gyro", alert.gyro_departure_deg),
        ("satellite compass", alert.satellite_departure_deg),
    ];
    let mut evidence: Vec<String> = departures
        .into_iter()
        .filter_map(|(name, departure)| Some((name, departure?)))
        .map(|(name, departure_deg)| {
            format!("The corrected compass less the {name} is {departure_deg:+.1}°.")
        })
        .collect();
    evidence.push(format!(
        "Model {} and the gyro's usual error allow {:.1}°.",
        alert.model_version, alert.limit_deg
    ));
    let (who, advice) = words(alert);
    AlertWanted {
        cause: Cause::ReportedAboard,
        severity,
        since: alert.since.into(),
        // The ship keeps to the date of each of her alerts.
        dated: Dated::exactly(alert.since.into()),
        summary: format!("{who} parted by {size_deg:.0}°, reported by the ship's agent."),
        advice,
        evidence: Evidence(evidence),
    }
}

fn words(alert: &ShipAlert) -> (&'static str, &'static str) {
    let both = if alert.gyro_departure_deg.is_some() {
        "Compass and gyro"
    } else {
        "Compass and satellite compass"
    };
    match alert.suspect() {
        Suspect::Compass => (
            both,
            "Steer by gyro: the satellite compass bears it out. Do not use the card. Take an \
             azimuth, and ask on board about lightning, a shock or magnetic cargo.",
        ),
        Suspect::Gyro => (
            "Gyro and compass",
            "The satellite compass bears out the magnetic compass: have the gyro and its speed \
             and latitude settings checked, and an azimuth taken before it is steered by.",
        ),
        Suspect::Satellite | Suspect::Unknown => (
            both,
            "Steer by gyro, but trust neither until an azimuth proves one: check the gyro, and \
             ask on board about lightning, a shock or magnetic cargo.",
        ),
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use binnacle_magnetics::time::Timestamp;
    use uuid::Uuid;

    fn said(gyro: Option<f64>, satellite: Option<f64>) -> AlertWanted {
        let at = Timestamp::parse("2026-11-21T07:00:00Z").unwrap();
        wanted(&ShipAlert {
            id: Uuid::from_u128(1),
            revision: 1,
            state: ShipAlertState::Open,
            since: at,
            at,
            gyro_departure_deg: gyro,
            satellite_departure_deg: satellite,
            limit_deg: 4.0,
            model_version: 7,
        })
    }

    #[test]
    fn it_is_as_bad_as_it_is_large_and_names_what_is_suspect() {
        let compass = said(Some(-28.4), Some(-27.9));
        assert_eq!(compass.severity, Severity::Critical);
        assert_eq!(
            compass.summary,
            "Compass and gyro parted by 28°, reported by the ship's agent."
        );
        assert!(compass.advice.starts_with("Steer by gyro:"));
        assert_eq!(
            compass.evidence.0[0],
            "The corrected compass less the gyro is -28.4°."
        );
        // The page on board says 6° too.
        let smaller = said(Some(-6.2), Some(-7.2));
        assert!(smaller.summary.starts_with("Compass and gyro parted by 6°"));
        let alone = said(None, Some(-7.2));
        assert!(
            alone
                .summary
                .starts_with("Compass and satellite compass parted by 7°")
        );
        let gyro = said(Some(6.0), Some(0.3));
        assert_eq!(gyro.severity, Severity::Warning);
        assert!(gyro.advice.contains("have the gyro"));
    }
}
