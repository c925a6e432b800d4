//! Settings by which a recording is decoded.

use binnacle_compass::time::Timestamp;
use binnacle_nmea::recording::DateOrder;

/// Period of the week numbers of GPS (IS-GPS-200, 20.3.3.3.1.1).
pub(super) const ROLL_OVER_MICROS: i64 = 1_024 * 7 * 86_400_000_000;

/// Settings by which a recording is decoded.
#[derive(Clone, Copy, Debug, Default, PartialEq)]
pub struct Plan {
    /// Order of day and month in dates with slashes.
    pub order: DateOrder,
    /// Time by which the logger's clock is ahead, microseconds.
    pub logger_ahead_micros: i64,
    /// Cycles of 1,024 weeks that are added to the dates of receivers.
    pub roll_overs: i64,
    /// Set if its sentences are read without checksums, for none has one.
    pub without_checksums: bool,
    /// Time near which the recording lies, for lines with a time of day alone.
    pub near: Option<Timestamp>,
}
