//! Recordings: files that a logger, a voyage data recorder or a server has written.
//!
//! Invariants:
//!
//! - Each line is one of NMEA 2000 ([`binnacle_nmea::n2k::text`]) or has one of the formats of
//!   [`binnacle_nmea::recording::LineFormat`], and each format one parser in `decoder.rs`. A
//!   stream or EBL file of an Actisense gateway has no lines.
//! - The time of a line is that which the logger gave it. Where it gave none, it is that of the
//!   receivers in the recording.
//! - Each line that was not understood is counted by reason, with the number of the first.
//! - No bytes cause a panic, and memory is bounded for any file.
//!
//! Another format of lines is a variant of `LineFormat` with its start in
//! `binnacle_nmea::recording`, and an arm with its parser in `LineReader::line`. A format without
//! lines is another reader behind [`Decoder::chunk`].

mod decoder;
mod file_clock;
mod lines;
mod not_understood;
mod open;
mod plan;
mod reader;
mod survey;

#[cfg(test)]
mod tests;

pub use decoder::{Decoder, Recorded, RollOver};
pub use not_understood::{NotUnderstood, Rejections};
pub use plan::Plan;
pub use reader::{Chunk, RecordingReader};
pub use survey::{Instruments, LoggerClock, Survey};
