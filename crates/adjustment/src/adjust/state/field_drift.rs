//! Possible changes of the ship's permanent field between the model's last heading and the
//! berth, as far as the berth's reading cannot show them.
//!
//! One reading on one heading gives two numbers. A change across the needle turns the
//! measured field, and the berth's angle shows it as precisely as heading and magnetometer
//! are known. A change along the needle changes the strength, like another λ. Invariant:
//! undetected changes are part of a plan's covariance, so that too wide a band refuses the
//! plan (docs/science.md, §11).

use crate::adjust::diagnosis::{LambdaComparison, Refusal};
use crate::adjust::inputs::Adjustment;
use crate::berth::{BerthEstimate, JointCovariance, USUAL_LAMBDA};
use binnacle_compass::deviation::NORMAL_99;
use binnacle_compass::result::NoiseLevels;
use binnacle_compass::ship::PARAMETERS;

/// Period of the typical drift of bx and by, days.
const DRIFT_DAYS: f64 = 30.0;
/// Detectable turn above which the angle's check is weak, degrees.
const SHOWS_LITTLE_DEG: f64 = 4.0;
/// Indices of bx, by and λ among the nine unknowns.
const BX: usize = 0;
const BY: usize = 2;
const LAMBDA: usize = PARAMETERS + 1;

/// Returns the drift of bx and by since the model's last heading, one standard deviation,
/// nT.
pub(crate) fn drift_nt(adjustment: &Adjustment<'_>) -> f64 {
    let circumstances = &adjustment.circumstances;
    let days = circumstances.model_age_days.unwrap_or(0.0);
    if circumstances.is_updated_here {
        0.0
    } else {
        NoiseLevels::TYPICAL.drift_nt * (days / DRIFT_DAYS).sqrt()
    }
}

/// Possible changes of the permanent field, one standard deviation, nT.
#[derive(Clone, Copy, Debug)]
pub(crate) struct FieldDrift {
    /// Direction of the needle in ship axes, `[forward, starboard]`.
    along: [f64; 2],
    /// Measured field, nT.
    field_nt: f64,
    /// Drift in any direction, nT.
    drift_nt: f64,
    /// Change across the needle that the berth's check has not excluded, nT.
    across_nt: f64,
    lambda: f64,
    comparison: Option<LambdaComparison>,
}

impl FieldDrift {
    /// Estimates the possible changes; `lambda_variance` includes the magnetometer's scale.
    pub(crate) fn new(
        adjustment: &Adjustment<'_>,
        estimate: &BerthEstimate,
        lambda_variance: f64,
    ) -> FieldDrift {
        let reading = adjustment.reading;
        let [forward, starboard] = reading.field_nt();
        let field_nt = forward.hypot(starboard);
        let lambda = estimate.lambda.value;
        let circumstances = &adjustment.circumstances;
        let drift_nt = drift_nt(adjustment);
        let sd = lambda_variance.sqrt().hypot(drift_nt * lambda / field_nt);
        let comparison = circumstances
            .earlier_lambda
            .map(|earlier| LambdaComparison {
                earlier,
                difference: lambda - earlier.lambda,
                standard_error: sd.hypot(earlier.standard_error),
            });
        let unchecked_deg = if circumstances.is_updated_here {
            0.0
        } else {
            estimate.consistency.unchecked_deg(reading.errors())
        };
        FieldDrift {
            along: [forward / field_nt, starboard / field_nt],
            field_nt,
            drift_nt,
            across_nt: unchecked_deg.to_radians() * field_nt,
            lambda,
            comparison,
        }
    }

    /// Adds the changes to the covariance of the seven ratios, the constant and λ. A change
    /// Δ along the needle adds to bx and by of the model, and reduces the measured λ by Δ
    /// over the field over λ.
    pub(crate) fn widen(&self, joint: &mut JointCovariance) {
        let [forward, starboard] = self.along;
        let across_nt = self.drift_nt.hypot(self.across_nt);
        let by_lambda = -self.drift_nt * self.lambda / self.field_nt;
        for (way, nt, by_lambda) in [
            ([forward, starboard], self.drift_nt, by_lambda),
            ([-starboard, forward], across_nt, 0.0),
        ] {
            let over_lambda = nt / self.lambda;
            let cause = [
                (BX, way[0] * over_lambda),
                (BY, way[1] * over_lambda),
                (LAMBDA, by_lambda),
            ];
            for (row, one) in cause {
                for (column, other) in cause {
                    joint[row][column] += one * other;
                }
            }
        }
    }

    /// Describes the part of the band that the berth's check leaves open; `None` at a good
    /// berth.
    pub(crate) fn unchecked_note(&self) -> Option<String> {
        let unchecked_deg = (self.across_nt / self.field_nt).to_degrees();
        (unchecked_deg > 0.0).then(|| {
            format!(
                "the ship's own field may have turned since the model, by {unchecked_deg:.1} \
                 degrees (one standard deviation): the berth cannot separate that from the given \
                 errors of heading and magnetometer, so it is included in the band"
            )
        })
    }

    /// Returns a refusal when λ contradicts the earlier one beyond the errors of both.
    pub(crate) fn refusal(&self) -> Option<Refusal> {
        let found = self.comparison?;
        let is_other = found.difference.abs() > NORMAL_99 * found.standard_error;
        is_other.then(|| Refusal::OtherLambda {
            lambda: self.lambda,
            along_nt: found.difference.abs() / self.lambda * self.field_nt,
            comparison: found,
        })
    }

    /// Lists notes on changes that the berth could not show.
    pub(crate) fn notes(&self, detectable_turn_deg: Option<f64>) -> Vec<String> {
        let mut words: Vec<String> = self.unchecked_note().into_iter().collect();
        if let Some(deg) = detectable_turn_deg.filter(|deg| *deg > SHOWS_LITTLE_DEG) {
            words.push(format!(
                "the check of the berth could not have shown a change of the ship's magnetism \
                 that turns the field by less than {deg:.0} degrees: a better heading or \
                 magnetometer would"
            ));
        }
        words.push(self.needle_note());
        words
    }

    /// Describes the change that no reading on one heading shows.
    fn needle_note(&self) -> String {
        let (least, greatest) = (USUAL_LAMBDA.start(), USUAL_LAMBDA.end());
        let room = (self.lambda - least).max(greatest - self.lambda);
        let usual = (room.max(0.0), "keep lambda in its usual range");
        let (could_be, why) = self.comparison.map_or(usual, |found| {
            let within = NORMAL_99 * found.standard_error;
            (within, "be within the errors of both berths")
        });
        let share = could_be / self.lambda;
        format!(
            "one heading cannot separate a change of the ship's magnetism along the needle from \
             lambda: up to {:.1} microtesla of it would {why}, and turn the compass by {:.0} \
             degrees on headings across this one; a reading on another heading would show it, and \
             so would headings at sea",
            share * self.field_nt / 1e3,
            share.atan().to_degrees()
        )
    }
}
