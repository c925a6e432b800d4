//! Bar magnet as two poles.

use super::effect::Vector;

/// µ0/4π in nT·m³/(A·m²): 10⁻⁷ tesla.
pub const MAGNETIC: f64 = 100.0;

/// A bar magnet with two poles at its ends.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct BarMagnet {
    /// Centre, metres from the card's centre.
    pub centre: Vector,
    /// Magnetic moment, A·m², towards the red (north-seeking) end. Not zero.
    pub moment: Vector,
    /// Distance of the poles, metres.
    pub length_m: f64,
}

impl BarMagnet {
    /// Computes the field at a place, nT (docs/science.md, eq. 19).
    ///
    /// Broadside, the field is 10⁻⁷ m/(ρ² + L²/4)^1.5 against the moment; end-on, it is
    /// 2·10⁻⁷ m h/(h² − L²/4)² along it.
    pub fn field_nt(&self, at: Vector) -> Vector {
        let size = self.moment.iter().map(|m| m * m).sum::<f64>().sqrt();
        let pole = |sign: f64| -> Vector {
            let from: Vector = std::array::from_fn(|axis| {
                let half = self.moment[axis] / size * self.length_m / 2.0;
                at[axis] - self.centre[axis] - sign * half
            });
            let distance = from.iter().map(|r| r * r).sum::<f64>().sqrt();
            from.map(|r| sign * r / distance.powi(3))
        };
        let (red, blue) = (pole(1.0), pole(-1.0));
        std::array::from_fn(|axis| MAGNETIC * size / self.length_m * (red[axis] + blue[axis]))
    }
}
