//! Exact deviation, from compass or magnetic heading and back.
//!
//! The five coefficients are the exact ones of docs/science.md, §3, not the handbooks'
//! approximate ones. Both directions are closed forms: nothing here iterates. A ship with
//! ambiguous headings is refused by name. Every deviation returned belongs to exactly one
//! pair of compass and magnetic headings.

mod approximate;
mod model_check;
mod needles;
mod prediction;

pub use approximate::CoefficientsInDegrees;
pub use model_check::{ModelError, PARAMETER_NAMES};
pub use prediction::{NORMAL_95, NORMAL_99, Prediction};

use crate::angle::{CompassHeading, Deviation, MagneticHeading};
use crate::model::Parameters;
use crate::ship::{EarthField, PARAMETERS};

/// Exact coefficients A to E at one place: dimensionless; × 57.3 they are near the
/// handbook's degrees.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Coefficients {
    /// (χ21 − χ12)/2λ: constant over headings and places.
    pub a: f64,
    /// (bx + χ13 Z)/λH.
    pub b: f64,
    /// (by + χ23 Z)/λH.
    pub c: f64,
    /// (χ11 − χ22)/2λ, constant over places.
    pub d: f64,
    /// (χ21 + χ12)/2λ, constant over places.
    pub e: f64,
}

/// Error of a deviation that cannot be computed.
#[derive(Clone, Copy, Debug, PartialEq, thiserror::Error)]
pub enum DeviationError {
    /// The given earth's field is not finite or has no horizontal part.
    #[error(
        "horizontal field {h_nt} nT, vertical field {z_nt} nT: not valid for a magnetic compass"
    )]
    InvalidField {
        /// Given horizontal field, nT.
        h_nt: f64,
        /// Given vertical field, nT.
        z_nt: f64,
    },
    /// The horizontal field is too weak for any ship's compass.
    #[error("horizontal field of {h_nt:.0} nT; a compass needs at least {needed_nt:.0} nT")]
    FieldTooWeak {
        /// Horizontal field, nT.
        h_nt: f64,
        /// Least horizontal field for a compass, nT.
        needed_nt: f64,
    },
    /// A parameter is NaN or infinite.
    #[error("the ship's magnetic parameters are not all finite")]
    NotFinite,
    /// The ship's field exceeds the earth's on some heading: a compass heading then stands
    /// for several magnetic headings, or for none.
    #[error(
        "compass headings are ambiguous: on magnetic heading {magnetic_deg:.1} the directive \
         force is {directive_force:.3} of its mean"
    )]
    Ambiguous {
        /// Magnetic heading with the least directive force, degrees.
        magnetic_deg: f64,
        /// Directive force there as a share of its mean, λH.
        directive_force: f64,
    },
}

impl Coefficients {
    /// Computes the exact coefficients of a ship in a given field.
    ///
    /// # Errors
    /// Fails when the field is not finite with a positive horizontal part, or a parameter is not
    /// finite. Ambiguity is not checked here: see [`Coefficients::check_unambiguous`].
    pub fn new(parameters: &Parameters, earth: EarthField) -> Result<Coefficients, DeviationError> {
        let EarthField { h_nt, z_nt } = earth;
        if !(h_nt > 0.0 && h_nt.is_finite() && z_nt.is_finite()) {
            return Err(DeviationError::InvalidField { h_nt, z_nt });
        }
        let p = parameters;
        let coefficients = Coefficients {
            a: (p.chi21 - p.chi12) / 2.0,
            b: (p.bx_nt + p.chi13 * z_nt) / h_nt,
            c: (p.by_nt + p.chi23 * z_nt) / h_nt,
            d: p.chi11_minus_chi22 / 2.0,
            e: f64::midpoint(p.chi21, p.chi12),
        };
        let Coefficients { a, b, c, d, e } = coefficients;
        if ![a, b, c, d, e].iter().all(|value| value.is_finite()) {
            return Err(DeviationError::NotFinite);
        }
        Ok(coefficients)
    }

