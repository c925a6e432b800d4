//! Lapse of a proposal of another time.

use crate::work_orders::events::event::{Circumstances, Event, Headline};
use crate::work_orders::order_state::OrderState;
use crate::work_orders::payload::exchange::Exchange;
use crate::work_orders::{message_kinds, notice_kinds};
use binnacle_platform::outbox;
use serde::{Deserialize, Serialize};

/// Lapse of the proposal of another time without an answer.
#[derive(Clone, Debug, Serialize, Deserialize)]
#[serde(transparent)]
pub(crate) struct RetimeLapsed(pub Exchange);

impl Event for RetimeLapsed {
    fn apply(&self, state: &mut OrderState) {
        state.offers.keep_agreed_terms(&self.0);
    }

    fn exchange(&self) -> Option<&Exchange> {
        Some(&self.0)
    }

    fn webhook(&self) -> Option<outbox::Kind> {
        Some(message_kinds::LAPSED)
    }

    fn operator_headline(&self, _circumstances: Circumstances) -> Option<Headline> {
        let firm = &self.0.firm.firm_name;
        let words = format!("no answer in time from {firm} to another time");
        Some(Headline::new(notice_kinds::ANSWER_LATE, words))
    }

    fn firm_headline(&self, _circumstances: Circumstances) -> Option<Headline> {
        let words = "you have not answered in time to another time";
        Some(Headline::new(notice_kinds::ANSWER_LATE, words))
    }

    fn changes_offers(&self) -> bool {
        true
    }
}
