//! Findings of one compass's analysis, as alerts, the timeline and the needs read them.
//!
//! Invariant: they are small enough to be stored beside the analysis, so that changed limits change
//! alerts without another analysis.

mod change_findings;
mod summary;

pub use change_findings::ChangeFinding;
pub use summary::{FailedLately, Findings};
