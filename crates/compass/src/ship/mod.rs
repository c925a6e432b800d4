//! A ship's magnetism by Poisson's equations, and the resulting field at the compass.
//!
//! `B = h + χ h + b` in ship axes (x forward, y starboard, z down), where `h` is the
//! earth's field and `B` the field at the compass (docs/science.md, §2). The card settles
//! along the horizontal part of `B`. Angles are radians here.

use crate::model::Parameters;
use serde::{Deserialize, Serialize};

/// Least horizontal field for a usable compass, nT.
pub const WEAKEST_H_NT: f64 = 2_000.0;
/// Horizontal field below which a compass needs caution, nT.
pub const CAUTION_H_NT: f64 = 6_000.0;

/// Number of values in [`Parameters`].
pub const PARAMETERS: usize = 7;

/// The earth's field at a place: the parts that do not depend on the ship's heading.
#[derive(Clone, Copy, Debug, PartialEq, Serialize, Deserialize)]
pub struct EarthField {
    /// Horizontal part, nT, at least 0.
    pub h_nt: f64,
    /// Vertical part, nT, down positive: positive north of the magnetic equator.
    pub z_nt: f64,
}

impl EarthField {
    /// Rotates the field into ship axes on a magnetic heading: `[forward, starboard,
    /// down]`, nT.
    ///
    /// A ship heading east has north on its port side, hence the minus sign.
    pub fn in_ship_axes(self, magnetic_rad: f64) -> [f64; 3] {
        let (sin, cos) = magnetic_rad.sin_cos();
        [self.h_nt * cos, -self.h_nt * sin, self.z_nt]
    }
}

/// Compass heading of a card in a horizontal field in ship axes, radians in (−π, π].
pub fn compass_rad(forward: f64, starboard: f64) -> f64 {
    (-starboard).atan2(forward)
}

/// Deviation on one magnetic heading with its derivatives.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Linearised {
    /// Deviation, radians, east positive, in (−π, π].
    pub deviation_rad: f64,
    /// ∂deviation/∂parameter in the order of [`Parameters`]: radians per nT for bx and by,
    /// radians for the others.
    pub gradient: [f64; PARAMETERS],
}

impl Parameters {
    /// Returns the parameters in the order of the covariance.
    pub fn to_array(&self) -> [f64; PARAMETERS] {
        [
            self.bx_nt,
            self.chi13,
            self.by_nt,
            self.chi23,
            self.chi11_minus_chi22,
            self.chi12,
            self.chi21,
        ]
    }

    /// Makes the parameters from an array in the order of the covariance.
    pub fn from_array(array: [f64; PARAMETERS]) -> Parameters {
        let [bx_nt, chi13, by_nt, chi23, chi11_minus_chi22, chi12, chi21] = array;
        Parameters {
            bx_nt,
            chi13,
            by_nt,
            chi23,
            chi11_minus_chi22,
            chi12,
            chi21,
        }
    }

    /// Computes the horizontal field at the compass over λ on a magnetic heading, nT:
    /// `[forward, starboard]`.
    pub fn field_over_lambda(&self, magnetic_rad: f64, earth: EarthField) -> [f64; 2] {
        self.field_over_lambda_in_ship_axes(earth.in_ship_axes(magnetic_rad))
    }

    /// Computes the horizontal field at the compass over λ for an earth's field in ship
    /// axes, nT.
    pub fn field_over_lambda_in_ship_axes(&self, [hx, hy, z]: [f64; 3]) -> [f64; 2] {
        let d = self.chi11_minus_chi22 / 2.0;
        [
            (1.0 + d) * hx + self.chi12 * hy + self.chi13 * z + self.bx_nt,
            self.chi21 * hx + (1.0 - d) * hy + self.chi23 * z + self.by_nt,
        ]
    }

    /// Returns the parameters seen by a compass whose zero moved so that it reads more by
    /// `rad` radians: the ship's iron lies further from its lubber line by the same angle
    /// (docs/science.md, §9).
    pub fn with_compass_turned(&self, rad: f64) -> Parameters {
        let (sin, cos) = rad.sin_cos();
        let (sin_2, cos_2) = (2.0 * rad).sin_cos();
        let turned = |x: f64, y: f64| (x * cos + y * sin, y * cos - x * sin);
        let (bx_nt, by_nt) = turned(self.bx_nt, self.by_nt);
        let (chi13, chi23) = turned(self.chi13, self.chi23);
        let lopsided = self.chi12 + self.chi21;
        let lopsided_turned = lopsided * cos_2 - self.chi11_minus_chi22 * sin_2;
        let more = (lopsided_turned - lopsided) / 2.0;
        Parameters {
            bx_nt,
            chi13,
            by_nt,
            chi23,
            chi11_minus_chi22: self.chi11_minus_chi22 * cos_2 + lopsided * sin_2,
            chi12: self.chi12 + more,
            chi21: self.chi21 + more,
        }
    }

