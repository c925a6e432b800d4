//! Counts of the requests of each caller, by which their rate is limited.
//!
//! Invariants: each process counts for itself, in windows of a minute.

use std::collections::HashMap;
use std::sync::{Mutex, PoisonError};

/// Length of a window, seconds.
pub const WINDOW_S: u64 = 60;
/// Callers to remember at most; beyond that all begin anew.
const MOST_CALLERS: usize = 100_000;

/// Requests of each caller in the present window.
#[derive(Debug, Default)]
pub struct RequestRates(Mutex<Counts>);

#[derive(Debug, Default)]
struct Counts {
    window: u64,
    requests: HashMap<Vec<u8>, u32>,
}

/// Requests that a caller may still make in this window.
#[derive(Clone, Copy, Debug)]
pub struct Quota {
    /// Most requests in a window.
    pub limit: u32,
    /// Requests left.
    pub left: u32,
    /// Seconds until the next window.
    pub resets_in_s: u64,
    /// True if this request is one too many.
    pub is_exceeded: bool,
}

impl RequestRates {
    /// Counts a request at a time, seconds since 1970.
    pub fn count(&self, caller: Vec<u8>, now_s: u64, limit: u32) -> Quota {
        let mut counts = self.0.lock().unwrap_or_else(PoisonError::into_inner);
        let window = now_s / WINDOW_S;
        if counts.window != window || counts.requests.len() >= MOST_CALLERS {
            counts.window = window;
            counts.requests.clear();
        }
        let requests = counts.requests.entry(caller).or_default();
        let is_exceeded = *requests >= limit;
        *requests = requests.saturating_add(1);
        Quota {
            limit,
            left: limit.saturating_sub(*requests),
            resets_in_s: WINDOW_S - now_s % WINDOW_S,
            is_exceeded,
        }
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn each_caller_has_a_limit_that_begins_anew_with_the_minute() {
        let rates = RequestRates::default();
        let is_refused = |caller: u8, now_s| rates.count(vec![caller], now_s, 2).is_exceeded;
        assert!(!is_refused(1, 60));
        assert!(!is_refused(1, 61));
        assert!(is_refused(1, 119));
        assert!(!is_refused(2, 119));
        assert!(!is_refused(1, 120));
    }
}
