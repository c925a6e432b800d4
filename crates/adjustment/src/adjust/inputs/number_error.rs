//! Error of a number outside its range.

/// A field of the form, and what is wrong with it.
#[derive(Clone, Debug, PartialEq, thiserror::Error)]
#[error("{field}: {what}")]
pub struct NumberError {
    /// The field, as in JSON.
    pub field: &'static str,
    /// What is wrong.
    pub what: String,
}
