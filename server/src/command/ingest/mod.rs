//! `bursts` and `import`: what came to the log by another way than an agent's link.

mod bursts;
mod import;
mod samples;
mod stream;

pub use bursts::bursts;
pub use import::import;
pub use samples::{Import, ImportedSamples, import_samples};
