//! Weighing of hypotheses as rows arrive.

mod bank;
mod evidence_sums;
mod learning;
mod logged;
mod proposals;
pub(crate) mod told;
pub(crate) mod tracker;
