//! Logbook entries in the database.

use super::entry::{AuthorKind, CheckedFilter, LogbookEntry, NewEntry, Revision};
use crate::agent_auth::Agent;
use crate::analysis_queue;
use crate::event_kinds;
use anyhow::Context;
use binnacle_compass::logbook::LogbookKind;
use binnacle_platform::app::App;
use binnacle_platform::audit::RequestContext;
use binnacle_platform::db::{Db, Tx, execute, row, rows};
use binnacle_platform::error::{Error, Result};
use binnacle_platform::events;
use binnacle_platform::http::Page;
use binnacle_platform::ids::{CompassId, EntryId, UserId, VesselId};
use binnacle_platform::session;
use binnacle_platform::time::Time;
use binnacle_wire::logbook::Report;
use serde::Serialize;
use serde::de::DeserializeOwned;
use serde_json::Value;
use uuid::Uuid;

/// An entry's columns. Its enumerations are read as JSON reads them.
#[derive(sqlx::FromRow)]
struct Row {
    id: EntryId,
    compass_id: Option<CompassId>,
    kind: String,
    from_at: Time,
    to_at: Option<Time>,
    cargo: Option<String>,
    hatch: Option<String>,
    port: Option<String>,
    note: String,
    created_at: Time,
    created_by: String,
    author: AuthorKind,
    revision: i64,
    board_revision: Option<i64>,
    revised_at: Option<Time>,
    revised_by: Option<String>,
    withdrawn_at: Option<Time>,
    withdrawn_by: Option<String>,
    withdrawal_reason: Option<String>,
}

/// The entry that a transaction has locked.
pub(super) struct LockedEntry {
    vessel_id: VesselId,
    id: EntryId,
    pub(super) revision: i64,
    /// Its content.
    pub(super) content: NewEntry,
    /// The latest revision from on board; none for an entry reported on shore.
    pub(super) board_revision: Option<u32>,
    /// Time of withdrawal.
    pub(super) withdrawn_at: Option<Time>,
}

/// Author of a revision, and its time.
pub(super) struct Author {
    kind: AuthorKind,
    id: Uuid,
    name: String,
    at: Time,
    /// The revision's number on board, if it comes from there.
    board_revision: Option<u32>,
}

/// A transaction that changes what people report of a vessel.
pub(crate) struct Change<'a> {
    app: &'a App,
    vessel: VesselId,
    now: Time,
    tx: Tx,
}

impl<'a> Change<'a> {
    pub(crate) async fn begin(
        app: &'a App,
        request: &RequestContext,
        vessel: VesselId,
        now: Time,
    ) -> Result<Change<'a>> {
        let tx = request.begin().await?;
        Ok(Change {
            app,
            vessel,
            now,
            tx,
        })
    }

    pub(crate) fn tx(&mut self) -> &mut Tx {
        &mut self.tx
    }

    /// Commits the change, enqueues an analysis of the vessel, and notifies dashboards.
    pub(crate) async fn commit(mut self) -> Result<()> {
        analysis_queue::enqueue(&mut self.tx, self.vessel, self.now, 0.0).await?;
        let event =
            events::insert(&mut self.tx, self.vessel, event_kinds::LOGBOOK, self.now).await?;
        self.tx.commit().await?;
        self.app.publish(event);
        self.app.work.notify_one();
        Ok(())
    }
}

impl Author {
    pub(super) async fn user(tx: &mut Tx, id: UserId, at: Time) -> Result<Author> {
        Ok(Author {
            kind: AuthorKind::User,
            id: id.0,
            name: session::name_of(tx, id).await?,
            at,
            board_revision: None,
        })
    }

    pub(super) fn agent(agent: &Agent, name: String, revision: u32, at: Time) -> Author {
        Author {
            kind: AuthorKind::Agent,
            id: agent.agent_id.0,
            name,
            at,
            board_revision: Some(revision),
        }
    }
}

