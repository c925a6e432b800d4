//! Hours and places of GNSS interference, for the fleet's map.

use super::findings::Findings;
use binnacle_compass::result::Cause;
use binnacle_platform::db::{Db, Result as DbResult, Tx, execute, rows};
use binnacle_platform::error::Result;
use binnacle_platform::ids::{CompassId, OperatorId, VesselId};
use binnacle_platform::time::Time;
use serde::Serialize;
use utoipa::ToSchema;

/// Age up to which an interference is listed, seconds.
const RECENT_S: f64 = 14.0 * 86_400.0;

/// Interference that a vessel met.
#[derive(Clone, Debug, Serialize, ToSchema, sqlx::FromRow)]
#[schema(as = GnssInterference)]
pub struct Interference {
    /// The vessel.
    #[serde(skip)]
    pub vessel_id: VesselId,
    /// Start.
    pub began_at: Time,
    /// End; none while it lasts.
    #[schema(required)]
    pub ended_at: Option<Time>,
    /// Latitude of its middle by dead reckoning, degrees north.
    pub lat: f64,
    /// Longitude, degrees east.
    pub lon: f64,
}

/// Stores a compass's interference in place of that of the analysis before.
pub(super) async fn store_interference(
    tx: &mut Tx,
    vessel: VesselId,
    compass: CompassId,
    findings: &Findings,
) -> Result<()> {
    execute!(
        &mut *tx,
        "DELETE FROM gnss_interference WHERE vessel_id = $1 AND compass_id = $2",
        vessel,
        compass
    )?;
    let found = findings.changes.iter();
    for found in found.filter(|found| found.change.cause == Cause::GnssInterference) {
        let Some(place) = found.change.position else {
            continue;
        };
        execute!(
            &mut *tx,
            "INSERT INTO gnss_interference (vessel_id, compass_id, began_at, ended_at, lat, lon)
             VALUES ($1, $2, $3, $4, $5, $6)",
            vessel,
            compass,
            Time(found.change.from),
            found.change.ended.map(Time),
            place.lat_deg(),
            place.lon_deg()
        )?;
    }
    Ok(())
}

/// Lists the interference that an operator's vessels met in the last fortnight, for the ids from
/// `first` to `last`.
pub async fn recent_interference(
    db: &Db,
    operator: OperatorId,
    first: VesselId,
    last: VesselId,
    now: Time,
) -> DbResult<Vec<Interference>> {
    rows!(
        db,
        Interference,
        "SELECT g.vessel_id, g.began_at, g.ended_at, g.lat, g.lon
         FROM gnss_interference g
         JOIN vessels v ON v.id = g.vessel_id
         WHERE v.operator_id = $1 AND v.id BETWEEN $2 AND $3
           AND (g.ended_at >= $4 OR g.ended_at IS NULL)
         ORDER BY g.began_at, g.vessel_id",
        operator,
        first,
        last,
        Time(now.0.plus_seconds(-RECENT_S))
    )
}
