//! From batches to models: the queue, the worker, and what an analysis leaves.
//!
//! What always holds:
//!
//! - An analysis is a function of its input; the same input is not analysed twice,
//!   and makes no second model version.
//! - No transaction is open while an analysis runs. What it found is stored in one
//!   transaction, and only by the process that still holds the job's lease.
//! - A server that starts with another estimator than a vessel's analysis was made
//!   with analyses that vessel again.
//! - One job waits for each vessel, however many batches come; a batch that comes
//!   while one runs makes the next.

mod disturbances;
mod findings;
pub mod input;
mod left_out;
pub mod queue;
pub mod store;
mod track;
mod wait;

pub use disturbances::{compare_with_fleet, compare_with_fleet_in};
pub use findings::{FailedLately, Findings, FoundChange};
pub use input::{Input, input_hash};
pub use left_out::LeftOut;
pub use queue::{Job, claim, count as count_jobs, enqueue, enqueue_outdated, renew};
pub use store::{Chunk, Covered, Found, chunk, chunks, chunks_between, coverage, refusal};
pub use track::Track;
pub use wait::done;
