//! Acceptance of another time by the firm.

use crate::work_orders::events::event::{Circumstances, Event, Headline};
use crate::work_orders::offers::OfferState;
use crate::work_orders::order_state::OrderState;
use crate::work_orders::payload::exchange::Exchange;
use crate::work_orders::summary::Summary;
use crate::work_orders::{message_kinds, notice_kinds};
use binnacle_platform::outbox;
use serde::{Deserialize, Serialize};

/// Acceptance of another time by the firm.
#[derive(Clone, Debug, Serialize, Deserialize)]
#[serde(transparent)]
pub(crate) struct RetimeAccepted(pub Exchange);

impl Event for RetimeAccepted {
    fn apply(&self, state: &mut OrderState) {
        state.offers.set(&self.0, OfferState::Accepted);
        if let Some(terms) = &self.0.terms {
            state.agree_time(terms.hours());
        }
    }

    fn update_summary(&self, summary: &mut Summary) {
        summary.apply_terms(&self.0);
    }

    fn exchange(&self) -> Option<&Exchange> {
        Some(&self.0)
    }

    fn webhook(&self) -> Option<outbox::Kind> {
        Some(message_kinds::ANSWERED)
    }

    fn operator_headline(&self, _circumstances: Circumstances) -> Option<Headline> {
        let firm = &self.0.firm.firm_name;
        Some(Headline::new(
            notice_kinds::ANSWERED,
            format!("{firm} agrees to another time"),
        ))
    }

    fn changes_offers(&self) -> bool {
        true
    }
}
