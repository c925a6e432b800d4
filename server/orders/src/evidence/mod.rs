//! Evidence of an adjustment: one archive that anyone can check.
//!
//! Invariants: the same state of an order gives the same bytes. The manifest names the SHA-256 of
//! every other file, each log entry that of the one before, and the completion that of the record.
//! Sheet and table are made from the record's text alone. The server signs each log entry when it is
//! written and the manifest when it makes the archive, so that neither can lose its end. [`verify()`]
//! needs nothing but the archive, and the server's published keys.

mod archive;
mod coverage;
mod findings;
mod seals;
mod sheets;
mod verify;

pub(crate) use archive::{Evidence, File, Line, archive};
pub use findings::Findings;
pub use sheets::{predicted_csv, record_pdf, record_svg};
pub use verify::verify;

/// Instructions for a check by hand, in every archive.
const README: &str = include_str!("README.txt");
