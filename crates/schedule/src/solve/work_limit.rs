//! Limits of work.
//!
//! Invariant: the unit is one check of a choice, or what takes about as long
//! (ten nanoseconds on a machine of 2026), never the clock. The same problem
//! has the same answer.

/// A limit of work.
#[derive(Clone, Copy, Debug)]
pub(super) struct WorkLimit {
    max: u64,
    spent: u64,
}

impl WorkLimit {
    pub(super) fn new(max: u64) -> WorkLimit {
        WorkLimit { max, spent: 0 }
    }

    pub(super) fn spend(&mut self, units: usize) {
        self.spent = self.spent.saturating_add(units as u64);
    }

    pub(super) fn is_spent(&self) -> bool {
        self.spent >= self.max
    }

    /// Returns the number of steps left, at `units` each.
    pub(super) fn steps(&self, units: usize) -> usize {
        let steps = self.max.saturating_sub(self.spent) / (units.max(1) as u64);
        usize::try_from(steps).unwrap_or(usize::MAX)
    }

    pub(super) fn spent(&self) -> u64 {
        self.spent
    }
}
