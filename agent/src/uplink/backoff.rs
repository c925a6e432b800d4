//! Pauses after failures: they grow, but never end the retries.

use rand::{Rng, RngExt};
use std::time::Duration;

/// Exponential backoff with full jitter above a minimum pause.
#[derive(Clone, Debug)]
pub(crate) struct Backoff {
    least: Duration,
    most: Duration,
    failures: u32,
}

impl Backoff {
    /// Creates a backoff with pauses between `least` and `most`.
    pub(crate) fn new(least: Duration, most: Duration) -> Backoff {
        Backoff {
            least,
            most: most.max(least),
            failures: 0,
        }
    }

    /// Resets the backoff after a success.
    pub(crate) fn reset(&mut self) {
        self.failures = 0;
    }

    /// Returns the pause after one more failure: a random value between the minimum and a limit
    /// that doubles each time, so that a fleet does not come back all at once.
    pub(crate) fn next(&mut self, rng: &mut impl Rng) -> Duration {
        self.failures = self.failures.saturating_add(1);
        let doubled = self
            .least
            .saturating_mul(2_u32.saturating_pow(self.failures));
        let limit = doubled.min(self.most);
        let spread = limit.saturating_sub(self.least);
        self.least + spread.mul_f64(rng.random::<f64>())
    }

    /// Returns the longest pause.
    pub(crate) fn most(&self) -> Duration {
        self.most
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use rand::SeedableRng;
    use rand::rngs::StdRng;

    #[test]
    fn pauses_grow_within_their_limits_and_start_anew_after_success() {
        let (least, most) = (Duration::from_secs(30), Duration::from_hours(1));
        let mut backoff = Backoff::new(least, most);
        let mut rng = StdRng::seed_from_u64(1);
        let pauses: Vec<Duration> = (0..200).map(|_| backoff.next(&mut rng)).collect();
        assert!(pauses.iter().all(|p| (least..=most).contains(p)));
        assert!(pauses[0] <= Duration::from_mins(1));
        assert!(pauses.iter().any(|p| *p > Duration::from_mins(50)));
        assert!(pauses[20..].iter().any(|p| *p < Duration::from_mins(10)));
        backoff.reset();
        assert!(backoff.next(&mut rng) <= Duration::from_mins(1));
    }
}
