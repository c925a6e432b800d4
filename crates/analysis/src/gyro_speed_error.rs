//! Speed error of a gyro: the vessel moves over a turning earth.

use binnacle_compass::angle::TrueHeading;

/// Speed of the earth's rotation at the equator, knots (speed error of a gyro: sin ε = V
/// cos C / 902.5 cos φ).
const EARTH_TURN_KN: f64 = 902.5;

/// Returns a gyro's speed error in degrees, to be subtracted from its reading: positive on
/// northerly headings.
pub fn gyro_speed_error_deg(gyro: TrueHeading, sog_kn: f64, lat_deg: f64) -> f64 {
    let sine = northerly_sine(sog_kn, lat_deg) * gyro.radians().cos();
    sine.clamp(-1.0, 1.0).asin().to_degrees()
}

/// Returns a gyro's speed error on a northerly heading, degrees.
pub fn northerly_speed_error_deg(sog_kn: f64, lat_deg: f64) -> f64 {
    let sine = northerly_sine(sog_kn, lat_deg);
    sine.clamp(-1.0, 1.0).asin().to_degrees()
}

fn northerly_sine(sog_kn: f64, lat_deg: f64) -> f64 {
    // At the pole itself the rule has no meaning, and the gyro no north.
    let turn_kn = (EARTH_TURN_KN * lat_deg.to_radians().cos()).max(1.0);
    sog_kn / turn_kn
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn a_gyros_speed_error_is_that_of_the_manuals() {
        let heading = |degrees| TrueHeading::new(degrees).unwrap();
        for (gyro, expected) in [(345.0, 343.3), (223.7, 225.0)] {
            let error = gyro_speed_error_deg(heading(gyro), 16.0, 55.0);
            assert!((gyro - error - expected).abs() < 0.05, "{gyro}: {error}");
        }
        assert!(gyro_speed_error_deg(heading(0.0), 20.0, 90.0).is_finite());
    }
}
