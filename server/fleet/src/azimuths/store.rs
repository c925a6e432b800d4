//! Azimuths in the database.

use super::entry::{AzimuthEntry, CheckedFilter};
use crate::agent_auth::Agent;
use crate::logbook::AuthorKind;
use anyhow::Context;
use binnacle_compass::azimuth::Azimuth;
use binnacle_platform::db::{Db, Tx, execute, row, rows};
use binnacle_platform::error::{Error, Result};
use binnacle_platform::http::Page;
use binnacle_platform::ids::{AzimuthId, CompassId, UserId, VesselId};
use binnacle_platform::session;
use binnacle_platform::time::Time;
use binnacle_wire::azimuth::AzimuthReport;
use uuid::Uuid;

/// An azimuth's columns.
#[derive(sqlx::FromRow)]
struct Row {
    id: AzimuthId,
    compass_id: CompassId,
    report: String,
    created_at: Time,
    created_by: String,
    author: AuthorKind,
    withdrawn_at: Option<Time>,
    withdrawn_by: Option<String>,
    withdrawal_reason: Option<String>,
}

/// An azimuth to be stored.
pub(super) struct NewRow<'a> {
    pub(super) vessel: VesselId,
    pub(super) id: AzimuthId,
    pub(super) compass: CompassId,
    pub(super) report: &'a AzimuthReport,
}

/// Author of a change, and its time.
pub(super) struct Author {
    kind: AuthorKind,
    id: Uuid,
    name: String,
    at: Time,
}

/// An azimuth that counts.
#[derive(Clone, Debug)]
pub struct StoredAzimuth {
    /// The azimuth's id.
    pub id: AzimuthId,
    /// The observation and its errors.
    pub azimuth: Azimuth,
    /// The observer's initials.
    pub observer: String,
    /// The observer's own words.
    pub remark: String,
}

impl Author {
    pub(super) async fn user(tx: &mut Tx, id: UserId, at: Time) -> Result<Author> {
        Ok(Author {
            kind: AuthorKind::User,
            id: id.0,
            name: session::name_of(tx, id).await?,
            at,
        })
    }

    pub(super) fn agent(agent: &Agent, report: &AzimuthReport, at: Time) -> Author {
        Author {
            kind: AuthorKind::Agent,
            id: agent.agent_id.0,
            name: report.observer.clone(),
            at,
        }
    }
}

/// Lists azimuths, the latest first.
pub(super) async fn list(
    db: &Db,
    vessel: VesselId,
    filter: &CheckedFilter,
    page: &Page,
) -> Result<Vec<AzimuthEntry>> {
    let (before, before_id) = page.after_time()?.unwrap_or((i64::MAX, Uuid::max()));
    let found = rows!(
        db,
        Row,
        "SELECT id, compass_id, report, created_at, created_by, author, withdrawn_at,
                withdrawn_by, withdrawal_reason
         FROM azimuths
         WHERE vessel_id = $1
           AND (observed_at, id) < ($2, $3)
           AND ($4 IS NULL OR compass_id = $4)
           AND observed_at >= $5 AND observed_at < $6
           AND ($7 OR withdrawn_at IS NULL)
         ORDER BY observed_at DESC, id DESC
         LIMIT $8",
        vessel,
        before,
        before_id,
        filter.compass,
        filter.from.map_or(i64::MIN, |time| time.0.micros()),
        filter.to.map_or(i64::MAX, |time| time.0.micros()),
        filter.withdrawn,
        page.fetch()
    )?;
    found.into_iter().map(Row::read).collect()
}

/// Finds an azimuth of the vessel.
///
/// # Errors
/// [`Error::NotFound`] when it has no such azimuth.
pub(super) async fn must_find(db: &Db, vessel: VesselId, id: AzimuthId) -> Result<AzimuthEntry> {
    row!(
        db,
        Row,
        "SELECT id, compass_id, report, created_at, created_by, author, withdrawn_at,
                withdrawn_by, withdrawal_reason
         FROM azimuths
         WHERE vessel_id = $1 AND id = $2
         ORDER BY id",
        vessel,
        id
    )?
    .ok_or(Error::NotFound("azimuth"))?
    .read()
}

