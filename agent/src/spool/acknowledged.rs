//! Acknowledged batches, retained in case the server loses them: a server restored from a backup
//! has fewer than before.
//!
//! Invariants:
//!
//! - They are deleted first when the disk limit is reached, and after a month by the server's
//!   clock.
//! - A lower contiguous number from the server is the only sign of a loss. Then all batches above
//!   it are sent again, byte for byte. Those that the server still has are not stored twice.
//! - No acknowledgement beyond what this agent has sent is believed, even in part: it is of another
//!   stream, or of another copy of this agent.

use super::database::{Spool, get};
use super::keys::CONTIGUOUS_SEQ;
use binnacle_wire::batch::StreamId;
use binnacle_wire::messages::Downlink;
use sqlx::SqliteConnection;

/// Retention of acknowledged batches: a lost server is restored from a backup younger than this.
const RETENTION_MICROS: i64 = 30 * 86_400 * 1_000_000;
/// Batches deleted in one transaction.
const DELETE_AT_ONCE: i64 = 64;

/// Acknowledgement that covers batches which this agent never sent.
#[derive(Clone, Copy, Debug, PartialEq, Eq, thiserror::Error)]
#[error("batches up to {claimed} were acknowledged, but only {sent} have been sent")]
pub(crate) struct NeverSent {
    /// Number up to which the server claims to have every batch.
    pub(crate) claimed: u64,
    /// Highest number that was sent.
    pub(crate) sent: u64,
}

/// Fails for an acknowledgement beyond every batch that this agent has sent in the stream.
pub(super) async fn ensure_sent(
    tx: &mut SqliteConnection,
    stream: StreamId,
    claimed: u64,
) -> sqlx::Result<Result<(), NeverSent>> {
    let tried: Option<i64> = sqlx::query_scalar("SELECT MAX(seq) FROM batches WHERE tried")
        .fetch_one(&mut *tx)
        .await?;
    let recorded: Option<i64> =
        sqlx::query_scalar("SELECT MAX(seq) FROM acknowledged WHERE stream = $1")
            .bind(stream.to_string())
            .fetch_one(&mut *tx)
            .await?;
    // Records and batches may have been lost with the disk, but not what they led to.
    let believed: u64 = get(tx, CONTIGUOUS_SEQ).await?.unwrap_or(0);
    let sent = tried.max(recorded).unwrap_or(0).cast_unsigned();
    let sent = sent.max(believed);
    Ok(if claimed > sent {
        Err(NeverSent { claimed, sent })
    } else {
        Ok(())
    })
}

impl Spool {
    /// Queues all retained batches again, after the server lost the stream.
    pub(crate) async fn requeue_all(&self) -> sqlx::Result<()> {
        let mut tx = self.write().await?;
        requeue(&mut tx, 0, 0).await?;
        tx.commit().await
    }
}

/// Reconciles the spool with the contiguous number in a response to a batch. Dates new
/// acknowledgements, deletes those older than a month, and queues again what the server lost.
/// `before` is the previous number.
pub(super) async fn reconcile(
    tx: &mut SqliteConnection,
    response_seq: u64,
    before: u64,
    downlink: &Downlink,
) -> sqlx::Result<()> {
    let now = downlink.server_time.micros();
    sqlx::query(
        "UPDATE batches SET acknowledged_micros = $1
         WHERE standing = 'acknowledged' AND acknowledged_micros IS NULL",
    )
    .bind(now)
    .execute(&mut *tx)
    .await?;
    let contiguous = downlink.contiguous_seq;
    // A number that stands still although the next batch is acknowledged is an error of the server,
    // not a loss. Sending everything again and again would not help.
    let has_regressed = contiguous < before
        || (contiguous > before && is_acknowledged(tx, contiguous.saturating_add(1)).await?);
    if has_regressed {
        let batches = requeue(tx, contiguous, response_seq).await?;
        tracing::warn!(
            contiguous,
            before,
            batches,
            "the server lost batches, they are sent again"
        );
    }
    sqlx::query(
        "DELETE FROM batches
         WHERE standing = 'acknowledged' AND seq <= $1 AND acknowledged_micros < $2",
    )
    .bind(as_stored(contiguous))
    .bind(now.saturating_sub(RETENTION_MICROS))
    .execute(tx)
    .await?;
    Ok(())
}

/// Deletes some of the oldest acknowledged batches. Returns their number.
pub(super) async fn delete_oldest(tx: &mut SqliteConnection) -> sqlx::Result<u64> {
    let contiguous: u64 = get(tx, CONTIGUOUS_SEQ).await?.unwrap_or(0);
    let deleted = sqlx::query(
        "DELETE FROM batches WHERE seq IN
         (SELECT seq FROM batches WHERE standing = 'acknowledged' AND seq <= $1
          ORDER BY seq LIMIT $2)",
    )
    .bind(as_stored(contiguous))
    .bind(DELETE_AT_ONCE)
    .execute(tx)
    .await?;
    Ok(deleted.rows_affected())
}

