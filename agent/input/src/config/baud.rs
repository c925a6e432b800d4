//! Bits per second of a serial port.

use serde::{Deserialize, Deserializer};

/// Rates of serial ports.
const RATES: std::ops::RangeInclusive<i64> = 300..=4_000_000;

/// Reads a rate from 300 to 4 000 000 bits per second.
pub(super) fn baud<'de, D: Deserializer<'de>>(deserializer: D) -> Result<u32, D::Error> {
    let rate = i64::deserialize(deserializer)?;
    let possible = RATES.contains(&rate).then(|| u32::try_from(rate).ok());
    possible.flatten().ok_or_else(|| {
        serde::de::Error::custom(format!("{rate} is not from 300 to 4000000 bits per second"))
    })
}

/// Reads a rate that may be absent.
pub(super) fn some_baud<'de, D: Deserializer<'de>>(d: D) -> Result<Option<u32>, D::Error> {
    baud(d).map(Some)
}
