//! Events of the dispatch: offers to firms, their answers, other terms, and messages.

mod accepted;
mod call_moved;
mod declined;
mod lapsed;
mod message;
mod offer_round;
mod offer_sent;
mod on_board;
mod terms_accepted;
mod terms_declined;
mod terms_proposed;

pub(crate) use accepted::Accepted;
pub(crate) use call_moved::CallMoved;
pub(crate) use declined::Declined;
pub(crate) use lapsed::Lapsed;
pub(crate) use message::MessageSent;
pub(crate) use offer_round::{OfferRound, OfferedFirm};
pub(crate) use offer_sent::OfferSent;
pub(crate) use on_board::Boarding;
pub(crate) use terms_accepted::ProposalAccepted;
pub(crate) use terms_declined::ProposalDeclined;
pub(crate) use terms_proposed::Proposed;
