//! Direction of the needle on a magnetic heading, and its slopes by the parameters.

use super::direction::Direction;
use binnacle_compass::model::Parameters;
use binnacle_compass::ship::{EarthField, PARAMETERS};

/// Horizontal field at the compass, over λ, on one magnetic heading, in a form that never
/// divides by zero.
#[derive(Clone, Copy, Debug)]
pub struct Needle {
    earth: [f64; 3],
    /// Sine and cosine of the compass heading over the strength, per nT.
    direction: [f64; 2],
    /// Strength along the vessel's magnetic heading and to starboard of it, nT.
    along: f64,
    across: f64,
    compass_per_magnetic: f64,
}

impl Needle {
    /// Returns the needle on a magnetic heading.
    pub fn at(p: &Parameters, heading: Direction, field: EarthField) -> Needle {
        let Direction { sin, cos } = heading;
        let (hx, hy) = (field.h_nt * cos, -field.h_nt * sin);
        let earth = [hx, hy, field.z_nt];
        let [ux, uy] = p.field_over_lambda_in_ship_axes(earth);
        // Without any force a needle has no direction: any small number keeps the
        // arithmetic finite.
        let squared = (ux * ux + uy * uy).max(1.0);
        let half = p.chi11_minus_chi22 / 2.0;
        let (dux, duy) = (
            (1.0 + half) * hy - p.chi12 * hx,
            p.chi21 * hy - (1.0 - half) * hx,
        );
        Needle {
            earth,
            direction: [-uy / squared, ux / squared],
            along: cos * ux - sin * uy,
            across: sin * ux + cos * uy,
            compass_per_magnetic: (uy * dux - ux * duy) / squared,
        }
    }

    /// Returns magnetic heading less compass heading (docs/science.md, eq. 5), radians in
    /// (−π, π].
    pub fn deviation_rad(&self) -> f64 {
        self.across.atan2(self.along)
    }

    /// Returns the slope of compass heading by magnetic heading: 1 without deviation.
    pub fn compass_per_magnetic(&self) -> f64 {
        self.compass_per_magnetic
    }

    /// Returns the derivative of deviation, in radians, by each parameter at fixed magnetic
    /// heading (docs/science.md, eq. 9): from dζ = −(sin ζ dux + cos ζ duy)/|u|.
    pub fn gradient(&self) -> [f64; PARAMETERS] {
        let [hx, hy, z] = self.earth;
        let [s, c] = self.direction;
        [s, z * s, c, z * c, (hx * s - hy * c) / 2.0, hy * s, hx * c]
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use binnacle_compass::ship::compass_rad;

    const EARTH: EarthField = EarthField {
        h_nt: 24e3,
        z_nt: 38e3,
    };

    #[test]
    fn the_gradient_is_the_slope_of_the_deviation() {
        let start = [2000.0, -0.02, -2900.0, 0.01, 0.035, 0.004, -0.003];
        let step = [1.0, 1e-6, 1.0, 1e-6, 1e-6, 1e-6, 1e-6];
        for degrees in 0..24 {
            let magnetic = f64::from(degrees * 15).to_radians();
            let needle = |a: &[f64; 7]| {
                Needle::at(
                    &Parameters::from_array(*a),
                    Direction::from_radians(magnetic),
                    EARTH,
                )
            };
            let deviation = |a: &[f64; 7]| needle(a).deviation_rad();
            let gradient = needle(&start).gradient();
            for j in 0..7 {
                let (mut up, mut down) = (start, start);
                up[j] += step[j];
                down[j] -= step[j];
                let slope = (deviation(&up) - deviation(&down)) / (2.0 * step[j]);
                assert!(
                    (slope - gradient[j]).abs() < 1e-6 * gradient[j].abs().max(1e-4),
                    "{j}"
                );
            }
        }
    }

    #[test]
    fn the_deviation_is_what_the_card_settles_on() {
        let p = Parameters::from_array([2000.0, -0.02, -2900.0, 0.01, 0.035, 0.004, -0.003]);
        for degrees in 0..24 {
            let magnetic = f64::from(degrees * 15 - 179).to_radians();
            let [forward, starboard] = p.field_over_lambda(magnetic, EARTH);
            let compass = compass_rad(forward, starboard);
            let deviation =
                Needle::at(&p, Direction::from_radians(magnetic), EARTH).deviation_rad();
            assert!(binnacle_compass::ship::wrap_pi(magnetic - deviation - compass).abs() < 1e-12);
        }
    }

    #[test]
    fn compass_heading_turns_with_the_ship_at_the_rate_given() {
        let p = Parameters::from_array([2000.0, -0.02, -2900.0, 0.01, 0.035, 0.004, -0.003]);
        for degrees in 0..24 {
            let magnetic = f64::from(degrees * 15 + 3).to_radians();
            let needle = |m: f64| Needle::at(&p, Direction::from_radians(m), EARTH);
            let compass = |m: f64| m - needle(m).deviation_rad();
            let slope = (compass(magnetic + 1e-6) - compass(magnetic - 1e-6)) / 2e-6;
            let rate = needle(magnetic).compass_per_magnetic();
            assert!((slope - rate).abs() < 1e-6);
        }
    }
}
