//! Sealed batches: their order, their state, and the change to another stream.

use super::acknowledged::{self, NeverSent, ensure_sent};
use super::database::{Spool, get, put};
use super::identity::Identity;
use super::keys::{CONTIGUOUS_SEQ, IDENTITY, NEXT_SEQ};
use super::seal::insert_batch;
use super::state::save_downlink;
use binnacle_wire::batch::{Batch, StreamId};
use binnacle_wire::messages::Downlink;
use sqlx::SqliteConnection;
use std::collections::BTreeMap;

/// Acknowledged batches whose number, size and checksum are recorded.
const MAX_ACKNOWLEDGED: i64 = 20_000;

/// A batch ready to send.
#[derive(Clone, Debug, PartialEq, Eq)]
pub(crate) struct SealedBatch {
    /// Number within the stream.
    pub(crate) seq: u64,
    /// Encoded frame.
    pub(crate) bytes: Vec<u8>,
    /// Set for a batch that is sent before everything else.
    pub(crate) urgent: bool,
    /// Number of its samples.
    pub(crate) samples: u64,
}

impl Spool {
    /// Returns the next batch to send: evidence of alerts, newest first, then batches with samples,
    /// then the rest, oldest first.
    pub(crate) async fn next_batch(&self) -> sqlx::Result<Option<SealedBatch>> {
        let row: Option<(i64, Vec<u8>, bool, i64)> = sqlx::query_as(
            "SELECT seq, bytes, urgent, samples FROM batches WHERE standing = 'waiting'
             ORDER BY urgent DESC, NOT urgent AND samples = 0,
                      CASE WHEN urgent THEN -seq ELSE seq END LIMIT 1",
        )
        .fetch_optional(&self.pool)
        .await?;
        Ok(row.map(|(seq, bytes, urgent, samples)| SealedBatch {
            seq: seq.cast_unsigned(),
            bytes,
            urgent,
            samples: samples.unsigned_abs(),
        }))
    }

    /// Counts the other waiting batches.
    pub(crate) async fn count_other_waiting(&self, seq: u64) -> sqlx::Result<u64> {
        let others: i64 = sqlx::query_scalar(
            "SELECT COUNT(*) FROM batches WHERE standing = 'waiting' AND seq <> $1",
        )
        .bind(seq.cast_signed())
        .fetch_one(&self.pool)
        .await?;
        Ok(others.unsigned_abs())
    }

    /// Marks these very bytes as sent, after which they are never changed. Returns `false` when the
    /// batch has been changed meanwhile.
    pub(crate) async fn mark_tried(&self, batch: &SealedBatch) -> sqlx::Result<bool> {
        let mut tx = self.write().await?;
        let noted = sqlx::query("UPDATE batches SET tried = TRUE WHERE seq = $1 AND bytes = $2")
            .bind(batch.seq.cast_signed())
            .bind(&batch.bytes)
            .execute(&mut *tx)
            .await?;
        tx.commit().await?;
        Ok(noted.rows_affected() > 0)
    }

    /// Acknowledges a batch, and reconciles the spool with the server's contiguous number
    /// ([`super::acknowledged`]). Refuses a number that was never sent, and then changes nothing.
    pub(crate) async fn acknowledge(
        &self,
        stream: StreamId,
        batch: &SealedBatch,
        downlink: &Downlink,
    ) -> sqlx::Result<Result<(), NeverSent>> {
        let mut tx = self.write().await?;
        if let Err(refused) = ensure_sent(&mut tx, stream, downlink.contiguous_seq).await? {
            return Ok(Err(refused));
        }
        let before = get(&mut tx, CONTIGUOUS_SEQ).await?.unwrap_or(0);
        put(&mut tx, CONTIGUOUS_SEQ, &downlink.contiguous_seq).await?;
        save_downlink(&mut tx, downlink).await?;
        let was_refused: Option<i64> = sqlx::query_scalar(
            "SELECT 1 FROM batches WHERE seq = $1 AND bytes = $2 AND problem IS NOT NULL",
        )
        .bind(batch.seq.cast_signed())
        .bind(&batch.bytes)
        .fetch_optional(&mut *tx)
        .await?;
        if was_refused.is_some() {
            unpark(&mut tx).await?;
        }
        let samples: Option<i64> = sqlx::query_scalar(
            "UPDATE batches SET standing = 'acknowledged', problem = NULL
             WHERE seq = $1 AND bytes = $2 RETURNING samples",
        )
        .bind(batch.seq.cast_signed())
        .bind(&batch.bytes)
        .fetch_optional(&mut *tx)
        .await?;
        if let Some(samples) = samples {
            record_acknowledged(&mut tx, stream, batch, samples).await?;
        }
        acknowledged::reconcile(&mut tx, batch.seq, before, downlink).await?;
        tx.commit().await?;
        Ok(Ok(()))
    }

