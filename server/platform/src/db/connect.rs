//! Database connections by URL, and schema migrations.

use super::file::{Claim, TRY_EVERY, damaged, is_busy, is_damage, make_private};
use super::{Db, Pools, Subscribers, Workload};
use crate::sealing::Seals;
use anyhow::{Context, bail};
use sqlx::migrate::{MigrateError, Migrator};
use sqlx::pool::PoolOptions;
use sqlx::postgres::PgConnectOptions;
use sqlx::sqlite::{SqliteConnectOptions, SqliteJournalMode, SqliteSynchronous};
use sqlx::{Connection, Database, PgConnection, PgPool, SqlitePool};
use std::str::FromStr;
use std::sync::Arc;
use std::time::{Duration, Instant};

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
            seals: Seals::default(),
        })
    }

    /// Applies pending migrations. Of processes that do so at once, one does and the others wait.
    ///
    /// # Errors
    /// Fails when one fails, an applied one is unknown or has been edited since, or a server of
    /// another version serves the SQLite file.
    pub async fn migrate(&self) -> anyhow::Result<()> {
        if self.is_up_to_date().await {
            return self.run_migrations().await;
        }
        let claim = self.claim_to_migrate().await?;
        self.migrate_claimed(&claim).await
    }

    /// Applies pending migrations of a database that this process has claimed.
    ///
    /// # Errors
    /// As for [`Db::migrate`].
    pub async fn migrate_claimed(&self, _: &Claim) -> anyhow::Result<()> {
        self.run_migrations().await
    }

    /// Returns true if the newest migration was applied to a SQLite file. sqlx itself has a lock for
    /// PostgreSQL alone.
    async fn is_up_to_date(&self) -> bool {
        let Pools::Sqlite { writer, .. } = self.pools() else {
            return true;
        };
        let newest = PORTABLE.iter().map(|migration| migration.version).max();
        let applied = sqlx::query_scalar("SELECT MAX(version) FROM _sqlx_migrations WHERE success");
        let applied: Result<Option<i64>, sqlx::Error> = applied.fetch_one(writer).await;
        applied.is_ok_and(|applied| applied >= newest)
    }

    async fn run_migrations(&self) -> anyhow::Result<()> {
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
    make_private(options.get_filename())?;
    let writer = open_writer(&options, url).await?;
    let options = options.pragma("query_only", "ON");
    Ok(Workload::ALL.map(|workload| Pools::Sqlite {
        readers: pool(workload.readers(), workload.patience_on_sqlite())
            .connect_lazy_with(options.clone()),
        writer: writer.clone(),
    }))
}

/// Opens the connection that writes. SQLite's own timeout does not cover the change of a new file's
/// journal, which another process may be making.
async fn open_writer(options: &SqliteConnectOptions, url: &str) -> anyhow::Result<SqlitePool> {
    let begun = Instant::now();
    loop {
        let opened = pool(1, BUSY_TIMEOUT).connect_with(options.clone()).await;
        let error = match opened {
            Ok(writer) => return Ok(writer),
            Err(error) => error,
        };
        if is_damage(&error) {
            return Err(damaged(options.get_filename(), error));
        }
        if !is_busy(&error) || begun.elapsed() > BUSY_TIMEOUT {
            return Err(anyhow::Error::new(error).context(format!("cannot open {url}")));
        }
        tokio::time::sleep(TRY_EVERY).await;
    }
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
