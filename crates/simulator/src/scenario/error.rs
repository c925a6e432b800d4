//! Faults of a scenario, with their lines.

use std::ops::Range;

/// The reason why a file is not a scenario.
#[derive(Clone, Debug, PartialEq, Eq, thiserror::Error)]
pub enum ScenarioError {
    /// The file cannot be read.
    #[error("{file}: {error}")]
    Unreadable {
        /// The file.
        file: String,
        /// The system's error.
        error: String,
    },
    /// A field is missing, unknown or out of range.
    #[error("{file}:{line}: {field}: {problem}")]
    Field {
        /// The file.
        file: String,
        /// The line, counted from 1.
        line: usize,
        /// The key, or the known part of it.
        field: String,
        /// The fault.
        problem: String,
    },
}

/// A scenario's text, for finding lines.
pub(super) struct Source<'a> {
    pub(super) file: &'a str,
    pub(super) text: &'a str,
}

impl Source<'_> {
    pub(super) fn error(
        &self,
        span: Range<usize>,
        field: &str,
        problem: impl Into<String>,
    ) -> ScenarioError {
        ScenarioError::Field {
            file: self.file.to_owned(),
            line: self.line(span.start),
            field: field.to_owned(),
            problem: problem.into(),
        }
    }

    pub(super) fn toml(&self, error: &toml::de::Error) -> ScenarioError {
        let span = error.span().unwrap_or(0..0);
        let problem = error.message().lines().collect::<Vec<_>>().join(" ");
        let field = match problem.split('`').nth(1) {
            Some(name) if problem.contains(" field ") => name.to_owned(),
            _ => self.key_at(span.start),
        };
        self.error(span, &field, problem)
    }

    fn line(&self, offset: usize) -> usize {
        let before = self.text.as_bytes().iter().take(offset);
        before.filter(|&&byte| byte == b'\n').count() + 1
    }

    /// The text left of the nearest equals sign before the offset.
    fn key_at(&self, offset: usize) -> String {
        let line = self.text.lines().nth(self.line(offset) - 1).unwrap_or("");
        let key = line.split('=').next().unwrap_or("").trim();
        if key.is_empty() {
            "document".to_owned()
        } else {
            key.chars().take(60).collect()
        }
    }
}
