//! Alerts in the database.

use super::alert::{Alert, Cause, DesiredAlert, Evidence, Filter, Severity, State};
use crate::db::{Db, Result as DbResult, Tx, execute, row, rows};
use crate::error::{Error, Result};
use crate::ids::{AlertId, CompassId, OperatorId, VesselId};
use crate::time::Time;
use uuid::Uuid;

/// An alert whose cause was there at the last look; cleared if a person did that.
#[derive(Clone, Debug, sqlx::FromRow)]
pub(super) struct KnownAlert {
    pub(super) id: AlertId,
    pub(super) cause: Cause,
    pub(super) severity: Severity,
    pub(super) state: State,
    pub(super) summary: String,
    pub(super) advice: String,
    #[sqlx(try_from = "String")]
    pub(super) evidence: Evidence,
    pub(super) since: Time,
    pub(super) cleared_at: Option<Time>,
}

/// What a person says of an alert.
#[derive(Clone, Debug)]
pub(super) struct Remark {
    pub(super) by: String,
    pub(super) text: Option<String>,
    pub(super) at: Time,
}

/// The newest first, from before an id.
pub(super) async fn list(
    db: &Db,
    operator: OperatorId,
    filter: &Filter,
    before: Option<Uuid>,
    limit: i64,
) -> DbResult<Vec<Alert>> {
    let severities = filter.severity.unwrap_or(Severity::Notice).and_worse();
    rows!(
        db,
        Alert,
        "SELECT a.*, v.name AS vessel_name, c.name AS compass_name
         FROM alerts a
         JOIN vessels v ON v.id = a.vessel_id
         JOIN compasses c ON c.vessel_id = a.vessel_id AND c.id = a.compass_id
         WHERE v.operator_id = $1 AND a.id < $2
           AND ($3 IS NULL OR a.vessel_id = $3)
           AND ($4 IS NULL OR a.state = $4)
           AND ($5 IS NULL OR (a.state <> 'cleared') = $5)
           AND a.severity IN ($6, $7, $8)
         ORDER BY a.id DESC
         LIMIT $9",
        operator,
        before.unwrap_or(Uuid::max()),
        filter.vessel,
        filter.state,
        filter.open,
        severities[0],
        severities[1],
        severities[2],
        limit
    )
}

/// An alert of the operator's.
///
/// # Errors
/// [`Error::NotFound`] when there is none.
pub(super) async fn must_find(db: &Db, operator: OperatorId, id: AlertId) -> Result<Alert> {
    row!(
        db,
        Alert,
        "SELECT a.*, v.name AS vessel_name, c.name AS compass_name
         FROM alerts a
         JOIN vessels v ON v.id = a.vessel_id
         JOIN compasses c ON c.vessel_id = a.vessel_id AND c.id = a.compass_id
         WHERE v.operator_id = $1 AND a.id = $2
         ORDER BY a.id",
        operator,
        id
    )?
    .ok_or(Error::NotFound("alert"))
}

/// The same within a transaction, of a vessel that is known.
pub(super) async fn read(tx: &mut Tx, vessel: VesselId, id: AlertId) -> Result<Alert> {
    let found = row!(
        in tx,
        Alert,
        "SELECT a.*, v.name AS vessel_name, c.name AS compass_name
         FROM alerts a
         JOIN vessels v ON v.id = a.vessel_id
         JOIN compasses c ON c.vessel_id = a.vessel_id AND c.id = a.compass_id
         WHERE a.vessel_id = $1 AND a.id = $2
         ORDER BY a.id",
        vessel,
        id
    )?;
    found.ok_or(Error::NotFound("alert"))
}

/// Lets nobody else change a compass's alerts until the transaction ends.
pub(super) async fn lock(tx: &mut Tx, vessel: VesselId, compass: CompassId) -> DbResult<()> {
    execute!(
        tx,
        "UPDATE compasses SET name = name WHERE vessel_id = $1 AND id = $2",
        vessel,
        compass
    )?;
    Ok(())
}

