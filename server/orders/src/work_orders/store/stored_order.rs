//! Order with its log, as it is read from the database.

use crate::work_orders::events::{OrderEvent, replay};
use crate::work_orders::log::entry::Entry;
use crate::work_orders::order_state::OrderState;
use crate::work_orders::state::State;
use crate::work_orders::summary::Summary;
use binnacle_platform::error::{Error, Result};

/// An order with its log.
pub(crate) struct StoredOrder {
    pub(crate) summary: Summary,
    pub(crate) log: Vec<Entry>,
}

impl StoredOrder {
    /// Reads an order whose entries are stored as these lines.
    ///
    /// # Errors
    /// Fails when a line is not an entry.
    pub(super) fn read(summary: Summary, lines: Vec<(String,)>) -> Result<StoredOrder> {
        let read = |(line,): (String,)| Ok(serde_json::from_str(&line)?);
        let log: Result<Vec<Entry>> = lines.into_iter().map(read).collect();
        Ok(StoredOrder { summary, log: log? })
    }

    /// State by the log.
    pub(crate) fn state(&self) -> OrderState {
        replay(self.events())
    }

    fn events(&self) -> impl Iterator<Item = &OrderEvent> {
        self.log.iter().map(|entry| &entry.content)
    }

    /// Refuses an action that the order's state does not allow.
    ///
    /// # Errors
    /// [`Error::WrongState`], with the reason.
    pub(crate) fn require_state(&self, allowed: &[State], reason: &str) -> Result<()> {
        if allowed.contains(&self.summary.state) {
            return Ok(());
        }
        let state = serde_json::to_value(self.summary.state)?;
        let state = state.as_str().unwrap_or_default().to_owned();
        Err(Error::WrongState(format!("the order is {state}: {reason}")))
    }

    /// Brings the summary in step with the last entry.
    pub(super) fn update_summary(&mut self, state: &OrderState) {
        let summary = &mut self.summary;
        summary.state = state.state;
        summary.answer_by = state.offers.answer_by();
        summary.call_fit = state.call_change.as_ref().map(|call| call.fit);
        let holder = state.offers.holder().map(|offer| offer.firm_id);
        if summary.firm_id.is_some() && holder.is_none() && !summary.state.is_over() {
            (
                summary.firm,
                summary.adjuster_name,
                summary.adjuster_licence,
            ) = (None, None, None);
        }
        summary.firm_id = holder;
        if let Some(entry) = self.log.last() {
            entry.content.event().update_summary(summary);
        }
        summary.update_local_times();
    }
}
