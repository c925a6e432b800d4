//! Forms in which arrays of states are kept: plain sequences of numbers.

use super::states::STATES;
use serde::de::Error;
use serde::{Deserialize, Deserializer, Serialize, Serializer};

/// Vector of the states.
pub(crate) mod vector {
    use super::{Deserialize, Deserializer, Error, STATES, Serialize, Serializer};

    pub(crate) fn serialize<S: Serializer>(
        values: &[f64; STATES],
        serializer: S,
    ) -> Result<S::Ok, S::Error> {
        values.as_slice().serialize(serializer)
    }

    pub(crate) fn deserialize<'de, D: Deserializer<'de>>(
        deserializer: D,
    ) -> Result<[f64; STATES], D::Error> {
        let values = Vec::<f64>::deserialize(deserializer)?;
        let count = values.len();
        values
            .try_into()
            .map_err(|_| D::Error::invalid_length(count, &"as many numbers as there are states"))
    }
}

/// Matrix of the states, row by row.
pub(crate) mod matrix {
    use super::{Deserialize, Deserializer, Error, STATES, Serialize, Serializer};

    pub(crate) fn serialize<S: Serializer>(
        rows: &[[f64; STATES]; STATES],
        serializer: S,
    ) -> Result<S::Ok, S::Error> {
        rows.as_flattened().serialize(serializer)
    }

    pub(crate) fn deserialize<'de, D: Deserializer<'de>>(
        deserializer: D,
    ) -> Result<Box<[[f64; STATES]; STATES]>, D::Error> {
        let values = Vec::<f64>::deserialize(deserializer)?;
        let mut rows = Box::new([[0.0; STATES]; STATES]);
        if values.len() != STATES * STATES {
            let expected = &"a row of numbers for each state";
            return Err(D::Error::invalid_length(values.len(), expected));
        }
        rows.as_flattened_mut().copy_from_slice(&values);
        Ok(rows)
    }
}
