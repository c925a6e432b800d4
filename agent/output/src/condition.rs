//! Condition behind an alert of bridge alert management.

use uuid::Uuid;

/// Condition behind an alert, as it is now.
#[derive(Clone, Debug, PartialEq, Eq)]
pub struct AlertCondition {
    /// Occurrence: another one is unacknowledged again.
    pub id: Uuid,
    /// Set while the condition holds.
    pub is_active: bool,
    /// Set once an officer has acknowledged this occurrence.
    pub is_acknowledged: bool,
    /// Title of at most 16 characters.
    pub title: &'static str,
    /// Description of at most 42 characters.
    pub description: String,
}
