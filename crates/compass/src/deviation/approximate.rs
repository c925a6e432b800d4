//! The adjuster's five approximate coefficients A to E, in degrees.
//!
//! `deviation ≈ A + B sin ζ + C cos ζ + D sin 2ζ + E cos 2ζ` on compass heading ζ is an
//! approximation: with B 12° and D 4° its error is half a degree. It is printed beside the
//! exact coefficients and never used in calculations.

use super::{Coefficients, DeviationError};
use crate::angle::{CompassHeading, Deviation};
use crate::model::Model;
use crate::ship::EarthField;
use serde::{Deserialize, Serialize};

/// Coefficients A to E in degrees, east positive.
///
/// A of a fitted model includes the offsets that headings cannot separate from it: compass
/// alignment, reference and variation.
#[derive(Clone, Copy, Debug, PartialEq, Serialize, Deserialize)]
#[cfg_attr(feature = "openapi", derive(utoipa::ToSchema))]
#[cfg_attr(feature = "openapi", schema(as = HandbookCoefficients))]
pub struct CoefficientsInDegrees {
    /// Constant part.
    #[serde(rename = "A")]
    pub a_deg: f64,
    /// Semicircular part with the sine of the heading: greatest on east and west.
    #[serde(rename = "B")]
    pub b_deg: f64,
    /// Semicircular part with the cosine: greatest on north and south.
    #[serde(rename = "C")]
    pub c_deg: f64,
    /// Quadrantal part with the sine of twice the heading: greatest between the cardinal
    /// points.
    #[serde(rename = "D")]
    pub d_deg: f64,
    /// Quadrantal part with the cosine of twice the heading: greatest on the cardinal
    /// points.
    #[serde(rename = "E")]
    pub e_deg: f64,
}

impl CoefficientsInDegrees {
    /// Analyses deviations observed on compass headings N, NE, E, SE, S, SW, W and NW (NGA
    /// Pub. 226, art. 501).
    pub fn from_deviations(deviations: [Deviation; 8]) -> CoefficientsInDegrees {
        let [n, ne, e, se, s, sw, w, nw] = deviations.map(Deviation::degrees_east);
        CoefficientsInDegrees {
            a_deg: (n + ne + e + se + s + sw + w + nw) / 8.0,
            b_deg: (e - w) / 2.0,
            c_deg: (n - s) / 2.0,
            d_deg: (ne - se + sw - nw) / 4.0,
            e_deg: (n - e + s - w) / 4.0,
        }
    }

    /// Analyses the exact deviations of a ship on the eight headings, as an adjuster's
    /// swing does.
    ///
    /// # Errors
    /// Fails when headings of the ship are ambiguous.
    pub fn from_swing(
        coefficients: &Coefficients,
    ) -> Result<CoefficientsInDegrees, DeviationError> {
        swing(|compass| coefficients.deviation_at_compass(compass))
    }

    /// Evaluates the five-term approximation on a compass heading, degrees.
    pub fn deviation_deg(&self, compass: CompassHeading) -> f64 {
        let (s1, c1) = compass.radians().sin_cos();
        let (s2, c2) = (2.0 * compass.radians()).sin_cos();
        self.a_deg + self.b_deg * s1 + self.c_deg * c1 + self.d_deg * s2 + self.e_deg * c2
    }
}

impl Coefficients {
    /// Converts the exact coefficients to degrees, for display beside the approximate ones.
    pub fn to_degrees(&self) -> CoefficientsInDegrees {
        CoefficientsInDegrees {
            a_deg: self.a.to_degrees(),
            b_deg: self.b.to_degrees(),
            c_deg: self.c.to_degrees(),
            d_deg: self.d.to_degrees(),
            e_deg: self.e.to_degrees(),
        }
    }
}

impl Model {
    /// Analyses the model's deviations on the eight headings in a field; A includes the
    /// model's constant.
    ///
    /// # Errors
    /// Fails when the field is invalid or headings are ambiguous.
    pub fn approximate_coefficients(
        &self,
        earth: EarthField,
    ) -> Result<CoefficientsInDegrees, DeviationError> {
        swing(|compass| Ok(self.deviation(compass, earth)?.deviation))
    }
}

fn swing(
    deviation: impl Fn(CompassHeading) -> Result<Deviation, DeviationError>,
) -> Result<CoefficientsInDegrees, DeviationError> {
    let mut deviations = [Deviation::ZERO; 8];
    for (step, slot) in deviations.iter_mut().enumerate() {
        let compass = CompassHeading::new(step as f64 * 45.0).expect("a multiple of 45 is finite");
        *slot = deviation(compass)?;
    }
    Ok(CoefficientsInDegrees::from_deviations(deviations))
}

#[cfg(test)]
mod tests {
    use super::*;

    fn assert_near(found: CoefficientsInDegrees, expected: [f64; 5], tolerance: f64) {
        let values = [
            found.a_deg,
            found.b_deg,
            found.c_deg,
            found.d_deg,
            found.e_deg,
        ];
        for (value, expected) in values.into_iter().zip(expected) {
            assert!((value - expected).abs() <= tolerance, "{found:?}");
        }
    }

    #[test]
    fn the_published_swing_has_its_published_coefficients() {
        let observed = [10.5, 20.0, 11.5, -1.2, -5.5, -8.0, -12.5, -6.8];
        let found = CoefficientsInDegrees::from_deviations(
            observed.map(|degrees| Deviation::new(degrees).unwrap()),
        );
        assert_near(found, [1.0, 12.0, 8.0, 5.0, 1.5], 1e-9);
    }

    #[test]
    fn small_coefficients_come_back_from_a_swing() {
        let degree = 1_f64.to_radians();
        let exact = Coefficients {
            a: 0.1 * degree,
            b: 0.5 * degree,
            c: -0.3 * degree,
            d: 0.4 * degree,
            e: -0.2 * degree,
        };
        let found = CoefficientsInDegrees::from_swing(&exact).unwrap();
        assert_near(found, [0.1, 0.5, -0.3, 0.4, -0.2], 0.01);
        assert_near(exact.to_degrees(), [0.1, 0.5, -0.3, 0.4, -0.2], 1e-12);
    }

    #[test]
    fn with_b_12_and_d_4_five_terms_are_wrong_by_half_a_degree() {
        let exact = Coefficients {
            a: 0.0,
            b: 12_f64.to_radians(),
            c: 0.0,
            d: 4_f64.to_radians(),
            e: 0.0,
        };
        let handbook = CoefficientsInDegrees::from_swing(&exact).unwrap();
        let worst = (0..360)
            .map(|degrees| {
                let compass = CompassHeading::new(f64::from(degrees)).unwrap();
                let exact = exact.deviation_at_compass(compass).unwrap();
                (exact.degrees_east() - handbook.deviation_deg(compass)).abs()
            })
            .fold(0.0, f64::max);
        assert!((0.4..0.7).contains(&worst), "{worst}");
    }

    #[test]
    fn json_names_the_coefficients_as_adjusters_do() {
        let handbook = CoefficientsInDegrees::from_deviations([Deviation::ZERO; 8]);
        assert_eq!(
            serde_json::to_string(&handbook).unwrap(),
            r#"{"A":0.0,"B":0.0,"C":0.0,"D":0.0,"E":0.0}"#
        );
    }
}
