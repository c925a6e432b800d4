//! What must outlive the agent: one SQLite file in the data directory.
//!
//! What always holds, also when the process is killed or the power fails at any
//! point (WAL, every commit synced):
//!
//! - A sample is in exactly one place: pending, or in one sealed batch.
//! - A sealed batch is never changed once it was tried; before that it may be thinned
//!   for want of room, and says so, or take in the one that was sealed after it. Batches of a stream are numbered from 1 without
//!   gaps, and sent again byte for byte until they are acknowledged.
//! - A batch is deleted only when the shore acknowledged that very batch and
//!   everything before it, and a month later or when room is short; a record of its
//!   number, size and checksum remains. Until then it is sent again if the shore lost it.
//! - An alert and the batch that carries it ashore are here from the same moment on.
//! - An officer's report is here until the shore has it.
//! - Position and data are one thing: there is no ledger beside the rows that
//!   could disagree with them.
//! - What is not in here yet: samples of the last second or of the last
//!   [`crate::run::SAMPLES_PER_COMMIT`], whichever is less, and the stretch of at most
//!   ten minutes that the sampler is still in.

mod account;
mod acknowledged;
mod batches;
mod merge;
mod repair;
mod reports;
mod seal;
mod short_bursts;
mod thinning;

pub(crate) use account::{BudgetAccount, REQUEST_BYTES};
pub(crate) use batches::{SealedBatch, SpoolStatus};
pub(crate) use reports::{ReportState, SaveReportError, StoredReport};
pub(crate) use seal::{Pending, Seal};
pub(crate) use thinning::{MAX_PENDING, is_disk_full};

use crate::alert::AlertRecord;
use crate::clock_checkpoint::ClockCheckpoint;
use crate::sampler::Exclusion;
use anyhow::Context;
use binnacle_magnetics::time::Timestamp;
use binnacle_wire::batch::StreamId;
use binnacle_wire::messages::{CardWithdrawn, Downlink, ModelDownlink, Settings};
use serde::de::DeserializeOwned;
use serde::{Deserialize, Serialize};
use sqlx::sqlite::{SqliteConnectOptions, SqliteJournalMode, SqlitePoolOptions, SqliteSynchronous};
use sqlx::{Sqlite, SqliteConnection, SqlitePool, Transaction};
use std::fmt;
use std::net::SocketAddr;
use std::path::Path;
use std::time::Duration;

/// The agent's memory. Cheap to clone; all clones share one connection.
#[derive(Clone, Debug)]
pub(crate) struct Spool {
    pool: SqlitePool,
}

/// Who the agent is to the shore.
#[derive(Clone, PartialEq, Serialize, Deserialize)]
pub(crate) struct Identity {
    /// Where the shore is, as `https://host`.
    pub(crate) server: String,
    /// Bearer token; never logged.
    pub(crate) token: String,
    /// What the shore may know instead: a new one of which it is not known whether it is
    /// in place, or the one before.
    #[serde(default, skip_serializing_if = "Option::is_none")]
    pub(crate) other_token: Option<String>,
    /// The stream that batches are numbered in.
    pub(crate) stream: StreamId,
    /// For the local page.
    pub(crate) vessel_name: String,
    /// For the local page.
    pub(crate) compass_name: String,
}

impl Identity {
    fn is_same_compass(&self, other: &Identity) -> bool {
        (&self.vessel_name, &self.compass_name) == (&other.vessel_name, &other.compass_name)
    }
}

impl fmt::Debug for Identity {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        write!(f, "{} at {} (token withheld)", self.stream, self.server)
    }
}

/// So long the journal gets, pages of 4 KiB, before it is written into the file: by SQLite's
/// own rule it would take 4 MB of a disk on which the ring has just made way by one.
const JOURNAL_PAGES: &str = "100";

const IDENTITY: &str = "identity";
const NEXT_SEQ: &str = "next_seq";
const CONTIGUOUS_SEQ: &str = "contiguous_seq";
const MODEL: &str = "model";
const WITHDRAWN: &str = "card_withdrawn";
const SETTINGS: &str = "settings";
const EXCLUSION: &str = "hold";
const PAGE: &str = "page";
const LAST_CONTACT: &str = "last_contact";
const ALERT: &str = "alert";
const THINNED: &str = "thinned";
const ACCOUNT: &str = "account";
const CLOCK_CHECKPOINT: &str = "clocks";

