//! Findings of a check of the evidence.

/// What was found.
#[derive(Clone, Debug, Default)]
pub struct Findings {
    /// What is wrong, a sentence each; empty when all is well.
    pub problems: Vec<String>,
    /// What it is and says, a sentence each.
    pub facts: Vec<String>,
}

impl Findings {
    pub(super) fn wrong(&mut self, problem: impl Into<String>) {
        self.problems.push(problem.into());
    }
}
