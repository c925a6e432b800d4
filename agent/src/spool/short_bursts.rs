//! Delivery of batches as short messages.

use super::acknowledged::{NeverSent, ensure_sent};
use super::batches::{SealedBatch, record_acknowledged};
use super::database::{Spool, get, put};
use super::identity::Identity;
use super::keys::{CONTIGUOUS_SEQ, IDENTITY};

/// Marks in place of the number of sent messages.
const COMPLETE: i64 = -1;
const EXCLUDED: i64 = -2;

impl Spool {
    /// Returns the next batch for short messages, and the number of its messages already sent.
    /// Alerts come first, newest first, then the oldest batch.
    pub(crate) async fn next_burst_batch(&self) -> sqlx::Result<Option<(SealedBatch, usize)>> {
        let row: Option<(i64, Vec<u8>, bool, i64, i64)> = sqlx::query_as(
            "SELECT seq, bytes, urgent, samples, burst FROM batches
             WHERE standing = 'waiting' AND burst >= 0
             ORDER BY urgent DESC, NOT urgent AND samples = 0,
                      CASE WHEN urgent THEN -seq ELSE seq END LIMIT 1",
        )
        .fetch_optional(&self.pool)
        .await?;
        Ok(row.map(|(seq, bytes, urgent, samples, sent)| {
            let batch = SealedBatch {
                seq: seq.cast_unsigned(),
                bytes,
                urgent,
                samples: samples.unsigned_abs(),
            };
            (batch, usize::try_from(sent).unwrap_or_default())
        }))
    }

    /// Records the number of sent messages of a batch, which may be all of them.
    pub(crate) async fn record_burst_progress(
        &self,
        batch: &SealedBatch,
        sent: usize,
        messages: usize,
    ) -> sqlx::Result<()> {
        let sent = i64::try_from(sent).unwrap_or(i64::MAX);
        let is_all = sent >= i64::try_from(messages).unwrap_or(i64::MAX);
        self.set_burst(batch, if is_all { COMPLETE } else { sent })
            .await
    }

    /// Excludes a batch that no messages can carry.
    pub(crate) async fn exclude_from_bursts(&self, batch: &SealedBatch) -> sqlx::Result<()> {
        self.set_burst(batch, EXCLUDED).await
    }

    async fn set_burst(&self, batch: &SealedBatch, burst: i64) -> sqlx::Result<()> {
        let mut tx = self.write().await?;
        sqlx::query("UPDATE batches SET burst = $3 WHERE seq = $1 AND bytes = $2")
            .bind(batch.seq.cast_signed())
            .bind(&batch.bytes)
            .bind(burst)
            .execute(&mut *tx)
            .await?;
        tx.commit().await
    }

    /// Acknowledges the batches up to a number whose messages are all sent. Returns their number.
    /// Refuses a number that was never sent, and then changes nothing.
    pub(crate) async fn acknowledge_bursts(
        &self,
        identity: &Identity,
        contiguous_seq: u64,
    ) -> sqlx::Result<Result<usize, NeverSent>> {
        let mut tx = self.write().await?;
        if get::<Identity>(&mut tx, IDENTITY).await?.as_ref() != Some(identity) {
            return Ok(Ok(0));
        }
        if let Err(refused) = ensure_sent(&mut tx, identity.stream, contiguous_seq).await? {
            return Ok(Err(refused));
        }
        let rows: Vec<(i64, Vec<u8>, bool, i64)> = sqlx::query_as(
            "UPDATE batches SET standing = 'acknowledged', problem = NULL
             WHERE seq <= $1 AND burst = $2 AND standing <> 'acknowledged'
             RETURNING seq, bytes, urgent, samples",
        )
        .bind(i64::try_from(contiguous_seq).unwrap_or(i64::MAX))
        .bind(COMPLETE)
        .fetch_all(&mut *tx)
        .await?;
        let acknowledged = rows.len();
        for (seq, bytes, urgent, samples) in rows {
            let batch = SealedBatch {
                seq: seq.cast_unsigned(),
                bytes,
                urgent,
                samples: samples.unsigned_abs(),
            };
            record_acknowledged(&mut tx, identity.stream, &batch, samples).await?;
        }
        let known = get::<u64>(&mut tx, CONTIGUOUS_SEQ).await?.unwrap_or(0);
        if acknowledged > 0 && known < contiguous_seq {
            put(&mut tx, CONTIGUOUS_SEQ, &contiguous_seq).await?;
        }
        tx.commit().await?;
        Ok(Ok(acknowledged))
    }
}
