//! NMEA 0183 and IEC 61162-450 sentences, read and written; NMEA 2000 in [`n2k`].
//!
//! Invariants:
//! - An empty field is `None`, never zero. Values that a status or mode
//!   declares not valid are not returned.
//! - Signs are settled by the parser: east, north, starboard and bow-up are
//!   positive, and the names say so. No letter E, W, N or S is passed on.
//! - A sentence without a checksum, or with a wrong one, is counted and never
//!   used.
//! - Numbers keep six decimals (positions a ten-millionth of a minute).
//!   [`parse()`] reads back exactly the value that [`write()`] printed.
//! - Sentences allocate nothing outside the caller's buffers. Memory is bounded
//!   for any input, and no bytes cause a panic.
//!
//! ```
//! use binnacle_nmea::{Data, parse};
//!
//! let heading = parse(b"$HCHDG,98.3,1.5,W,12.6,E*53").unwrap();
//! assert_eq!(&heading.talker, b"HC");
//! let Data::Hdg(hdg) = heading.data else { unreachable!() };
//! assert_eq!(hdg.reading_deg, Some(98.3));
//! assert_eq!(hdg.deviation_deg_east, Some(-1.5));
//! assert_eq!(hdg.variation_deg_east, Some(12.6));
//! ```

pub mod alert;
pub mod datagram;
pub mod lines;
pub mod n2k;
pub mod recording;
pub mod rejected;
pub mod sentence;
pub mod tag;
pub mod tally;
pub mod time;

mod checksum;
mod fields;
mod parse;
mod print;
mod write;

pub use checksum::with_checksum;
pub use lines::Lines;
pub use parse::{MAX_SENTENCE_BYTES, parse};
pub use rejected::Rejected;
pub use sentence::{Data, Kind, Sentence};
pub use tag::{Tag, Tagged, parse_tagged};
pub use tally::Tally;
pub use write::write;
