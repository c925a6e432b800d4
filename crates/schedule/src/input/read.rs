//! Reads an input from its text.

use super::{Checked, Input, check};

/// A fault of an input, with its place.
#[derive(Clone, Debug, PartialEq, Eq, thiserror::Error)]
#[error("{path}: {detail}")]
pub struct InputError {
    /// The JSON path, as `port_calls[3].eta`.
    pub path: String,
    /// The fault.
    pub detail: String,
}

impl InputError {
    pub(super) fn new(path: impl Into<String>, detail: impl Into<String>) -> InputError {
        InputError {
            path: path.into(),
            detail: detail.into(),
        }
    }
}

/// Reads and checks an input.
///
/// # Errors
/// The first fault.
pub fn read(text: &str) -> Result<Checked, InputError> {
    let mut json = serde_json::Deserializer::from_str(text);
    let input: Input = serde_path_to_error::deserialize(&mut json).map_err(|error| {
        let path = match error.path().to_string() {
            whole if whole == "." => "$".to_owned(),
            path => path,
        };
        InputError::new(path, error.inner().to_string())
    })?;
    json.end()
        .map_err(|error| InputError::new("$", error.to_string()))?;
    check::check(input)
}