/// Columns of `batches` that earlier agents did not have.
const LATER_COLUMNS: [(&str, &str); 5] = [
    (
        "urgent",
        "ALTER TABLE batches ADD COLUMN urgent BOOLEAN NOT NULL DEFAULT FALSE",
    ),
    // What an earlier agent left may have been sent.
    (
        "tried",
        "ALTER TABLE batches ADD COLUMN tried BOOLEAN NOT NULL DEFAULT TRUE",
    ),
    (
        "thinned",
        "ALTER TABLE batches ADD COLUMN thinned BIGINT NOT NULL DEFAULT 0",
    ),
    (
        "burst",
        "ALTER TABLE batches ADD COLUMN burst BIGINT NOT NULL DEFAULT 0",
    ),
    (
        "acknowledged_micros",
        "ALTER TABLE batches ADD COLUMN acknowledged_micros BIGINT",
    ),
];

impl Spool {
    /// Opens the spool in a directory, which is made if need be; both are the
    /// owner's only.
    pub(crate) async fn open(directory: &Path) -> anyhow::Result<Spool> {
        let path = directory.join("spool.db");
        create_private(directory, &path)
            .with_context(|| format!("{}: cannot create the spool", path.display()))?;
        let opened = connect(&path).await;
        let pool = opened.with_context(|| format!("{}: cannot open the spool", path.display()))?;
        sqlx::raw_sql(include_str!("schema.sql"))
            .execute(&pool)
            .await
            .with_context(|| format!("{}: cannot use the spool", path.display()))?;
        let spool = Spool { pool };
        let added = spool.add_missing_columns().await;
        added.with_context(|| format!("{}: cannot use the spool", path.display()))?;
        Ok(spool)
    }

    /// Opens a spool that cannot be written to, as on a disk that has failed: what is in
    /// it can still be told.
    pub(crate) async fn open_to_read(directory: &Path) -> sqlx::Result<Spool> {
        let options = SqliteConnectOptions::new()
            .filename(directory.join("spool.db"))
            .read_only(true);
        let pool = one_connection().connect_with(options).await?;
        Ok(Spool { pool })
    }

    /// A spool that an older agent made lacks what came later.
    async fn add_missing_columns(&self) -> sqlx::Result<()> {
        for (column, statement) in LATER_COLUMNS {
            let known: Option<i64> =
                sqlx::query_scalar("SELECT 1 FROM pragma_table_info('batches') WHERE name = $1")
                    .bind(column)
                    .fetch_optional(&self.pool)
                    .await?;
            if known.is_none() {
                sqlx::query(statement).execute(&self.pool).await?;
            }
        }
        Ok(())
    }

    /// Finishes what is under way and closes the file.
    pub(crate) async fn close(&self) {
        self.pool.close().await;
    }

    /// Who the agent is, once it is enrolled.
    pub(crate) async fn identity(&self) -> sqlx::Result<Option<Identity>> {
        self.get(IDENTITY).await
    }

    /// Becomes another stream, as after enrolment: batches that were not
    /// acknowledged are numbered anew in it. The model and settings of another
    /// compass are forgotten: nobody must steer by them.
    pub(crate) async fn enrol(&self, identity: &Identity) -> sqlx::Result<()> {
        let mut tx = self.write().await?;
        let before = get::<Identity>(&mut tx, IDENTITY).await?;
        if let Some(before) = &before
            && before.vessel_name != identity.vessel_name
        {
            reports::refuse_waiting(&mut tx, &before.vessel_name).await?;
        }
        if before.is_some_and(|before| !before.is_same_compass(identity)) {
            sqlx::query("DELETE FROM state WHERE name IN ($1, $2, $3, $4)")
                .bind(MODEL)
                .bind(WITHDRAWN)
                .bind(SETTINGS)
                .bind(ALERT)
                .execute(&mut *tx)
                .await?;
        }
        batches::renumber(&mut tx, identity.stream).await?;
        put(&mut tx, IDENTITY, identity).await?;
        tx.commit().await
    }

    /// Keeps another token beside the one in use.
    pub(crate) async fn save_other_token(&self, token: &str) -> sqlx::Result<()> {
        let mut tx = self.write().await?;
        if let Some(mut identity) = get::<Identity>(&mut tx, IDENTITY).await? {
            identity.other_token = Some(token.to_owned());
            put(&mut tx, IDENTITY, &identity).await?;
        }
        tx.commit().await
    }

    /// Uses the other token, if the one in use is still this; whether there was one.
    pub(crate) async fn swap_tokens(&self, in_use: &str) -> sqlx::Result<bool> {
        let mut tx = self.write().await?;
        let Some(mut identity) = get::<Identity>(&mut tx, IDENTITY).await? else {
            return Ok(false);
        };
        let Some(other) = identity.other_token.take() else {
            return Ok(false);
        };
        if identity.token == in_use {
            identity.other_token = Some(std::mem::replace(&mut identity.token, other));
            put(&mut tx, IDENTITY, &identity).await?;
            tx.commit().await?;
        }
        Ok(true)
    }

