//! A ship's magnetism by Poisson's equations, and what it makes of the earth's field.
//!
//! `B = h + χ h + b` in ship axes (x forward, y starboard, z down), where `h` is
//! the earth's field and `B` the field at the compass (docs/science.md, §2).
//! The card settles along the horizontal part of `B`. Angles are radians here:
//! this is the inside of the science.

use crate::model::Parameters;
use serde::{Deserialize, Serialize};

/// Below this a compass is of no use.
pub const WEAKEST_H_NT: f64 = 2_000.0;
/// A compass is used with caution where H is below this.
pub const CAUTION_H_NT: f64 = 6_000.0;

/// How many numbers [`Parameters`] holds.
pub const PARAMETERS: usize = 7;

/// The earth's field at a place, as a ship on any heading meets it.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct EarthField {
    /// Horizontal part, nT, at least 0.
    pub h_nt: f64,
    /// Vertical part, nT, down positive: positive north of the magnetic equator.
    pub z_nt: f64,
}

impl EarthField {
    /// The field in ship axes on a magnetic heading: `[forward, starboard, down]`, nT.
    ///
    /// A ship heading east has north on her port side, hence the minus sign.
    pub fn in_ship_axes(self, magnetic_rad: f64) -> [f64; 3] {
        let (sin, cos) = magnetic_rad.sin_cos();
        [self.h_nt * cos, -self.h_nt * sin, self.z_nt]
    }
}

/// The compass heading that a horizontal field in ship axes gives, radians in (−π, π].
pub fn compass_rad(forward: f64, starboard: f64) -> f64 {
    (-starboard).atan2(forward)
}

/// The deviation on one magnetic heading with its derivatives.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Linearised {
    /// Deviation, radians, east positive, in (−π, π].
    pub deviation_rad: f64,
    /// ∂deviation/∂parameter in the order of [`Parameters`]: radians a nT for
    /// bx and by, radians for the others.
    pub gradient: [f64; PARAMETERS],
}

impl Parameters {
    /// The parameters in their order, as the covariance has them.
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

    /// The parameters from an array in their order.
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

    /// The horizontal field at the compass over λ, nT: `[forward, starboard]`,
    /// on a magnetic heading.
    pub fn field_over_lambda(&self, magnetic_rad: f64, earth: EarthField) -> [f64; 2] {
        self.field_over_lambda_in_ship_axes(earth.in_ship_axes(magnetic_rad))
    }

    /// The same of an earth's field in ship axes.
    pub fn field_over_lambda_in_ship_axes(&self, [hx, hy, z]: [f64; 3]) -> [f64; 2] {
        let d = self.chi11_minus_chi22 / 2.0;
        [
            (1.0 + d) * hx + self.chi12 * hy + self.chi13 * z + self.bx_nt,
            self.chi21 * hx + (1.0 - d) * hy + self.chi23 * z + self.by_nt,
        ]
    }

    /// The same ship by a compass whose zero moved so that it reads more by so much, radians:
    /// her iron lies as much further from its lubber line (docs/science.md, §9).
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

    /// The deviation on a magnetic heading and its gradient at that fixed
    /// magnetic heading (docs/science.md, eq. 9).
    ///
    /// Where the ship's own field exactly cancels the earth's the gradient is
    /// infinite or NaN; check [`Coefficients::check_unambiguous`] first where
    /// that can be.
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

/// A whole Poisson ship: more than headings can ever tell.
#[derive(Clone, Copy, Debug, PartialEq, Serialize, Deserialize)]
pub struct ShipMagnetism {
    /// Soft iron: the field in row's direction for a unit of earth field in
    /// column's direction (a, b, c; d, e, f; g, h, k of the handbooks).
    pub chi: [[f64; 3]; 3],
    /// Permanent field `[forward, starboard, down]`, nT (P, Q, R).
    pub b_nt: [f64; 3],
}

/// Why a ship has no parameters over λ.
#[derive(Clone, Copy, Debug, PartialEq, thiserror::Error)]
#[error("the shielding factor lambda is {0}, not a positive number")]
pub struct NoShieldingFactor(pub f64);

impl ShipMagnetism {
    /// λ, the mean share of the earth's horizontal field that reaches the compass.
    pub fn lambda(&self) -> f64 {
        1.0 + f64::midpoint(self.chi[0][0], self.chi[1][1])
    }

    /// The field at the compass, nT in ship axes, for the earth's field in ship axes.
    pub fn field_at_compass(&self, earth: [f64; 3]) -> [f64; 3] {
        std::array::from_fn(|row| {
            let induced: f64 = (0..3)
                .map(|column| self.chi[row][column] * earth[column])
                .sum();
            earth[row] + induced + self.b_nt[row]
        })
    }

    /// The deviation on a magnetic heading, radians, straight from Poisson's equations.
    pub fn deviation_rad(&self, magnetic_rad: f64, earth: EarthField) -> f64 {
        let [forward, starboard, _] = self.field_at_compass(earth.in_ship_axes(magnetic_rad));
        wrap_pi(magnetic_rad - compass_rad(forward, starboard))
    }

    /// The seven ratios that headings can tell.
    ///
    /// # Errors
    /// When λ is not positive: such a ship turns the compass around.
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

    /// The ship that has these parameters over λ, this λ, and no vertical
    /// effects of her own.
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