    /// Checks that every compass heading stands for one magnetic heading.
    ///
    /// While the directive force is positive on every heading, deviation stays within 90°
    /// and the field at the compass turns once as the ship does.
    ///
    /// # Errors
    /// [`DeviationError::Ambiguous`] with the worst heading otherwise.
    pub fn check_unambiguous(&self) -> Result<(), DeviationError> {
        // Most ships pass this cheap sufficient test.
        if self.b.hypot(self.c) + self.d.hypot(self.e) < 1.0 {
            return Ok(());
        }
        let (magnetic_rad, directive_force) = self.least_directive_force();
        if directive_force > 0.0 {
            return Ok(());
        }
        Err(DeviationError::Ambiguous {
            magnetic_deg: magnetic_rad.to_degrees(),
            directive_force,
        })
    }

    /// Computes the force towards magnetic north on a magnetic heading, as a share of its
    /// mean over all headings, λH.
    pub fn directive_force(&self, magnetic_rad: f64) -> f64 {
        let (s1, c1) = magnetic_rad.sin_cos();
        let (s2, c2) = (2.0 * magnetic_rad).sin_cos();
        1.0 + self.b * c1 - self.c * s1 + self.d * c2 - self.e * s2
    }

    /// Computes the deviation on a magnetic heading, radians (docs/science.md, eq. 7).
    ///
    /// Correct for any ship whose field at the compass is not zero; invertible only after
    /// [`Coefficients::check_unambiguous`].
    pub fn deviation_at_magnetic_rad(&self, magnetic_rad: f64) -> f64 {
        let (s1, c1) = magnetic_rad.sin_cos();
        let (s2, c2) = (2.0 * magnetic_rad).sin_cos();
        let east = self.a + self.b * s1 + self.c * c1 + self.d * s2 + self.e * c2;
        let north = 1.0 + self.b * c1 - self.c * s1 + self.d * c2 - self.e * s2;
        east.atan2(north)
    }

    /// Computes the deviation on a compass heading, radians, in closed form
    /// (docs/science.md, eq. 8); `None` where no or more than one magnetic heading gives
    /// this reading.
    pub fn deviation_at_compass_rad(&self, compass_rad: f64) -> Option<f64> {
        let across = AtCompass::new(self, compass_rad)?;
        let deviation =
            (across.k3 / across.k1.hypot(across.k2)).asin() + across.k2.atan2(across.k1);
        Some(crate::ship::wrap_pi(deviation))
    }

    /// Computes the deviation on a compass heading.
    ///
    /// # Errors
    /// [`DeviationError::Ambiguous`] when some heading of this ship is ambiguous.
    pub fn deviation_at_compass(
        &self,
        compass: CompassHeading,
    ) -> Result<Deviation, DeviationError> {
        self.check_unambiguous()?;
        let radians = self
            .deviation_at_compass_rad(compass.radians())
            .ok_or_else(|| self.ambiguous())?;
        deviation_from(radians)
    }

    /// Computes the deviation on a magnetic heading.
    ///
    /// # Errors
    /// [`DeviationError::Ambiguous`] when some heading of this ship is ambiguous.
    pub fn deviation_at_magnetic(
        &self,
        magnetic: MagneticHeading,
    ) -> Result<Deviation, DeviationError> {
        self.check_unambiguous()?;
        deviation_from(self.deviation_at_magnetic_rad(magnetic.radians()))
    }

    /// Converts a compass heading to magnetic.
    ///
    /// # Errors
    /// [`DeviationError::Ambiguous`] when some heading of this ship is ambiguous.
    pub fn magnetic(&self, compass: CompassHeading) -> Result<MagneticHeading, DeviationError> {
        Ok(compass + self.deviation_at_compass(compass)?)
    }

    /// Converts a magnetic heading to compass.
    ///
    /// # Errors
    /// [`DeviationError::Ambiguous`] when some heading of this ship is ambiguous.
    pub fn compass(&self, magnetic: MagneticHeading) -> Result<CompassHeading, DeviationError> {
        Ok(magnetic - self.deviation_at_magnetic(magnetic)?)
    }

