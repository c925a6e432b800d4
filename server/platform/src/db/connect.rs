//! Database connections by URL, and schema migrations.

use super::{Db, Pools, Subscribers};
use anyhow::{Context, bail};
use sqlx::Database;
use sqlx::migrate::{MigrateError, Migrator};
use sqlx::pool::PoolOptions;
use sqlx::sqlite::{SqliteConnectOptions, SqliteJournalMode, SqliteSynchronous};
use std::str::FromStr;
use std::sync::Arc;
use std::time::Duration;

static PORTABLE: Migrator = sqlx::migrate!("../../migrations");
static POSTGRES_ONLY: Migrator = sqlx::migrate!("../../migrations/postgres");

/// Longest wait of a connection for another process's lock or for its turn.
const PATIENCE: Duration = Duration::from_secs(30);

const OTHER_VERSION: &str = "the database was set up by another version of binnacle-server: \
                             run that version, or name a new database";

impl Db {
    /// Opens `sqlite://FILE` (created if missing) or `postgres://…`.
    ///
    /// # Errors
    /// Fails when the URL is of another kind, or the database cannot be reached.
    pub async fn connect(url: &str, subscribers: Subscribers) -> anyhow::Result<Db> {
        let pools = match url.split_once(':') {
            Some(("sqlite", _)) => connect_sqlite(url).await?,
            Some(("postgres" | "postgresql", _)) => connect_postgres(url).await?,
            _ => bail!("the database URL begins neither with sqlite: nor with postgres:"),
        };
        Ok(Db {
            pools,
            subscribers: Arc::new(subscribers),
        })
    }

    /// Applies pending migrations.
    ///
    /// # Errors
    /// Fails when one fails, or an applied one is unknown or has been edited since.
    pub async fn migrate(&self) -> anyhow::Result<()> {
        let migrated = match &self.pools {
            Pools::Sqlite { writer, .. } => PORTABLE.run(writer).await,
            Pools::Postgres(pool) => {
                let all = PORTABLE.iter().chain(POSTGRES_ONLY.iter()).cloned();
                Migrator::with_migrations(all.collect()).run(pool).await
            }
        };
        migrated.map_err(explain)
    }
}

/// Adds advice to the error that another version's database causes.
fn explain(error: MigrateError) -> anyhow::Error {
    let other_version = matches!(
        error,
        MigrateError::VersionMissing(_) | MigrateError::VersionMismatch(_)
    );
    let error = anyhow::Error::new(error);
    if other_version {
        return error.context(OTHER_VERSION);
    }
    error
}

/// Returns pool options with a limit of connections, which are kept open: reaping idle ones
/// may spin for ever in this version of sqlx (its issue 3645).
fn pool<D: Database>(connections: u32) -> PoolOptions<D> {
    PoolOptions::new()
        .max_connections(connections)
        .acquire_timeout(PATIENCE)
        .idle_timeout(None)
        .max_lifetime(None)
}

async fn connect_sqlite(url: &str) -> anyhow::Result<Pools> {
    let options = SqliteConnectOptions::from_str(url)
        .with_context(|| format!("{url:?} is not a SQLite URL"))?
        .create_if_missing(true)
        .foreign_keys(true)
        .journal_mode(SqliteJournalMode::Wal)
        // An acknowledged write survives a power cut, not only a crash.
        .synchronous(SqliteSynchronous::Full)
        .busy_timeout(PATIENCE);
    let writer = pool(1)
        .connect_with(options.clone())
        .await
        .with_context(|| format!("cannot open {url}"))?;
    let readers = pool(4)
        .connect_with(options.pragma("query_only", "ON"))
        .await
        .with_context(|| format!("cannot open {url}"))?;
    Ok(Pools::Sqlite { readers, writer })
}

async fn connect_postgres(url: &str) -> anyhow::Result<Pools> {
    let pool = pool(16)
        .connect(url)
        .await
        .context("cannot connect to PostgreSQL")?;
    Ok(Pools::Postgres(pool))
}
