//! A value in a request to change something: left as it is, set, or taken away.

use serde::{Deserialize, Deserializer};

/// What is left out stays, null takes a value away.
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

impl<'de, T: Deserialize<'de>> Deserialize<'de> for Amended<T> {
    fn deserialize<D: Deserializer<'de>>(deserializer: D) -> Result<Self, D::Error> {
        Option::deserialize(deserializer).map(Amended::Set)
    }
}
