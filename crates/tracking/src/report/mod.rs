//! Analysis of a compass as epochs, models and changes.

mod analysis;
mod by_course;
mod cargo_entries;
mod causes;
mod changes;
mod diagnostics;
mod epochs;
mod faults;
mod fold;
mod input;
mod kept;
mod marked_readings;
mod notices;
mod overlaps;
mod past;
mod predictions;
mod references;
mod row_times;
mod voyage;

pub use fold::analyse;
pub use input::{Input, Part};
pub(crate) use marked_readings::refused_references;
pub use voyage::Voyage;