/// Work on a compass as a work order writes it.
#[allow(missing_docs, reason = "they are an entry's parts")]
pub struct CompassWork<'a> {
    pub kind: LogbookKind,
    pub id: EntryId,
    pub vessel: VesselId,
    pub compass: CompassId,
    pub at: Time,
    pub port: &'a str,
    pub note: &'a str,
    pub author_id: Uuid,
    pub author_name: &'a str,
    pub now: Time,
}

/// Writes work on a compass at its time, and enqueues an analysis of the vessel.
pub async fn write_compass_work(tx: &mut Tx, work: &CompassWork<'_>) -> Result<()> {
    let entry = NewEntry {
        report: Report {
            kind: work.kind,
            from: work.at.0,
            to: None,
            cargo: None,
            hatch: None,
            // A logbook's port is shorter than an order's.
            port: Some(work.port.chars().take(100).collect()),
            note: work.note.to_owned(),
        },
        compass_id: Some(work.compass),
    };
    let entry = entry.checked(work.now.0)?;
    let author = Author {
        kind: AuthorKind::User,
        id: work.author_id,
        name: work.author_name.to_owned(),
        at: work.now,
        board_revision: None,
    };
    insert(tx, work.vessel, work.id, &entry, &author).await?;
    analysis_queue::enqueue(tx, work.vessel, work.now, 0.0).await?;
    Ok(())
}

/// Lists entries, the latest event first.
pub(super) async fn list(
    db: &Db,
    vessel: VesselId,
    filter: &CheckedFilter,
    page: &Page,
) -> Result<Vec<LogbookEntry>> {
    let (before, before_id) = page.after_time()?.unwrap_or((i64::MAX, Uuid::max()));
    let found = rows!(
        db,
        Row,
        "SELECT id, compass_id, kind, from_at, to_at, cargo, hatch, port, note, created_at,
                created_by, author, revision, board_revision, revised_at, revised_by,
                withdrawn_at, withdrawn_by, withdrawal_reason
         FROM logbook_entries
         WHERE vessel_id = $1
           AND (from_at, id) < ($2, $3)
           AND ($4 IS NULL OR kind = $4)
           AND from_at < $6
           AND (from_at >= $5 OR to_at >= $5
                OR (to_at IS NULL AND kind IN ('magnetic_cargo', 'berth')))
           AND ($7 OR withdrawn_at IS NULL)
         ORDER BY from_at DESC, id DESC
         LIMIT $8",
        vessel,
        before,
        before_id,
        filter.kind.map(|kind| word(&kind)).transpose()?,
        filter.from.map_or(i64::MIN, |time| time.0.micros()),
        filter.to.map_or(i64::MAX, |time| time.0.micros()),
        filter.withdrawn,
        page.fetch()
    )?;
    found.into_iter().map(Row::read).collect()
}

/// Finds an entry of the vessel.
///
/// # Errors
/// [`Error::NotFound`] when it has no such entry.
pub(super) async fn must_find(db: &Db, vessel: VesselId, id: EntryId) -> Result<LogbookEntry> {
    row!(
        db,
        Row,
        "SELECT id, compass_id, kind, from_at, to_at, cargo, hatch, port, note, created_at,
                created_by, author, revision, board_revision, revised_at, revised_by,
                withdrawn_at, withdrawn_by, withdrawal_reason
         FROM logbook_entries
         WHERE vessel_id = $1 AND id = $2
         ORDER BY id",
        vessel,
        id
    )?
    .ok_or(Error::NotFound("logbook entry"))?
    .read()
}

/// Locks an entry for an update; concurrent updates wait.
pub(super) async fn lock(tx: &mut Tx, vessel_id: VesselId, id: EntryId) -> Result<LockedEntry> {
    let found = row!(
        in tx,
        Row,
        "UPDATE logbook_entries SET revision = revision
         WHERE vessel_id = $1 AND id = $2
         RETURNING id, compass_id, kind, from_at, to_at, cargo, hatch, port, note, created_at,
                   created_by, author, revision, board_revision, revised_at, revised_by,
                   withdrawn_at, withdrawn_by, withdrawal_reason",
        vessel_id,
        id
    )?
    .ok_or(Error::NotFound("logbook entry"))?;
    let board_revision = found.board_revision.map(u32::try_from).transpose();
    let (revision, withdrawn_at) = (found.revision, found.withdrawn_at);
    Ok(LockedEntry {
        vessel_id,
        id,
        revision,
        board_revision: board_revision.context("a revision from on board")?,
        withdrawn_at,
        content: found.read()?.content(),
    })
}

