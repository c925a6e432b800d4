//! Validation of a model from outside.
//!
//! A model from a file or the network is checked once, where it is read. After that its
//! numbers are finite, of a ship's size, and its covariance is positive semidefinite.

use crate::model::{Covariance, Model, NeedleInduction};
use crate::ship::WEAKEST_H_NT;
use nalgebra::SMatrix;

/// Names of the parameters and the constant, in the covariance's order.
pub const PARAMETER_NAMES: [&str; 8] = [
    "bx_nt",
    "chi13",
    "by_nt",
    "chi23",
    "chi11_minus_chi22",
    "chi12",
    "chi21",
    "constant_deg",
];

/// Ten times the strongest field of any ship, nT; a larger number has the wrong unit.
const GREATEST_FIELD_NT: f64 = 1e6;
/// Greatest soft-iron coefficient; a larger one would turn the compass around many times
/// over.
const GREATEST_CHI: f64 = 10.0;
/// Tolerance of correlations, for the rounding of a printed covariance.
const ROUNDING: f64 = 1e-5;

/// Error of an invalid model.
#[derive(Clone, Debug, PartialEq, thiserror::Error)]
pub enum ModelError {
    /// A parameter or the constant is not finite, or larger than any ship's.
    #[error("{name} is {value}, not a number between -{limit} and {limit}")]
    Value {
        /// Name of the parameter, as in JSON.
        name: &'static str,
        /// Given value.
        value: f64,
        /// Greatest accepted magnitude.
        limit: f64,
    },
    /// The mean field, or a number of the needles' part, is out of its range.
    #[error("{name} is {value}, not a number between {least} and {greatest}")]
    Range {
        /// Name of the number, as in JSON.
        name: &'static str,
        /// Given value.
        value: f64,
        /// Least accepted value.
        least: f64,
        /// Greatest accepted value.
        greatest: f64,
    },
    /// The residuals' root mean square is negative or not finite.
    #[error("rms_deg is {0}, not a positive number")]
    Rms(f64),
    /// A variance or covariance is not finite, or a variance negative.
    #[error("covariance of {row} and {column} is {value}")]
    CovarianceValue {
        /// Parameter of the row.
        row: &'static str,
        /// Parameter of the column.
        column: &'static str,
        /// Given value.
        value: f64,
    },
    /// The covariance differs from its transpose.
    #[error("covariance of {row} and {column} differs from that of {column} and {row}")]
    NotSymmetric {
        /// Parameter of the row.
        row: &'static str,
        /// Parameter of the column.
        column: &'static str,
    },
    /// Some combination of parameters has a negative variance.
    #[error("covariance is not positive semidefinite: its least scaled eigenvalue is {0:.3e}")]
    NotPositive(f64),
}

impl Model {
    /// Checks that the numbers are plausible for a ship.
    ///
    /// # Errors
    /// Names the first implausible number.
    pub fn check(&self) -> Result<(), ModelError> {
        let parameters = self.parameters_over_lambda.to_array();
        for (index, name) in PARAMETER_NAMES.into_iter().enumerate() {
            let (value, limit) = match index {
                0 | 2 => (parameters[index], GREATEST_FIELD_NT),
                7 => (self.constant_deg, 180.0),
                _ => (parameters[index], GREATEST_CHI),
            };
            if !(-limit..=limit).contains(&value) {
                return Err(ModelError::Value { name, value, limit });
            }
        }
        if let Some(rms) = self.rms_deg
            && !(rms >= 0.0 && rms.is_finite())
        {
            return Err(ModelError::Rms(rms));
        }
        if let Some(mean_h_nt) = self.mean_h_nt {
            check_range("mean_h_nt", mean_h_nt, WEAKEST_H_NT, GREATEST_FIELD_NT)?;
        }
        if let Some(needles) = &self.needles {
            check_needles(needles)?;
        }
        self.covariance.as_ref().map_or(Ok(()), check_covariance)
    }
}

fn check_needles(needles: &NeedleInduction) -> Result<(), ModelError> {
    for (name, value, least, greatest) in [
        (
            "needles.d_nt",
            needles.d_nt,
            -GREATEST_FIELD_NT,
            GREATEST_FIELD_NT,
        ),
        (
            "needles.e_nt",
            needles.e_nt,
            -GREATEST_FIELD_NT,
            GREATEST_FIELD_NT,
        ),
        (
            "needles.reference_h_nt",
            needles.reference_h_nt,
            WEAKEST_H_NT,
            GREATEST_FIELD_NT,
        ),
        ("needles.relative_sd", needles.relative_sd, 0.0, 1.0),
    ] {
        check_range(name, value, least, greatest)?;
    }
    Ok(())
}

fn check_range(
    name: &'static str,
    value: f64,
    least: f64,
    greatest: f64,
) -> Result<(), ModelError> {
    if (least..=greatest).contains(&value) {
        return Ok(());
    }
    Err(ModelError::Range {
        name,
        value,
        least,
        greatest,
    })
}

