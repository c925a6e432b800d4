//! Counts of Signal K values.

use std::collections::BTreeMap;

/// Values by path, and rejected deltas and values by reason.
#[derive(Clone, Debug, Default)]
pub struct DeltaCounts {
    /// Values in use.
    pub values: BTreeMap<&'static str, u64>,
    /// Rejected deltas and values.
    pub rejected: BTreeMap<&'static str, u64>,
}

impl DeltaCounts {
    /// Adds the counts of others.
    pub fn add(&mut self, other: &DeltaCounts) {
        for (mine, more) in [
            (&mut self.values, &other.values),
            (&mut self.rejected, &other.rejected),
        ] {
            for (name, count) in more {
                *mine.entry(name).or_default() += count;
            }
        }
    }

    /// Counts a value in use.
    pub(crate) fn count_value(&mut self, path: &'static str) {
        *self.values.entry(path).or_default() += 1;
    }

    /// Counts a rejected delta or value.
    pub fn reject(&mut self, reason: &'static str) {
        *self.rejected.entry(reason).or_default() += 1;
    }
}
