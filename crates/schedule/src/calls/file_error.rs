//! Faults of a file of port calls, with their places.
//!
//! Invariant: however many lines are bad, [`FileErrors`] keeps the first
//! [`MAX_LISTED`] by line, and counts the others.

use std::fmt;

/// The most faults of a file that are listed.
pub const MAX_LISTED: usize = 50;
/// The most characters of a column's name and of a detail, which repeat text of
/// the file.
const LONGEST: (usize, usize) = (60, 400);

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
            field: field.chars().take(LONGEST.0).collect(),
            detail: detail.chars().take(LONGEST.1).collect(),
        }
    }
}

/// All faults of a file.
#[derive(Clone, Debug, Default, PartialEq, Eq)]
pub struct FileErrors {
    named: Vec<FileError>,
    more: usize,
}

impl FileErrors {
    /// Adds a fault.
    pub fn push(&mut self, error: FileError) {
        let at = self.named.partition_point(|known| *known <= error);
        self.named.insert(at, error);
        if self.named.len() > MAX_LISTED {
            self.named.pop();
            self.more += 1;
        }
    }

    /// Returns `made` if there is no fault, and otherwise the faults.
    ///
    /// # Errors
    /// Itself, unless it is empty.
    pub fn unless<T>(self, made: T) -> Result<T, FileErrors> {
        if self.is_empty() { Ok(made) } else { Err(self) }
    }

    /// True without faults.
    pub fn is_empty(&self) -> bool {
        self.named.is_empty()
    }

    /// The listed faults, by line.
    pub fn named(&self) -> &[FileError] {
        &self.named
    }
}

impl From<FileError> for FileErrors {
    fn from(error: FileError) -> FileErrors {
        FileErrors {
            named: vec![error],
            more: 0,
        }
    }
}

impl fmt::Display for FileErrors {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        for (at, error) in self.named.iter().enumerate() {
            let between = if at == 0 { "" } else { "; " };
            write!(f, "{between}{error}")?;
        }
        match self.more {
            0 => Ok(()),
            1 => f.write_str("; and 1 more"),
            more => write!(f, "; and {more} more"),
        }
    }
}

impl std::error::Error for FileErrors {}
