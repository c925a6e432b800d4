//! Deviations predicted by a fitted model, with their uncertainty.
//!
//! The prediction is the deviation that the compass's user sees: the exact deviation of the
//! parameters plus the model's constant. Its standard error comes from the model's
//! covariance through the gradient at the fixed compass heading (docs/science.md, eq. 11).

use super::{Coefficients, DeviationError, linearised_at_compass};
use crate::angle::{CompassHeading, Deviation, MagneticHeading, TrueHeading, Variation};
use crate::model::{Covariance, Model};
use crate::ship::{EarthField, PARAMETERS};
use serde::{Deserialize, Serialize};

/// Two-sided 95 % of a normal distribution, in standard deviations.
pub const NORMAL_95: f64 = 1.959_964;

/// Two-sided 99 % of a normal distribution, in standard deviations.
pub const NORMAL_99: f64 = 2.575_829;

/// A predicted deviation with its uncertainty.
#[derive(Clone, Copy, Debug, PartialEq, Serialize, Deserialize)]
pub struct Prediction {
    /// Deviation as seen by the compass's user.
    #[serde(rename = "deviation_deg")]
    pub deviation: Deviation,
    /// Standard error in degrees; `None` for a model without a covariance.
    pub standard_error_deg: Option<f64>,
    /// Half the width of the 95 % band in degrees, at most 180; `None` for a model without
    /// a covariance.
    pub band95_deg: Option<f64>,
}

impl Model {
    /// Predicts the deviation on a compass heading in the earth's field.
    ///
    /// # Errors
    /// Fails when the field is invalid, the model is not finite, or headings of the ship are
    /// ambiguous.
    pub fn deviation(
        &self,
        compass: CompassHeading,
        earth: EarthField,
    ) -> Result<Prediction, DeviationError> {
        let parameters = self.parameters_at(earth);
        let (radians, gradient) = linearised_at_compass(&parameters, compass.radians(), earth)?;
        let deviation = Deviation::new(radians.to_degrees() + self.constant_deg)
            .ok_or(DeviationError::NotFinite)?;
        let Some(covariance) = &self.covariance else {
            return Ok(Prediction {
                deviation,
                standard_error_deg: None,
                band95_deg: None,
            });
        };
        let of_needles = self.needles.map_or(0.0, |needles| {
            let change = needles.change(earth);
            let turned: f64 = gradient.iter().zip(change).map(|(g, c)| g * c).sum();
            needles.relative_sd * turned.to_degrees()
        });
        let standard_error = standard_error_deg(covariance, &gradient)?.hypot(of_needles);
        Ok(Prediction {
            deviation,
            standard_error_deg: Some(standard_error),
            band95_deg: Some((NORMAL_95 * standard_error).min(180.0)),
        })
    }

    /// Converts a compass heading to magnetic.
    ///
    /// # Errors
    /// As [`Model::deviation`].
    pub fn magnetic(
        &self,
        compass: CompassHeading,
        earth: EarthField,
    ) -> Result<MagneticHeading, DeviationError> {
        Ok(compass + self.deviation(compass, earth)?.deviation)
    }

    /// Converts a magnetic heading to compass: the inverse of [`Model::magnetic`].
    ///
    /// # Errors
    /// As [`Model::deviation`].
    pub fn compass(
        &self,
        magnetic: MagneticHeading,
        earth: EarthField,
    ) -> Result<CompassHeading, DeviationError> {
        let coefficients = Coefficients::new(&self.parameters_at(earth), earth)?;
        // The constant is not part of the ship's magnetism and is removed first.
        let by_the_ship = MagneticHeading::new(magnetic.degrees() - self.constant_deg)
            .ok_or(DeviationError::NotFinite)?;
        coefficients.compass(by_the_ship)
    }

    /// Converts a true heading to compass: the heading to steer.
    ///
    /// # Errors
    /// As [`Model::deviation`].
    pub fn compass_for_true(
        &self,
        true_heading: TrueHeading,
        variation: Variation,
        earth: EarthField,
    ) -> Result<CompassHeading, DeviationError> {
        self.compass(true_heading - variation, earth)
    }
}