    /// Parks a batch that the server refused. A batch damaged by the disk is quarantined, and an
    /// empty one takes its number, so that the server need not wait for it.
    pub(crate) async fn park(&self, seq: u64, problem: &str) -> sqlx::Result<()> {
        let mut tx = self.write().await?;
        if replace_damaged(&mut tx, seq).await? {
            return tx.commit().await;
        }
        sqlx::query("UPDATE batches SET standing = 'parked', problem = $2 WHERE seq = $1")
            .bind(seq.cast_signed())
            .bind(problem)
            .execute(&mut *tx)
            .await?;
        tx.commit().await
    }

    /// Queues all parked batches again, as at a start.
    pub(crate) async fn unpark(&self) -> sqlx::Result<()> {
        let mut tx = self.write().await?;
        unpark(&mut tx).await?;
        tx.commit().await
    }

    /// Queues the first parked batch again: if it is accepted, the others follow.
    pub(crate) async fn unpark_first(&self) -> sqlx::Result<()> {
        let mut tx = self.write().await?;
        sqlx::query(
            "UPDATE batches SET standing = 'waiting'
             WHERE seq = (SELECT MIN(seq) FROM batches WHERE standing = 'parked')",
        )
        .execute(&mut *tx)
        .await?;
        tx.commit().await
    }

    /// Continues in a new stream of the same identity: batches that were not acknowledged are
    /// renumbered in it.
    pub(crate) async fn move_to_stream(&self, stream: StreamId) -> sqlx::Result<()> {
        let mut tx = self.write().await?;
        renumber(&mut tx, stream).await?;
        if let Some(identity) = get::<Identity>(&mut tx, IDENTITY).await? {
            put(&mut tx, IDENTITY, &Identity { stream, ..identity }).await?;
        }
        tx.commit().await
    }

    /// Returns whether the server lacks batches that are no longer here, as after a restore from an
    /// old backup. Its contiguous number can then never rise.
    pub(crate) async fn has_unfillable_gap(&self, contiguous_seq: u64) -> sqlx::Result<bool> {
        let mut connection = self.pool.acquire().await?;
        let wanted = contiguous_seq.saturating_add(1);
        let here: Option<i64> = sqlx::query_scalar("SELECT 1 FROM batches WHERE seq = $1")
            .bind(i64::try_from(wanted).unwrap_or(i64::MAX))
            .fetch_optional(&mut *connection)
            .await?;
        let next = get::<u64>(&mut connection, NEXT_SEQ).await?.unwrap_or(1);
        Ok(here.is_none() && wanted < next)
    }
}

async fn unpark(tx: &mut SqliteConnection) -> sqlx::Result<()> {
    sqlx::query("UPDATE batches SET standing = 'waiting' WHERE standing = 'parked'")
        .execute(tx)
        .await?;
    Ok(())
}

