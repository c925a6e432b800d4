//! Events of the dispatch: offers to firms, their answers, other times, and messages.

mod accepted;
mod call_moved;
mod declined;
mod lapsed;
mod message;
mod offer_round;
mod offer_sent;
mod on_board;
mod proposal;
mod retime;

pub(crate) use accepted::Accepted;
pub(crate) use call_moved::CallMoved;
pub(crate) use declined::Declined;
pub(crate) use lapsed::Lapsed;
pub(crate) use message::MessageSent;
pub(crate) use offer_round::{OfferRound, OfferedFirm};
pub(crate) use offer_sent::OfferSent;
pub(crate) use on_board::Boarding;
pub(crate) use proposal::{ProposalAccepted, ProposalDeclined, Proposed};
pub(crate) use retime::{RetimeAccepted, RetimeDeclined, RetimeLapsed, RetimeProposed};
