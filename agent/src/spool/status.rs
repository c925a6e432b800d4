//! Counts of the spool for the page and `status`.

use super::database::{Spool, get};
use super::keys::CONTIGUOUS_SEQ;
use super::thinning::used_bytes;
use serde::{Deserialize, Serialize};

/// How far the shore has come with what is here.
#[derive(Clone, Debug, Default, PartialEq, Eq, Serialize, Deserialize)]
pub(crate) struct SpoolStatus {
    /// Samples that are in no batch yet.
    pub(crate) pending_samples: u64,
    /// Sealed batches that were not acknowledged.
    pub(crate) waiting_batches: u64,
    /// Batches that the shore refused; kept, and offered again.
    pub(crate) parked_batches: u64,
    /// Why the last of those was refused.
    pub(crate) parked_because: Option<String>,
    /// Batches that the shore acknowledged, as far as they are remembered.
    pub(crate) acknowledged_batches: u64,
    /// The samples in those.
    pub(crate) acknowledged_samples: u64,
    /// Every batch up to this one is durable on shore.
    pub(crate) contiguous_seq: u64,
    /// What all of that takes on the disk.
    #[serde(default)]
    pub(crate) used_bytes: u64,
    /// Batches that were thinned for want of room and wait.
    #[serde(default)]
    pub(crate) thinned_batches: u64,
}

impl Spool {
    /// How far the shore has come.
    pub(crate) async fn status(&self) -> sqlx::Result<SpoolStatus> {
        let pending_samples = self.pending().await?.samples;
        let mut connection = self.pool.acquire().await?;
        let (waiting, parked, thinned, because): (i64, i64, i64, Option<String>) = sqlx::query_as(
            "SELECT COUNT(*) FILTER (WHERE standing = 'waiting'),
                    COUNT(*) FILTER (WHERE standing = 'parked'),
                    COUNT(*) FILTER (WHERE standing <> 'acknowledged' AND thinned > 0),
                    (SELECT problem FROM batches WHERE standing = 'parked'
                     ORDER BY seq DESC LIMIT 1)
             FROM batches",
        )
        .fetch_one(&mut *connection)
        .await?;
        let (batches, samples): (i64, i64) =
            sqlx::query_as("SELECT COUNT(*), COALESCE(SUM(samples), 0) FROM acknowledged")
                .fetch_one(&mut *connection)
                .await?;
        Ok(SpoolStatus {
            pending_samples,
            waiting_batches: waiting.cast_unsigned(),
            parked_batches: parked.cast_unsigned(),
            parked_because: because,
            acknowledged_batches: batches.cast_unsigned(),
            acknowledged_samples: samples.cast_unsigned(),
            contiguous_seq: get(&mut connection, CONTIGUOUS_SEQ).await?.unwrap_or(0),
            used_bytes: used_bytes(&mut connection).await?,
            thinned_batches: thinned.cast_unsigned(),
        })
    }
}
