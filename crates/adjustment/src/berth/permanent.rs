//! bx and by from a reading, with soft iron and λ unchanged.
//!
//! For a ship whose magnets were moved after λ was determined: the soft iron is unchanged,
//! so one reading shows the magnets' new effect without headings at sea.

use super::error::BerthError;
use super::estimated::Estimated;
use super::expected_field::{ExpectedField, Spread};
use super::lambda_range::{GREATEST_LAMBDA, LEAST_LAMBDA};
use super::reading::BerthReading;
use binnacle_compass::model::Model;
use binnacle_compass::ship::EarthField;
use serde::{Deserialize, Serialize};

/// Permanent horizontal field of a ship.
#[derive(Clone, Copy, Debug, PartialEq, Serialize, Deserialize)]
pub struct Permanent {
    /// Fore and aft, nT, forward positive; not divided by λ.
    pub bx_nt: Estimated,
    /// Athwartships, nT, starboard positive; not divided by λ.
    pub by_nt: Estimated,
}

/// Determines the permanent field from a reading and an earlier λ: b = B − λ(u − b').
/// Heading and alignment errors count as about |B| times their angle.
///
/// The errors of λ and of the model are treated as independent: nearly all of λ's error
/// comes from its own reading.
///
/// # Errors
/// Fails when the model or the earth's field is invalid, the model leaves no directive force on
/// this heading, or λ or its standard error is implausible.
pub fn permanent_at_berth(
    model: &Model,
    earth: EarthField,
    reading: &BerthReading,
    lambda: Estimated,
) -> Result<Permanent, BerthError> {
    if !(LEAST_LAMBDA..=GREATEST_LAMBDA).contains(&lambda.value) {
        return Err(BerthError::Implausible(lambda.value));
    }
    if let Some(value) = lambda.standard_error
        && !(0.0..=GREATEST_LAMBDA).contains(&value)
    {
        return Err(BerthError::Reading {
            name: "lambda's standard error",
            value,
            least: 0.0,
            greatest: GREATEST_LAMBDA,
        });
    }
    let expected = ExpectedField::new(model, earth, reading)?;
    let p = &model.parameters_over_lambda;
    let permanent = [p.bx_nt, p.by_nt];
    let solve = |axis: usize| {
        let others = expected.u[axis] - permanent[axis];
        let mut by_b = [0.0; 2];
        by_b[axis] = 1.0;
        let by_u = by_b.map(|slope| -lambda.value * slope);
        let mut spread: Spread = expected.spread(reading, earth, by_b, by_u);
        // The model's own bx and by play no part.
        spread.by_unknown[0] = 0.0;
        spread.by_unknown[2] = 0.0;
        let standard_error = model.covariance.as_ref().zip(lambda.standard_error);
        Estimated {
            value: reading.field_nt()[axis] - lambda.value * others,
            standard_error: standard_error.map(|(covariance, error)| {
                spread.variance(covariance).sqrt().hypot(others * error)
            }),
        }
    };
    Ok(Permanent {
        bx_nt: solve(0),
        by_nt: solve(1),
    })
}
