//! Acceptance of a firm's terms by the operator.

use crate::work_orders::events::event::{Circumstances, Event, Headline};
use crate::work_orders::offers::OfferState;
use crate::work_orders::order_state::OrderState;
use crate::work_orders::payload::exchange::Exchange;
use crate::work_orders::summary::Summary;
use crate::work_orders::{message_kinds, notice_kinds};
use binnacle_platform::outbox;
use serde::{Deserialize, Serialize};

/// Acceptance of a firm's terms by the operator.
#[derive(Clone, Debug, Serialize, Deserialize)]
#[serde(transparent)]
pub(crate) struct ProposalAccepted(pub Exchange);

impl Event for ProposalAccepted {
    fn apply(&self, state: &mut OrderState) {
        state.offers.set(&self.0, OfferState::Accepted);
        state.offers.withdraw_unless(OfferState::is_waiting);
        if let Some(terms) = &self.0.terms
            && state.hours != Some(terms.hours())
        {
            // A proposal of a fee alone leaves the time and its call as they are.
            state.agree_time(terms.hours());
        }
        state.follow_offers();
    }

    fn update_summary(&self, summary: &mut Summary) {
        summary.firm = Some(self.0.firm.firm_name.clone());
        (summary.adjuster_name, summary.adjuster_licence) = (None, None);
        summary.apply_terms(&self.0);
    }

    fn exchange(&self) -> Option<&Exchange> {
        Some(&self.0)
    }

    fn webhook(&self) -> Option<outbox::Kind> {
        Some(message_kinds::ANSWERED)
    }

    fn firm_headline(&self, _circumstances: Circumstances) -> Option<Headline> {
        Some(Headline::new(
            notice_kinds::ANSWERED,
            "your terms are accepted",
        ))
    }

    fn changes_offers(&self) -> bool {
        true
    }
}
