//! The charted earth's field at the ship, computed in one place.

use binnacle_compass::field::{Field, FieldAt, FieldError, FieldModel};
use binnacle_compass::position::Position;
use binnacle_compass::time::Timestamp;

/// Age at which the coefficients are recomputed; the field changes by less than
/// a third of a nanotesla in that time.
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

    /// Returns the field at a place. After the model's last day, its last
    /// coefficients are used.
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