async fn is_acknowledged(tx: &mut SqliteConnection, seq: u64) -> sqlx::Result<bool> {
    let found: Option<i64> =
        sqlx::query_scalar("SELECT 1 FROM batches WHERE seq = $1 AND standing = 'acknowledged'")
            .bind(as_stored(seq))
            .fetch_optional(tx)
            .await?;
    Ok(found.is_some())
}

/// Queues acknowledged batches above a number again, except one. Returns their number. Batches sent
/// as short messages are sent so again.
async fn requeue(tx: &mut SqliteConnection, beyond: u64, but: u64) -> sqlx::Result<u64> {
    let waiting = sqlx::query(
        "UPDATE batches SET standing = 'waiting', acknowledged_micros = NULL,
                            burst = CASE WHEN burst = -2 THEN -2 ELSE 0 END
         WHERE standing = 'acknowledged' AND seq > $1 AND seq <> $2",
    )
    .bind(as_stored(beyond))
    .bind(as_stored(but))
    .execute(tx)
    .await?;
    Ok(waiting.rows_affected())
}

/// Converts a number for SQL: a server may claim any.
fn as_stored(seq: u64) -> i64 {
    i64::try_from(seq).unwrap_or(i64::MAX)
}

#[cfg(test)]
mod tests {
    use super::super::tests::{accepted, downlink, enrolled, identity, next_sent, seal};
    use super::*;
    use crate::spool::Seal;
    use binnacle_compass::sample::Sample;

    /// Sends all waiting batches to a server that then claims the contiguous number. Returns the
    /// sent numbers.
    async fn send(spool: &Spool, contiguous: u64) -> Vec<u64> {
        let mut sent = Vec::new();
        while let Some(batch) = next_sent(spool).await {
            sent.push(batch.seq);
            assert!(sent.len() < 20, "{sent:?}");
            let far = contiguous.max(batch.seq);
            spool
                .acknowledge(identity(7).stream, &batch, &downlink(far))
                .await
                .unwrap()
                .unwrap();
        }
        sent
    }

    #[tokio::test]
    async fn a_server_that_fell_behind_gets_again_what_it_lacks_and_no_more() {
        let (_directory, spool) = enrolled().await;
        seal(&spool, 0..1).await;
        seal(&spool, 1..2).await;
        seal(&spool, 2..3).await;
        let first = spool.next_batch().await.unwrap().unwrap();
        assert_eq!(send(&spool, 0).await, [1, 2, 3]);
        seal(&spool, 3..4).await;
        let fourth = next_sent(&spool).await.unwrap();
        let stream = identity(7).stream;
        spool
            .acknowledge(stream, &fourth, &downlink(1))
            .await
            .unwrap()
            .unwrap();
        assert!(!spool.has_unfillable_gap(1).await.unwrap());
        assert_eq!(send(&spool, 4).await, [2, 3]);
        let status = spool.status().await.unwrap();
        assert_eq!(
            (status.acknowledged_batches, status.acknowledged_samples),
            (4, 4)
        );
        spool.requeue_all().await.unwrap();
        assert_eq!(spool.next_batch().await.unwrap().unwrap(), first);
    }

    #[tokio::test]
    async fn a_server_that_never_counts_on_is_not_sent_the_same_for_ever() {
        let (_directory, spool) = enrolled().await;
        for minute in 0..4 {
            seal(&spool, minute..minute + 1).await;
        }
        for seq in 1..=4 {
            let batch = next_sent(&spool).await.unwrap();
            assert_eq!(batch.seq, seq);
            spool
                .acknowledge(identity(7).stream, &batch, &downlink(0))
                .await
                .unwrap()
                .unwrap();
        }
        assert_eq!(spool.next_batch().await.unwrap(), None);
    }

    #[tokio::test]
    async fn what_is_acknowledged_goes_after_a_month_and_before_anything_is_thinned() {
        let (_directory, spool) = enrolled().await;
        seal(&spool, 0..1).await;
        send(&spool, 0).await;
        seal(&spool, 1..2).await;
        let second = next_sent(&spool).await.unwrap();
        let mut later = downlink(2);
        later.server_time = later.server_time.plus_seconds(31.0 * 86_400.0);
        let stream = identity(7).stream;
        let acknowledged = spool.acknowledge(stream, &second, &later).await;
        assert_eq!(acknowledged.unwrap(), Ok(()));
        assert_eq!(kept(&spool).await, [2]);
        let many: Vec<Sample> = (2..400).map(super::super::tests::restless).collect();
        spool.store(&many, &accepted(1), Seal::All).await.unwrap();
        spool.shrink_to_limit(1).await.unwrap();
        assert_eq!(kept(&spool).await, [0_i64; 0]);
        assert!(spool.has_unfillable_gap(1).await.unwrap());
        assert!(!spool.has_unfillable_gap(2).await.unwrap());
    }

    async fn kept(spool: &Spool) -> Vec<i64> {
        sqlx::query_scalar("SELECT seq FROM batches WHERE standing = 'acknowledged' ORDER BY seq")
            .fetch_all(&spool.pool)
            .await
            .unwrap()
    }
}
