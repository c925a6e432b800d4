//! Faults of a file of port calls, with their places.
//!
//! Invariant: however many lines are bad, [`FileErrors`] keeps the first
//! [`MAX_LISTED`] by line, and counts the others.

use std::fmt;

/// Maximum number of faults of a file that are listed.
pub const MAX_LISTED: usize = 50;
/// Maximum number of characters of a column's name, which repeats text of the file.
const MAX_FIELD_CHARS: usize = 60;
/// Maximum number of characters of a detail, which repeats text of the file.
const MAX_DETAIL_CHARS: usize = 400;

/// A fault of a file, with its place.
#[derive(Clone, Debug, PartialEq, Eq, PartialOrd, Ord, thiserror::Error)]
#[error("line {line}: {field}: {detail}")]
pub struct FileError {
    /// The line, from 1.
    pub line: usize,
    /// The column or property at fault.
    pub field: String,
    /// The fault.
    pub detail: String,
}

impl FileError {
    /// Builds the error of a column or property on a line.
    pub fn new(line: usize, field: &str, detail: impl Into<String>) -> FileError {
        let detail: String = detail.into();
        FileError {
            line,
            field: field.chars().take(MAX_FIELD_CHARS).collect(),
            detail: detail.chars().take(MAX_DETAIL_CHARS).collect(),
        }
    }
}

/// All faults of a file.
#[derive(Clone, Debug, Default, PartialEq, Eq)]
pub struct FileErrors {
    listed: Vec<FileError>,
    unlisted: usize,
}

impl FileErrors {
    /// Adds a fault.
    pub fn push(&mut self, error: FileError) {
        let at = self.listed.partition_point(|known| *known <= error);
        self.listed.insert(at, error);
        if self.listed.len() > MAX_LISTED {
            self.listed.pop();
            self.unlisted += 1;
        }
    }

    /// Returns `value` if there is no fault.
    ///
    /// # Errors
    /// Fails with the faults, if there are any.
    pub fn into_result<T>(self, value: T) -> Result<T, FileErrors> {
        if self.is_empty() {
            Ok(value)
        } else {
            Err(self)
        }
    }

    /// Returns true without faults.
    pub fn is_empty(&self) -> bool {
        self.listed.is_empty()
    }

    /// Returns the listed faults, by line.
    pub fn listed(&self) -> &[FileError] {
        &self.listed
    }
}

impl From<FileError> for FileErrors {
    fn from(error: FileError) -> FileErrors {
        FileErrors {
            listed: vec![error],
            unlisted: 0,
        }
    }
}

impl fmt::Display for FileErrors {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        for (at, error) in self.listed.iter().enumerate() {
            let between = if at == 0 { "" } else { "; " };
            write!(f, "{between}{error}")?;
        }
        match self.unlisted {
            0 => Ok(()),
            1 => f.write_str("; and 1 more"),
            more => write!(f, "; and {more} more"),
        }
    }
}

impl std::error::Error for FileErrors {}
