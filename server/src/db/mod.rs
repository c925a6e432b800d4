//! Both databases behind one type, and one SQL text for both.
//!
//! What always holds: reads go through [`Db`], writes through a [`Tx`], and what
//! [`Tx::commit`] has returned from is on disk. On SQLite there is one writer at a
//! time, which takes the write lock before it reads anything, so that no
//! transaction fails half-way for another's sake.
//!
//! A change that a request makes carries its line of the audit log in its transaction.
//!
//! The macros take the SQL as a literal and run it on whichever database is
//! there: `rows!`, `row!` and `execute!`.

mod connect;
mod queries;

pub(crate) use queries::{execute, row, rows};

use crate::audit;
use sqlx::{PgPool, Postgres, Sqlite, SqlitePool, Transaction};

/// A result from the database.
pub type Result<T> = std::result::Result<T, sqlx::Error>;

/// The database that the URL named.
#[derive(Clone, Debug)]
pub enum Db {
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
pub enum Tx {
    /// On SQLite.
    Sqlite(Transaction<'static, Sqlite>),
    /// On PostgreSQL.
    Postgres(Transaction<'static, Postgres>),
}

impl Db {
    /// Begins a transaction that may write.
    pub async fn begin(&self) -> Result<Tx> {
        match self {
            Db::Sqlite { writer, .. } => Ok(Tx::Sqlite(begin_sqlite(writer).await?)),
            Db::Postgres(pool) => Ok(Tx::Postgres(pool.begin().await?)),
        }
    }

    /// Whether the database answers.
    pub async fn ping(&self) -> Result<()> {
        row!(self, (i64,), "SELECT CAST(1 AS BIGINT)").map(drop)
    }

    /// Closes every connection once it is idle.
    pub async fn close(&self) {
        match self {
            Db::Sqlite { readers, writer } => {
                readers.close().await;
                writer.close().await;
            }
            Db::Postgres(pool) => pool.close().await,
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
    /// Makes everything durable, and visible to others, at once; with it the line that
    /// the request behind it has in the audit log.
    pub async fn commit(mut self) -> Result<()> {
        let written = audit::write_with(&mut self).await?;
        match self {
            Tx::Sqlite(tx) => tx.commit().await?,
            Tx::Postgres(tx) => tx.commit().await?,
        }
        if written {
            audit::kept();
        }
        Ok(())
    }
}
