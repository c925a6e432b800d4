//! Records of sent batches at both ends: the agent's spool and the server's
//! batch log, read directly from their databases.

use crate::process::database::Database;
use crate::server_process::ServerProcess;
use crate::ship::Ship;
use anyhow::{Context, Result, ensure};
use binnacle_compass::sample::Sample;
use binnacle_wire::decode;
use serde_json::Value;
use sqlx::sqlite::SqliteConnectOptions;
use sqlx::{Connection, PgConnection, SqliteConnection};
use std::str::FromStr;
use uuid::Uuid;

/// The agent's record of its batches.
#[derive(Clone, Debug, Default, PartialEq, Eq)]
pub struct Spool {
    /// Acknowledged batches, by stream and number.
    pub acknowledged: Vec<Acknowledged>,
    /// Number of sealed batches without an acknowledgement.
    pub waiting: i64,
    /// Batches refused by the server, or unreadable: there must be none.
    pub refused: i64,
    /// Samples without an acknowledgement, in batches or not yet.
    pub unsent_samples: i64,
    /// Windows in those samples.
    pub unsent_windows: u64,
}

/// Writes the spool's journal into its file and truncates it, so that the next
/// write on a full disk fails.
///
/// # Errors
/// Fails when there is no spool, or its agent holds a lock.
pub async fn clear_journal(ship: &Ship) -> Result<()> {
    let options = SqliteConnectOptions::new().filename(ship.data_dir().join("spool.db"));
    let mut db = SqliteConnection::connect_with(&options).await?;
    let (busy, pages, _): (i64, i64, i64) = sqlx::query_as("PRAGMA wal_checkpoint(TRUNCATE)")
        .fetch_one(&mut db)
        .await?;
    ensure!(busy == 0 && pages == 0, "{busy}, {pages} pages left");
    Ok(db.close().await?)
}

/// An acknowledged batch.
#[derive(Clone, Debug, PartialEq, Eq, PartialOrd, Ord)]
pub struct Acknowledged {
    /// The stream.
    pub stream: Uuid,
    /// Its number in the stream.
    pub seq: i64,
    /// Its number of samples.
    pub samples: i64,
    /// Checksum of the whole batch.
    pub crc32: i64,
}

/// Returns the bytes that the agent has counted at its socket, and those of its last connection.
///
/// # Errors
/// Fails when the spool cannot be read, or has none.
pub async fn counted_bytes(ship: &Ship) -> Result<(f64, f64)> {
    let mut db = open(ship).await?;
    let account: String = sqlx::query_scalar("SELECT value FROM state WHERE name = 'account'")
        .fetch_one(&mut db)
        .await?;
    let account: Value = serde_json::from_str(&account)?;
    let bytes = |name: &str| account[name].as_f64().with_context(|| account.to_string());
    Ok((bytes("total_bytes")?, bytes("connection_bytes")?))
}

async fn open(ship: &Ship) -> Result<SqliteConnection> {
    let file = ship.data_dir().join("spool.db");
    let options = SqliteConnectOptions::new().filename(&file).read_only(true);
    SqliteConnection::connect_with(&options)
        .await
        .with_context(|| file.display().to_string())
}

impl Spool {
    /// Reads the spool as it is now.
    ///
    /// # Errors
    /// Fails when there is none, or it cannot be read.
    pub async fn read(ship: &Ship) -> Result<Spool> {
        let mut db = open(ship).await?;
        // One snapshot: a batch may be acknowledged between two statements.
        let mut db = db.begin().await?;
        let rows: Vec<(String, i64, i64, i64)> = sqlx::query_as(
            "SELECT stream, seq, samples, crc32 FROM acknowledged ORDER BY stream, seq",
        )
        .fetch_all(&mut *db)
        .await?;
        let (waiting, parked): (i64, i64) = sqlx::query_as(
            "SELECT COUNT(*) FILTER (WHERE standing = 'waiting'),
                    COUNT(*) FILTER (WHERE standing = 'parked') FROM batches",
        )
        .fetch_one(&mut *db)
        .await?;
        let quarantined: i64 = sqlx::query_scalar("SELECT COUNT(*) FROM quarantine")
            .fetch_one(&mut *db)
            .await?;
        let unsent_samples: i64 = sqlx::query_scalar(
            "SELECT (SELECT COUNT(*) FROM pending_samples)
                  + (SELECT COALESCE(SUM(samples), 0) FROM batches
                     WHERE standing <> 'acknowledged')",
        )
        .fetch_one(&mut *db)
        .await?;
        let unsent_windows = unsent_windows(&mut db).await?;
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
            refused: parked + quarantined,
            unsent_samples,
            unsent_windows,
        })
    }
}

