//! λ at the berth, and with it all of the ship's horizontal magnetism.

use super::consistency::{Consistency, Verdict};
use super::direction_check::check_direction;
use super::error::BerthError;
use super::estimated::Estimated;
use super::expected_field::{ExpectedField, Spread, UNKNOWNS, covariances, dot};
use super::lambda_range::{GREATEST_LAMBDA, LEAST_LAMBDA};
use super::reading::BerthReading;
use super::two_headings::TwoHeadings;
use binnacle_compass::model::{Covariance, Model, Parameters};
use binnacle_compass::ship::EarthField;
use serde::{Deserialize, Serialize};

/// Index of λ, after the seven ratios and the constant.
const LAMBDA: usize = UNKNOWNS;

/// Covariance of the seven ratios, the constant and, last, λ.
pub type JointCovariance = [[f64; UNKNOWNS + 1]; UNKNOWNS + 1];

/// Result of a berth reading.
#[derive(Clone, Copy, Debug, PartialEq, Serialize, Deserialize)]
pub struct BerthEstimate {
    /// Mean share of the earth's horizontal field that reaches the compass.
    pub lambda: Estimated,
    /// Agreement of the field's direction: never inconsistent here.
    pub consistency: Consistency,
    /// Poisson's parameters themselves.
    pub parameters: FullParameters,
    /// Covariance of the model's unknowns with λ; `None` for a model without one.
    pub covariance: Option<JointCovariance>,
}

/// Poisson's horizontal parameters, not divided by λ.
#[derive(Clone, Copy, Debug, PartialEq, Serialize, Deserialize)]
pub struct FullParameters {
    /// Handbook coefficient a.
    pub chi11: Estimated,
    /// Handbook coefficient b.
    pub chi12: Estimated,
    /// Handbook coefficient c.
    pub chi13: Estimated,
    /// Handbook coefficient d.
    pub chi21: Estimated,
    /// Handbook coefficient e.
    pub chi22: Estimated,
    /// Handbook coefficient f.
    pub chi23: Estimated,
    /// P: fore-and-aft permanent field, nT, forward positive.
    pub bx_nt: Estimated,
    /// Q: athwartship permanent field, nT, starboard positive.
    pub by_nt: Estimated,
}

/// Determines λ and the full parameters by projecting the measured field on the expected
/// one (docs/science.md, eq. 13). The precision does not depend on the heading.
///
/// # Errors
/// Fails when the model or the earth's field is invalid, the model leaves no directive force on
/// this heading, the field's direction differs from the model's, or λ is implausible.
pub fn lambda_at_berth(
    model: &Model,
    earth: EarthField,
    reading: &BerthReading,
) -> Result<BerthEstimate, BerthError> {
    let expected = ExpectedField::new(model, earth, reading)?;
    let covariance = model.covariance.as_ref();
    let consistency = check_direction(&expected, earth, reading, covariance);
    if consistency.verdict == Verdict::Inconsistent {
        return Err(BerthError::Inconsistent(consistency));
    }
    let (b, u) = (reading.field_nt(), expected.u);
    let squared = dot(u, u);
    let lambda = dot(b, u) / squared;
    if !(LEAST_LAMBDA..=GREATEST_LAMBDA).contains(&lambda) {
        return Err(BerthError::Implausible(lambda));
    }
    let by_b = u.map(|part| part / squared);
    let by_u = [0, 1].map(|axis| (b[axis] - 2.0 * lambda * u[axis]) / squared);
    let spread = expected.spread(reading, earth, by_b, by_u);
    let joint = covariance.map(|covariance| joint_covariance(covariance, &spread));
    Ok(BerthEstimate {
        lambda: Estimated {
            value: lambda,
            standard_error: spread.standard_error(covariance),
        },
        consistency,
        parameters: FullParameters::new(&model.parameters_over_lambda, lambda, joint.as_ref()),
        covariance: joint,
    })
}

impl BerthEstimate {
    /// Takes λ and its errors from readings on two headings.
    pub(crate) fn replace_lambda(&mut self, found: &TwoHeadings) {
        self.lambda = Estimated {
            value: found.lambda,
            standard_error: self.covariance.map(|_| found.standard_error),
        };
        if let Some(joint) = &mut self.covariance {
            for (row, with_lambda) in found.with_model.into_iter().enumerate() {
                joint[row][LAMBDA] = with_lambda;
                joint[LAMBDA][row] = with_lambda;
            }
            joint[LAMBDA][LAMBDA] = found.standard_error.powi(2);
        }
    }
}

/// Combines the model's covariance with λ, whose error depends on the model's unknowns.
fn joint_covariance(covariance: &Covariance, spread: &Spread) -> JointCovariance {
    let with_lambda = covariances(covariance, &spread.by_unknown);
    let mut joint = [[0.0; UNKNOWNS + 1]; UNKNOWNS + 1];
    for (row, with_lambda) in with_lambda.into_iter().enumerate() {
        joint[row][..UNKNOWNS].copy_from_slice(&covariance[row]);
        joint[row][LAMBDA] = with_lambda;
        joint[LAMBDA][row] = with_lambda;
    }
    joint[LAMBDA][LAMBDA] = spread.variance(covariance);
    joint
}

impl FullParameters {
    fn new(p: &Parameters, lambda: f64, joint: Option<&JointCovariance>) -> FullParameters {
        let d = p.chi11_minus_chi22 / 2.0;
        // Value λ (share + slope × ratio), where the ratio is the one at `index`.
        let scaled = |index: usize, slope: f64, share: f64| {
            let standard_error = joint.map(|joint| {
                let by_ratio = lambda * slope;
                let variance = by_ratio.powi(2) * joint[index][index]
                    + 2.0 * by_ratio * share * joint[index][LAMBDA]
                    + share.powi(2) * joint[LAMBDA][LAMBDA];
                variance.max(0.0).sqrt()
            });
            Estimated {
                value: lambda * share,
                standard_error,
            }
        };
        let less_1 = |estimated: Estimated| Estimated {
            value: estimated.value - 1.0,
            ..estimated
        };
        FullParameters {
            chi11: less_1(scaled(4, 0.5, 1.0 + d)),
            chi12: scaled(5, 1.0, p.chi12),
            chi13: scaled(1, 1.0, p.chi13),
            chi21: scaled(6, 1.0, p.chi21),
            chi22: less_1(scaled(4, -0.5, 1.0 - d)),
            chi23: scaled(3, 1.0, p.chi23),
            bx_nt: scaled(0, 1.0, p.bx_nt),
            by_nt: scaled(2, 1.0, p.by_nt),
        }
    }
}
