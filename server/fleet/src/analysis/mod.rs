//! Analysis of a vessel's batches: its input, its findings, and their storage.
//!
//! Invariants:
//!
//! - An analysis is a function of its input. The same input is not analysed twice, and makes no
//!   second model version.
//! - No transaction is open while an analysis runs. One transaction stores its results, and only if
//!   the process still holds the job's lease.
//! - A server with a new estimator analyses again the vessels that an older one analysed.
//! - One job waits for each vessel, however many batches arrive. A batch that arrives while one
//!   runs enqueues the next.

mod disturbances;
mod findings;
pub mod input;
mod interference;
pub mod store;
mod track;

pub use disturbances::{compare_with_fleet, compare_with_fleet_in};
pub use findings::{ChangeFinding, FailedLately, Findings};
pub use input::{Input, input_hash};
pub use interference::{Interference, recent_interference};
pub use store::{AnalysisResult, Chunk, Covered, chunk, chunks, chunks_between, coverage};
pub use track::Track;
