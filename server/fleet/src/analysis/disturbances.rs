//! Transient disturbances, compared across the ships of all fleets.
//!
//! Invariants:
//!
//! - The findings of a ship's own analysis are stored unchanged. They are compared with those of
//!   other ships when they are read.
//! - Nothing is revealed of another ship but its presence.
//! - A new disturbance enqueues the analyses of the ships disturbed at the same time. That changes
//!   only their alerts.

use super::findings::{ChangeFinding, Findings};
use crate::analysis_queue;
use binnacle_compass::position::Position;
use binnacle_compass::result::{FleetDisturbance, weigh_with_fleet};
use binnacle_compass::time::Timestamp;
use binnacle_platform::db::{Db, Result as DbResult, Tx, execute, rows};
use binnacle_platform::error::Result;
use binnacle_platform::ids::{CompassId, VesselId};
use binnacle_platform::time::Time;
use std::collections::BTreeMap;

/// Longest duration of a disturbance, seconds.
const LONGEST_S: f64 = 7.0 * 86_400.0;
/// Age beyond which a disturbance no longer queues other analyses, seconds.
const RECENT_S: f64 = 7.0 * 86_400.0;
/// Delay of the queued analyses, in which more disturbances may come, seconds.
const DELAY_S: f64 = 60.0;
/// Half height of the belt about a place, degrees of latitude.
const BELT_DEG: f64 = 0.5;
/// Half width of the belt, degrees of longitude: enough at the latitudes where a compass
/// serves. It ends at the antimeridian.
const BELT_LON_DEG: f64 = 3.0;

/// Query for disturbances of other ships in the hours from $2 to $3, or near a place.
const OTHERS: &str = "SELECT vessel_id, began_at, ended_at, lat, lon FROM disturbances
     WHERE vessel_id <> $1
       AND ((began_at BETWEEN $4 AND $3 AND ended_at >= $2)
            OR (lat BETWEEN $5 AND $6 AND lon BETWEEN $7 AND $8))
     ORDER BY vessel_id, began_at
     LIMIT 1000";

/// A disturbance of another ship.
#[derive(Clone, Copy, Debug, sqlx::FromRow)]
struct OtherDisturbance {
    vessel_id: VesselId,
    began_at: Time,
    ended_at: Time,
    lat: f64,
    lon: f64,
}

/// Place and time in which disturbances of other ships bear on one.
struct Neighbourhood {
    from: Time,
    until: Time,
    began_after: Time,
    lat: (f64, f64),
    lon: (f64, f64),
}

/// Stores a compass's passing disturbances in place of those of the analysis before.
///
/// Queues the analyses of other ships that were disturbed in the hours of a new one.
pub(super) async fn store_disturbances(
    tx: &mut Tx,
    vessel: VesselId,
    compass: CompassId,
    findings: &Findings,
    now: Time,
) -> Result<()> {
    let known = rows!(
        in &mut *tx,
        (Time,),
        "SELECT began_at FROM disturbances WHERE vessel_id = $1 AND compass_id = $2
         ORDER BY began_at",
        vessel,
        compass
    )?;
    execute!(
        &mut *tx,
        "DELETE FROM disturbances WHERE vessel_id = $1 AND compass_id = $2",
        vessel,
        compass
    )?;
    let mut recent = Vec::new();
    for (began_at, ended_at, position) in passing(findings) {
        execute!(
            &mut *tx,
            "INSERT INTO disturbances (vessel_id, compass_id, began_at, ended_at, lat, lon)
             VALUES ($1, $2, $3, $4, $5, $6)
             ON CONFLICT (vessel_id, compass_id, began_at) DO NOTHING",
            vessel,
            compass,
            began_at,
            ended_at,
            position.lat_deg(),
            position.lon_deg()
        )?;
        let is_recent = now.0.seconds_since(ended_at.0) < RECENT_S;
        if is_recent && known.binary_search(&(began_at,)).is_err() {
            recent.push((began_at, ended_at));
        }
    }
    for (began_at, ended_at) in recent {
        queue_others(tx, vessel, began_at, ended_at, now).await?;
    }
    Ok(())
}