    /// The last model from shore.
    pub(crate) async fn model(&self) -> sqlx::Result<Option<ModelDownlink>> {
        self.get(MODEL).await
    }

    /// Why that model holds no more.
    pub(crate) async fn card_withdrawn(&self) -> sqlx::Result<Option<CardWithdrawn>> {
        self.get(WITHDRAWN).await
    }

    /// The last settings from shore, or the built-in ones.
    pub(crate) async fn settings(&self) -> sqlx::Result<Settings> {
        Ok(self.get(SETTINGS).await?.unwrap_or_default())
    }

    /// Keeps what the shore sent.
    pub(crate) async fn save_downlink(&self, downlink: &Downlink) -> sqlx::Result<()> {
        let mut tx = self.write().await?;
        save_downlink(&mut tx, downlink).await?;
        tx.commit().await
    }

    /// The last alert of the agent's own.
    pub(crate) async fn alert(&self) -> sqlx::Result<Option<AlertRecord>> {
        self.get(ALERT).await
    }

    /// Keeps what is known of the alert aboard alone.
    pub(crate) async fn save_alert(&self, record: &AlertRecord) -> sqlx::Result<()> {
        let mut tx = self.write().await?;
        put(&mut tx, ALERT, record).await?;
        tx.commit().await
    }

    /// What is left of the budget of the link.
    pub(crate) async fn account(&self) -> sqlx::Result<Option<BudgetAccount>> {
        self.get(ACCOUNT).await
    }

    /// Keeps what is left of the budget.
    pub(crate) async fn save_account(&self, account: &BudgetAccount) -> sqlx::Result<()> {
        let mut tx = self.write().await?;
        put(&mut tx, ACCOUNT, account).await?;
        tx.commit().await
    }

    /// What both clocks said when it was last noted.
    pub(crate) async fn clock_checkpoint(&self) -> sqlx::Result<Option<ClockCheckpoint>> {
        self.get(CLOCK_CHECKPOINT).await
    }

    /// Notes what both clocks say.
    pub(crate) async fn save_clock_checkpoint(
        &self,
        clock_checkpoint: &ClockCheckpoint,
    ) -> sqlx::Result<()> {
        let mut tx = self.write().await?;
        put(&mut tx, CLOCK_CHECKPOINT, clock_checkpoint).await?;
        tx.commit().await
    }

    /// When the shore last answered, by its clock.
    pub(crate) async fn last_contact(&self) -> sqlx::Result<Option<Timestamp>> {
        self.get(LAST_CONTACT).await
    }

    /// The crew's hold. One that cannot be read is still a hold: a sample less
    /// is better than one of the quay.
    pub(crate) async fn exclusion(&self) -> sqlx::Result<Option<Exclusion>> {
        let mut connection = self.pool.acquire().await?;
        let Some(text) = text(&mut connection, EXCLUSION).await? else {
            return Ok(None);
        };
        Ok(serde_json::from_str(&text).unwrap_or_else(|error| {
            tracing::error!(%error, "the hold in the spool cannot be read; it counts as berthed");
            Some(Exclusion::Berthed)
        }))
    }

    /// Keeps the crew's hold.
    pub(crate) async fn set_exclusion(&self, exclusion: Option<Exclusion>) -> sqlx::Result<()> {
        let mut tx = self.write().await?;
        put(&mut tx, EXCLUSION, &exclusion).await?;
        tx.commit().await
    }

    /// Where the running agent's page is, for the command line.
    pub(crate) async fn page(&self) -> sqlx::Result<Option<SocketAddr>> {
        Ok(self.get(PAGE).await?.flatten())
    }

    /// Notes where the page is, or that there is none.
    pub(crate) async fn set_page_address(&self, address: Option<SocketAddr>) -> sqlx::Result<()> {
        let mut tx = self.write().await?;
        put(&mut tx, PAGE, &address).await?;
        tx.commit().await
    }

    async fn write(&self) -> sqlx::Result<Transaction<'static, Sqlite>> {
        // At once, so that two processes wait for each other instead of failing.
        const BEGIN: &str = "BEGIN IMMEDIATE";
        match self.pool.begin_with(BEGIN).await {
            // A transaction that SQLite itself has rolled back, as on a full disk, is open
            // for good to this version of sqlx: only another connection begins another.
            Err(sqlx::Error::InvalidSavePointStatement) => {}
            begun => return begun,
        }
        self.pool.acquire().await?.close().await?;
        self.pool.begin_with(BEGIN).await
    }

    async fn get<T: DeserializeOwned>(&self, name: &str) -> sqlx::Result<Option<T>> {
        let mut connection = self.pool.acquire().await?;
        get(&mut connection, name).await
    }
}

