//! What must outlive the agent: one SQLite file in the data directory.
//!
//! What always holds, also when the process is killed or the power fails at any
//! point (WAL, every commit synced):
//!
//! - A sample is in exactly one place: pending, or in one sealed batch.
//! - A sealed batch is never changed once it was tried; before that it may be thinned
//!   for want of room, and says so, or take in the one that was sealed after it. Batches of a stream are numbered from 1 without
//!   gaps, and sent again byte for byte until they are acknowledged.
//! - A batch is deleted only when the shore acknowledged that very batch and
//!   everything before it, and a month later or when room is short; a record of its
//!   number, size and checksum remains. Until then it is sent again if the shore lost it.
//! - An alert and the batch that carries it ashore are here from the same moment on.
//! - An officer's report is here until the shore has it.
//! - Position and data are one thing: there is no ledger beside the rows that
//!   could disagree with them.
//! - What is not in here yet: samples of the last second or of the last
//!   [`crate::run::SAMPLES_PER_COMMIT`], whichever is less, and the stretch of at most
//!   ten minutes that the sampler is still in.

mod database;
mod keys;

mod account;
mod identity;
mod state;

mod acknowledged;
mod batches;
mod merge;
mod reports;
mod seal;
mod short_bursts;
mod status;
mod thinning;

mod enrolment;
mod repair;

pub(crate) use account::{BudgetAccount, REQUEST_BYTES};
pub(crate) use batches::SealedBatch;
pub(crate) use database::Spool;
pub(crate) use identity::Identity;
pub(crate) use reports::{ReportState, SaveReportError, StoredReport};
pub(crate) use seal::{Pending, Seal};
pub(crate) use status::SpoolStatus;
pub(crate) use thinning::{MAX_PENDING, is_disk_full};

#[cfg(test)]
pub(crate) mod tests;
