//! Counts of the spool for the page and `status`.

use super::database::{Spool, get};
use super::keys::CONTIGUOUS_SEQ;
use super::thinning::used_bytes;
use serde::{Deserialize, Serialize};

/// Progress of the spool's batches.
#[derive(Clone, Debug, Default, PartialEq, Eq, Serialize, Deserialize)]
pub(crate) struct SpoolStatus {
    /// Samples that are in no batch yet.
    pub(crate) pending_samples: u64,
    /// Sealed batches that were not acknowledged.
    pub(crate) waiting_batches: u64,
    /// Batches that the server refused; kept, and sent again later.
    pub(crate) parked_batches: u64,
    /// Reason of the last refusal.
    pub(crate) parked_because: Option<String>,
    /// Acknowledged batches, as far as they are on record.
    pub(crate) acknowledged_batches: u64,
    /// Samples in those.
    pub(crate) acknowledged_samples: u64,
    /// Number up to which all batches are durable on the server.
    pub(crate) contiguous_seq: u64,
    /// Disk space in use.
    #[serde(default)]
    pub(crate) used_bytes: u64,
    /// Waiting batches that were thinned.
    #[serde(default)]
    pub(crate) thinned_batches: u64,
}

impl Spool {
    /// Returns the progress of the batches.
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
