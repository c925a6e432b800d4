//! Persistent state of the agent: one SQLite file in the data directory.
//!
//! Invariants, also when the process is killed or the power fails at any point (WAL, every commit
//! synced):
//!
//! - A sample is in exactly one place: pending, or in one sealed batch.
//! - A sealed batch is never changed once it was tried. Before that it may be thinned to the
//!   limits, and says so, or be merged with the one sealed after it.
//! - Batches of a stream are numbered from 1 without gaps, and sent again byte for byte until they
//!   are acknowledged.
//! - A batch is deleted only when the server acknowledged that very batch and all before it, and
//!   then after a month or when the disk limit is reached. Its number, size and checksum stay on
//!   record. Until then it is sent again if the server lost it.
//! - An alert is stored together with the batch that carries it to the server.
//! - An officer's report or azimuth is here until the server has it.
//! - The rows are the only record of progress: no separate ledger could disagree with them.
//! - Not stored yet: samples of the last second or of the last [`crate::run::SAMPLES_PER_COMMIT`],
//!   whichever is less, and the open sample of at most ten minutes.

mod database;
mod keys;

mod account;
mod identity;
mod state;

mod acknowledged;
mod actions;
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
pub(crate) use actions::BoardAction;
pub(crate) use batches::SealedBatch;
pub(crate) use database::Spool;
pub(crate) use identity::Identity;
pub(crate) use repair::is_agent_running;
pub(crate) use reports::azimuths::SpooledAzimuth;
pub(crate) use reports::{ReportState, SaveReportError, StoredReport};
pub(crate) use seal::{Pending, Seal};
pub(crate) use status::SpoolStatus;
pub(crate) use thinning::{MAX_PENDING, is_disk_full};

#[cfg(test)]
pub(crate) mod tests;
