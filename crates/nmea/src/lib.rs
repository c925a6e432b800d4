//! NMEA 0183 and IEC 61162-450 sentences, in and out.
//!
//! What always holds:
//! - A field left empty is `None`, never zero; values that a status or mode
//!   declares not valid are not handed out at all.
//! - Signs are settled at the parse: east, north, starboard and bow-up are
//!   positive, and the names say so. No letter E, W, N or S gets past it.
//! - A sentence without a checksum, or with a wrong one, is counted and never used.
//! - Numbers keep six decimals (positions a ten-millionth of a minute), so what
//!   [`write()`] prints, [`parse()`] reads back as the very same value.
//! - No allocation but in the buffers of the caller, bounded memory for any
//!   input, and no panic on any bytes.
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

pub mod datagram;
pub mod lines;
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

pub use lines::Lines;
pub use parse::{MAX_SENTENCE_BYTES, parse};
pub use rejected::Rejected;
pub use sentence::{Data, Kind, Sentence};
pub use tag::{Tag, Tagged, parse_tagged};
pub use tally::Tally;
pub use write::write;