/// A compass's alerts whose cause was there at the last look: one of each cause.
pub(super) async fn known(
    tx: &mut Tx,
    vessel: VesselId,
    compass: CompassId,
) -> DbResult<Vec<KnownAlert>> {
    rows!(
        in tx,
        KnownAlert,
        "SELECT id, cause, severity, state, summary, advice, evidence, since, cleared_at
         FROM alerts
         WHERE vessel_id = $1 AND compass_id = $2 AND holds
         ORDER BY id",
        vessel,
        compass
    )
}

pub(super) async fn insert(
    tx: &mut Tx,
    vessel: VesselId,
    compass: CompassId,
    wanted: &DesiredAlert,
    now: Time,
) -> Result<AlertId> {
    let id = AlertId::new();
    execute!(
        tx,
        "INSERT INTO alerts (vessel_id, id, compass_id, cause, severity, state, holds, since,
                             summary, advice, evidence, raised_at, updated_at)
         VALUES ($1, $2, $3, $4, $5, 'raised', $6, $7, $8, $9, $10, $11, $11)",
        vessel,
        id,
        compass,
        wanted.cause,
        wanted.severity,
        true,
        wanted.since,
        wanted.summary.as_str(),
        wanted.advice,
        serde_json::to_string(&wanted.evidence)?,
        now
    )?;
    Ok(id)
}

/// Says what is so now; one that got worse than what was acknowledged is raised
/// again.
pub(super) async fn update(
    tx: &mut Tx,
    vessel: VesselId,
    known: &KnownAlert,
    wanted: &DesiredAlert,
    now: Time,
) -> Result<()> {
    execute!(
        &mut *tx,
        "UPDATE alerts SET severity = $3, summary = $4, advice = $5, evidence = $6, updated_at = $7,
                           since = COALESCE($8, since)
         WHERE vessel_id = $1 AND id = $2",
        vessel,
        known.id,
        wanted.severity,
        wanted.summary.as_str(),
        wanted.advice,
        serde_json::to_string(&wanted.evidence)?,
        now,
        Some(wanted.since).filter(|_| wanted.cause.is_dated_anew())
    )?;
    if wanted.severity > known.severity && known.state == State::Acknowledged {
        execute!(
            &mut *tx,
            "UPDATE alerts SET state = 'raised', acknowledged_at = NULL, acknowledged_by = NULL,
                               acknowledgement_note = NULL
             WHERE vessel_id = $1 AND id = $2",
            vessel,
            known.id
        )?;
    }
    Ok(())
}

/// Notes that an alert's cause is over; one that is open is cleared by that, for the
/// reason given.
pub(super) async fn end(
    tx: &mut Tx,
    vessel: VesselId,
    id: AlertId,
    reason: &str,
    now: Time,
) -> DbResult<()> {
    execute!(
        tx,
        "UPDATE alerts
         SET holds = $3, state = 'cleared', updated_at = $4,
             cleared_at = COALESCE(cleared_at, $4),
             clearing_reason = COALESCE(clearing_reason, $5)
         WHERE vessel_id = $1 AND id = $2",
        vessel,
        id,
        false,
        now,
        reason
    )?;
    Ok(())
}

/// Notes that someone knows; `false` unless it is raised.
pub(super) async fn acknowledge(
    tx: &mut Tx,
    vessel: VesselId,
    id: AlertId,
    word: &Remark,
) -> DbResult<bool> {
    let changed = execute!(
        tx,
        "UPDATE alerts
         SET state = 'acknowledged', acknowledged_at = $3, acknowledged_by = $4,
             acknowledgement_note = $5, updated_at = $3
         WHERE vessel_id = $1 AND id = $2 AND state = 'raised'",
        vessel,
        id,
        word.at,
        word.by.as_str(),
        word.text.as_deref()
    )?;
    Ok(changed > 0)
}

/// Clears an alert in a person's name; `false` unless it is open.
pub(super) async fn clear(
    tx: &mut Tx,
    vessel: VesselId,
    id: AlertId,
    word: &Remark,
) -> DbResult<bool> {
    let changed = execute!(
        tx,
        "UPDATE alerts
         SET state = 'cleared', cleared_at = $3, cleared_by = $4, clearing_reason = $5,
             updated_at = $3
         WHERE vessel_id = $1 AND id = $2 AND state <> 'cleared'",
        vessel,
        id,
        word.at,
        word.by.as_str(),
        word.text.as_deref()
    )?;
    Ok(changed > 0)
}