/// Returns the passing disturbances: beginning, end and place.
fn passing(findings: &Findings) -> impl Iterator<Item = (Time, Time, Position)> {
    let until = findings.data_until;
    let passing = findings.changes.iter();
    passing.filter_map(move |found| {
        let change = &found.change;
        let ended = change.ended.or(until)?.max(change.from);
        let is_known = change.cause.is_transient() && !change.is_weak_transient();
        let position = found.change.position.filter(|_| is_known)?;
        Some((change.from.into(), ended.into(), position))
    })
}

async fn queue_others(
    tx: &mut Tx,
    vessel: VesselId,
    began_at: Time,
    ended_at: Time,
    now: Time,
) -> Result<()> {
    let others = rows!(
        in &mut *tx,
        (VesselId,),
        "SELECT DISTINCT vessel_id FROM disturbances
         WHERE vessel_id <> $1 AND began_at BETWEEN $4 AND $3 AND ended_at >= $2
         ORDER BY vessel_id",
        vessel,
        began_at,
        ended_at,
        Time(began_at.0.plus_seconds(-LONGEST_S))
    )?;
    for (other,) in others {
        analysis_queue::enqueue(tx, other, now, DELAY_S).await?;
    }
    Ok(())
}

/// Compares the findings about a vessel's compass with disturbances of other ships.
pub async fn compare_with_fleet(db: &Db, vessel: VesselId, findings: &mut Findings) -> Result<()> {
    let until = findings.data_until;
    for found in findings.changes.iter_mut().filter(|found| may_pass(found)) {
        let Some(near) = Neighbourhood::from_finding(found, until) else {
            continue;
        };
        let others = rows!(
            db,
            OtherDisturbance,
            OTHERS,
            vessel,
            near.from,
            near.until,
            near.began_after,
            near.lat.0,
            near.lat.1,
            near.lon.0,
            near.lon.1
        )?;
        compare(found, &near, &others)?;
    }
    Ok(())
}

/// Does what [`compare_with_fleet`] does, within a transaction.
pub async fn compare_with_fleet_in(
    tx: &mut Tx,
    vessel: VesselId,
    findings: &mut Findings,
) -> Result<()> {
    let until = findings.data_until;
    for found in findings.changes.iter_mut().filter(|found| may_pass(found)) {
        let Some(near) = Neighbourhood::from_finding(found, until) else {
            continue;
        };
        let others: DbResult<Vec<OtherDisturbance>> = rows!(
            in &mut *tx,
            OtherDisturbance,
            OTHERS,
            vessel,
            near.from,
            near.until,
            near.began_after,
            near.lat.0,
            near.lat.1,
            near.lon.0,
            near.lon.1
        );
        compare(found, &near, &others?)?;
    }
    Ok(())
}

fn may_pass(found: &ChangeFinding) -> bool {
    found.change.cause.is_transient() || !found.change.confirmed
}

impl Neighbourhood {
    fn from_finding(found: &ChangeFinding, data_until: Option<Timestamp>) -> Option<Neighbourhood> {
        let from = found.change.from;
        let until = found.change.ended.or(data_until)?.max(from);
        // No place is in an empty belt.
        let belt = found
            .change
            .position
            .map_or(((1.0, 0.0), (1.0, 0.0)), |here| {
                let (lat, lon) = (here.lat_deg(), here.lon_deg());
                (
                    (lat - BELT_DEG, lat + BELT_DEG),
                    (lon - BELT_LON_DEG, lon + BELT_LON_DEG),
                )
            });
        Some(Neighbourhood {
            from: from.into(),
            until: until.into(),
            began_after: Time(from.plus_seconds(-LONGEST_S)),
            lat: belt.0,
            lon: belt.1,
        })
    }
}

fn compare(
    found: &mut ChangeFinding,
    near: &Neighbourhood,
    others: &[OtherDisturbance],
) -> Result<()> {
    let mut ships = BTreeMap::new();
    let mut elsewhere = Vec::with_capacity(others.len());
    for other in others {
        let next = ships.len();
        elsewhere.push(FleetDisturbance {
            ship: *ships.entry(other.vessel_id).or_insert(next),
            from: other.began_at.0,
            until: other.ended_at.0,
            position: Position::new(other.lat, other.lon).map_err(anyhow::Error::from)?,
        });
    }
    found.change = weigh_with_fleet(
        &found.change,
        found.change.position,
        near.until.0,
        &elsewhere,
    );
    Ok(())
}
