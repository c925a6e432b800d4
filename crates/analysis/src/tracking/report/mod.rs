//! Analysis of a compass as epochs, models and changes.

mod analysis;
mod told_changes;

pub use analysis::analyse;
