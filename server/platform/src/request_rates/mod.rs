//! Counts of the requests of each caller, by which their rate is limited.
//!
//! Invariants: each process counts for itself, in windows of a minute or a day. A session or a token
//! is a caller only once it was accepted, so that nobody is a new caller with each invented one.

pub mod letters;

use std::collections::{HashMap, HashSet};
use std::sync::{Mutex, PoisonError};

/// Length of a window by default, seconds.
pub const WINDOW_S: u64 = 60;
/// Length of a window of uploads, seconds.
const DAY_S: u64 = 86_400;
/// Callers to remember at most; beyond that all begin anew.
const MOST_CALLERS: usize = 100_000;

/// Requests of each caller in the present window.
#[derive(Debug)]
pub struct RequestRates {
    window_s: u64,
    counts: Mutex<Counts>,
}

impl Default for RequestRates {
    fn default() -> RequestRates {
        RequestRates::in_windows_of(WINDOW_S)
    }
}

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
    /// Creates counts for windows of a day.
    pub fn daily() -> RequestRates {
        RequestRates::in_windows_of(DAY_S)
    }

    fn in_windows_of(window_s: u64) -> RequestRates {
        RequestRates {
            window_s,
            counts: Mutex::default(),
        }
    }

    /// Counts a request at a time, seconds since 1970.
    pub fn count(&self, caller: Vec<u8>, now_s: u64, limit: u32) -> Quota {
        let mut counts = self.counts.lock().unwrap_or_else(PoisonError::into_inner);
        let window = now_s / self.window_s;
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
            resets_in_s: self.window_s - now_s % self.window_s,
            is_exceeded,
        }
    }
}

/// Hashes of the sessions and tokens that were accepted lately.
#[derive(Debug, Default)]
pub struct AcceptedCredentials(Mutex<Generations>);

/// Hashes since the last turn, and those of the turn before. Each has half of the callers.
#[derive(Debug, Default)]
struct Generations {
    young: HashSet<Vec<u8>>,
    old: HashSet<Vec<u8>>,
}

impl AcceptedCredentials {
    /// Records that a credential was accepted.
    pub fn note(&self, hash: Vec<u8>) {
        let mut accepted = self.0.lock().unwrap_or_else(PoisonError::into_inner);
        if accepted.young.len() >= MOST_CALLERS / 2 {
            accepted.old = std::mem::take(&mut accepted.young);
        }
        accepted.young.insert(hash);
    }

    /// Checks whether a credential was accepted lately.
    pub fn contains(&self, hash: &[u8]) -> bool {
        let accepted = self.0.lock().unwrap_or_else(PoisonError::into_inner);
        accepted.young.contains(hash) || accepted.old.contains(hash)
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn accepted_credentials_are_remembered_within_bounds() {
        let accepted = AcceptedCredentials::default();
        for number in 0..=MOST_CALLERS {
            accepted.note(number.to_be_bytes().to_vec());
        }
        assert!(accepted.contains(&MOST_CALLERS.to_be_bytes()));
        assert!(!accepted.contains(&0_usize.to_be_bytes()));
        let kept = accepted.0.lock().unwrap();
        assert!(kept.young.len() + kept.old.len() <= MOST_CALLERS);
    }

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
