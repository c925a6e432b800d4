//! Errors of the one who typed the command.

use crate::config::ConfigError;

/// What the one who typed it got wrong.
#[derive(Debug, thiserror::Error)]
#[error("{0}")]
pub(super) struct BadInput(pub(super) String);

impl From<ConfigError> for BadInput {
    fn from(error: ConfigError) -> BadInput {
        BadInput(error.to_string())
    }
}
