//! Errors of the configuration: file, line and field.

use std::ops::Range;
use std::path::{Path, PathBuf};

/// Reason that a configuration cannot be used, in one line.
#[derive(Debug, thiserror::Error)]
pub(crate) enum ConfigError {
    /// The file does not exist or cannot be read.
    #[error("{}: {source}", path.display())]
    Unreadable {
        /// Configuration file.
        path: PathBuf,
        /// Error of the system.
        source: std::io::Error,
    },
    /// A value is invalid.
    #[error("{}:{line}: {field}{problem}", path.display())]
    Invalid {
        /// Configuration file.
        path: PathBuf,
        /// Line, counted from 1.
        line: usize,
        /// Key before the value, with a colon; empty when there is none.
        field: String,
        /// Description of the mistake.
        problem: String,
    },
}

/// Problem and its position in the text.
pub(super) struct Problem {
    pub(super) span: Option<Range<usize>>,
    pub(super) problem: String,
}

impl Problem {
    pub(super) fn in_file(self, path: &Path, text: &str) -> ConfigError {
        let at = self.span.map_or(0, |span| span.start.min(text.len()));
        let before = text.get(..at).unwrap_or_default();
        let line_start = before.rfind('\n').map_or(0, |newline| newline + 1);
        ConfigError::Invalid {
            path: path.to_owned(),
            line: before.matches('\n').count() + 1,
            field: key_before(&text[line_start..at]),
            problem: self.problem,
        }
    }
}

/// Returns the key before a value: `interval_s = ` gives `interval_s: `, `{ input = "a", talker = `
/// gives `talker: `.
fn key_before(text: &str) -> String {
    let Some((left, _)) = text.rsplit_once('=') else {
        return String::new();
    };
    let key = left
        .trim_end()
        .rsplit(|c: char| !(c.is_alphanumeric() || c == '_' || c == '-'))
        .next();
    match key {
        Some(key) if !key.is_empty() => format!("{key}: "),
        _ => String::new(),
    }
}
