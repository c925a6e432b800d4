//! A value in a request to change something: left as it is, set, or taken away.

use serde::{Deserialize, Deserializer};

/// A change to one value: an omitted field keeps it, null removes it.
#[derive(Debug, Default)]
pub enum Amended<T> {
    /// As it is.
    #[default]
    Left,
    /// To this, or to none.
    Set(Option<T>),
}

impl<T> Amended<T> {
    /// The value, over what it was.
    pub fn over(self, was: Option<T>) -> Option<T> {
        match self {
            Amended::Left => was,
            Amended::Set(value) => value,
        }
    }
}

/// Reads a value that can be changed and not taken away: null is refused.
///
/// # Errors
/// When it is no such value.
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