fn check_covariance(covariance: &Covariance) -> Result<(), ModelError> {
    let scale = scales(covariance)?;
    let mut correlation = SMatrix::<f64, 8, 8>::zeros();
    for row in 0..8 {
        for column in 0..8 {
            let scaled = |value: f64| value / (scale[row] * scale[column]);
            let here = scaled(covariance[row][column]);
            if (here - scaled(covariance[column][row])).abs() > ROUNDING {
                return Err(ModelError::NotSymmetric {
                    row: PARAMETER_NAMES[row],
                    column: PARAMETER_NAMES[column],
                });
            }
            correlation[(row, column)] = here;
        }
    }
    let least = correlation.symmetric_eigenvalues().min();
    if least < -ROUNDING {
        return Err(ModelError::NotPositive(least));
    }
    Ok(())
}

/// Returns the standard deviations; 1 where the variance is zero, so that nothing is
/// divided by zero.
fn scales(covariance: &Covariance) -> Result<[f64; 8], ModelError> {
    let mut scales = [1.0; 8];
    for row in 0..8 {
        for column in 0..8 {
            let value = covariance[row][column];
            if !value.is_finite() || (row == column && value < 0.0) {
                return Err(ModelError::CovarianceValue {
                    row: PARAMETER_NAMES[row],
                    column: PARAMETER_NAMES[column],
                    value,
                });
            }
        }
        if covariance[row][row] > 0.0 {
            scales[row] = covariance[row][row].sqrt();
        }
    }
    Ok(scales)
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::model::{Parameters, ReferenceGrade};

    fn model(covariance: Option<&Covariance>) -> Model {
        Model {
            parameters_over_lambda: Parameters::from_array([
                2_000.0, 0.01, -500.0, 0.0, 0.03, 0.0, 0.0,
            ]),
            constant_deg: 0.0,
            covariance: covariance.copied(),
            identifiable: None,
            rms_deg: Some(0.4),
            samples_used: 100,
            samples_rejected: 3,
            quality: None,
            reference_grade: ReferenceGrade::Heading,
            mean_h_nt: None,
            needles: None,
        }
    }

    fn diagonal() -> Covariance {
        let mut covariance = [[0.0; 8]; 8];
        for (index, deviation) in [40.0, 1e-3, 30.0, 1e-3, 8e-4, 5e-4, 5e-4, 0.05]
            .into_iter()
            .enumerate()
        {
            covariance[index][index] = deviation * deviation;
        }
        covariance
    }

    #[test]
    fn a_whole_model_passes_with_and_without_a_covariance() {
        assert_eq!(model(None).check(), Ok(()));
        assert_eq!(model(Some(&diagonal())).check(), Ok(()));
        assert_eq!(model(Some(&[[0.0; 8]; 8])).check(), Ok(()));
    }

    #[test]
    fn a_parameter_in_the_wrong_unit_is_named() {
        let mut wrong = model(None);
        wrong.parameters_over_lambda.by_nt = 2e6;
        assert_eq!(
            wrong.check().unwrap_err().to_string(),
            "by_nt is 2000000, not a number between -1000000 and 1000000"
        );
        wrong = model(None);
        wrong.constant_deg = f64::NAN;
        let refused = wrong.check().unwrap_err();
        assert!(refused.to_string().starts_with("constant_deg is NaN"));
    }

    #[test]
    fn a_covariance_off_its_transpose_is_named() {
        let mut covariance = diagonal();
        covariance[0][1] = 0.5 * 40.0 * 1e-3;
        assert_eq!(
            model(Some(&covariance)).check().unwrap_err().to_string(),
            "covariance of bx_nt and chi13 differs from that of chi13 and bx_nt"
        );
    }

    #[test]
    fn a_correlation_beyond_one_is_no_covariance() {
        let mut covariance = diagonal();
        for (correlation, good) in [(-1.0, true), (-0.999_999_9, true), (-1.01, false)] {
            covariance[0][1] = correlation * 40.0 * 1e-3;
            covariance[1][0] = covariance[0][1];
            assert_eq!(
                model(Some(&covariance)).check().is_ok(),
                good,
                "{correlation}"
            );
        }
    }

    #[test]
    fn a_covariance_with_what_is_exactly_known_is_no_covariance() {
        let mut covariance = diagonal();
        covariance[7][7] = 0.0;
        assert_eq!(model(Some(&covariance)).check(), Ok(()));
        covariance[7][6] = 0.01;
        covariance[6][7] = 0.01;
        let refused = model(Some(&covariance)).check().unwrap_err();
        assert!(matches!(refused, ModelError::NotPositive(_)));
    }

    #[test]
    fn a_negative_variance_and_an_infinite_one_are_named() {
        for value in [-1e-9, f64::INFINITY, f64::NAN] {
            let mut covariance = diagonal();
            covariance[4][4] = value;
            let refused = model(Some(&covariance)).check().unwrap_err().to_string();
            assert!(refused.contains("chi11_minus_chi22"), "{refused}");
        }
        let mut wrong = model(None);
        wrong.rms_deg = Some(-1.0);
        assert_eq!(wrong.check(), Err(ModelError::Rms(-1.0)));
    }
}
