//! Tracking of a ship's magnetism by weighed hypotheses (multiple-hypothesis tracking).

mod hypotheses;
mod report;
mod state_space;
mod weighing;

pub use report::{Input, analyse};