/// Propagates the covariance to the deviation's standard error, degrees, by the parameters'
/// gradient in radians a unit; the constant's own is 1.
fn standard_error_deg(
    covariance: &Covariance,
    gradient: &[f64; PARAMETERS],
) -> Result<f64, DeviationError> {
    let mut slope = [1.0; PARAMETERS + 1];
    for (degrees, radians) in slope.iter_mut().zip(gradient) {
        *degrees = radians.to_degrees();
    }
    let variance: f64 = covariance
        .iter()
        .zip(slope)
        .map(|(row, by)| by * row.iter().zip(slope).map(|(v, s)| v * s).sum::<f64>())
        .sum();
    if !variance.is_finite() {
        return Err(DeviationError::NotFinite);
    }
    // Rounding may make a variance of zero slightly negative.
    Ok(variance.max(0.0).sqrt())
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::angle::wrap_180;
    use crate::model::{NeedleInduction, Parameters, ReferenceGrade};
    use crate::ship::test_support::{random_earth, random_ship};
    use rand::{RngExt, SeedableRng};
    use rand_chacha::ChaCha8Rng;

    const BISCAY: EarthField = EarthField {
        h_nt: 24_000.0,
        z_nt: 38_500.0,
    };

    fn model() -> Model {
        Model {
            parameters_over_lambda: Parameters {
                bx_nt: 2_060.0,
                chi13: -0.0215,
                by_nt: -2_930.0,
                chi23: 0.0022,
                chi11_minus_chi22: 0.0352,
                chi12: 0.0012,
                chi21: 0.0016,
            },
            constant_deg: 0.7,
            covariance: None,
            identifiable: None,
            rms_deg: None,
            samples_used: 0,
            samples_rejected: 0,
            quality: None,
            reference_grade: ReferenceGrade::Heading,
            mean_h_nt: None,
            needles: None,
        }
    }

    fn heading(degrees: f64) -> CompassHeading {
        CompassHeading::new(degrees).unwrap()
    }

    #[test]
    fn parameters_alone_make_a_model_and_its_band_is_unknown() {
        let json = r#"{"parameters_over_lambda":{"bx_nt":2060,"chi13":0,"by_nt":0,"chi23":0,
            "chi11_minus_chi22":0,"chi12":0,"chi21":0}}"#;
        let model: Model = serde_json::from_str(json).unwrap();
        let prediction = model.deviation(heading(90.0), BISCAY).unwrap();
        let expected = (2_060.0_f64 / 24_000.0).asin().to_degrees();
        assert!((prediction.deviation.degrees_east() - expected).abs() < 1e-9);
        assert_eq!(prediction.band95_deg, None);
    }

    #[test]
    fn the_constant_is_added_with_its_sign_and_its_variance() {
        let mut with = model();
        let mut covariance = [[0.0; 8]; 8];
        covariance[7][7] = 0.25;
        with.covariance = Some(covariance);
        let mut without = with.clone();
        without.constant_deg = 0.0;
        for degrees in [0.0, 133.0, 270.0] {
            let with = with.deviation(heading(degrees), BISCAY).unwrap();
            let without = without.deviation(heading(degrees), BISCAY).unwrap();
            let added = with.deviation.degrees_east() - without.deviation.degrees_east();
            assert!((added - 0.7).abs() < 1e-9);
            assert!((with.standard_error_deg.unwrap() - 0.5).abs() < 1e-12);
            assert!((with.band95_deg.unwrap() - 0.98).abs() < 1e-3);
        }
    }

    /// D of 2° by the needles at 36 µT is 4° at 18 µT, on the headings between the cardinal
    /// points, and its error is in the band.
    #[test]
    fn what_the_needles_induce_grows_as_the_horizontal_field_falls() {
        let mut model = model();
        let (strong_nt, d) = (36_000.0, 2_f64.to_radians());
        model.parameters_over_lambda = Parameters {
            chi11_minus_chi22: 2.0 * d,
            ..Parameters::from_array([0.0; PARAMETERS])
        };
        model.constant_deg = 0.0;
        model.covariance = Some([[0.0; 8]; 8]);
        model.needles = Some(NeedleInduction {
            d_nt: d * strong_nt,
            e_nt: 0.0,
            reference_h_nt: strong_nt,
            relative_sd: 0.1,
        });
        let north_east = |h_nt: f64| {
            let earth = EarthField { h_nt, z_nt: 0.0 };
            let found = model.deviation(heading(45.0), earth).unwrap();
            (
                found.deviation.degrees_east(),
                found.standard_error_deg.unwrap(),
            )
        };
        let ((strong_deg, known), (weak_deg, sd_deg)) = (north_east(strong_nt), north_east(18e3));
        assert!(
            (strong_deg - 2.0).abs() < 0.01 && known < 1e-9,
            "{strong_deg}"
        );
        assert!((weak_deg - 4.0).abs() < 0.02, "{weak_deg}");
        assert!((sd_deg - 0.2).abs() < 0.01, "{sd_deg}");
        let text = serde_json::to_string(&model).unwrap();
        assert_eq!(serde_json::from_str::<Model>(&text).unwrap(), model);
        model.needles.as_mut().unwrap().reference_h_nt = 0.0;
        assert!(model.check().is_err());
    }

    #[test]
    fn compass_to_true_and_back_is_where_it_began() {
        let model = model();
        for variation in [-25.0, -3.4, 0.0, 17.0] {
            let variation = Variation::new(variation).unwrap();
            for degrees in (0..360).step_by(5) {
                let compass = heading(f64::from(degrees));
                let true_heading = model.magnetic(compass, BISCAY).unwrap() + variation;
                let back = model
                    .compass_for_true(true_heading, variation, BISCAY)
                    .unwrap();
                assert!(wrap_180(back.degrees() - compass.degrees()).abs() < 1e-7);
            }
        }
    }

    /// Definition of the covariance: scatter of deviations over draws of the model.
    #[test]
    fn the_standard_error_is_the_scatter_of_drawn_models() {
        let mut rng = ChaCha8Rng::seed_from_u64(9);
        let deviations = [40.0, 1e-3, 30.0, 1e-3, 8e-4, 5e-4, 5e-4, 0.05];
        // bx and chi13 are correlated, as after a voyage at one latitude.
        let correlation = -0.9;
        let mut covariance = [[0.0; 8]; 8];
        for (index, deviation) in deviations.iter().enumerate() {
            covariance[index][index] = deviation * deviation;
        }
        covariance[0][1] = correlation * deviations[0] * deviations[1];
        covariance[1][0] = covariance[0][1];
        let mut base = model();
        base.covariance = Some(covariance);
        // A sum of twelve uniforms is near enough to normal for a variance.
        let mut normal = || (0..12).map(|_| rng.random_range(-0.5..0.5)).sum::<f64>();
        let draws: Vec<Model> = (0..20_000)
            .map(|_| {
                let mut shift: [f64; 8] = std::array::from_fn(|_| normal());
                shift[1] =
                    correlation * shift[0] + (1.0 - correlation * correlation).sqrt() * shift[1];
                let mut array = base.parameters_over_lambda.to_array();
                for (index, value) in array.iter_mut().enumerate() {
                    *value += deviations[index] * shift[index];
                }
                let mut drawn = base.clone();
                drawn.covariance = None;
                drawn.parameters_over_lambda = Parameters::from_array(array);
                drawn.constant_deg += deviations[7] * shift[7];
                drawn
            })
            .collect();
        for degrees in [10.0, 95.0, 200.0, 310.0] {
            let prediction = base.deviation(heading(degrees), BISCAY).unwrap();
            let centre = prediction.deviation.degrees_east();
            let squares: f64 = draws
                .iter()
                .map(|drawn| {
                    let drawn = drawn.deviation(heading(degrees), BISCAY).unwrap();
                    (drawn.deviation.degrees_east() - centre).powi(2)
                })
                .sum();
            let scatter = (squares / draws.len() as f64).sqrt();
            let expected = prediction.standard_error_deg.unwrap();
            assert!(
                (scatter / expected - 1.0).abs() < 0.03,
                "{scatter} {expected}"
            );
        }
    }

    #[test]
    fn a_model_that_is_not_finite_is_refused() {
        let mut broken = model();
        broken.constant_deg = f64::NAN;
        let refused = broken.deviation(heading(1.0), BISCAY).unwrap_err();
        assert_eq!(refused, DeviationError::NotFinite);
        let mut broken = model();
        broken.covariance = Some([[f64::NAN; 8]; 8]);
        assert!(broken.deviation(heading(1.0), BISCAY).is_err());
    }

    #[test]
    fn every_random_ship_is_answered_or_refused_by_name() {
        let mut rng = ChaCha8Rng::seed_from_u64(10);
        let (mut answered, mut refused) = (0, 0);
        for _ in 0..300 {
            let mut ship = random_ship(&mut rng);
            ship.b_nt[0] *= 10.0;
            let mut model = model();
            model.parameters_over_lambda = ship.parameters_over_lambda().unwrap();
            match model.deviation(heading(50.0), random_earth(&mut rng)) {
                Ok(prediction) => {
                    assert!(prediction.deviation.degrees_east().abs() < 91.0);
                    answered += 1;
                }
                Err(DeviationError::Ambiguous {
                    directive_force, ..
                }) => {
                    assert!(directive_force <= 0.0);
                    refused += 1;
                }
                Err(other) => panic!("{other}"),
            }
        }
        assert!(answered > 50 && refused > 10, "{answered} {refused}");
    }
}
