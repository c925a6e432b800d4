//! Analysis of a compass as epochs, models and changes.

mod analysis;
mod course_use;
mod detected_changes;

pub use analysis::{Input, analyse};