async fn connect(path: &Path) -> sqlx::Result<SqlitePool> {
    let options = SqliteConnectOptions::new()
        .filename(path)
        .journal_mode(SqliteJournalMode::Wal)
        .synchronous(SqliteSynchronous::Full)
        .pragma("wal_autocheckpoint", JOURNAL_PAGES)
        .busy_timeout(Duration::from_secs(20));
    one_connection().connect_with(options).await
}

/// Reaping idle connections may spin for ever in this version of sqlx (its issue 3645),
/// and one connection to a file of our own needs none.
fn one_connection() -> SqlitePoolOptions {
    SqlitePoolOptions::new()
        .max_connections(1)
        .idle_timeout(None)
        .max_lifetime(None)
}

/// A value by name. One that does not read is reported and counts as absent:
/// a damaged value must not stop the agent.
async fn get<T: DeserializeOwned>(
    connection: &mut SqliteConnection,
    name: &str,
) -> sqlx::Result<Option<T>> {
    let Some(text) = text(connection, name).await? else {
        return Ok(None);
    };
    match serde_json::from_str(&text) {
        Ok(value) => Ok(Some(value)),
        Err(error) => {
            tracing::error!(name, %error, "a value in the spool cannot be read; going on without");
            Ok(None)
        }
    }
}

async fn text(connection: &mut SqliteConnection, name: &str) -> sqlx::Result<Option<String>> {
    sqlx::query_scalar("SELECT value FROM state WHERE name = $1")
        .bind(name)
        .fetch_optional(connection)
        .await
}

async fn put<T: Serialize>(
    connection: &mut SqliteConnection,
    name: &str,
    value: &T,
) -> sqlx::Result<()> {
    let text = serde_json::to_string(value).map_err(|e| sqlx::Error::Encode(e.into()))?;
    sqlx::query(
        "INSERT INTO state (name, value) VALUES ($1, $2)
         ON CONFLICT (name) DO UPDATE SET value = excluded.value",
    )
    .bind(name)
    .bind(text)
    .execute(connection)
    .await?;
    Ok(())
}

async fn forget(connection: &mut SqliteConnection, name: &str) -> sqlx::Result<()> {
    sqlx::query("DELETE FROM state WHERE name = $1")
        .bind(name)
        .execute(connection)
        .await?;
    Ok(())
}

/// All but how far the shore has come, which only the answer to a batch is sure to know.
async fn save_downlink(connection: &mut SqliteConnection, downlink: &Downlink) -> sqlx::Result<()> {
    put(connection, LAST_CONTACT, &downlink.server_time).await?;
    if let Some(model) = &downlink.model {
        put(connection, MODEL, model).await?;
    }
    match &downlink.card_withdrawn {
        Some(withdrawn) => put(connection, WITHDRAWN, withdrawn).await?,
        None => forget(connection, WITHDRAWN).await?,
    }
    if let Some(settings) = &downlink.settings {
        put(connection, SETTINGS, settings).await?;
    }
    Ok(())
}

#[cfg(unix)]
fn create_private(directory: &Path, file: &Path) -> std::io::Result<()> {
    use std::os::unix::fs::{DirBuilderExt, OpenOptionsExt};
    let is_new = !directory.exists();
    std::fs::DirBuilder::new()
        .recursive(true)
        .mode(0o700)
        .create(directory)?;
    if is_new {
        set_mode(directory, 0o700);
    }
    std::fs::OpenOptions::new()
        .append(true)
        .create(true)
        .mode(0o600)
        .open(file)?;
    // SQLite gives new journals the mode of the database. A copy that was put back may
    // have any mode, and so may what was made under a strange mask.
    for suffix in ["", "-wal", "-shm"] {
        let mut path = file.as_os_str().to_owned();
        path.push(suffix);
        set_mode(Path::new(&path), 0o600);
    }
    Ok(())
}

/// What is another's cannot be put right, and stops nothing.
#[cfg(unix)]
fn set_mode(path: &Path, mode: u32) {
    use std::os::unix::fs::PermissionsExt;
    let Ok(found) = std::fs::metadata(path) else {
        return;
    };
    if found.permissions().mode() & 0o777 == mode {
        return;
    }
    if let Err(error) = std::fs::set_permissions(path, std::fs::Permissions::from_mode(mode)) {
        tracing::warn!(path = %path.display(), %error, "others may read what is the agent's own");
    }
}

#[cfg(not(unix))]
fn create_private(directory: &Path, _file: &Path) -> std::io::Result<()> {
    std::fs::create_dir_all(directory)
}

#[cfg(test)]
pub(crate) mod tests;
