//! Records of a page of a fleet in the database, in seven queries.

use crate::alerts::{Cause, State};
use crate::analysis::{Interference, Track, recent_interference};
use crate::models::{self, StoredModel};
use crate::tags;
use crate::vessels::LastPosition;
use binnacle_platform::db::{Db, Result, rows};
use binnacle_platform::ids::{AlertId, OperatorId, VesselId};
use binnacle_platform::severity::Severity;
use binnacle_platform::time::Time;
use uuid::Uuid;

/// Records for the overview.
#[derive(Default)]
pub(super) struct FleetRecords {
    pub(super) vessels: Vec<VesselRow>,
    /// Current models, a vessel's first compass first.
    pub(super) models: Vec<StoredModel>,
    /// Tracks, in the same order.
    pub(super) tracks: Vec<StoredTrack>,
    /// Alerts that are neither cleared nor snoozed.
    pub(super) alerts: Vec<WorstAlert>,
    /// Each vessel's first port call that is not over.
    pub(super) calls: Vec<NextPortCall>,
    /// GNSS interference of late.
    pub(super) interference: Vec<Interference>,
    /// Tags of the vessels.
    pub(super) tags: Vec<(VesselId, String)>,
}

/// A vessel's own columns.
#[derive(sqlx::FromRow)]
pub(super) struct VesselRow {
    pub(super) id: VesselId,
    pub(super) name: String,
    pub(super) imo_number: Option<String>,
    pub(super) call_sign: Option<String>,
    pub(super) last_upload_at: Option<Time>,
    last_sample_at: Option<Time>,
    last_lat: Option<f64>,
    last_lon: Option<f64>,
}

/// A compass's track.
#[derive(sqlx::FromRow)]
pub(super) struct StoredTrack {
    pub(super) vessel_id: VesselId,
    #[sqlx(try_from = "String")]
    pub(super) track: Track,
}

/// An alert that is neither cleared nor snoozed.
#[derive(sqlx::FromRow)]
pub(super) struct WorstAlert {
    pub(super) id: AlertId,
    pub(super) vessel_id: VesselId,
    pub(super) cause: Cause,
    pub(super) severity: Severity,
    pub(super) state: State,
    pub(super) summary: String,
}

/// A port call, in short.
#[derive(sqlx::FromRow)]
pub(super) struct NextPortCall {
    pub(super) vessel_id: VesselId,
    pub(super) port: String,
    pub(super) eta: Time,
    pub(super) etd: Time,
}

impl VesselRow {
    pub(super) fn position(&self) -> Option<LastPosition> {
        Some(LastPosition {
            lat: self.last_lat?,
            lon: self.last_lon?,
            at: self.last_sample_at?,
        })
    }
}

impl WorstAlert {
    pub(super) fn is_raised(&self) -> bool {
        self.state == State::Raised
    }

    /// Returns the key by which the most urgent alert is the greatest.
    pub(super) fn urgency(&self) -> (Severity, bool, AlertId) {
        (self.severity, self.is_raised(), self.id)
    }
}

/// Vessels to read.
pub(super) struct Which {
    pub(super) operator: OperatorId,
    /// Only this vessel.
    pub(super) only: Option<VesselId>,
    /// Only vessels after this one.
    pub(super) after: Option<VesselId>,
    /// Maximum number of vessels.
    pub(super) fetch: i64,
    pub(super) with_tracks: bool,
}

/// Reads the records of a page of an operator's vessels, or of one of them.
pub(super) async fn find(db: &Db, which: &Which, now: Time) -> Result<FleetRecords> {
    let operator = which.operator;
    let vessels = vessels(db, which).await?;
    let (Some(first), Some(last)) = (vessels.first(), vessels.last()) else {
        return Ok(FleetRecords::default());
    };
    let (first, last) = (first.id, last.id);
    let tracks = if which.with_tracks {
        tracks(db, operator, first, last).await?
    } else {
        Vec::new()
    };
    Ok(FleetRecords {
        vessels,
        models: models::current_of_fleet(db, operator, first, last).await?,
        tracks,
        alerts: open_alerts(db, operator, first, last, now).await?,
        calls: next_calls(db, operator, first, last, now).await?,
        interference: recent_interference(db, operator, first, last, now).await?,
        tags: tags::of_fleet(db, operator, first, last).await?,
    })
}

async fn vessels(db: &Db, which: &Which) -> Result<Vec<VesselRow>> {
    let first = which.only.unwrap_or(VesselId(Uuid::nil()));
    let last = which.only.unwrap_or(VesselId(Uuid::max()));
    rows!(
        db,
        VesselRow,
        "SELECT id, name, imo_number, call_sign, last_upload_at, last_sample_at, last_lat, last_lon
         FROM vessels
         WHERE operator_id = $1 AND id BETWEEN $2 AND $3 AND id > $4
           AND (out_of_service_at IS NULL OR $2 = $3)
         ORDER BY id
         LIMIT $5",
        which.operator,
        first,
        last,
        which.after.unwrap_or(VesselId(Uuid::nil())),
        which.fetch
    )
}

async fn tracks(
    db: &Db,
    operator: OperatorId,
    first: VesselId,
    last: VesselId,
) -> Result<Vec<StoredTrack>> {
    rows!(
        db,
        StoredTrack,
        "SELECT a.vessel_id, a.track
         FROM analyses a
         JOIN vessels v ON v.id = a.vessel_id
         WHERE v.operator_id = $1 AND v.id BETWEEN $2 AND $3 AND a.track IS NOT NULL
         ORDER BY a.vessel_id, a.compass_id",
        operator,
        first,
        last
    )
}

async fn open_alerts(
    db: &Db,
    operator: OperatorId,
    first: VesselId,
    last: VesselId,
    now: Time,
) -> Result<Vec<WorstAlert>> {
    rows!(
        db,
        WorstAlert,
        "SELECT a.id, a.vessel_id, a.cause, a.severity, a.state, a.summary
         FROM alerts a
         JOIN vessels v ON v.id = a.vessel_id
         WHERE v.operator_id = $1 AND v.id BETWEEN $2 AND $3 AND a.state <> 'cleared'
           AND (a.snoozed_until IS NULL OR a.snoozed_until <= $4)
         ORDER BY a.vessel_id, a.id",
        operator,
        first,
        last,
        now
    )
}

async fn next_calls(
    db: &Db,
    operator: OperatorId,
    first: VesselId,
    last: VesselId,
    now: Time,
) -> Result<Vec<NextPortCall>> {
    rows!(
        db,
        NextPortCall,
        "SELECT c.vessel_id, c.port, c.eta, c.etd
         FROM port_calls c
         JOIN vessels v ON v.id = c.vessel_id
         WHERE v.operator_id = $1 AND v.id BETWEEN $2 AND $3
           AND c.etd > $4 AND c.withdrawn_at IS NULL
           AND NOT EXISTS (SELECT 1 FROM port_calls e
                           WHERE e.vessel_id = c.vessel_id AND e.eta < c.eta
                             AND e.etd > $4 AND e.withdrawn_at IS NULL)
         ORDER BY c.vessel_id, c.id",
        operator,
        first,
        last,
        now
    )
}