/// Writes an entry. Returns `false` when one with this id exists.
pub(super) async fn insert(
    tx: &mut Tx,
    vessel: VesselId,
    id: EntryId,
    new: &NewEntry,
    author: &Author,
) -> Result<bool> {
    must_have_compass(tx, vessel, new.compass_id).await?;
    let report = &new.report;
    let inserted = execute!(
        &mut *tx,
        "INSERT INTO logbook_entries (vessel_id, id, compass_id, kind, from_at, to_at, cargo,
                                      hatch, port, note, created_at, created_by, author,
                                      revision, board_revision)
         VALUES ($1, $2, $3, $4, $5, $6, $7, $8, $9, $10, $11, $12, $13, 1, $14)
         ON CONFLICT (vessel_id, id) DO NOTHING",
        vessel,
        id,
        new.compass_id,
        word(&report.kind)?,
        Time(report.from),
        report.to.map(Time),
        report.cargo.map(|cargo| word(&cargo)).transpose()?,
        report.hatch.as_deref(),
        report.port.as_deref(),
        report.note.as_str(),
        author.at,
        author.name.as_str(),
        author.kind,
        author.board_revision.map(i64::from)
    )?;
    if inserted == 0 {
        return Ok(false);
    }
    insert_revision(tx, vessel, id, 1, new, author).await?;
    Ok(true)
}

/// Writes a revision of an entry.
pub(super) async fn revise(
    tx: &mut Tx,
    locked: &LockedEntry,
    amended: &NewEntry,
    author: &Author,
) -> Result<()> {
    let vessel = locked.vessel_id;
    must_have_compass(tx, vessel, amended.compass_id).await?;
    let report = &amended.report;
    execute!(
        &mut *tx,
        "UPDATE logbook_entries
         SET compass_id = $3, kind = $4, from_at = $5, to_at = $6, cargo = $7, hatch = $8,
             port = $9, note = $10, revision = $11, revised_at = $12, revised_by = $13,
             board_revision = COALESCE($14, board_revision)
         WHERE vessel_id = $1 AND id = $2",
        vessel,
        locked.id,
        amended.compass_id,
        word(&report.kind)?,
        Time(report.from),
        report.to.map(Time),
        report.cargo.map(|cargo| word(&cargo)).transpose()?,
        report.hatch.as_deref(),
        report.port.as_deref(),
        report.note.as_str(),
        locked.revision + 1,
        author.at,
        author.name.as_str(),
        author.board_revision.map(i64::from)
    )?;
    insert_revision(tx, vessel, locked.id, locked.revision + 1, amended, author).await
}

/// Marks an entry as withdrawn.
pub(super) async fn withdraw(
    tx: &mut Tx,
    locked: &LockedEntry,
    reason: Option<&str>,
    author: &Author,
) -> Result<()> {
    execute!(
        tx,
        "UPDATE logbook_entries
         SET withdrawn_at = $3, withdrawn_by = $4, withdrawal_reason = $5,
             board_revision = COALESCE($6, board_revision)
         WHERE vessel_id = $1 AND id = $2",
        locked.vessel_id,
        locked.id,
        author.at,
        author.name.as_str(),
        reason,
        author.board_revision.map(i64::from)
    )?;
    Ok(())
}

