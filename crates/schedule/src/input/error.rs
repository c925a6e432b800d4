//! The error of an input.

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
