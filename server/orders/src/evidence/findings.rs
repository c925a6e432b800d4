//! Findings of a check of the evidence.

/// Result of a check.
#[derive(Clone, Debug, Default)]
pub struct Findings {
    /// Problems, a sentence each; empty when all is well.
    pub problems: Vec<String>,
    /// Facts, a sentence each.
    pub facts: Vec<String>,
}

impl Findings {
    pub(super) fn wrong(&mut self, problem: impl Into<String>) {
        self.problems.push(problem.into());
    }
}