/// Quarantines the batch if it is damaged, and puts an empty one in its place. Returns whether it
/// was.
async fn replace_damaged(tx: &mut SqliteConnection, seq: u64) -> sqlx::Result<bool> {
    let bytes: Option<Vec<u8>> = sqlx::query_scalar("SELECT bytes FROM batches WHERE seq = $1")
        .bind(seq.cast_signed())
        .fetch_optional(&mut *tx)
        .await?;
    let identity = get::<Identity>(tx, IDENTITY).await?;
    let (Some(bytes), Some(identity)) = (bytes, identity) else {
        return Ok(false);
    };
    let Err(problem) = binnacle_wire::decode(&bytes) else {
        return Ok(false);
    };
    quarantine(tx, &bytes, &problem.to_string()).await?;
    let empty = Batch {
        stream: identity.stream,
        seq,
        samples: Vec::new(),
        tally: BTreeMap::new(),
        alerts: Vec::new(),
        thinned: None,
    };
    let empty = binnacle_wire::encode(&empty).map_err(|e| sqlx::Error::Encode(e.into()))?;
    sqlx::query("UPDATE batches SET bytes = $2, samples = 0 WHERE seq = $1")
        .bind(seq.cast_signed())
        .bind(empty)
        .execute(tx)
        .await?;
    Ok(true)
}

async fn quarantine(tx: &mut SqliteConnection, bytes: &[u8], problem: &str) -> sqlx::Result<()> {
    tracing::error!(problem, "a damaged batch was quarantined");
    sqlx::query("INSERT INTO quarantine (bytes, problem) VALUES ($1, $2)")
        .bind(bytes)
        .bind(problem)
        .execute(tx)
        .await?;
    Ok(())
}

pub(super) async fn record_acknowledged(
    tx: &mut SqliteConnection,
    stream: StreamId,
    batch: &SealedBatch,
    samples: i64,
) -> sqlx::Result<()> {
    sqlx::query(
        "INSERT INTO acknowledged (stream, seq, samples, crc32) VALUES ($1, $2, $3, $4)
         ON CONFLICT (stream, seq) DO NOTHING",
    )
    .bind(stream.to_string())
    .bind(batch.seq.cast_signed())
    .bind(samples)
    .bind(i64::from(checksum(&batch.bytes)))
    .execute(&mut *tx)
    .await?;
    sqlx::query("DELETE FROM acknowledged WHERE id <= (SELECT MAX(id) FROM acknowledged) - $1")
        .bind(MAX_ACKNOWLEDGED)
        .execute(tx)
        .await?;
    Ok(())
}

/// Returns the checksum of the frame's content. Including its own checksum, every frame would have
/// the same.
fn checksum(frame: &[u8]) -> u32 {
    let content = frame.len().saturating_sub(4);
    crc32fast::hash(&frame[..content])
}

/// Renumbers the batches that were not acknowledged from 1 in another stream.
///
/// Acknowledged batches are durable on the server in the old stream, and are deleted here.
/// Unreadable bytes are quarantined and never fatal.
pub(super) async fn renumber(tx: &mut SqliteConnection, stream: StreamId) -> sqlx::Result<()> {
    let rows: Vec<(Vec<u8>, bool)> = sqlx::query_as(
        "SELECT bytes, urgent FROM batches WHERE standing <> 'acknowledged' ORDER BY seq",
    )
    .fetch_all(&mut *tx)
    .await?;
    sqlx::query("DELETE FROM batches").execute(&mut *tx).await?;
    let mut next = 1;
    for (bytes, urgent) in rows {
        match reencode(&bytes, stream, next) {
            Ok((bytes, samples)) => {
                insert_batch(tx, next, &bytes, samples, urgent).await?;
                next += 1;
            }
            Err(problem) => quarantine(tx, &bytes, &problem).await?,
        }
    }
    put(tx, NEXT_SEQ, &next).await?;
    put(tx, CONTIGUOUS_SEQ, &0_u64).await
}

fn reencode(bytes: &[u8], stream: StreamId, seq: u64) -> Result<(Vec<u8>, usize), String> {
    let mut batch = binnacle_wire::decode(bytes).map_err(|e| e.to_string())?;
    batch.stream = stream;
    batch.seq = seq;
    let bytes = binnacle_wire::encode(&batch).map_err(|e| e.to_string())?;
    Ok((bytes, batch.samples.len()))
}
