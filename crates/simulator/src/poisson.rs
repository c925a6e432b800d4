//! Magnetic field at the compass, by Poisson's equations in full.
//!
//! `B = h + χ h + b` in ship axes (x forward, y starboard, z down), with all
//! nine coefficients and all three components of `b`, also for a heeled ship.
//! The card settles along the horizontal part of `B`. The simulator has its own
//! code on purpose: it must not share errors with the estimator.

use binnacle_compass::angle::wrap_180;
use serde::Serialize;

/// A ship's magnetism at one compass.
#[derive(Clone, Copy, Debug, PartialEq, Serialize)]
pub struct Magnetism {
    /// Permanent field, nT: forward, starboard, down.
    pub b_nt: [f64; 3],
    /// Soft iron: field per earth's field, rows and columns in ship axes.
    pub chi: [[f64; 3]; 3],
}

/// The horizontal and vertical earth's field, nT; vertical is down positive.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Field {
    /// Horizontal, nT.
    pub h_nt: f64,
    /// Vertical, nT, positive north of the magnetic equator.
    pub z_nt: f64,
}

impl Magnetism {
    /// Returns the horizontal field at the compass, nT: forward and starboard
    /// in level axes, on a magnetic heading, with the starboard side down by
    /// `roll_rad`.
    pub fn horizontal(&self, field: Field, magnetic_rad: f64, roll_rad: f64) -> [f64; 2] {
        let (sin, cos) = magnetic_rad.sin_cos();
        let (roll_sin, roll_cos) = roll_rad.sin_cos();
        let starboard = -field.h_nt * sin;
        let earth = [
            field.h_nt * cos,
            starboard * roll_cos + field.z_nt * roll_sin,
            field.z_nt * roll_cos - starboard * roll_sin,
        ];
        let at_compass = |axis: usize| {
            let row = self.chi[axis];
            earth[axis]
                + row[0] * earth[0]
                + row[1] * earth[1]
                + row[2] * earth[2]
                + self.b_nt[axis]
        };
        let (across, down) = (at_compass(1), at_compass(2));
        [at_compass(0), across * roll_cos - down * roll_sin]
    }

    /// Returns the deviation, degrees east, on a magnetic heading in degrees.
    pub fn deviation_deg(&self, field: Field, magnetic_deg: f64, roll_deg: f64) -> f64 {
        let [forward, starboard] =
            self.horizontal(field, magnetic_deg.to_radians(), roll_deg.to_radians());
        wrap_180(magnetic_deg - (-starboard).atan2(forward).to_degrees())
    }

    /// Returns the magnetic heading, degrees, on which an upright ship's
    /// compass shows `compass_deg`. It is unique where the deviation is below a
    /// right angle and the compass follows every turn.
    pub fn magnetic_deg(&self, field: Field, compass_deg: f64) -> f64 {
        let excess = |magnetic: f64| {
            wrap_180(magnetic - self.deviation_deg(field, magnetic, 0.0) - compass_deg)
        };
        let (mut low, mut high) = (compass_deg - 90.0, compass_deg + 90.0);
        for _ in 0..60 {
            let middle = f64::midpoint(low, high);
            if excess(middle) < 0.0 {
                low = middle;
            } else {
                high = middle;
            }
        }
        f64::midpoint(low, high)
    }

    /// λ: the mean directive force on the card as a fraction of the earth's.
    pub fn lambda(&self) -> f64 {
        1.0 + f64::midpoint(self.chi[0][0], self.chi[1][1])
    }

    /// The least directive force on any heading, as a fraction of the earth's
    /// horizontal field. Where it is negative or near zero, the compass is
    /// useless.
    pub fn least_directive_force(&self, field: Field) -> f64 {
        (0..72)
            .map(|step| {
                let magnetic = f64::from(step) * 5.0;
                let [forward, starboard] = self.horizontal(field, magnetic.to_radians(), 0.0);
                let (sin, cos) = magnetic.to_radians().sin_cos();
                (forward * cos - starboard * sin) / field.h_nt
            })
            .fold(f64::INFINITY, f64::min)
    }

    /// Adds `share` of another magnetism.
    pub(crate) fn plus(mut self, other: &Magnetism, share: f64) -> Magnetism {
        for axis in 0..3 {
            self.b_nt[axis] += share * other.b_nt[axis];
            for column in 0..3 {
                self.chi[axis][column] += share * other.chi[axis][column];
            }
        }
        self
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    const NONE: Magnetism = Magnetism {
        b_nt: [0.0; 3],
        chi: [[0.0; 3]; 3],
    };
    const HERE: Field = Field {
        h_nt: 20_000.0,
        z_nt: 40_000.0,
    };

    fn deviation(ship: &Magnetism, magnetic_deg: f64) -> f64 {
        ship.deviation_deg(HERE, magnetic_deg, 0.0)
    }

    #[test]
    fn a_ship_of_wood_has_no_deviation() {
        for heading in [0.0, 90.0, 135.5, 359.9] {
            assert!(deviation(&NONE, heading).abs() < 1e-12);
        }
    }

    #[test]
    fn a_red_pole_forward_draws_the_card_east_on_an_easterly_heading() {
        let mut ship = NONE;
        ship.b_nt[0] = 2_000.0;
        let expected = (0.1_f64).atan().to_degrees();
        assert!((deviation(&ship, 90.0) - expected).abs() < 1e-9);
        assert!((deviation(&ship, 270.0) + expected).abs() < 1e-9);
        assert!(deviation(&ship, 0.0).abs() < 1e-9);
    }

    #[test]
    fn a_red_pole_to_starboard_draws_the_card_east_on_north() {
        let mut ship = NONE;
        ship.b_nt[1] = 2_000.0;
        assert!(deviation(&ship, 0.0) > 5.0);
        assert!(deviation(&ship, 180.0) < -5.0);
    }

    #[test]
    fn athwartship_iron_gives_easterly_deviation_on_north_east() {
        let mut ship = NONE;
        ship.chi[1][1] = -0.1;
        assert!(deviation(&ship, 45.0) > 2.0);
        assert!(deviation(&ship, 135.0) < -2.0);
        assert!(deviation(&ship, 225.0) > 2.0);
    }

    #[test]
    fn heeling_error_is_as_the_textbook_has_it() {
        let mut ship = NONE;
        ship.b_nt[2] = 3_000.0;
        ship.chi[1][1] = -0.05;
        ship.chi[2][2] = 0.02;
        let heel = 0.01_f64;
        let coefficient =
            ((ship.chi[1][1] - ship.chi[2][2]) * HERE.z_nt - ship.b_nt[2]) / HERE.h_nt;
        let found = ship.deviation_deg(HERE, 0.0, heel.to_degrees());
        assert!((found - (coefficient * heel).to_degrees()).abs() < 1e-3);
    }

    #[test]
    fn the_way_back_from_the_compass_is_the_way_there() {
        let ship = Magnetism {
            b_nt: [2_060.0, -2_930.0, 1_500.0],
            chi: [
                [-0.05, 0.0012, -0.0215],
                [0.0016, -0.085, 0.0022],
                [0.001, -0.002, 0.03],
            ],
        };
        for step in 0..72 {
            let magnetic = f64::from(step) * 5.0;
            let compass = magnetic - deviation(&ship, magnetic);
            let back = ship.magnetic_deg(HERE, compass);
            assert!(wrap_180(back - magnetic).abs() < 1e-9, "{magnetic}");
        }
    }
}
