//! Message between the operator and a firm.

use crate::work_orders::events::event::{Circumstances, Event, Headline};
use crate::work_orders::order_state::OrderState;
use crate::work_orders::payload::exchange::Exchange;
use crate::work_orders::{message_kinds, notice_kinds};
use binnacle_platform::outbox;
use serde::{Deserialize, Serialize};

/// Message between the operator and a firm.
#[derive(Clone, Debug, Serialize, Deserialize)]
#[serde(transparent)]
pub(crate) struct MessageSent(pub Exchange);

impl Event for MessageSent {
    fn apply(&self, _state: &mut OrderState) {}

    fn exchange(&self) -> Option<&Exchange> {
        Some(&self.0)
    }

    fn webhook(&self) -> Option<outbox::Kind> {
        Some(message_kinds::MESSAGE)
    }

    fn operator_headline(&self, circumstances: Circumstances) -> Option<Headline> {
        let words = format!("{} writes", self.0.firm.firm_name);
        circumstances
            .by_firm
            .then(|| Headline::new(notice_kinds::MESSAGE, words))
    }

    fn firm_headline(&self, circumstances: Circumstances) -> Option<Headline> {
        (!circumstances.by_firm)
            .then(|| Headline::new(notice_kinds::MESSAGE, "message from the operator"))
    }
}
