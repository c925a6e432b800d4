//! Clock: the one place where this program reads the time.

use binnacle_compass::time::Timestamp;
use std::sync::Arc;
use std::sync::atomic::{AtomicI64, Ordering};
use std::time::{SystemTime, UNIX_EPOCH};

/// Source of the current time: the machine's clock, or one that a test sets.
#[derive(Clone, Debug, Default)]
pub enum Clock {
    /// The machine's clock.
    #[default]
    System,
    /// Clock that stands still until it is moved; microseconds since 1970.
    Manual(Arc<AtomicI64>),
}

impl Clock {
    /// Creates a clock that stands at `time` until [`Clock::advance`] moves it.
    pub fn manual(time: Timestamp) -> Clock {
        Clock::Manual(Arc::new(AtomicI64::new(time.micros())))
    }

    /// Returns the current time, UTC.
    #[allow(clippy::missing_panics_doc, reason = "it cannot: see the message")]
    pub fn now(&self) -> Timestamp {
        match self {
            Clock::System => system_time(),
            Clock::Manual(micros) => Timestamp::from_micros(micros.load(Ordering::SeqCst))
                .expect("a manual clock is only set from a Timestamp"),
        }
    }

    /// Advances a manual clock; the machine's clock is not affected.
    pub fn advance(&self, seconds: f64) {
        if let Clock::Manual(micros) = self {
            micros.store(self.now().plus_seconds(seconds).micros(), Ordering::SeqCst);
        }
    }
}

#[allow(
    clippy::disallowed_methods,
    reason = "the one function that reads the machine's clock"
)]
fn system_time() -> Timestamp {
    let since_1970 = SystemTime::now()
        .duration_since(UNIX_EPOCH)
        .unwrap_or_default();
    Timestamp::from_micros(since_1970.as_micros() as i64).expect("the year is before 9999")
}