/// How a vessel's open alerts stand.
#[derive(Clone, Copy, Debug, sqlx::FromRow)]
pub struct OpenCount {
    /// The vessel.
    pub vessel_id: VesselId,
    /// How bad.
    pub severity: Severity,
    /// How far people have come with them.
    pub state: State,
    /// How many.
    pub alerts: i64,
}

/// The open alerts of an operator's vessels from one id to another, counted.
pub async fn count_open(
    db: &Db,
    operator: OperatorId,
    first: VesselId,
    last: VesselId,
) -> DbResult<Vec<OpenCount>> {
    rows!(
        db,
        OpenCount,
        "SELECT a.vessel_id, a.severity, a.state, COUNT(*) AS alerts
         FROM alerts a
         JOIN vessels v ON v.id = a.vessel_id
         WHERE v.operator_id = $1 AND v.id BETWEEN $2 AND $3 AND a.state <> 'cleared'
         GROUP BY a.vessel_id, a.severity, a.state
         ORDER BY a.vessel_id, a.severity, a.state",
        operator,
        first,
        last
    )
}

/// What an open alert says, in short.
#[derive(Clone, Debug, sqlx::FromRow)]
pub struct OpenAlert {
    /// What it is about.
    pub cause: Cause,
    /// Since when it is so.
    pub since: Time,
    /// What is so, in a sentence.
    pub summary: String,
}

/// The alerts of a compass that are not cleared, the newest first.
pub(super) async fn open_of_compass(
    db: &Db,
    vessel: VesselId,
    compass: CompassId,
) -> DbResult<Vec<OpenAlert>> {
    rows!(
        db,
        OpenAlert,
        "SELECT cause, since, summary FROM alerts
         WHERE vessel_id = $1 AND compass_id = $2 AND state <> 'cleared'
         ORDER BY id DESC",
        vessel,
        compass
    )
}

/// What was found of a compass at its last analysis, as JSON.
pub(super) async fn findings(
    tx: &mut Tx,
    vessel: VesselId,
    compass: CompassId,
) -> DbResult<Option<String>> {
    let found = row!(
        in tx,
        (Option<String>,),
        "SELECT findings FROM analyses WHERE vessel_id = $1 AND compass_id = $2
         ORDER BY compass_id",
        vessel,
        compass
    )?;
    Ok(found.and_then(|(findings,)| findings))
}

/// When a compass's agents were last heard of.
#[derive(Clone, Debug, sqlx::FromRow)]
pub(super) struct LastUpload {
    pub(super) vessel_id: VesselId,
    pub(super) compass_id: CompassId,
    pub(super) last_at: Time,
    /// The vessel's limits as JSON; none for the defaults.
    pub(super) limits: Option<String>,
    /// Whether their silence is an alert already, or was until a person cleared it.
    pub(super) alerts: i64,
}

/// When the agents of every compass that has any were last heard of, of vessels in service.
pub(super) async fn heard(db: &Db) -> DbResult<Vec<LastUpload>> {
    rows!(
        db,
        LastUpload,
        "SELECT s.vessel_id, s.compass_id, MAX(COALESCE(s.last_upload_at, s.opened_at)) AS last_at,
                MAX(w.alerts) AS limits,
                (SELECT COUNT(*) FROM alerts a
                 WHERE a.vessel_id = s.vessel_id AND a.compass_id = s.compass_id
                   AND a.cause = 'silent_agent' AND a.holds) AS alerts
         FROM streams s
         JOIN vessels v ON v.id = s.vessel_id AND v.out_of_service_at IS NULL
         LEFT JOIN vessel_settings w ON w.vessel_id = s.vessel_id
         GROUP BY s.vessel_id, s.compass_id
         ORDER BY s.vessel_id, s.compass_id"
    )
}

/// The compasses whose alert of a cause goes on, though nothing has shown it since.
pub(super) async fn unshown(
    db: &Db,
    cause: Cause,
    since: Time,
) -> DbResult<Vec<(VesselId, CompassId)>> {
    rows!(
        db,
        (VesselId, CompassId),
        "SELECT vessel_id, compass_id FROM alerts
         WHERE cause = $1 AND holds AND updated_at < $2
         ORDER BY vessel_id, compass_id",
        cause,
        since
    )
}
