//! The computer's clock, for the page and the pauses of the uplink only. Samples carry GNSS time
//! (see `binnacle_instruments`).

use binnacle_compass::time::Timestamp;

/// Returns the computer's time.
#[allow(
    clippy::disallowed_methods,
    reason = "the one place where the agent asks the computer for the time"
)]
pub(crate) fn now() -> Timestamp {
    Timestamp::from_micros(chrono::Utc::now().timestamp_micros())
        .expect("the present lies between the years 1 and 9999")
}
