//! SQLite and PostgreSQL behind one type, with one SQL text for both.
//!
//! Invariants: reads go through [`Db`] and writes through a [`Tx`]. Once [`Tx::commit`] has
//! returned, the data is on disk. On SQLite there is one writer at a time, which takes the
//! write lock before it reads anything. So no transaction fails half-way because of
//! another.
//!
//! A transaction may carry a [`CommitHook`], which writes into it last. That is how a
//! change gets its line in the audit log while this module knows nothing of that log.
//!
//! An event published in a transaction is handled in it, and a question asked in it is
//! answered in it, see [`Subscribers`].
//!
//! The macros take the SQL as a literal and run it on the open database: `rows!`, `row!`
//! and `execute!`.

mod connect;
mod file;
mod queries;
mod subscribers;
mod workload;

pub use crate::{execute, row, rows};
pub use file::Claim;
pub use subscribers::{Answerer, DomainEvent, Handler, Question, Subscribers};
pub use workload::{Usage, Workload};

use crate::error;
use crate::ids::TokenId;
use crate::sealing::Seals;
use futures_util::future::BoxFuture;
use metrics::histogram;
use sqlx::{Database, PgPool, Pool, Postgres, Sqlite, SqlitePool, Transaction};
use std::any::type_name;
use std::sync::Arc;
use std::time::{Duration, Instant};
use tokio::time::timeout;

/// Result of a database call.
pub type Result<T> = std::result::Result<T, sqlx::Error>;

/// Database named by the URL, with the subscribers to events.
#[derive(Clone, Debug)]
pub struct Db {
    /// Pools of each workload.
    pools: Arc<[Pools; 3]>,
    workload: Workload,
    subscribers: Arc<Subscribers>,
    seals: Seals,
}

/// Connection pools of the database.
#[derive(Clone, Debug)]
pub enum Pools {
    /// SQLite: one file.
    Sqlite {
        /// Concurrent readers.
        readers: SqlitePool,
        /// Pool of one connection: SQLite has one writer at a time.
        writer: SqlitePool,
    },
    /// PostgreSQL server, which other processes of ours may share.
    Postgres(PgPool),
}

/// Transaction; rolled back unless committed.
pub struct Tx {
    connection: Connection,
    subscribers: Arc<Subscribers>,
    seals: Seals,
    hook: Option<Arc<dyn CommitHook>>,
}

