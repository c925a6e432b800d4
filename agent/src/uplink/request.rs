//! What a batch says of the ship beside its samples, in the words of its request.

use crate::spool::SealedBatch;

/// How long the shore may wait with its answer for what the samples show, in the words of
/// the request.
const WAIT_FOR_ANALYSIS: &str = "&wait=20";

/// How it is on board, for whoever looks after the ship.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub(crate) struct BatchContext {
    /// How many batches wait besides this one.
    pub(crate) waiting_batches: u64,
    /// What is left of the budget where that is less than a day's, in hundredths of it.
    pub(crate) budget_percent: Option<i32>,
}

impl BatchContext {
    /// With a batch; of an ordinary one nothing but that none follows it.
    pub(super) fn query(self, batch: &SealedBatch) -> String {
        let budget = self.budget_percent.map(|left| format!("&budget={left}"));
        let waiting_batches = if batch.samples > 0 && self.waiting_batches == 0 {
            // What it shows comes with this answer, and not half a day later with the next.
            WAIT_FOR_ANALYSIS.to_owned()
        } else {
            format!("&waits={}", self.waiting_batches)
        };
        waiting_batches + &budget.unwrap_or_default()
    }
}
