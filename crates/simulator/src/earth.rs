//! The earth's field where the ship is, in the one place that asks for it.

use binnacle_compass::field::{Field, FieldAt, FieldError, FieldModel};
use binnacle_compass::position::Position;
use binnacle_compass::time::Timestamp;

/// The coefficients are made anew when they are this old; the field changes by
/// less than a third of a nanotesla in that time.
const DAY_S: f64 = 86_400.0;

/// IGRF-14 at sea level, at the ship's time.
#[derive(Clone, Debug)]
pub(crate) struct Chart {
    drawn: Timestamp,
    field: FieldAt,
}

impl Chart {
    pub(crate) fn new(time: Timestamp) -> Result<Chart, FieldError> {
        let field = FieldAt::from_time(FieldModel::Igrf14, time)?;
        Ok(Chart { drawn: time, field })
    }

    /// The field at a place. Beyond the model's last day its last chart serves.
    pub(crate) fn field(&mut self, position: Position, time: Timestamp) -> Field {
        if time.seconds_since(self.drawn) > DAY_S
            && let Ok(newer) = Chart::new(time)
        {
            *self = newer;
        }
        self.field
            .at(position, 0.0)
            .expect("sea level is a valid altitude")
    }
}
