//! SQLite file of the spool.

use anyhow::Context;
use serde::Serialize;
use serde::de::DeserializeOwned;
use sqlx::sqlite::{SqliteConnectOptions, SqliteJournalMode, SqlitePoolOptions, SqliteSynchronous};
use sqlx::{Sqlite, SqliteConnection, SqlitePool, Transaction};
use std::path::Path;
use std::time::Duration;

/// Persistent store of the agent. Cheap to clone; all clones share one connection.
#[derive(Clone, Debug)]
pub(crate) struct Spool {
    pub(super) pool: SqlitePool,
}

/// Journal pages of 4 KiB before a checkpoint. SQLite's default would take 4 MB of a disk that the
/// raw log may just have freed.
const JOURNAL_PAGES: &str = "100";

/// Columns of `batches` that older agents did not have.
const LATER_COLUMNS: [(&str, &str); 5] = [
    (
        "urgent",
        "ALTER TABLE batches ADD COLUMN urgent BOOLEAN NOT NULL DEFAULT FALSE",
    ),
    // Batches of an older agent may have been sent.
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
    /// Opens the spool in a directory, which is created if necessary; both are private to the
    /// owner.
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

    /// Opens a spool that cannot be written to, as on a failed disk, for its status.
    pub(crate) async fn open_to_read(directory: &Path) -> sqlx::Result<Spool> {
        let options = SqliteConnectOptions::new()
            .filename(directory.join("spool.db"))
            .read_only(true);
        let pool = one_connection().connect_with(options).await?;
        Ok(Spool { pool })
    }

    /// Adds the columns that a spool of an older agent lacks.
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

    /// Finishes pending work and closes the file.
    pub(crate) async fn close(&self) {
        self.pool.close().await;
    }

    pub(super) async fn write(&self) -> sqlx::Result<Transaction<'static, Sqlite>> {
        // Immediate, so that two processes wait for each other instead of failing.
        const BEGIN: &str = "BEGIN IMMEDIATE";
        match self.pool.begin_with(BEGIN).await {
            // A transaction that SQLite itself has rolled back, as on a full disk, stays open for
            // this version of sqlx: only another connection can begin another.
            Err(sqlx::Error::InvalidSavePointStatement) => {}
            begun => return begun,
        }
        self.pool.acquire().await?.close().await?;
        self.pool.begin_with(BEGIN).await
    }

    pub(super) async fn get<T: DeserializeOwned>(&self, name: &str) -> sqlx::Result<Option<T>> {
        let mut connection = self.pool.acquire().await?;
        get(&mut connection, name).await
    }
}

pub(super) async fn connect(path: &Path) -> sqlx::Result<SqlitePool> {
    let options = SqliteConnectOptions::new()
        .filename(path)
        .journal_mode(SqliteJournalMode::Wal)
        .synchronous(SqliteSynchronous::Full)
        .pragma("wal_autocheckpoint", JOURNAL_PAGES)
        .busy_timeout(Duration::from_secs(20));
    one_connection().connect_with(options).await
}

/// Returns the options of a single connection. Reaping idle connections may spin for ever in this
/// version of sqlx (its issue 3645), and one connection to a private file needs none.
fn one_connection() -> SqlitePoolOptions {
    SqlitePoolOptions::new()
        .max_connections(1)
        .idle_timeout(None)
        .max_lifetime(None)
}

/// Reads a value by name. An unreadable value is logged and counts as absent, because damage must
/// not stop the agent.
pub(super) async fn get<T: DeserializeOwned>(
    connection: &mut SqliteConnection,
    name: &str,
) -> sqlx::Result<Option<T>> {
    let Some(text) = text(connection, name).await? else {
        return Ok(None);
    };
    match serde_json::from_str(&text) {
        Ok(value) => Ok(Some(value)),
        Err(error) => {
            tracing::error!(name, %error, "a value in the spool cannot be read and is ignored");
            Ok(None)
        }
    }
}

pub(super) async fn text(
    connection: &mut SqliteConnection,
    name: &str,
) -> sqlx::Result<Option<String>> {
    sqlx::query_scalar("SELECT value FROM state WHERE name = $1")
        .bind(name)
        .fetch_optional(connection)
        .await
}

pub(super) async fn put<T: Serialize>(
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

pub(super) async fn forget(connection: &mut SqliteConnection, name: &str) -> sqlx::Result<()> {
    sqlx::query("DELETE FROM state WHERE name = $1")
        .bind(name)
        .execute(connection)
        .await?;
    Ok(())
}

#[cfg(unix)]
pub(super) fn create_private(directory: &Path, file: &Path) -> std::io::Result<()> {
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
    // SQLite gives new journals the mode of the database. A restored copy may have any mode, and so
    // may files made under an unusual umask.
    for suffix in ["", "-wal", "-shm"] {
        let mut path = file.as_os_str().to_owned();
        path.push(suffix);
        set_mode(Path::new(&path), 0o600);
    }
    Ok(())
}

/// Sets the mode of a file; a file of another owner is only logged.
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
        tracing::warn!(path = %path.display(), %error, "the mode of a private file cannot be set");
    }
}

#[cfg(not(unix))]
pub(super) fn create_private(directory: &Path, _file: &Path) -> std::io::Result<()> {
    std::fs::create_dir_all(directory)
}
