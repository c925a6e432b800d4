//! Merging of batches that wait behind one that cannot be sent: each costs a request and a round
//! trip of its own.
//!
//! Invariants:
//!
//! - Only the two batches sealed last are merged, and neither if it was tried: no number changes
//!   that anybody may know.
//! - Evidence of alerts and thinned batches are never merged.
//! - A merged batch with its request head fits into one packet, and through a proxy that cuts after
//!   a kilobyte.

use super::database::{Spool, put};
use super::keys::NEXT_SEQ;
use super::seal::SAMPLES_PER_BATCH;
use super::thinning::add;

/// Size limit of a merged batch; a request's head takes some 300 bytes more.
const MAX_BYTES: usize = 700;

impl Spool {
    /// Merges the batch that was sealed last into the one before, where possible.
    pub(crate) async fn merge_last_two(&self) -> sqlx::Result<()> {
        let mut tx = self.write().await?;
        let last_two: Vec<(i64, Vec<u8>)> = sqlx::query_as(
            "SELECT seq, bytes FROM batches
             WHERE seq > (SELECT MAX(seq) FROM batches) - 2 AND standing = 'waiting'
                   AND NOT tried AND NOT urgent AND thinned = 0 AND burst = 0
             ORDER BY seq",
        )
        .fetch_all(&mut *tx)
        .await?;
        let [(seq, before), (last_seq, last)] = last_two.as_slice() else {
            return Ok(());
        };
        let Some((bytes, samples)) = merge(before, last) else {
            return Ok(());
        };
        sqlx::query("UPDATE batches SET bytes = $2, samples = $3 WHERE seq = $1")
            .bind(seq)
            .bind(bytes)
            .bind(samples)
            .execute(&mut *tx)
            .await?;
        sqlx::query("DELETE FROM batches WHERE seq = $1")
            .bind(last_seq)
            .execute(&mut *tx)
            .await?;
        put(&mut tx, NEXT_SEQ, &last_seq.cast_unsigned()).await?;
        tx.commit().await
    }
}

/// Merges two batches; returns the bytes and the number of samples. `None` when the result would be
/// too large, or when one is unreadable: damage is handled when it is sent.
fn merge(before: &[u8], last: &[u8]) -> Option<(Vec<u8>, i64)> {
    let mut batch = binnacle_wire::decode(before).ok()?;
    let last = binnacle_wire::decode(last).ok()?;
    batch.samples.extend(last.samples);
    batch.samples.sort_by_key(|sample| sample.time);
    if batch.samples.len() > SAMPLES_PER_BATCH as usize {
        return None;
    }
    for (reason, windows) in last.tally {
        let sum = batch.tally.entry(reason).or_default();
        *sum = sum.saturating_add(windows);
    }
    batch.thinned = match (batch.thinned, last.thinned) {
        (Some(before), Some(last)) => Some(add(before, last)),
        (before, last) => before.or(last),
    };
    let bytes = binnacle_wire::encode(&batch).ok()?;
    let samples = i64::try_from(batch.samples.len()).ok()?;
    (bytes.len() <= MAX_BYTES).then_some((bytes, samples))
}

#[cfg(test)]
mod tests {
    use super::super::tests::{accepted, alert, enrolled, restless, sample, seal};
    use crate::spool::{Seal, Spool};
    use binnacle_wire::batch::Batch;

    /// Seals a quarter of a day, as without a link.
    async fn quarter(spool: &Spool, number: i64) {
        let samples: Vec<_> = (0..36).map(|i| sample(number * 360 + i * 10)).collect();
        let stored = spool.store(&samples, &accepted(2_160), Seal::All).await;
        assert_eq!(stored.unwrap().1, 1);
        spool.merge_last_two().await.unwrap();
    }

    async fn waiting(spool: &Spool) -> Vec<Batch> {
        let rows: Vec<(Vec<u8>,)> =
            sqlx::query_as("SELECT bytes FROM batches WHERE standing = 'waiting' ORDER BY seq")
                .fetch_all(&spool.pool)
                .await
                .unwrap();
        let read = |(bytes,): &(Vec<u8>,)| binnacle_wire::decode(bytes).unwrap();
        rows.iter().map(read).collect()
    }

    #[tokio::test]
    async fn a_month_without_a_link_waits_in_few_batches_with_every_sample() {
        let (_directory, spool) = enrolled().await;
        quarter(&spool, 0).await;
        let tried = spool.next_batch().await.unwrap().unwrap();
        assert!(spool.mark_tried(&tried).await.unwrap());
        for number in 1..120 {
            quarter(&spool, number).await;
        }
        assert_eq!(spool.next_batch().await.unwrap().unwrap(), tried);
        let batches = waiting(&spool).await;
        assert!((5..40).contains(&batches.len()), "{}", batches.len());
        let seqs: Vec<u64> = batches.iter().map(|batch| batch.seq).collect();
        let all: Vec<u64> = (1..).take(batches.len()).collect();
        assert_eq!(seqs, all);
        let times = batches.iter().flat_map(|b| &b.samples).map(|s| s.time);
        let sealed: Vec<_> = (0..120 * 36).map(|i| sample(i * 10).time).collect();
        assert_eq!(times.collect::<Vec<_>>(), sealed);
        let windows: u64 = batches.iter().map(|batch| batch.tally["accepted"]).sum();
        assert_eq!(windows, 120 * 2_160);
    }

    #[tokio::test]
    async fn what_may_be_ashore_and_evidence_stay_as_they_are() {
        let (_directory, spool) = enrolled().await;
        seal(&spool, 0..1).await;
        let tried = spool.next_batch().await.unwrap().unwrap();
        spool.mark_tried(&tried).await.unwrap();
        seal(&spool, 1..2).await;
        spool.merge_last_two().await.unwrap();
        let nothing = std::collections::BTreeMap::new();
        spool
            .store_evidence(&[sample(2)], &nothing, &[alert(2)], None)
            .await
            .unwrap();
        spool.merge_last_two().await.unwrap();
        seal(&spool, 3..4).await;
        spool.merge_last_two().await.unwrap();
        let batches = waiting(&spool).await;
        let samples: Vec<usize> = batches.iter().map(|batch| batch.samples.len()).collect();
        assert_eq!(samples, [1; 4]);
    }

    #[tokio::test]
    async fn what_would_not_go_through_a_kilobyte_stays_apart() {
        let (_directory, spool) = enrolled().await;
        for from in [0, 150] {
            let samples: Vec<_> = (from..from + 150).map(restless).collect();
            let stored = spool.store(&samples, &accepted(150), Seal::All).await;
            stored.unwrap();
            spool.merge_last_two().await.unwrap();
        }
        assert_eq!(waiting(&spool).await.len(), 2);
    }
}
