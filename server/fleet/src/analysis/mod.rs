//! Analysis of a vessel's batches: its input, its findings, and their storage.
//!
//! Invariants:
//!
//! - An analysis is a function of its input. The same input is not analysed twice, and makes no
//!   second model version.
//! - It is a fold over segments, of which the last states are kept: a cache of the log. Removing the
//!   cache changes nothing.
//! - No transaction is open while an analysis runs. One transaction stores its results, and only if
//!   the process still holds the job's lease.
//! - A server with a new estimator analyses again the vessels that an older one analysed.
//! - One job waits for each vessel, however many batches arrive. A batch that arrives while one
//!   runs enqueues the next.

mod disturbances;
mod findings;
pub mod input;
mod interference;
mod packed;
mod sealed;
pub mod segments;
pub mod store;
mod track;

pub use disturbances::{compare_with_fleet, compare_with_fleet_in};
pub use findings::{ChangeFinding, FailedLately, Findings};
pub use interference::{Interference, recent_interference};
pub use segments::{Chunk, chunk, chunks_between, samples};
pub use store::{AnalysisResult, Covered, coverage};
pub use track::Track;
