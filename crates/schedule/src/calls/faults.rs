//! What is wrong with a file of port calls, and where.
//!
//! What always holds: however many lines are wrong, [`FileErrors`] keeps [`MOST_NAMED`] of
//! them, the first by their lines, and the number of the others.

use std::fmt;

/// No more faults of a file are named.
pub const MOST_NAMED: usize = 50;
/// No column's name and no word on it is longer, in characters: they repeat what is in the file.
const LONGEST: (usize, usize) = (60, 400);

/// What is wrong with a file, and where.
#[derive(Clone, Debug, PartialEq, Eq, PartialOrd, Ord, thiserror::Error)]
#[error("line {line}: {field}: {detail}")]
pub struct FileError {
    /// The line, from 1.
    pub line: usize,
    /// The column or property at fault.
    pub field: String,
    /// What is wrong with it.
    pub detail: String,
}

impl FileError {
    /// What is wrong with a column or property of a line.
    pub fn new(line: usize, field: &str, detail: impl Into<String>) -> FileError {
        let detail: String = detail.into();
        FileError {
            line,
            field: field.chars().take(LONGEST.0).collect(),
            detail: detail.chars().take(LONGEST.1).collect(),
        }
    }
}

/// Everything that is wrong with a file.
#[derive(Clone, Debug, Default, PartialEq, Eq)]
pub struct FileErrors {
    named: Vec<FileError>,
    more: usize,
}

impl FileErrors {
    /// One more fault.
    pub fn push(&mut self, error: FileError) {
        let at = self.named.partition_point(|known| *known <= error);
        self.named.insert(at, error);
        if self.named.len() > MOST_NAMED {
            self.named.pop();
            self.more += 1;
        }
    }

    /// What was made where nothing is wrong, else everything that is.
    ///
    /// # Errors
    /// Itself, unless it is empty.
    pub fn unless<T>(self, made: T) -> Result<T, FileErrors> {
        if self.is_empty() { Ok(made) } else { Err(self) }
    }

    /// Whether nothing is wrong.
    pub fn is_empty(&self) -> bool {
        self.named.is_empty()
    }

    /// The faults that are named, by line.
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
