//! Why something is no binnacle.

/// Names the field, as in JSON, and says what is wrong with it.
#[derive(Clone, Debug, PartialEq, Eq, thiserror::Error)]
#[error("{field}: {what}")]
pub struct BinnacleError {
    /// The path of the field, such as `athwartship.holes[2].below_card_mm`.
    pub field: String,
    /// What is wrong.
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