/// Open transaction of a [`Tx`] on either database.
pub enum Connection {
    /// SQLite transaction.
    Sqlite(Transaction<'static, Sqlite>),
    /// PostgreSQL transaction.
    Postgres(Transaction<'static, Postgres>),
}

/// Work that a transaction carries to its commit.
///
/// This is a trait so that upper layers can write into a transaction that other code knows
/// only as [`Tx`].
pub trait CommitHook: Send + Sync {
    /// Writes into the transaction. Returns true if [`CommitHook::committed`] is to be
    /// called.
    fn before_commit<'a>(&'a self, tx: &'a mut Tx) -> BoxFuture<'a, Result<bool>>;

    /// Records that the written data is on disk.
    fn committed(&self);

    /// Returns the API token of the program that works, if it is one.
    fn token(&self) -> Option<TokenId>;
}

impl Db {
    /// Returns the connection pools, for features of one kind of database.
    pub fn pools(&self) -> &Pools {
        &self.pools[self.workload as usize]
    }

    /// Returns the same database, by the connections of a workload.
    #[must_use]
    pub fn for_workload(&self, workload: Workload) -> Db {
        Db {
            workload,
            ..self.clone()
        }
    }

    /// Sets the keys by which secrets are sealed.
    #[must_use]
    pub fn with_seals(self, seals: Seals) -> Db {
        Db { seals, ..self }
    }

    /// Returns the keys by which secrets are sealed.
    pub fn seals(&self) -> &Seals {
        &self.seals
    }

    /// Returns the connections of each workload; on SQLite its readers.
    pub fn usage(&self) -> [Usage; 3] {
        Workload::ALL.map(|workload| match &self.pools[workload as usize] {
            Pools::Sqlite { readers, .. } => usage(workload, readers),
            Pools::Postgres(pool) => usage(workload, pool),
        })
    }

    /// Begins a writing transaction for work without a request. A request begins its own
    /// with `audit::RequestContext::begin`.
    pub async fn begin(&self) -> Result<Tx> {
        let begun = Instant::now();
        let tx = self.begin_now().await;
        histogram!("binnacle_database_wait_seconds", "workload" => self.workload.name())
            .record(begun.elapsed().as_secs_f64());
        tx
    }

    async fn begin_now(&self) -> Result<Tx> {
        let connection = match self.pools() {
            Pools::Sqlite { writer, .. } => {
                let patience = self.workload.patience_on_sqlite();
                Connection::Sqlite(begin_sqlite(writer, patience).await?)
            }
            Pools::Postgres(pool) => Connection::Postgres(pool.begin().await?),
        };
        Ok(self.transaction(connection))
    }

    /// Begins a transaction that only reads. On SQLite it waits for no writer, and a write in it fails.
    pub async fn begin_reading(&self) -> Result<Tx> {
        let connection = match self.pools() {
            Pools::Sqlite { readers, .. } => Connection::Sqlite(readers.begin().await?),
            Pools::Postgres(pool) => Connection::Postgres(pool.begin().await?),
        };
        Ok(self.transaction(connection))
    }

    fn transaction(&self, connection: Connection) -> Tx {
        Tx {
            connection,
            subscribers: Arc::clone(&self.subscribers),
            seals: self.seals.clone(),
            hook: None,
        }
    }

    /// Closes every connection once it is idle.
    pub async fn close(&self) {
        for pools in self.pools.iter() {
            match pools {
                Pools::Sqlite { readers, writer } => {
                    readers.close().await;
                    writer.close().await;
                }
                Pools::Postgres(pool) => pool.close().await,
            }
        }
    }
}

fn usage<D: Database>(workload: Workload, pool: &Pool<D>) -> Usage {
    Usage {
        workload,
        used: (pool.size() as usize).saturating_sub(pool.num_idle()),
        most: pool.options().get_max_connections() as usize,
    }
}

/// Begins a transaction, which must wait no longer than `patience` for those before it.
async fn begin_sqlite(
    writer: &SqlitePool,
    patience: Duration,
) -> Result<Transaction<'static, Sqlite>> {
    let begun = timeout(patience, begin_immediate(writer)).await;
    begun.unwrap_or(Err(sqlx::Error::PoolTimedOut))
}

async fn begin_immediate(writer: &SqlitePool) -> Result<Transaction<'static, Sqlite>> {
    const BEGIN: &str = "BEGIN IMMEDIATE";
    match writer.begin_with(BEGIN).await {
        // In this version of sqlx, a transaction that SQLite itself has rolled back, as on
        // a full disk, stays open for good. Only another connection can begin a new one.
        Err(sqlx::Error::InvalidSavePointStatement) => {}
        begun => return begun,
    }
    writer.acquire().await?.close().await?;
    writer.begin_with(BEGIN).await
}

impl Tx {
    /// Sets the hook that the transaction carries to its commit.
    #[must_use]
    pub fn with_hook(self, hook: Arc<dyn CommitHook>) -> Tx {
        Tx {
            hook: Some(hook),
            ..self
        }
    }

    /// Returns the keys by which secrets are sealed.
    pub fn seals(&self) -> &Seals {
        &self.seals
    }

    /// Publishes an event: each subscriber runs now, in this transaction.
    ///
    /// # Errors
    /// Fails when a subscriber fails or rejects the event.
    pub async fn publish<E: DomainEvent>(&mut self, event: &E) -> error::Result<()> {
        let subscribers = Arc::clone(&self.subscribers);
        for handler in subscribers.of::<E>() {
            handler(self, event).await?;
        }
        Ok(())
    }

    /// Asks a question, which its handler answers in this transaction.
    ///
    /// # Errors
    /// Fails when the question has no handler, or the handler fails.
    pub async fn ask<Q: Question>(&mut self, question: &Q) -> Result<Q::Answer> {
        let Some(answerer) = self.subscribers.to::<Q>() else {
            let name = type_name::<Q>();
            return Err(sqlx::Error::Protocol(format!("{name} has no handler")));
        };
        answerer(self, question).await
    }

    /// Returns the API token of the program that writes, if it is one.
    pub fn token(&self) -> Option<TokenId> {
        self.hook.as_ref().and_then(|hook| hook.token())
    }

    /// Returns the connection on which the statements of this transaction run.
    pub fn connection(&mut self) -> &mut Connection {
        &mut self.connection
    }

    /// Commits everything, including the hook's writes.
    pub async fn commit(mut self) -> Result<()> {
        let Some(hook) = self.hook.take() else {
            return self.connection.commit().await;
        };
        let written = hook.before_commit(&mut self).await?;
        self.connection.commit().await?;
        if written {
            hook.committed();
        }
        Ok(())
    }
}

impl Connection {
    async fn commit(self) -> Result<()> {
        match self {
            Connection::Sqlite(tx) => tx.commit().await,
            Connection::Postgres(tx) => tx.commit().await,
        }
    }
}
