//! Weighing of hypotheses as rows arrive.

mod bank;
mod detected;
mod evidence_sums;
mod learning;
mod logged;
mod proposals;
pub(crate) mod records;
pub(crate) mod tracker;
