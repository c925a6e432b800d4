//! Alerts in the database.

use super::alert::{Alert, KnownAlert, State};
use super::cause::Cause;
use super::causes::Source;
use super::desired::DesiredAlert;
use super::requests::Filter;
use crate::agent_auth::{Agent, IMPORT_VERSION};
use binnacle_platform::db::{Db, Result as DbResult, Tx, execute, row, rows};
use binnacle_platform::error::{Error, Result};
use binnacle_platform::ids::{AlertId, CompassId, OperatorId, VesselId};
use binnacle_platform::severity::Severity;
use binnacle_platform::time::Time;
use uuid::Uuid;

/// Remark of a person on an alert.
#[derive(Clone, Debug)]
pub(super) struct Remark {
    pub(super) by: String,
    pub(super) text: Option<String>,
    pub(super) at: Time,
}

/// Part of the alerts to list.
pub(super) struct ListedAlerts {
    /// Vessel, state and severity.
    pub(super) filter: Filter,
    /// First instant of their beginning, and the first after it, microseconds since 1970.
    pub(super) since: (i64, i64),
    /// Id before which the list begins.
    pub(super) before: Option<Uuid>,
    /// Maximum number of alerts.
    pub(super) limit: i64,
}

/// Lists an operator's alerts from before an id, the newest first.
pub(super) async fn list(
    db: &Db,
    operator: OperatorId,
    asked: &ListedAlerts,
) -> DbResult<Vec<Alert>> {
    let filter = &asked.filter;
    let severities = filter.severity.unwrap_or(Severity::Notice).and_worse();
    rows!(
        db,
        Alert,
        "SELECT a.*, v.name AS vessel_name, c.name AS compass_name, u.name AS assigned_name
         FROM alerts a
         JOIN vessels v ON v.id = a.vessel_id
         JOIN compasses c ON c.vessel_id = a.vessel_id AND c.id = a.compass_id
         LEFT JOIN users u ON u.id = a.assigned_to
         WHERE v.operator_id = $1 AND a.id < $2
           AND ($3 IS NULL OR a.vessel_id = $3)
           AND ($4 IS NULL OR a.state = $4)
           AND ($5 IS NULL OR (a.state <> 'cleared') = $5)
           AND a.severity IN ($6, $7, $8)
           AND a.since >= $9 AND a.since < $10
         ORDER BY a.id DESC
         LIMIT $11",
        operator,
        asked.before.unwrap_or(Uuid::max()),
        filter.vessel,
        filter.state,
        filter.open,
        severities[0],
        severities[1],
        severities[2],
        asked.since.0,
        asked.since.1,
        asked.limit
    )
}

/// Finds an alert of the operator's.
///
/// # Errors
/// Fails with [`Error::NotFound`] when there is none.
pub(super) async fn must_find(db: &Db, operator: OperatorId, id: AlertId) -> Result<Alert> {
    row!(
        db,
        Alert,
        "SELECT a.*, v.name AS vessel_name, c.name AS compass_name, u.name AS assigned_name
         FROM alerts a
         JOIN vessels v ON v.id = a.vessel_id
         JOIN compasses c ON c.vessel_id = a.vessel_id AND c.id = a.compass_id
         LEFT JOIN users u ON u.id = a.assigned_to
         WHERE v.operator_id = $1 AND a.id = $2
         ORDER BY a.id",
        operator,
        id
    )?
    .ok_or(Error::NotFound("alert"))
}

/// Reads an alert of a vessel within a transaction.
pub(super) async fn read(tx: &mut Tx, vessel: VesselId, id: AlertId) -> Result<Alert> {
    let found = row!(
        in tx,
        Alert,
        "SELECT a.*, v.name AS vessel_name, c.name AS compass_name, u.name AS assigned_name
         FROM alerts a
         JOIN vessels v ON v.id = a.vessel_id
         JOIN compasses c ON c.vessel_id = a.vessel_id AND c.id = a.compass_id
         LEFT JOIN users u ON u.id = a.assigned_to
         WHERE a.vessel_id = $1 AND a.id = $2
         ORDER BY a.id",
        vessel,
        id
    )?;
    found.ok_or(Error::NotFound("alert"))
}

