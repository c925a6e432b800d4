//! The evidence of an adjustment: one archive that anyone can check.
//!
//! What always holds: the same state of an order makes the same octets; the archive's
//! manifest names the SHA-256 of every other file in it, the log's entries name each
//! other's, and the completion names the record's; sheet and table are made from the
//! record's text alone. [`verify()`] needs nothing but the archive itself.

mod archive;
mod covered;
mod findings;
mod sheets;
mod verify;

pub use archive::{Evidence, File, Line, archive};
pub use findings::Findings;
pub use sheets::{predicted_csv, record_pdf, record_svg};
pub use verify::verify;

/// What says how to check it, in every archive.
const README: &str = include_str!("README.txt");
