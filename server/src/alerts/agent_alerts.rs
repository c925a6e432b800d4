//! What the ship's agent says itself: compass and gyro have parted.
//!
//! What always holds: revisions may come late, again and in any order; the highest of
//! each alert counts, and the alert that the ship spoke of last is the one that is
//! open or over. Those that follow each other within hours are one: it is over when they
//! have not parted for [`QUIET_S`], by the ship's samples or the clock. An analysis
//! neither raises it nor says anything else of it.

use super::after_adjustment::ADJUSTED;
use super::alert::{Cause, DesiredAlert, EventWindow, Evidence, Severity, State};
use super::reconcile::{OVER, PendingChange, publish_changes, reconcile};
use super::store::{self, KnownAlert};
use crate::app::App;
use crate::db::{Result as DbResult, Tx, execute, rows};
use crate::error::Result;
use crate::events::Event;
use crate::ids::{CompassId, VesselId};
use crate::time::Time;
use crate::work_orders;
use binnacle_magnetics::time::Timestamp;
use binnacle_wire::alert::{ShipAlert, ShipAlertState, Suspect};

/// What has been quiet for so long is over, seconds: compass and gyro that part at the
/// limit do so again and again.
const QUIET_S: f64 = 6.0 * 3600.0;
/// Alerts of the ship's that are looked at, the latest first.
const MOST: i64 = 64;
const NOT_JUDGED: &str = "the card by which it was judged is not in force any more: it is not known \
                          to be over";
/// A departure beyond this makes the compass, or the gyro, worse than none.
const CRITICAL_DEG: f64 = 10.0;

/// Takes what a batch says of the ship's own alerts.
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
        keep(tx, vessel, compass, alert).await?;
    }
    let said = alerts.iter().map(|alert| alert.at).max();
    let news = in_line(tx, vessel, compass, said, now).await?;
    publish_changes(tx, vessel, &news, now).await
}

/// Holds the ship's own alert against the time that she is known to have sailed until;
/// the compass's alerts are locked.
pub(super) async fn in_line(
    tx: &mut Tx,
    vessel: VesselId,
    compass: CompassId,
    until: Option<Timestamp>,
    now: Time,
) -> Result<Vec<PendingChange>> {
    let mut known = store::known(tx, vessel, compass).await?;
    known.retain(|alert| alert.cause == Cause::ReportedAboard);
    let spoken = spoken(tx, vessel, compass).await?;
    let Some(last) = spoken.first() else {
        return Ok(Vec::new());
    };
    let adjusted = work_orders::adjusted_at(tx, vessel, compass).await?;
    let is_before = adjusted.is_some_and(|adjusted| Time(last.at) < adjusted);
    let (wanted, why) = match last.state {
        // No card from before an adjustment judges the compass after it; the gyro it does.
        _ if is_before && last.suspect() != Suspect::Gyro => (None, ADJUSTED),
        ShipAlertState::NotJudged => (called_for(&spoken, known.first(), until), NOT_JUDGED),
        _ => (called_for(&spoken, known.first(), until), OVER),
    };
    reconcile(tx, vessel, compass, &known, wanted.as_slice(), |_| why, now).await
}

/// Looks which of these alerts have been quiet for long, where no sample tells.
pub(super) async fn look(app: &App) -> Result<()> {
    let now: Time = app.clock.now().into();
    let before = Time(now.0.plus_seconds(-QUIET_S));
    for (vessel, compass) in store::unshown(&app.db, Cause::ReportedAboard, before).await? {
        let mut tx = app.db.begin().await?;
        store::lock(&mut tx, vessel, compass).await?;
        let news = in_line(&mut tx, vessel, compass, Some(now.0), now).await?;
        let event = publish_changes(&mut tx, vessel, &news, now).await?;
        tx.commit().await?;
        if let Some(event) = event {
            app.publish(event);
        }
    }
    Ok(())
}