    /// Computes the deviation on a magnetic heading and its gradient at that fixed magnetic
    /// heading (docs/science.md, eq. 9).
    ///
    /// The gradient is infinite or NaN where the ship's own field exactly cancels the earth's;
    /// check [`Coefficients::check_unambiguous`] first where that is possible.
    ///
    /// [`Coefficients::check_unambiguous`]: crate::deviation::Coefficients::check_unambiguous
    pub fn linearised_at_magnetic(&self, magnetic_rad: f64, earth: EarthField) -> Linearised {
        let [hx, hy, z] = earth.in_ship_axes(magnetic_rad);
        let [forward, starboard] = self.field_over_lambda_in_ship_axes([hx, hy, z]);
        let squared = forward * forward + starboard * starboard;
        let s = -starboard / squared;
        let c = forward / squared;
        Linearised {
            deviation_rad: wrap_pi(magnetic_rad - compass_rad(forward, starboard)),
            gradient: [s, z * s, c, z * c, (hx * s - hy * c) / 2.0, hy * s, hx * c],
        }
    }
}

/// Wraps a finite angle in radians into (−π, π].
pub fn wrap_pi(radians: f64) -> f64 {
    use std::f64::consts::{PI, TAU};
    let wrapped = radians.rem_euclid(TAU);
    if wrapped > PI { wrapped - TAU } else { wrapped }
}

/// All of Poisson's coefficients of a ship, including those that headings cannot determine.
#[derive(Clone, Copy, Debug, PartialEq, Serialize, Deserialize)]
pub struct ShipMagnetism {
    /// Soft iron: field in the row's direction per unit of earth field in the column's
    /// direction (a, b, c; d, e, f; g, h, k of the handbooks).
    pub chi: [[f64; 3]; 3],
    /// Permanent field `[forward, starboard, down]`, nT (P, Q, R).
    pub b_nt: [f64; 3],
}

/// Error of a ship without a positive shielding factor λ.
#[derive(Clone, Copy, Debug, PartialEq, thiserror::Error)]
#[error("the shielding factor lambda is {0}, not a positive number")]
pub struct NoShieldingFactor(pub f64);

impl ShipMagnetism {
    /// Shielding factor λ: mean share of the earth's horizontal field that reaches the
    /// compass.
    pub fn lambda(&self) -> f64 {
        1.0 + f64::midpoint(self.chi[0][0], self.chi[1][1])
    }

    /// Computes the field at the compass from the earth's field, both in ship axes, nT.
    pub fn field_at_compass(&self, earth: [f64; 3]) -> [f64; 3] {
        std::array::from_fn(|row| {
            let induced: f64 = (0..3)
                .map(|column| self.chi[row][column] * earth[column])
                .sum();
            earth[row] + induced + self.b_nt[row]
        })
    }

    /// Computes the deviation on a magnetic heading by Poisson's equations, radians.
    pub fn deviation_rad(&self, magnetic_rad: f64, earth: EarthField) -> f64 {
        let [forward, starboard, _] = self.field_at_compass(earth.in_ship_axes(magnetic_rad));
        wrap_pi(magnetic_rad - compass_rad(forward, starboard))
    }

    /// Computes the seven ratios that headings determine.
    ///
    /// # Errors
    /// Fails when λ is not positive: such a ship reverses the compass.
    pub fn parameters_over_lambda(&self) -> Result<Parameters, NoShieldingFactor> {
        let lambda = self.lambda();
        if !(lambda > 0.0 && lambda.is_finite()) {
            return Err(NoShieldingFactor(lambda));
        }
        let chi = &self.chi;
        Ok(Parameters {
            bx_nt: self.b_nt[0] / lambda,
            chi13: chi[0][2] / lambda,
            by_nt: self.b_nt[1] / lambda,
            chi23: chi[1][2] / lambda,
            chi11_minus_chi22: (chi[0][0] - chi[1][1]) / lambda,
            chi12: chi[0][1] / lambda,
            chi21: chi[1][0] / lambda,
        })
    }

    /// Makes a ship with these parameters over λ, this λ, and no vertical coefficients.
    pub fn from_parameters(parameters: &Parameters, lambda: f64) -> ShipMagnetism {
        let p = parameters;
        let d = p.chi11_minus_chi22 / 2.0;
        ShipMagnetism {
            chi: [
                [lambda * (1.0 + d) - 1.0, lambda * p.chi12, lambda * p.chi13],
                [lambda * p.chi21, lambda * (1.0 - d) - 1.0, lambda * p.chi23],
                [0.0; 3],
            ],
            b_nt: [lambda * p.bx_nt, lambda * p.by_nt, 0.0],
        }
    }
}

#[cfg(test)]
pub(crate) mod test_support;
#[cfg(test)]
mod tests;
