//! Database connections by URL, and schema migrations.

use super::{Db, Pools, Subscribers, Workload};
use anyhow::{Context, bail};
use sqlx::migrate::{MigrateError, Migrator};
use sqlx::pool::PoolOptions;
use sqlx::postgres::PgConnectOptions;
use sqlx::sqlite::{SqliteConnectOptions, SqliteJournalMode, SqliteSynchronous};
use sqlx::{Connection, Database, PgConnection, PgPool};
use std::str::FromStr;
use std::sync::Arc;
use std::time::Duration;

static PORTABLE: Migrator = sqlx::migrate!("../../migrations");
static POSTGRES_ONLY: Migrator = sqlx::migrate!("../../migrations/postgres");

/// Longest wait for a lock that another process holds on a SQLite file.
const BUSY_TIMEOUT: Duration = Duration::from_secs(30);
/// Time without use after which a connection is checked before it is used again.
const CHECK_AFTER: Duration = Duration::from_secs(1);

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
            pools: Arc::new(pools),
            workload: Workload::Background,
            subscribers: Arc::new(subscribers),
        })
    }

    /// Applies pending migrations.
    ///
    /// # Errors
    /// Fails when one fails, or an applied one is unknown or has been edited since.
    pub async fn migrate(&self) -> anyhow::Result<()> {
        let migrated = match self.pools() {
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
fn pool<D: Database>(connections: u32, patience: Duration) -> PoolOptions<D> {
    PoolOptions::new()
        .max_connections(connections)
        .acquire_timeout(patience)
        .idle_timeout(None)
        .max_lifetime(None)
}

async fn connect_sqlite(url: &str) -> anyhow::Result<[Pools; 3]> {
    let options = SqliteConnectOptions::from_str(url)
        .with_context(|| format!("{url:?} is not a SQLite URL"))?
        .create_if_missing(true)
        .foreign_keys(true)
        .journal_mode(SqliteJournalMode::Wal)
        // An acknowledged write survives a power cut, not only a crash.
        .synchronous(SqliteSynchronous::Full)
        .busy_timeout(BUSY_TIMEOUT);
    let writer = pool(1, BUSY_TIMEOUT)
        .connect_with(options.clone())
        .await
        .with_context(|| format!("cannot open {url}"))?;
    let options = options.pragma("query_only", "ON");
    Ok(Workload::ALL.map(|workload| Pools::Sqlite {
        readers: pool(workload.readers(), workload.patience_on_sqlite())
            .connect_lazy_with(options.clone()),
        writer: writer.clone(),
    }))
}

async fn connect_postgres(url: &str) -> anyhow::Result<[Pools; 3]> {
    let options = PgConnectOptions::from_str(url).context("this is not a PostgreSQL URL")?;
    let pools = Workload::ALL.map(|workload| postgres_pool(workload, &options));
    // A wrong password or name is reported at the start.
    let [_, _, background] = &pools;
    let connection = background.acquire().await;
    connection.context("cannot connect to PostgreSQL")?;
    Ok(pools.map(Pools::Postgres))
}

fn postgres_pool(workload: Workload, options: &PgConnectOptions) -> PgPool {
    pool(workload.connections(), workload.patience_on_postgres())
        // A connection in steady use fails by itself, and each check is a round trip.
        .test_before_acquire(false)
        .before_acquire(|connection: &mut PgConnection, meta| {
            Box::pin(async move {
                if meta.idle_for > CHECK_AFTER {
                    connection.ping().await?;
                }
                Ok(true)
            })
        })
        .connect_lazy_with(options.clone())
}
