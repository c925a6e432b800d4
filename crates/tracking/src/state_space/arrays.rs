//! Forms in which arrays of states are kept: plain sequences of numbers, in single precision.

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
        values.map(|x| x as f32).as_slice().serialize(serializer)
    }

    pub(crate) fn deserialize<'de, D: Deserializer<'de>>(
        deserializer: D,
    ) -> Result<[f64; STATES], D::Error> {
        let values = Vec::<f32>::deserialize(deserializer)?;
        let count = values.len();
        let values = <[f32; STATES]>::try_from(values);
        values
            .map(|values| values.map(f64::from))
            .map_err(|_| D::Error::invalid_length(count, &"as many numbers as there are states"))
    }
}

/// Symmetric matrix of the states: its upper half, row by row.
pub(crate) mod matrix {
    use super::{Deserialize, Deserializer, Error, STATES, Serialize, Serializer};

    pub(crate) fn serialize<S: Serializer>(
        rows: &[[f64; STATES]; STATES],
        serializer: S,
    ) -> Result<S::Ok, S::Error> {
        let upper = rows.iter().enumerate().flat_map(|(i, row)| &row[i..]);
        let upper = upper.map(|x| *x as f32);
        upper.collect::<Vec<f32>>().serialize(serializer)
    }

    pub(crate) fn deserialize<'de, D: Deserializer<'de>>(
        deserializer: D,
    ) -> Result<Box<[[f64; STATES]; STATES]>, D::Error> {
        let values = Vec::<f32>::deserialize(deserializer)?;
        if values.len() != STATES * (STATES + 1) / 2 {
            let expected = &"half a row of numbers for each state";
            return Err(D::Error::invalid_length(values.len(), expected));
        }
        let mut rows = Box::new([[0.0; STATES]; STATES]);
        let mut values = values.into_iter();
        for i in 0..STATES {
            for (j, value) in (i..STATES).zip(&mut values) {
                rows[i][j] = f64::from(value);
                rows[j][i] = f64::from(value);
            }
        }
        Ok(rows)
    }
}
