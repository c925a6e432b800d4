//! Errors in the user's input.

use crate::config::ConfigError;

/// A mistake in the user's input: exit code 2.
#[derive(Debug, thiserror::Error)]
#[error("{0}")]
pub(super) struct BadInput(pub(super) String);

impl From<ConfigError> for BadInput {
    fn from(error: ConfigError) -> BadInput {
        BadInput(error.to_string())
    }
}
