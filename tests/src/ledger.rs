//! Both ends' own records of what was sent: the agent's spool and the server's
//! batch log, read from their databases as they lie.

use crate::database::Database;
use crate::ship::Ship;
use anyhow::{Context, Result};
use sqlx::sqlite::SqliteConnectOptions;
use sqlx::{Connection, PgConnection, SqliteConnection};
use std::str::FromStr;
use uuid::Uuid;

/// What an agent knows of its batches.
#[derive(Clone, Debug, Default, PartialEq, Eq)]
pub struct Spool {
    /// Those the shore acknowledged, by stream and number.
    pub acknowledged: Vec<Acknowledged>,
    /// Sealed and not acknowledged.
    pub waiting: i64,
    /// Refused by the shore, or unreadable: there must be none.
    pub in_trouble: i64,
}

/// One acknowledged batch.
#[derive(Clone, Debug, PartialEq, Eq, PartialOrd, Ord)]
pub struct Acknowledged {
    /// The stream.
    pub stream: Uuid,
    /// Its number there.
    pub seq: i64,
    /// How many samples it had.
    pub samples: i64,
    /// The checksum of the whole of it.
    pub crc32: i64,
}

impl Spool {
    /// As it is now.
    ///
    /// # Errors
    /// When there is none, or it cannot be read.
    pub async fn of(ship: &Ship) -> Result<Spool> {
        let file = ship.data_dir().join("spool.db");
        let options = SqliteConnectOptions::new().filename(&file).read_only(true);
        let mut db = SqliteConnection::connect_with(&options)
            .await
            .with_context(|| file.display().to_string())?;
        let rows: Vec<(String, i64, i64, i64)> = sqlx::query_as(
            "SELECT stream, seq, samples, crc32 FROM acknowledged ORDER BY stream, seq",
        )
        .fetch_all(&mut db)
        .await?;
        let (waiting, parked): (i64, i64) = sqlx::query_as(
            "SELECT COUNT(*) FILTER (WHERE standing = 'waiting'),
                    COUNT(*) FILTER (WHERE standing = 'parked') FROM batches",
        )
        .fetch_one(&mut db)
        .await?;
        let quarantined: i64 = sqlx::query_scalar("SELECT COUNT(*) FROM quarantine")
            .fetch_one(&mut db)
            .await?;
        let acknowledged = rows
            .into_iter()
            .map(|(stream, seq, samples, crc32)| {
                let stream = stream.parse().with_context(|| stream.clone())?;
                Ok(Acknowledged {
                    stream,
                    seq,
                    samples,
                    crc32,
                })
            })
            .collect::<Result<_>>()?;
        Ok(Spool {
            acknowledged,
            waiting,
            in_trouble: parked + quarantined,
        })
    }
}

/// A batch in the server's log: stream, number, bytes.
pub type Logged = (Uuid, i64, Vec<u8>);

/// The server's log of a vessel's batches.
///
/// # Errors
/// When the database cannot be read.
pub async fn batch_log(database: &Database, vessel: Uuid) -> Result<Vec<Logged>> {
    const SQL: &str =
        "SELECT stream, seq, bytes FROM batches WHERE vessel_id = $1 ORDER BY stream, seq";
    let url = database.url();
    if url.starts_with("sqlite:") {
        let options = SqliteConnectOptions::from_str(url)?.read_only(true);
        let mut db = SqliteConnection::connect_with(&options).await?;
        return Ok(sqlx::query_as(SQL).bind(vessel).fetch_all(&mut db).await?);
    }
    let mut db = PgConnection::connect(url).await?;
    Ok(sqlx::query_as(SQL).bind(vessel).fetch_all(&mut db).await?)
}