    fn ambiguous(&self) -> DeviationError {
        let (magnetic_rad, directive_force) = self.least_directive_force();
        DeviationError::Ambiguous {
            magnetic_deg: magnetic_rad.to_degrees(),
            directive_force,
        }
    }

    /// Finds the magnetic heading, in [0, 2π), with the least directive force, and that
    /// force.
    fn least_directive_force(&self) -> (f64, f64) {
        const STEPS: u32 = 72;
        let step = std::f64::consts::TAU / f64::from(STEPS);
        let start = (0..STEPS)
            .map(|index| f64::from(index) * step)
            .min_by(|x, y| {
                self.directive_force(*x)
                    .total_cmp(&self.directive_force(*y))
            })
            .expect("there is at least one heading");
        // A sum of two harmonics has one minimum between the neighbours of its
        // least sample, so a ternary search finds it.
        let (mut low, mut high) = (start - step, start + step);
        for _ in 0..60 {
            let third = (high - low) / 3.0;
            if self.directive_force(low + third) < self.directive_force(high - third) {
                high -= third;
            } else {
                low += third;
            }
        }
        let heading = f64::midpoint(low, high);
        let heading = heading.rem_euclid(std::f64::consts::TAU);
        (heading, self.directive_force(heading))
    }
}

/// Sums that determine the deviation on a compass heading ζ: the force across the card is H
/// (K3 + K2 cos δ − K1 sin δ), zero at rest.
struct AtCompass {
    k1: f64,
    k2: f64,
    k3: f64,
    /// √(K1² + K2² − K3²): stability of the heading, positive.
    stability: f64,
}

impl AtCompass {
    fn new(coefficients: &Coefficients, compass_rad: f64) -> Option<AtCompass> {
        let Coefficients { a, b, c, d, e } = *coefficients;
        let (s1, c1) = compass_rad.sin_cos();
        let (s2, c2) = (2.0 * compass_rad).sin_cos();
        let k1 = 1.0 - d * c2 + e * s2;
        let k2 = a + d * s2 + e * c2;
        let k3 = b * s1 + c * c1;
        let stability_squared = k1 * k1 + k2 * k2 - k3 * k3;
        (stability_squared > 0.0).then(|| AtCompass {
            k1,
            k2,
            k3,
            stability: stability_squared.sqrt(),
        })
    }
}

/// Computes the deviation on a compass heading, radians, and its gradient at that fixed
/// compass heading, in the order of [`Parameters`] (docs/science.md, eq. 10).
///
/// # Errors
/// Fails when the field is invalid or headings are ambiguous.
pub fn linearised_at_compass(
    parameters: &Parameters,
    compass_rad: f64,
    earth: EarthField,
) -> Result<(f64, [f64; PARAMETERS]), DeviationError> {
    let coefficients = Coefficients::new(parameters, earth)?;
    coefficients.check_unambiguous()?;
    let ambiguous = || coefficients.ambiguous();
    let deviation = coefficients
        .deviation_at_compass_rad(compass_rad)
        .ok_or_else(ambiguous)?;
    let stability = AtCompass::new(&coefficients, compass_rad)
        .ok_or_else(ambiguous)?
        .stability;
    let [hx, hy, z] = earth.in_ship_axes(compass_rad + deviation);
    let (sin, cos) = compass_rad.sin_cos();
    let (s, c) = (
        sin / (earth.h_nt * stability),
        cos / (earth.h_nt * stability),
    );
    let gradient = [s, z * s, c, z * c, (hx * s - hy * c) / 2.0, hy * s, hx * c];
    Ok((deviation, gradient))
}

fn deviation_from(radians: f64) -> Result<Deviation, DeviationError> {
    Deviation::new(radians.to_degrees()).ok_or(DeviationError::NotFinite)
}

#[cfg(test)]
mod tests;
