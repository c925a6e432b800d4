//! Kelvin spheres: a pair of soft-iron spheres on either side of the card.

use super::effect::{Effect, Vector};
use super::magnet::{BarMagnet, MAGNETIC};

/// (µ − 1)/(µ + 2) of soft iron with a relative permeability of 200.
pub const KAPPA: f64 = 0.985;

/// Two equal spheres at the card's height, opposite each other.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Pair {
    /// Effect q = κ (a/r)³ (docs/science.md, eq. 20).
    q: f64,
    /// Distance from the card's centre to either sphere, metres.
    distance_m: f64,
    /// Direction of the sphere that is to starboard without slew: forward, starboard.
    towards: [f64; 2],
}

impl Pair {
    /// Makes spheres of a radius at a distance from the card, metres, slewed clockwise from
    /// athwartships.
    pub fn new(radius_m: f64, distance_m: f64, slew_deg: f64) -> Pair {
        let (sin, cos) = slew_deg.to_radians().sin_cos();
        Pair {
            q: KAPPA * (radius_m / distance_m).powi(3),
            distance_m,
            towards: [-sin, cos],
        }
    }

    /// Returns the pair with a measured q.
    pub fn measured(self, q: f64) -> Pair {
        Pair { q, ..self }
    }

    /// Returns q, a third of the pair's reduction of λD.
    pub fn q(&self) -> f64 {
        self.q
    }

    /// Returns the effect in the earth's field, and with needles of this moment, A·m².
    pub fn effect(&self, needle_am2: f64) -> Effect {
        let mut effect = Effect::default();
        let n = [self.towards[0], self.towards[1], 0.0];
        for row in 0..3 {
            for column in 0..3 {
                let unit = if row == column { 2.0 } else { 0.0 };
                effect.chi[row][column] = self.q * (6.0 * n[row] * n[column] - unit);
            }
        }
        // A field that the needles induce along themselves does not turn them: of 3nn + 1
        // only 3nn − 3/2 does, which is quadrantal and leaves λ unchanged.
        let needle_nt = 6.0 * self.q * MAGNETIC * needle_am2 / self.distance_m.powi(3);
        for row in 0..2 {
            for column in 0..2 {
                let half = if row == column { 0.5 } else { 0.0 };
                effect.needle_nt[row][column] = needle_nt * (n[row] * n[column] - half);
            }
        }
        effect
    }

    /// Returns the field added to a magnet's field at the card, nT.
    pub fn reflected(&self, magnet: &BarMagnet) -> Vector {
        let mut sum = [0.0; 3];
        let n = [self.towards[0], self.towards[1], 0.0];
        for side in [1.0, -1.0] {
            let induced = magnet.field_nt(n.map(|part| side * self.distance_m * part));
            let along: f64 = n.iter().zip(induced).map(|(n, b)| n * b).sum();
            for axis in 0..3 {
                sum[axis] += self.q * (3.0 * along * n[axis] - induced[axis]);
            }
        }
        sum
    }
}
