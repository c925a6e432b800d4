//! Optional value in a change request: kept, set or removed.

use serde::{Deserialize, Deserializer};

/// Change to one value: an omitted field keeps it, null removes it.
#[derive(Debug, Default)]
pub enum Amended<T> {
    /// Kept.
    #[default]
    Left,
    /// Set to this value, or removed.
    Set(Option<T>),
}

impl<T> Amended<T> {
    /// Returns the new value, given the old one.
    pub fn over(self, was: Option<T>) -> Option<T> {
        match self {
            Amended::Left => was,
            Amended::Set(value) => value,
        }
    }
}

/// Deserializes a value that can be changed but not removed: null is rejected.
///
/// # Errors
/// Fails when the value is null or invalid.
pub fn never_null<'de, D: Deserializer<'de>, T: Deserialize<'de>>(
    deserializer: D,
) -> Result<Option<T>, D::Error> {
    T::deserialize(deserializer).map(Some)
}

impl<'de, T: Deserialize<'de>> Deserialize<'de> for Amended<T> {
    fn deserialize<D: Deserializer<'de>>(deserializer: D) -> Result<Self, D::Error> {
        Option::deserialize(deserializer).map(Amended::Set)
    }
}
