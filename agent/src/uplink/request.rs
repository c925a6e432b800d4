//! Query parameters of a batch's request.

use crate::spool::SealedBatch;

/// Seconds that the server may wait with its response for the analysis of the samples.
const WAIT_FOR_ANALYSIS: &str = "&wait=20";

/// State of the agent that a batch reports beside its samples.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub(crate) struct BatchContext {
    /// Number of other waiting batches.
    pub(crate) waiting_batches: u64,
    /// Balance of the budget where it is less than a day's, as a percentage of it.
    pub(crate) budget_percent: Option<i32>,
}

impl BatchContext {
    /// Returns the query parameters of a batch: for an ordinary one only that no other follows it.
    pub(super) fn query(self, batch: &SealedBatch) -> String {
        let budget = self.budget_percent.map(|left| format!("&budget={left}"));
        let waiting_batches = if batch.samples > 0 && self.waiting_batches == 0 {
            // The result of the analysis comes with this response, and not half a day later.
            WAIT_FOR_ANALYSIS.to_owned()
        } else {
            format!("&waits={}", self.waiting_batches)
        };
        waiting_batches + &budget.unwrap_or_default()
    }
}