/// Lists the revisions of an entry, the first one first.
pub(super) async fn revisions(db: &Db, vessel: VesselId, id: EntryId) -> Result<Vec<Revision>> {
    let found = rows!(
        db,
        (i64, Time, AuthorKind, String, String),
        "SELECT revision, at, author, author_name, entry FROM logbook_revisions
         WHERE vessel_id = $1 AND entry_id = $2
         ORDER BY revision",
        vessel,
        id
    )?;
    let read = |(revision, at, author, author_name, entry): (i64, _, _, _, String)| {
        Ok(Revision {
            number: u32::try_from(revision).context("a revision")?,
            at,
            author,
            author_name,
            entry: serde_json::from_str(&entry)?,
        })
    };
    found.into_iter().map(read).collect()
}

/// Lists the entries that the analysis of a compass needs, in order of time and without text. Notes
/// and withdrawn entries are left out.
pub async fn of_compass(
    db: &Db,
    vessel: VesselId,
    compass: CompassId,
) -> Result<Vec<binnacle_compass::logbook::LogbookEntry>> {
    let found = rows!(
        db,
        Row,
        "SELECT id, compass_id, kind, from_at, to_at, cargo, hatch, port, note, created_at,
                created_by, author, revision, board_revision, revised_at, revised_by,
                withdrawn_at, withdrawn_by, withdrawal_reason
         FROM logbook_entries
         WHERE vessel_id = $1 AND (compass_id IS NULL OR compass_id = $2)
           AND withdrawn_at IS NULL AND kind <> 'note'
         ORDER BY from_at, id",
        vessel,
        compass
    )?;
    let entry = |row: Row| Ok(row.report()?.entry());
    found.into_iter().map(entry).collect()
}

/// Inserts a revision, which is kept for good.
async fn insert_revision(
    tx: &mut Tx,
    vessel: VesselId,
    id: EntryId,
    revision: i64,
    entry: &NewEntry,
    author: &Author,
) -> Result<()> {
    execute!(
        tx,
        "INSERT INTO logbook_revisions (vessel_id, entry_id, revision, at, author, author_id,
                                        author_name, entry)
         VALUES ($1, $2, $3, $4, $5, $6, $7, $8)",
        vessel,
        id,
        revision,
        author.at,
        author.kind,
        author.id,
        author.name.as_str(),
        serde_json::to_string(entry)?
    )?;
    Ok(())
}

async fn must_have_compass(
    tx: &mut Tx,
    vessel: VesselId,
    compass: Option<CompassId>,
) -> Result<()> {
    let Some(compass) = compass else {
        return Ok(());
    };
    let found = row!(
        in tx,
        (CompassId,),
        "SELECT id FROM compasses WHERE vessel_id = $1 AND id = $2 ORDER BY id",
        vessel,
        compass
    )?;
    found.map(drop).ok_or_else(|| Error::Invalid {
        field: "compass_id",
        detail: "the vessel has no such compass".to_owned(),
    })
}

impl Row {
    fn report(&self) -> Result<Report> {
        Ok(Report {
            kind: read_word(&self.kind)?,
            from: self.from_at.0,
            to: self.to_at.map(|to| to.0),
            cargo: self.cargo.as_deref().map(read_word).transpose()?,
            hatch: self.hatch.clone(),
            port: self.port.clone(),
            note: self.note.clone(),
        })
    }

    fn read(self) -> Result<LogbookEntry> {
        Ok(LogbookEntry {
            report: self.report()?,
            id: self.id,
            compass_id: self.compass_id,
            created_at: self.created_at,
            created_by: self.created_by,
            author: self.author,
            revision: u32::try_from(self.revision).context("a revision")?,
            revised_at: self.revised_at,
            revised_by: self.revised_by,
            withdrawn_at: self.withdrawn_at,
            withdrawn_by: self.withdrawn_by,
            withdrawal_reason: self.withdrawal_reason,
        })
    }
}

/// Returns a word as it stands in JSON.
fn word(value: &impl Serialize) -> Result<String> {
    match serde_json::to_value(value)? {
        Value::String(word) => Ok(word),
        other => Err(anyhow::anyhow!("{other} is not a string").into()),
    }
}

fn read_word<T: DeserializeOwned>(word: &str) -> Result<T> {
    Ok(serde_json::from_value(Value::from(word))?)
}
