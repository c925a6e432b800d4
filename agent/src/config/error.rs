//! Errors of the configuration: file, line and field.

use super::document::Document;
use std::fs;
use std::ops::Range;
use std::path::{Path, PathBuf};
use std::string::FromUtf8Error;

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

impl ConfigError {
    /// Creates the error of a file in another encoding, as some editors write.
    pub(crate) fn not_text(path: &Path, error: &FromUtf8Error) -> ConfigError {
        let right = &error.as_bytes()[..error.utf8_error().valid_up_to()];
        ConfigError::Invalid {
            path: path.to_owned(),
            line: right.split(|&byte| byte == b'\n').count(),
            field: String::new(),
            problem: "this is not text in UTF-8: save the file in that encoding".to_owned(),
        }
    }

    /// Creates the error of a field of a file, given by its keys, that was read before.
    pub(crate) fn of_field(path: &Path, keys: &[&str], problem: String) -> ConfigError {
        // What was read a moment ago can be read, or has no line any more.
        let text = fs::read_to_string(path).unwrap_or_default();
        Problem::of_field(keys, problem).in_file(path, &text)
    }
}

/// Problem and its place in the text.
#[derive(Debug)]
pub(super) struct Problem {
    pub(super) place: Place,
    pub(super) problem: String,
}

/// Place of a problem.
#[derive(Debug)]
pub(super) enum Place {
    /// Bytes of the text; the whole text if there are none.
    Bytes(Option<Range<usize>>),
    /// Field by its keys, as [`Document::span_of`] takes them.
    Field(Vec<String>),
}

impl Problem {
    /// Creates a problem of a value that knows its position.
    pub(super) fn at(span: Range<usize>, problem: String) -> Problem {
        Problem {
            place: Place::Bytes(Some(span)),
            problem,
        }
    }

    /// Creates a problem of a field.
    pub(super) fn of_field(keys: &[&str], problem: String) -> Problem {
        let keys = keys.iter().map(|key| (*key).to_owned());
        Problem {
            place: Place::Field(keys.collect()),
            problem,
        }
    }

    pub(super) fn in_file(self, path: &Path, text: &str) -> ConfigError {
        let document = Document::read(text);
        let span = match &self.place {
            Place::Bytes(span) => span.clone(),
            Place::Field(keys) => document.span_of(keys),
        };
        let is_whole = span.as_ref().is_none_or(|span| *span == (0..0));
        let at = span.map_or(0, |span| span.start);
        let field = match &self.place {
            Place::Field(keys) => keys.iter().rev().find(|key| !is_number(key)).cloned(),
            // Of the whole text no field is at fault, whatever it begins with.
            Place::Bytes(_) if is_whole => None,
            // A missing field is named by the problem.
            Place::Bytes(_) => document.field_at(at).map(str::to_owned),
        };
        ConfigError::Invalid {
            path: path.to_owned(),
            line: document.line_at(at),
            field: field.map(|field| format!("{field}: ")).unwrap_or_default(),
            problem: self.problem,
        }
    }
}

fn is_number(key: &str) -> bool {
    key.bytes().all(|byte| byte.is_ascii_digit())
}
