//! Error of a number outside its range.

/// Error of a number outside its range.
#[derive(Clone, Debug, PartialEq, thiserror::Error)]
#[error("{field}: {what}")]
pub struct NumberError {
    /// Name of the field, as in JSON.
    pub field: &'static str,
    /// Description of the error.
    pub what: String,
}
