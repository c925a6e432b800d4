//! What a batch says of the ship beside its samples, in the words of its request.

use crate::spool::SealedBatch;

/// How long the shore may wait with its answer for what the samples show, in the words of
/// the request.
const WAIT_FOR_ANALYSIS: &str = "&wait=20";

/// How it is on board, for whoever looks after the ship.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub(crate) struct Aboard {
    /// How many batches wait besides this one.
    pub(crate) waits: u64,
    /// What is left of the budget where that is less than a day's, in hundredths of it.
    pub(crate) budget: Option<i32>,
}

impl Aboard {
    /// With a batch; of an ordinary one nothing but that none follows it.
    pub(super) fn with(self, batch: &SealedBatch) -> String {
        let budget = self.budget.map(|left| format!("&budget={left}"));
        let waits = if batch.samples > 0 && self.waits == 0 {
            // What it shows comes with this answer, and not half a day later with the next.
            WAIT_FOR_ANALYSIS.to_owned()
        } else {
            format!("&waits={}", self.waits)
        };
        waits + &budget.unwrap_or_default()
    }
}
