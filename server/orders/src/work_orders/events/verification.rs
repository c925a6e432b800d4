//! Verdict of headings at sea on the prediction.

use crate::work_orders::events::event::{Circumstances, Event, Headline};
use crate::work_orders::order_state::OrderState;
use crate::work_orders::payload::sea_verification::SeaVerification;
use crate::work_orders::state::State;
use crate::work_orders::{message_kinds, notice_kinds};
use binnacle_adjustment::adjust::Verification;
use binnacle_platform::outbox;

impl Event for SeaVerification {
    fn apply(&self, state: &mut OrderState) {
        state.state = match self.verification {
            Verification::Passed { .. } => State::Verified,
            Verification::MoreNeeded { .. } => State::Adjusted,
            Verification::Alarm { .. } => State::Failed,
        };
        state.verification = Some(self.clone());
    }

    fn webhook(&self) -> Option<outbox::Kind> {
        Some(match self.verification {
            Verification::Passed { .. } => message_kinds::VERIFIED,
            Verification::MoreNeeded { .. } => message_kinds::UPDATED,
            Verification::Alarm { .. } => message_kinds::FAILED,
        })
    }

    fn operator_headline(&self, _circumstances: Circumstances) -> Option<Headline> {
        self.headline()
    }

    fn firm_headline(&self, _circumstances: Circumstances) -> Option<Headline> {
        self.headline()
    }

    fn quote(&self, _port: &str) -> Option<String> {
        Some(self.words.clone())
    }
}

impl SeaVerification {
    /// Headline for both sides.
    fn headline(&self) -> Option<Headline> {
        match self.verification {
            Verification::Passed { .. } => {
                Some(Headline::new(notice_kinds::VERIFIED, "verified at sea"))
            }
            Verification::Alarm { .. } => Some(Headline::new(
                notice_kinds::VERIFICATION_FAILED,
                "headings at sea do not confirm the adjustment",
            )),
            Verification::MoreNeeded { .. } => None,
        }
    }
}