/// Locks a compass's alerts until the transaction ends.
pub(super) async fn lock(tx: &mut Tx, vessel: VesselId, compass: CompassId) -> DbResult<()> {
    execute!(
        tx,
        "UPDATE compasses SET name = name WHERE vessel_id = $1 AND id = $2",
        vessel,
        compass
    )?;
    Ok(())
}

/// Lists a compass's alerts whose cause held at the last evaluation: one of each cause.
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

/// Lists the known alerts of one source.
pub(super) async fn known_of(
    tx: &mut Tx,
    vessel: VesselId,
    compass: CompassId,
    source: Source,
) -> DbResult<Vec<KnownAlert>> {
    let mut known = known(tx, vessel, compass).await?;
    known.retain(|alert| alert.cause.row().source() == source);
    Ok(known)
}

/// Inserts a raised alert.
pub(super) async fn insert(
    tx: &mut Tx,
    vessel: VesselId,
    compass: CompassId,
    desired: &DesiredAlert,
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
        desired.cause,
        desired.severity,
        true,
        desired.since,
        desired.summary.as_str(),
        desired.advice,
        serde_json::to_string(&desired.evidence)?,
        now
    )?;
    Ok(id)
}

/// Updates an alert. One that got worse after its acknowledgement is raised again.
pub(super) async fn update(
    tx: &mut Tx,
    vessel: VesselId,
    known: &KnownAlert,
    desired: &DesiredAlert,
    now: Time,
) -> Result<()> {
    execute!(
        &mut *tx,
        "UPDATE alerts SET severity = $3, summary = $4, advice = $5, evidence = $6, updated_at = $7,
                           since = COALESCE($8, since)
         WHERE vessel_id = $1 AND id = $2",
        vessel,
        known.id,
        desired.severity,
        desired.summary.as_str(),
        desired.advice,
        serde_json::to_string(&desired.evidence)?,
        now,
        Some(desired.since).filter(|_| desired.cause.row().is_redated)
    )?;
    if desired.severity > known.severity {
        execute!(
            &mut *tx,
            "UPDATE alerts SET snoozed_until = NULL WHERE vessel_id = $1 AND id = $2",
            vessel,
            known.id
        )?;
    }
    if desired.severity > known.severity && known.state == State::Acknowledged {
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

/// Records that an alert's cause is over, which clears an open alert for the reason given.
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

/// Acknowledges an alert; `false` unless it is raised.
pub(super) async fn acknowledge(
    tx: &mut Tx,
    vessel: VesselId,
    id: AlertId,
    remark: &Remark,
) -> DbResult<bool> {
    let changed = execute!(
        tx,
        "UPDATE alerts
         SET state = 'acknowledged', acknowledged_at = $3, acknowledged_by = $4,
             acknowledgement_note = $5, updated_at = $3
         WHERE vessel_id = $1 AND id = $2 AND state = 'raised'",
        vessel,
        id,
        remark.at,
        remark.by.as_str(),
        remark.text.as_deref()
    )?;
    Ok(changed > 0)
}

/// Clears an alert in a person's name; `false` unless it is open.
pub(super) async fn clear(
    tx: &mut Tx,
    vessel: VesselId,
    id: AlertId,
    remark: &Remark,
) -> DbResult<bool> {
    let changed = execute!(
        tx,
        "UPDATE alerts
         SET state = 'cleared', cleared_at = $3, cleared_by = $4, clearing_reason = $5,
             updated_at = $3
         WHERE vessel_id = $1 AND id = $2 AND state <> 'cleared'",
        vessel,
        id,
        remark.at,
        remark.by.as_str(),
        remark.text.as_deref()
    )?;
    Ok(changed > 0)
}

/// Number of a vessel's open alerts of one severity and state.
#[derive(Clone, Copy, Debug, sqlx::FromRow)]
pub struct OpenCount {
    /// The vessel.
    pub vessel_id: VesselId,
    /// Their severity.
    pub severity: Severity,
    /// Their state.
    pub state: State,
    /// Their number.
    pub alerts: i64,
}

/// Counts the open alerts of an operator's vessels from one id to another.
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

/// An open alert in short.
#[derive(Clone, Debug, sqlx::FromRow)]
pub struct OpenAlert {
    /// Its cause.
    pub cause: Cause,
    /// Beginning of its cause.
    pub since: Time,
    /// The facts, in a sentence.
    pub summary: String,
}

/// Lists the alerts of a compass that are not cleared, the newest first.
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

/// Reads the findings of a compass's last analysis, as JSON.
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

/// Last upload of a compass's agents.
#[derive(Clone, Debug, sqlx::FromRow)]
pub(super) struct LastUpload {
    pub(super) vessel_id: VesselId,
    pub(super) compass_id: CompassId,
    pub(super) last_at: Time,
    /// The vessel's limits as JSON; none for the defaults.
    pub(super) limits: Option<String>,
    /// Number of alerts about their silence, with those that a person cleared.
    pub(super) alerts: i64,
}

/// Lists the last upload for every compass with an agent, of vessels in service. Imported
/// recordings are no agent's uploads.
pub(super) async fn last_uploads(db: &Db) -> DbResult<Vec<LastUpload>> {
    rows!(
        db,
        LastUpload,
        "SELECT s.vessel_id, s.compass_id, MAX(COALESCE(s.last_upload_at, s.opened_at)) AS last_at,
                MAX(w.alerts) AS limits,
                (SELECT COUNT(*) FROM alerts a
                 WHERE a.vessel_id = s.vessel_id AND a.compass_id = s.compass_id
                   AND a.cause = 'silent_agent' AND a.holds) AS alerts
         FROM streams s
         JOIN agents g ON g.vessel_id = s.vessel_id AND g.id = s.agent_id AND g.agent_version <> $1
         JOIN vessels v ON v.id = s.vessel_id AND v.out_of_service_at IS NULL
         LEFT JOIN vessel_settings w ON w.vessel_id = s.vessel_id
         GROUP BY s.vessel_id, s.compass_id
         ORDER BY s.vessel_id, s.compass_id",
        IMPORT_VERSION
    )
}

/// Lists the compasses with an open alert of a cause that was not updated since.
pub(super) async fn not_updated_since(
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

/// Lists an operator's compasses with an alert about an agreed job.
pub(super) async fn with_job_at_risk(
    tx: &mut Tx,
    operator: OperatorId,
) -> DbResult<Vec<(VesselId, CompassId)>> {
    rows!(
        in tx,
        (VesselId, CompassId),
        "SELECT a.vessel_id, a.compass_id FROM alerts a JOIN vessels v ON v.id = a.vessel_id
         WHERE v.operator_id = $1 AND a.cause = $2 AND a.holds
         ORDER BY a.vessel_id, a.compass_id",
        operator,
        Cause::AgreedJobAtRisk
    )
}

/// Finds the first newer stream in which an agent has sent, with the time of its opening.
///
/// Ids of streams are in the order of their opening.
pub(super) async fn newer_stream(
    tx: &mut Tx,
    agent: Agent,
    stream: Uuid,
) -> DbResult<Option<(Uuid, Time)>> {
    row!(
        in tx,
        (Uuid, Time),
        "SELECT id, opened_at FROM streams
         WHERE vessel_id = $1 AND agent_id = $2 AND id > $3 AND batches > 0
         ORDER BY id LIMIT 1",
        agent.vessel_id,
        agent.agent_id,
        stream
    )
}

/// Returns the number of raised alerts, and the worst severity of the open ones.
pub fn summarize<'a>(counts: impl Iterator<Item = &'a OpenCount>) -> (u32, Option<Severity>) {
    let (mut raised, mut worst) = (0, None);
    for count in counts {
        worst = worst.max(Some(count.severity));
        if count.state == State::Raised {
            raised += count.alerts as u32;
        }
    }
    (raised, worst)
}
