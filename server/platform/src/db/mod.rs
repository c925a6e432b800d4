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
mod queries;
mod subscribers;

pub use crate::{execute, row, rows};
pub use subscribers::{Answerer, DomainEvent, Handler, Question, Subscribers};

use crate::error;
use futures_util::future::BoxFuture;
use sqlx::{PgPool, Postgres, Sqlite, SqlitePool, Transaction};
use std::any::type_name;
use std::sync::Arc;

/// Result of a database call.
pub type Result<T> = std::result::Result<T, sqlx::Error>;

/// Database named by the URL, with the subscribers to events.
#[derive(Clone, Debug)]
pub struct Db {
    pools: Pools,
    subscribers: Arc<Subscribers>,
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
}

impl Db {
    /// Returns the connection pools, for features of one kind of database.
    pub fn pools(&self) -> &Pools {
        &self.pools
    }

    /// Begins a writing transaction for work without a request. A request begins its own
    /// with `audit::RequestContext::begin`.
    pub async fn begin(&self) -> Result<Tx> {
        let connection = match &self.pools {
            Pools::Sqlite { writer, .. } => Connection::Sqlite(begin_sqlite(writer).await?),
            Pools::Postgres(pool) => Connection::Postgres(pool.begin().await?),
        };
        Ok(Tx {
            connection,
            subscribers: Arc::clone(&self.subscribers),
            hook: None,
        })
    }

    /// Checks that the database responds.
    pub async fn ping(&self) -> Result<()> {
        row!(self, (i64,), "SELECT CAST(1 AS BIGINT)").map(drop)
    }

    /// Closes every connection once it is idle.
    pub async fn close(&self) {
        match &self.pools {
            Pools::Sqlite { readers, writer } => {
                readers.close().await;
                writer.close().await;
            }
            Pools::Postgres(pool) => pool.close().await,
        }
    }
}

async fn begin_sqlite(writer: &SqlitePool) -> Result<Transaction<'static, Sqlite>> {
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
