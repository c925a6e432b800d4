//! Both databases behind one type, and one SQL text for both.
//!
//! What always holds: reads go through [`Db`], writes through a [`Tx`], and what
//! [`Tx::commit`] has returned from is on disk. On SQLite there is one writer at a
//! time, which takes the write lock before it reads anything, so that no
//! transaction fails half-way for another's sake.
//!
//! A transaction may carry a [`CommitHook`], which writes into it last of all: so a change
//! has its line in the audit log, and this module knows nothing of that log.
//!
//! An event that is published in a transaction is handled in it, see [`Subscribers`].
//!
//! The macros take the SQL as a literal and run it on whichever database is
//! there: `rows!`, `row!` and `execute!`.

mod connect;
mod queries;
mod subscribers;

pub use crate::{execute, row, rows};
pub use subscribers::{DomainEvent, Handler, Subscribers};

use crate::error;
use futures_util::future::BoxFuture;
use sqlx::{PgPool, Postgres, Sqlite, SqlitePool, Transaction};
use std::sync::Arc;

/// A result from the database.
pub type Result<T> = std::result::Result<T, sqlx::Error>;

/// The database that the URL named, with those who subscribed to events.
#[derive(Clone, Debug)]
pub struct Db {
    pools: Pools,
    subscribers: Arc<Subscribers>,
}

/// Connections to the database.
#[derive(Clone, Debug)]
pub enum Pools {
    /// One file.
    Sqlite {
        /// Any number of readers.
        readers: SqlitePool,
        /// A pool of one: SQLite knows one writer at a time.
        writer: SqlitePool,
    },
    /// A server, which other processes of ours may share.
    Postgres(PgPool),
}

/// A transaction; rolled back unless committed.
pub struct Tx {
    connection: Connection,
    subscribers: Arc<Subscribers>,
    hook: Option<Arc<dyn CommitHook>>,
}

/// The open transaction of a [`Tx`], on whichever database is there.
pub enum Connection {
    /// On SQLite.
    Sqlite(Transaction<'static, Sqlite>),
    /// On PostgreSQL.
    Postgres(Transaction<'static, Postgres>),
}

/// Work that a transaction carries to its commit.
///
/// A trait, so that the layers above can write into a transaction that code knows only as
/// [`Tx`].
pub trait CommitHook: Send + Sync {
    /// Writes into the transaction. Returns whether [`CommitHook::committed`] is to be called.
    fn before_commit<'a>(&'a self, tx: &'a mut Tx) -> BoxFuture<'a, Result<bool>>;

    /// Notes that what was written is on disk.
    fn committed(&self);
}

impl Db {
    /// The connections, for what only one kind of database can do.
    pub fn pools(&self) -> &Pools {
        &self.pools
    }

    /// Begins a transaction that may write, for work that no request asked for. A request
    /// begins its own by `audit::RequestContext::begin`.
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

    /// Whether the database answers.
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
        // A transaction that SQLite itself has rolled back, as on a full disk, is open for
        // good to this version of sqlx: only another connection begins another.
        Err(sqlx::Error::InvalidSavePointStatement) => {}
        begun => return begun,
    }
    writer.acquire().await?.close().await?;
    writer.begin_with(BEGIN).await
}

impl Tx {
    /// The transaction with a hook that it carries to its commit.
    #[must_use]
    pub fn with_hook(self, hook: Arc<dyn CommitHook>) -> Tx {
        Tx {
            hook: Some(hook),
            ..self
        }
    }

    /// Publishes an event: each of its subscribers runs now, in this transaction.
    ///
    /// # Errors
    /// When a subscriber fails, or refuses what is about to happen.
    pub async fn publish<E: DomainEvent>(&mut self, event: &E) -> error::Result<()> {
        let subscribers = Arc::clone(&self.subscribers);
        for handler in subscribers.of::<E>() {
            handler(self, event).await?;
        }
        Ok(())
    }

    /// The connection that statements of this transaction run on.
    pub fn connection(&mut self) -> &mut Connection {
        &mut self.connection
    }

    /// Makes everything durable, and visible to others, at once; with it what the hook writes.
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
