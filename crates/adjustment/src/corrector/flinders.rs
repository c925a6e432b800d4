//! Flinders bar: an upright cylinder of soft iron, its top pole at the card's height.

use super::effect::{Effect, Vector};
use super::magnet::BarMagnet;
use std::f64::consts::PI;

/// 1/χ of the bar's iron.
const INVERSE_SUSCEPTIBILITY: f64 = 6e-4;

/// Demagnetising factor along its axis of a cylinder, by length over diameter.
const DEMAGNETISING: [(f64, f64); 7] = [
    (2.0, 0.141),
    (3.0, 0.0922),
    (4.0, 0.0664),
    (6.0, 0.0402),
    (8.0, 0.0275),
    (10.0, 0.0202),
    (12.0, 0.0156),
];

/// Interpolates the demagnetising factor as a power of the ratio of length to diameter;
/// beyond the table, extrapolates from the nearest two values.
pub fn demagnetising(length_over_diameter: f64) -> f64 {
    // No body of this length exceeds a sphere's factor of one third.
    let ratio = length_over_diameter.max(0.8);
    let after = DEMAGNETISING
        .iter()
        .position(|(known, _)| *known >= ratio)
        .unwrap_or(DEMAGNETISING.len() - 1)
        .max(1);
    let ((r0, n0), (r1, n1)) = (DEMAGNETISING[after - 1], DEMAGNETISING[after]);
    let share = (ratio / r0).ln() / (r1 / r0).ln();
    (n0 * (n1 / n0).powf(share)).min(1.0 / 3.0)
}

/// A Flinders bar in its position.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Bar {
    /// χ13 of the bar in its forward position.
    c: f64,
    length_m: f64,
    diameter_m: f64,
    axis_m: f64,
    /// Direction from the card to the bar: forward, starboard.
    towards: [f64; 2],
}

impl Bar {
    /// Makes a bar of a length and diameter with its axis at a distance from the card,
    /// metres, at an angle clockwise from forward.
    pub fn new(length_m: f64, diameter_m: f64, axis_m: f64, azimuth_deg: f64) -> Bar {
        let (sin, cos) = azimuth_deg.to_radians().sin_cos();
        let bar = Bar {
            c: 0.0,
            length_m,
            diameter_m,
            axis_m,
            towards: [cos, sin],
        };
        let (poles_m, squared) = bar.poles();
        let c = bar.strength() * (axis_m.powi(-2) - axis_m / squared.powf(1.5)) / poles_m;
        Bar { c, ..bar }
    }

    /// Returns the bar with a measured χ13.
    pub fn measured(self, c: f64) -> Bar {
        Bar { c, ..self }
    }

    /// Returns χ13 of the bar in its forward position.
    pub fn c(&self) -> f64 {
        self.c
    }

    /// Returns the distance of the poles, and the squared distance of the lower one from
    /// the card.
    fn poles(&self) -> (f64, f64) {
        let poles_m = 5.0 / 6.0 * self.length_m;
        (poles_m, self.axis_m.powi(2) + poles_m.powi(2))
    }

    fn volume(&self) -> f64 {
        PI / 4.0 * self.diameter_m.powi(2) * self.length_m
    }

    /// Returns the moment along the axis per unit of vertical field, over 4π.
    fn strength(&self) -> f64 {
        let factor = demagnetising(self.length_m / self.diameter_m);
        self.volume() / (factor + INVERSE_SUSCEPTIBILITY) / (4.0 * PI)
    }

    /// Returns the field at the card, forward, starboard and down, per unit of vertical
    /// field in the bar (docs/science.md, eq. 21).
    fn of_vertical(&self) -> Vector {
        let (_, squared) = self.poles();
        // Upwards from the lower pole, for a field that points down.
        let up = self.strength() / squared.powf(1.5);
        [self.c * self.towards[0], self.c * self.towards[1], -up]
    }

    /// Returns the effect in the earth's field: along the bar, and across it as a line of
    /// dipoles (docs/science.md, eq. 22).
    pub fn effect(&self) -> Effect {
        let mut effect = Effect::default();
        for (row, part) in self.of_vertical().into_iter().enumerate() {
            effect.chi[row][2] = part;
        }
        let across = (1.0 - demagnetising(self.length_m / self.diameter_m)) / 2.0;
        let per_metre = self.volume() / self.length_m / (across + INVERSE_SUSCEPTIBILITY);
        let per_metre = per_metre / (4.0 * PI);
        let (i3, i5) = self.along_the_line();
        let n = self.towards;
        for row in 0..2 {
            for column in 0..2 {
                let unit = if row == column { i3 } else { 0.0 };
                let dipole = 3.0 * self.axis_m.powi(2) * i5 * n[row] * n[column] - unit;
                effect.chi[row][column] = per_metre * dipole;
            }
        }
        effect
    }

    /// Integrates ∫ds/s³ and ∫ds/s⁵ over the bar's length, s the distance from the card.
    fn along_the_line(&self) -> (f64, f64) {
        let d2 = self.axis_m.powi(2);
        let up_to = |z: f64| {
            let s = d2.sqrt().hypot(z);
            let i3 = z / (d2 * s);
            (i3, z / (3.0 * d2 * s.powi(3)) + 2.0 * i3 / (3.0 * d2))
        };
        let (top, bottom) = (
            up_to(-self.length_m / 12.0),
            up_to(self.length_m * 11.0 / 12.0),
        );
        (bottom.0 - top.0, bottom.1 - top.1)
    }

    /// Returns the field added to a magnet's field at the card, nT, by the mean vertical
    /// field along the bar.
    pub fn reflected(&self, magnet: &BarMagnet) -> Vector {
        const PARTS: i32 = 8;
        let mut vertical_nt = 0.0;
        for part in 0..PARTS {
            let share = (f64::from(part) + 0.5) / f64::from(PARTS);
            let down = self.length_m * (share - 1.0 / 12.0);
            let [forward, starboard] = self.towards.map(|n| n * self.axis_m);
            vertical_nt += magnet.field_nt([forward, starboard, down])[2] / f64::from(PARTS);
        }
        self.of_vertical().map(|part| part * vertical_nt)
    }
}
