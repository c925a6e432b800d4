//! λ, and with it the whole of the ship's horizontal magnetism.

use super::consistency::{Consistency, Verdict};
use super::direction_check::check_direction;
use super::error::BerthError;
use super::estimated::Estimated;
use super::expected_field::{ExpectedField, Spread, UNKNOWNS, covariances, dot};
use super::lambda_range::{GREATEST_LAMBDA, LEAST_LAMBDA};
use super::reading::BerthReading;
use binnacle_compass::model::{Covariance, Model, Parameters};
use binnacle_compass::ship::EarthField;
use serde::{Deserialize, Serialize};

/// The seven ratios, the constant and λ: where λ stands.
const LAMBDA: usize = UNKNOWNS;

/// Variances and covariances of the seven ratios, the constant and, last, λ.
pub type JointCovariance = [[f64; UNKNOWNS + 1]; UNKNOWNS + 1];

/// What a berth reading tells.
#[derive(Clone, Copy, Debug, PartialEq, Serialize, Deserialize)]
pub struct BerthEstimate {
    /// The mean share of the earth's horizontal field that reaches the compass.
    pub lambda: Estimated,
    /// How well the field's direction agrees: never inconsistent here.
    pub consistency: Consistency,
    /// Poisson's parameters themselves.
    pub parameters: FullParameters,
    /// Of the model's unknowns with λ; `None` when the model came without one.
    pub covariance: Option<JointCovariance>,
}

/// Poisson's horizontal parameters, no longer over λ.
#[derive(Clone, Copy, Debug, PartialEq, Serialize, Deserialize)]
pub struct FullParameters {
    /// a.
    pub chi11: Estimated,
    /// b.
    pub chi12: Estimated,
    /// c.
    pub chi13: Estimated,
    /// d.
    pub chi21: Estimated,
    /// e.
    pub chi22: Estimated,
    /// f.
    pub chi23: Estimated,
    /// P: fore-and-aft permanent field, nT, forward positive.
    pub bx_nt: Estimated,
    /// Q: athwartship permanent field, nT, starboard positive.
    pub by_nt: Estimated,
}

/// λ and all that follows from it, by projecting the field read on the field
/// expected (docs/science.md, eq. 13): as sure on one heading as on another.
///
/// # Errors
/// When the model or the earth's field is none, the model leaves no directive
/// force on this heading, the field's direction is not the model's, or λ is no
/// ship's.
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

/// λ leans on the model, so that it errs together with the model's unknowns.
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
        // λ (share + slope × ratio), where the ratio is the one at `index`.
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
