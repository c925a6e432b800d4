//! Contributions to Poisson's equations.

use binnacle_compass::ship::ShipMagnetism;

/// A vector in ship axes: forward, starboard, down.
pub type Vector = [f64; 3];

/// A contribution to Poisson's equations, `B = h + (χ + Δχ + N/H) h + b + Δb`
/// (docs/science.md, eq. 18).
#[derive(Clone, Copy, Debug, Default, PartialEq)]
pub struct Effect {
    /// Δχ.
    pub chi: [[f64; 3]; 3],
    /// Δb, nT.
    pub b_nt: Vector,
    /// N, nT: the field that the needles induce in the spheres turns with the card. It acts
    /// as soft iron that is stronger the weaker H is, on D and E alone: its trace is zero,
    /// so it turns the card without changing the directive force.
    pub needle_nt: [[f64; 2]; 2],
}

impl Effect {
    /// Adds another effect.
    pub fn plus(mut self, other: &Effect) -> Effect {
        self.add(other, 1.0);
        self
    }

    /// Subtracts another effect.
    pub fn less(mut self, other: &Effect) -> Effect {
        self.add(other, -1.0);
        self
    }

    /// Scales the effect.
    pub fn times(&self, factor: f64) -> Effect {
        let mut scaled = Effect::default();
        scaled.add(self, factor);
        scaled
    }

    pub(super) fn add(&mut self, other: &Effect, factor: f64) {
        for row in 0..3 {
            self.b_nt[row] += factor * other.b_nt[row];
            for column in 0..3 {
                self.chi[row][column] += factor * other.chi[row][column];
            }
        }
        for row in 0..2 {
            for column in 0..2 {
                self.needle_nt[row][column] += factor * other.needle_nt[row][column];
            }
        }
    }

    /// Returns the soft iron at a horizontal field H, including the needles' share.
    pub fn chi_at(&self, h_nt: f64) -> [[f64; 3]; 3] {
        let mut chi = self.chi;
        for (chi, needle) in chi.iter_mut().zip(self.needle_nt) {
            for (chi, needle) in chi.iter_mut().zip(needle) {
                *chi += needle / h_nt;
            }
        }
        chi
    }

    /// Converts the effect to a ship's magnetism at a horizontal field H.
    pub fn as_ship(&self, h_nt: f64) -> ShipMagnetism {
        ShipMagnetism {
            chi: self.chi_at(h_nt),
            b_nt: self.b_nt,
        }
    }
}
