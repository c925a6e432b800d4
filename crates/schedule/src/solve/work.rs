//! Work that is counted, so that no problem runs away.
//!
//! What always holds: the unit is a look at one choice, or what takes about as long (ten
//! nanoseconds on a machine of 2026), never the clock: the same problem, the same answer.

/// A limit of work.
#[derive(Clone, Copy, Debug)]
pub(super) struct Work {
    most: u64,
    spent: u64,
}

impl Work {
    pub(super) fn new(most: u64) -> Work {
        Work { most, spent: 0 }
    }

    pub(super) fn spend(&mut self, looks: usize) {
        self.spent = self.spent.saturating_add(looks as u64);
    }

    pub(super) fn is_spent(&self) -> bool {
        self.spent >= self.most
    }

    /// How many steps of so many looks are left.
    pub(super) fn steps(&self, looks: usize) -> usize {
        let steps = self.most.saturating_sub(self.spent) / (looks.max(1) as u64);
        usize::try_from(steps).unwrap_or(usize::MAX)
    }

    pub(super) fn spent(&self) -> u64 {
        self.spent
    }
}
