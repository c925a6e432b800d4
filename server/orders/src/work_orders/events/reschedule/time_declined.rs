//! Refusal of another time by the firm, or its withdrawal by the operator.

use crate::work_orders::events::event::{Circumstances, Event, Headline};
use crate::work_orders::order_state::OrderState;
use crate::work_orders::payload::exchange::Exchange;
use crate::work_orders::{message_kinds, notice_kinds};
use binnacle_platform::outbox;
use serde::{Deserialize, Serialize};

/// Refusal of another time by the firm, or withdrawal by the operator.
#[derive(Clone, Debug, Serialize, Deserialize)]
#[serde(transparent)]
pub(crate) struct RetimeDeclined(pub Exchange);

impl Event for RetimeDeclined {
    fn apply(&self, state: &mut OrderState) {
        state.offers.keep_agreed_terms(&self.0);
    }

    fn exchange(&self) -> Option<&Exchange> {
        Some(&self.0)
    }

    fn webhook(&self) -> Option<outbox::Kind> {
        Some(message_kinds::ANSWERED)
    }

    fn operator_headline(&self, circumstances: Circumstances) -> Option<Headline> {
        let words = format!("{} does not agree to another time", self.0.firm.firm_name);
        circumstances
            .by_firm
            .then(|| Headline::new(notice_kinds::ANSWERED, words))
    }

    fn firm_headline(&self, circumstances: Circumstances) -> Option<Headline> {
        let words = "the proposal of another time is withdrawn";
        (!circumstances.by_firm).then(|| Headline::new(notice_kinds::ANSWERED, words))
    }

    fn changes_offers(&self) -> bool {
        true
    }
}
