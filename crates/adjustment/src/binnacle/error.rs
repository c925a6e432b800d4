//! Error of an invalid binnacle.

/// Error of an invalid binnacle, with the field as in JSON.
#[derive(Clone, Debug, PartialEq, Eq, thiserror::Error)]
#[error("{field}: {what}")]
pub struct BinnacleError {
    /// Path of the field, such as `athwartship.holes[2].below_card_mm`.
    pub field: String,
    /// Description of the error.
    pub what: String,
}

impl BinnacleError {
    pub(crate) fn new(field: impl Into<String>, what: impl Into<String>) -> BinnacleError {
        BinnacleError {
            field: field.into(),
            what: what.into(),
        }
    }
}
