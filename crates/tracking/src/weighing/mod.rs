//! Weighing of hypotheses as rows arrive.

mod detected;
mod evidence_sums;
mod learning;
mod logged;
mod proposals;
pub(crate) mod records;
mod selection;
pub(crate) mod tracker;