async fn unsent_windows(db: &mut SqliteConnection) -> Result<u64> {
    let pending: i64 = sqlx::query_scalar(
        "SELECT COALESCE(SUM(json_extract(sample, '$.windows')), 0) FROM pending_samples",
    )
    .fetch_one(&mut *db)
    .await?;
    let sealed: Vec<Vec<u8>> =
        sqlx::query_scalar("SELECT bytes FROM batches WHERE standing <> 'acknowledged'")
            .fetch_all(db)
            .await?;
    let mut windows = pending.unsigned_abs();
    for bytes in sealed {
        let samples = decode(&bytes)?.samples;
        windows += samples.iter().map(|s| u64::from(s.windows)).sum::<u64>();
    }
    Ok(windows)
}

/// A batch in the server's log: stream, number, bytes.
pub type Logged = (Uuid, i64, Vec<u8>);

/// Reads the server's log of a vessel's batches.
///
/// # Errors
/// Fails when the database cannot be read.
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

/// Compares both ends' records: the batches that the agent holds for
/// acknowledged are those of the server, to the checksum.
///
/// # Errors
/// Fails when they differ, or a batch was refused.
pub async fn ensure_records_match(
    server: &ServerProcess,
    vessel: Uuid,
    spool: &Spool,
) -> Result<()> {
    ensure!(spool.refused == 0, "{spool:?}");
    let logged = logged(server, vessel).await?;
    ensure!(
        logged == spool.acknowledged,
        "on the server {logged:?}, on board {spool:?}"
    );
    Ok(())
}

/// Checks that acknowledged batches are on the server, to the checksum. The
/// server may have more, when a response or its record was lost.
///
/// # Errors
/// Fails when one is missing.
pub async fn ensure_acknowledged_is_stored(
    server: &ServerProcess,
    vessel: Uuid,
    spool: &Spool,
) -> Result<()> {
    let logged = logged(server, vessel).await?;
    for batch in &spool.acknowledged {
        ensure!(logged.contains(batch), "{batch:?} is not in {logged:?}");
    }
    Ok(())
}

async fn logged(server: &ServerProcess, vessel: Uuid) -> Result<Vec<Acknowledged>> {
    let log = batch_log(server.database(), vessel).await?;
    let read = |(stream, seq, bytes): Logged| {
        Ok(Acknowledged {
            stream,
            seq,
            samples: i64::try_from(decode(&bytes)?.samples.len())?,
            crc32: i64::from(checksum(&bytes)),
        })
    };
    log.into_iter().map(read).collect()
}

/// Checksum of a frame without its own checksum, with which every frame would
/// have the same.
pub fn checksum(frame: &[u8]) -> u32 {
    crc32fast::hash(&frame[..frame.len().saturating_sub(4)])
}

/// Returns the samples in the server's log, each once, in order of time.
///
/// # Errors
/// Fails when two different samples share windows.
pub async fn stored_samples(server: &ServerProcess, vessel: Uuid) -> Result<Vec<Sample>> {
    let mut samples = Vec::new();
    for (_, _, bytes) in batch_log(server.database(), vessel).await? {
        samples.extend(decode(&bytes)?.samples);
    }
    samples.sort_by_key(|sample| sample.time);
    samples.dedup();
    for pair in samples.windows(2) {
        let apart = pair[1].time.seconds_since(pair[0].time);
        let both = 5.0 * f64::from(pair[0].windows) + 5.0 * f64::from(pair[1].windows);
        ensure!(apart >= both, "these share windows: {pair:?}");
    }
    Ok(samples)
}
