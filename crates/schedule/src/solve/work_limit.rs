//! Limits of work.
//!
//! Invariant: the unit is one look at a choice, or whatever takes about as long
//! (ten nanoseconds on a machine of 2026), never the clock. The same problem
//! has the same answer.

/// A limit of work.
#[derive(Clone, Copy, Debug)]
pub(super) struct WorkLimit {
    most: u64,
    spent: u64,
}

impl WorkLimit {
    pub(super) fn new(most: u64) -> WorkLimit {
        WorkLimit { most, spent: 0 }
    }

    pub(super) fn spend(&mut self, looks: usize) {
        self.spent = self.spent.saturating_add(looks as u64);
    }

    pub(super) fn is_spent(&self) -> bool {
        self.spent >= self.most
    }

    /// Number of steps left, at `looks` each.
    pub(super) fn steps(&self, looks: usize) -> usize {
        let steps = self.most.saturating_sub(self.spent) / (looks.max(1) as u64);
        usize::try_from(steps).unwrap_or(usize::MAX)
    }

    pub(super) fn spent(&self) -> u64 {
        self.spent
    }
}