/// Lists the azimuths of a compass between two instants that are not withdrawn, in order of time.
pub async fn of_compass(
    db: &Db,
    vessel: VesselId,
    compass: CompassId,
    from: Option<Time>,
    to: Option<Time>,
) -> Result<Vec<StoredAzimuth>> {
    let found = rows!(
        db,
        Row,
        "SELECT id, compass_id, report, created_at, created_by, author, withdrawn_at,
                withdrawn_by, withdrawal_reason
         FROM azimuths
         WHERE vessel_id = $1 AND compass_id = $2 AND withdrawn_at IS NULL
           AND observed_at >= $3 AND observed_at < $4
         ORDER BY observed_at, id",
        vessel,
        compass,
        from.map_or(i64::MIN, |time| time.0.micros()),
        to.map_or(i64::MAX, |time| time.0.micros())
    )?;
    found.into_iter().map(Row::counted).collect()
}

/// Stores an azimuth. Returns `false` when one with this id exists.
pub(super) async fn insert(tx: &mut Tx, new: &NewRow<'_>, author: &Author) -> Result<bool> {
    let inserted = execute!(
        tx,
        "INSERT INTO azimuths (vessel_id, id, compass_id, observed_at, report, created_at,
                               created_by, author, author_id)
         VALUES ($1, $2, $3, $4, $5, $6, $7, $8, $9)
         ON CONFLICT (vessel_id, id) DO NOTHING",
        new.vessel,
        new.id,
        new.compass,
        Time(new.report.observation.time),
        serde_json::to_string(new.report)?,
        author.at,
        author.name.as_str(),
        author.kind,
        author.id
    )?;
    Ok(inserted > 0)
}

/// Tells whether an azimuth was entered on board.
pub(super) async fn is_from_on_board(tx: &mut Tx, vessel: VesselId, id: AzimuthId) -> Result<bool> {
    let found = row!(
        in tx,
        (AuthorKind,),
        "SELECT author FROM azimuths WHERE vessel_id = $1 AND id = $2 ORDER BY id",
        vessel,
        id
    )?;
    Ok(found == Some((AuthorKind::Agent,)))
}

/// Marks an azimuth as withdrawn. Returns `false` when there was nothing to change.
pub(super) async fn withdraw(
    tx: &mut Tx,
    vessel: VesselId,
    id: AzimuthId,
    reason: Option<&str>,
    author: &Author,
) -> Result<bool> {
    let changed = execute!(
        tx,
        "UPDATE azimuths
         SET withdrawn_at = $3, withdrawn_by = $4, withdrawal_reason = $5
         WHERE vessel_id = $1 AND id = $2 AND withdrawn_at IS NULL",
        vessel,
        id,
        author.at,
        author.name.as_str(),
        reason
    )?;
    Ok(changed > 0)
}

impl Row {
    fn counted(self) -> Result<StoredAzimuth> {
        let (report, azimuth) = self.observed()?;
        Ok(StoredAzimuth {
            id: self.id,
            azimuth,
            observer: report.observer,
            remark: report.remark,
        })
    }

    fn read(self) -> Result<AzimuthEntry> {
        let (report, azimuth) = self.observed()?;
        Ok(AzimuthEntry {
            id: self.id,
            compass_id: self.compass_id,
            report,
            result: azimuth.result().clone(),
            created_at: self.created_at,
            created_by: self.created_by,
            author: self.author,
            withdrawn_at: self.withdrawn_at,
            withdrawn_by: self.withdrawn_by,
            withdrawal_reason: self.withdrawal_reason,
        })
    }

    fn observed(&self) -> Result<(AzimuthReport, Azimuth)> {
        let report: AzimuthReport = serde_json::from_str(&self.report)?;
        let azimuth = report.azimuth().context("a stored azimuth")?;
        Ok((report, azimuth))
    }
}
