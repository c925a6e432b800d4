//! Acceptance of an offer by a firm.

use crate::work_orders::events::event::{Circumstances, Event, Headline};
use crate::work_orders::offers::OfferState;
use crate::work_orders::order_state::OrderState;
use crate::work_orders::payload::exchange::Exchange;
use crate::work_orders::summary::Summary;
use crate::work_orders::{message_kinds, notice_kinds};
use binnacle_platform::outbox;
use serde::{Deserialize, Serialize};

/// Acceptance of the order by a firm, as it was offered.
#[derive(Clone, Debug, Serialize, Deserialize)]
#[serde(transparent)]
pub(crate) struct Accepted(pub Exchange);

impl Event for Accepted {
    fn apply(&self, state: &mut OrderState) {
        state.offers.set(&self.0, OfferState::Accepted);
        state.offers.withdraw_unless(OfferState::is_waiting);
        state.follow_offers();
    }

    fn update_summary(&self, summary: &mut Summary) {
        summary.firm = Some(self.0.firm.firm_name.clone());
        summary.adjuster_name.clone_from(&self.0.adjuster_name);
        summary
            .adjuster_licence
            .clone_from(&self.0.adjuster_licence);
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
            format!("{firm} accepts the job"),
        ))
    }

    fn changes_offers(&self) -> bool {
        true
    }
}
