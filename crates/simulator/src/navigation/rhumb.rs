//! Courses and distances along rhumb lines, on a sphere with 60 miles to a
//! degree.
//!
//! Bowditch, The American Practical Navigator, "The Sailings": Mercator
//! sailing.

use binnacle_compass::angle::{wrap_180, wrap_360};
use binnacle_compass::position::Position;

/// The constant course, degrees true, and the distance, nautical miles.
#[derive(Clone, Copy, Debug, PartialEq)]
pub(crate) struct Leg {
    pub(crate) course_deg: f64,
    pub(crate) distance_nm: f64,
}

/// Returns the leg from one place to another, by the shorter way round.
pub(crate) fn leg(from: Position, to: Position) -> Leg {
    let north_deg = to.lat_deg() - from.lat_deg();
    let east_deg = wrap_180(to.lon_deg() - from.lon_deg());
    let meridional_deg = meridional_parts_deg(to) - meridional_parts_deg(from);
    // Along a parallel both become zero, and their ratio the cosine.
    let stretch = if meridional_deg.abs() > 1e-9 {
        north_deg / meridional_deg
    } else {
        from.lat_deg().to_radians().cos()
    };
    Leg {
        course_deg: wrap_360(east_deg.atan2(meridional_deg).to_degrees()),
        distance_nm: 60.0 * north_deg.hypot(stretch * east_deg),
    }
}

fn meridional_parts_deg(place: Position) -> f64 {
    let lat = place.lat_deg().clamp(-89.0, 89.0).to_radians();
    lat.tan().asinh().to_degrees()
}

#[cfg(test)]
mod tests {
    use super::*;

    fn at(lat: f64, lon: f64) -> Position {
        Position::new(lat, lon).unwrap()
    }

    #[test]
    fn a_degree_of_latitude_is_sixty_miles_due_north_or_south() {
        let north = leg(at(10.0, 20.0), at(11.0, 20.0));
        assert!(north.course_deg.abs() < 1e-9 && (north.distance_nm - 60.0).abs() < 1e-9);
        let south = leg(at(-10.0, 20.0), at(-11.0, 20.0));
        assert!((south.course_deg - 180.0).abs() < 1e-9);
    }

    #[test]
    fn a_parallel_shrinks_with_the_cosine_and_crosses_the_antimeridian() {
        let east = leg(at(60.0, 179.5), at(60.0, -179.5));
        assert!((east.course_deg - 90.0).abs() < 1e-9);
        assert!((east.distance_nm - 30.0).abs() < 1e-6);
        let west = leg(at(-60.0, -179.5), at(-60.0, 179.5));
        assert!((west.course_deg - 270.0).abs() < 1e-9);
    }

    #[test]
    fn mercator_sailing_gives_the_handbook_course() {
        // Bowditch's example: 32°14.7' N 66°28.9' W to 36°58.7' N 75°42.2' W,
        // course 302°, 536 miles on the spheroid.
        let found = leg(at(32.245, -66.4817), at(36.9783, -75.7033));
        assert!((found.course_deg - 302.0).abs() < 0.6, "{found:?}");
        assert!((found.distance_nm - 536.0).abs() < 5.0, "{found:?}");
    }
}
