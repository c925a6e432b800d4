//! Regions where the horizontal field is too weak for a magnetic compass: around the magnetic
//! poles, of which the southern one lies at sea.

use binnacle_compass::field::{FieldModel, field};
use binnacle_compass::position::Position;
use binnacle_compass::time::Timestamp;

/// Least horizontal field for a compass: some 12 % of that at mid-latitudes.
pub(crate) const MIN_H_NT: f64 = 2_000.0;

/// Returns whether the field is too weak for a compass; `false` where the field is not known.
pub(crate) fn is_weak(position: Position, time: Timestamp) -> bool {
    field(FieldModel::Igrf14, position, 0.0, time)
        .is_ok_and(|field| field.for_ship().h_nt < MIN_H_NT)
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn a_compass_is_of_no_use_by_the_magnetic_poles_alone() {
        let time = Timestamp::parse("2026-01-01T00:00:00Z").unwrap();
        for (lat, lon, weak) in [
            (-64.0, 136.0, true),
            (-64.0, -44.0, false),
            (85.8, 139.0, true),
            (43.3, -3.0, false),
            (0.0, 0.0, false),
        ] {
            let position = Position::new(lat, lon).unwrap();
            assert_eq!(is_weak(position, time), weak, "{lat} {lon}");
        }
    }
}
