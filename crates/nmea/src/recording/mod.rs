//! Lines as loggers record them: the bytes of an instrument, with a time and a
//! device's name before or behind them.
//!
//! Invariants:
//! - No logger is known by name. Content begins where a sentence or a delta can
//!   begin, and everything around it is searched for a time.
//! - A time is used only if it names a whole date and time of day, or a time of
//!   day alone. A time without a zone is UTC.
//! - Nothing is allocated, and no bytes cause a panic.
//!
//! ```
//! use binnacle_nmea::recording::{DateOrder, LineFormat, Stamp, split};
//!
//! let line = b"03/15/2010,14:08:45.876,$HEHDT,146.2,T*2E";
//! let recorded = split(line, DateOrder::MonthFirst).unwrap();
//! assert_eq!(recorded.format, LineFormat::Sentence);
//! assert_eq!(recorded.content, b"$HEHDT,146.2,T*2E");
//! assert_eq!(recorded.stamp, Some(Stamp::Instant(1_268_662_125_876_000)));
//! ```

mod content;
mod digits;
mod moment;
mod stamp;

pub use moment::DateOrder;
pub use stamp::{Stamp, read_stamp};

use content::{delta_end, find_start, sentence_end};

/// Format of a line's content. Each has one parser.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum LineFormat {
    /// An NMEA 0183 sentence, TAG blocks included.
    Sentence,
    /// A Signal K delta as JSON.
    Delta,
}

/// A recorded line in its parts.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub struct RecordedLine<'a> {
    /// Time that the logger gave the line.
    pub stamp: Option<Stamp>,
    /// Format of the content.
    pub format: LineFormat,
    /// Bytes of the instrument.
    pub content: &'a [u8],
    /// Bytes behind the content, in which another may begin.
    pub rest: &'a [u8],
}

/// Splits a line; `None` when no known content begins in it.
pub fn split(line: &[u8], order: DateOrder) -> Option<RecordedLine<'_>> {
    let (start, format) = find_start(line)?;
    let (before, from_start) = line.split_at(start);
    let end = match format {
        LineFormat::Sentence => sentence_end(from_start, before),
        LineFormat::Delta => delta_end(from_start),
    };
    let (content, rest) = from_start.split_at(end);
    let stamp = if before.is_empty() && rest.is_empty() {
        None
    } else {
        read_stamp(before, order).or_else(|| read_stamp(behind(rest), order))
    };
    Some(RecordedLine {
        stamp,
        format,
        content,
        rest,
    })
}

/// Returns the part of the rest that belongs to this content, not to a next one.
fn behind(rest: &[u8]) -> &[u8] {
    let end = find_start(rest).map_or(rest.len(), |(start, _)| start);
    &rest[..end]
}

#[cfg(test)]
mod tests;