/// The alert that what the ship said calls for, the latest first.
fn called_for(
    spoken: &[ShipAlert],
    known: Option<&KnownAlert>,
    until: Option<Timestamp>,
) -> Option<DesiredAlert> {
    let last = spoken.first()?;
    let alert = if last.state == ShipAlertState::Open {
        wanted(last)
    } else {
        let quiet_s = until.map_or(0.0, |until| until.seconds_since(last.at));
        quiet(last, known.filter(|_| quiet_s < QUIET_S)?)
    };
    // Cleared by a person, what parts anew is another.
    let is_anew = known.is_some_and(|known| {
        known.state == State::Cleared && known.cleared_at.is_some_and(|at| at.0 < last.since)
    });
    if is_anew {
        return Some(alert);
    }
    let since: Time = since(spoken).unwrap_or(last.since).into();
    Some(DesiredAlert {
        since,
        window: EventWindow {
            from: Some(since),
            ..alert.window
        },
        ..alert
    })
}

/// When the first of those began that followed each other within hours, up to the last.
fn since(spoken: &[ShipAlert]) -> Option<Timestamp> {
    let mut since = spoken.first()?.since;
    for earlier in &spoken[1..] {
        if since.seconds_since(earlier.at) >= QUIET_S {
            break;
        }
        since = since.min(earlier.since);
    }
    Some(since)
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

/// What the ship said, the latest first.
async fn spoken(tx: &mut Tx, vessel: VesselId, compass: CompassId) -> Result<Vec<ShipAlert>> {
    let found: DbResult<Vec<(String,)>> = rows!(
        in tx,
        (String,),
        "SELECT alert FROM ship_alerts WHERE vessel_id = $1 AND compass_id = $2
         ORDER BY at DESC, id DESC LIMIT $3",
        vessel,
        compass,
        MOST
    );
    let spoken = found?.into_iter();
    Ok(spoken
        .map(|(text,)| serde_json::from_str(&text))
        .collect::<std::result::Result<_, _>>()?)
}

/// What is said of one that is not open, and was until lately.
fn quiet(last: &ShipAlert, known: &KnownAlert) -> DesiredAlert {
    let (who, _) = words(last);
    let since = Time(last.at).to_the_minute();
    let (so, advice) = match last.state {
        ShipAlertState::NotJudged => (
            format!("since {since} nobody can tell whether they still are apart"),
            "Steer by gyro and take an azimuth until there is a card again.",
        ),
        _ => (
            format!("since {since} they agree"),
            "Keep comparing them each watch. If they stay together for six hours, this alert \
             clears itself.",
        ),
    };
    DesiredAlert {
        severity: known.severity,
        summary: format!("{who} parted, reported by the ship's agent; {so}."),
        advice,
        ..wanted(last)
    }
}

fn wanted(alert: &ShipAlert) -> DesiredAlert {
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
        "Model {} and the usual error of the {} allow {:.1}°.",
        alert.model_version,
        alert.reference(),
        alert.limit_deg
    ));
    let (who, advice) = words(alert);
    DesiredAlert {
        cause: Cause::ReportedAboard,
        severity,
        since: alert.since.into(),
        window: EventWindow::exactly(alert.since.into()),
        summary: format!("{who} parted by {size_deg:.0}°, reported by the ship's agent."),
        advice,
        evidence: Evidence(evidence),
    }
}

fn words(alert: &ShipAlert) -> (&'static str, &'static str) {
    let both = if alert.reference() == "gyro" {
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
        Suspect::Unknown if alert.gyro_departure_deg.is_none() => (
            both,
            "Trust neither until an azimuth proves one: compare both with a steady course over \
             ground, check the satellite compass and its antennas, and ask on board about \
             lightning, a shock or magnetic cargo.",
        ),
        Suspect::Satellite => (
            both,
            "The gyro bears out the magnetic compass: have the satellite compass and its antennas \
             checked.",
        ),
        Suspect::Unknown => (
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

    fn said(gyro: Option<f64>, satellite: Option<f64>) -> DesiredAlert {
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
        assert!(!alone.advice.contains("gyro"), "{}", alone.advice);
        let gyro = said(Some(6.0), Some(0.3));
        assert_eq!(gyro.severity, Severity::Warning);
        assert!(gyro.advice.contains("have the gyro"));
    }
}
