//! Signal K deltas, from a server or a recording.

mod counts;
mod delta;
mod value;

pub use counts::DeltaCounts;
pub use delta::{DeltaReader, PATHS};
