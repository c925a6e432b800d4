//! The wall clock, read in one place only.

use binnacle_compass::time::Timestamp;

/// Returns the current time.
#[allow(clippy::disallowed_methods, reason = "this is the one clock function")]
pub(crate) fn now() -> Timestamp {
    let since = std::time::SystemTime::now().duration_since(std::time::UNIX_EPOCH);
    let micros = since.map_or(0, |since| since.as_micros() as i64);
    Timestamp::from_micros(micros).expect("a computer's clock is between the years 1 and 9999")
}
