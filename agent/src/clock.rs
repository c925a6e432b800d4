//! The computer's clock: for the page and the uplink's pauses only. Samples
//! carry the ship's own time (see [`crate::instruments::gnss_clock`]).

use binnacle_magnetics::time::Timestamp;

/// The time now, as the computer has it.
#[allow(
    clippy::disallowed_methods,
    reason = "the one place where the agent asks the computer for the time"
)]
pub(crate) fn now() -> Timestamp {
    Timestamp::from_micros(chrono::Utc::now().timestamp_micros())
        .expect("the present lies between the years 1 and 9999")
}
