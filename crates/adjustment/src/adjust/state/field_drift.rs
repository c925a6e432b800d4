//! What may have become of the ship's permanent field between the model's last heading and
//! the berth, and how much of it the berth's reading cannot have shown.
//!
//! One reading on one heading gives two numbers. A change across the needle turns the field
//! that is read, and the berth's angle shows it as well as heading and magnetometer are known;
//! a change along the needle makes it stronger or weaker, as another λ would. What always
//! holds: whatever of either has not been shown is in the covariance that a plan carries, so
//! that a band too wide refuses it (docs/science.md, §11).

use crate::adjust::diagnosis::{LambdaComparison, Refusal};
use crate::adjust::inputs::Adjustment;
use crate::berth::{BerthEstimate, JointCovariance, USUAL_LAMBDA};
use binnacle_compass::deviation::NORMAL_99;
use binnacle_compass::result::NoiseLevels;
use binnacle_compass::ship::PARAMETERS;

/// The days in which bx and by wander by their typical drift.
const DRIFT_DAYS: f64 = 30.0;
/// An angle's check that lets more than this pass has not shown much, degrees.
const SHOWS_LITTLE_DEG: f64 = 4.0;
/// Where bx, by and λ stand among the nine.
const BX: usize = 0;
const BY: usize = 2;
const LAMBDA: usize = PARAMETERS + 1;

/// What bx and by may have wandered since the model's last heading, one standard deviation.
pub(crate) fn drift_nt(adjustment: &Adjustment<'_>) -> f64 {
    let circumstances = &adjustment.circumstances;
    let days = circumstances.model_age_days.unwrap_or(0.0);
    if circumstances.is_updated_here {
        0.0
    } else {
        NoiseLevels::TYPICAL.drift_nt * (days / DRIFT_DAYS).sqrt()
    }
}

/// What the permanent field may have changed by, one standard deviation, nT.
#[derive(Clone, Copy, Debug)]
pub(crate) struct FieldDrift {
    /// The way the needle points aboard, `[forward, starboard]`.
    along: [f64; 2],
    /// What was read, nT.
    field_nt: f64,
    /// Any way, by drift.
    drift_nt: f64,
    /// Across the needle, as far as the berth's check has not shown it.
    across_nt: f64,
    lambda: f64,
    comparison: Option<LambdaComparison>,
}

impl FieldDrift {
    /// λ's variance with the magnetometer's scale.
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

    /// Adds it to the covariance of the seven ratios, the constant and λ: with Δ along the
    /// needle bx and by are more by it than the model has, and λ is less than it was read by
    /// Δ over the field over λ.
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

    /// What of a band the berth's check leaves open, in words; none at a good berth.
    pub(crate) fn unchecked_note(&self) -> Option<String> {
        let unchecked_deg = (self.across_nt / self.field_nt).to_degrees();
        (unchecked_deg > 0.0).then(|| {
            format!(
                "the ship's own field may have turned since the model, by {unchecked_deg:.1} \
                 degrees one standard deviation: with the errors that were given for heading and \
                 magnetometer the berth does not tell that from them, and it is in the band"
            )
        })
    }

    /// Whether the earlier λ is contradicted beyond the errors of both.
    pub(crate) fn refusal(&self) -> Option<Refusal> {
        let found = self.comparison?;
        let is_other = found.difference.abs() > NORMAL_99 * found.standard_error;
        is_other.then(|| Refusal::OtherLambda {
            lambda: self.lambda,
            along_nt: found.difference.abs() / self.lambda * self.field_nt,
            comparison: found,
        })
    }

    /// What the berth cannot have shown, for the adjuster.
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

    /// What no reading on one heading shows.
    fn needle_note(&self) -> String {
        let (least, greatest) = (USUAL_LAMBDA.start(), USUAL_LAMBDA.end());
        let room = (self.lambda - least).max(greatest - self.lambda);
        let usual = (room.max(0.0), "leave lambda usual");
        let (could_be, why) = self.comparison.map_or(usual, |found| {
            let within = NORMAL_99 * found.standard_error;
            (within, "be within the errors of both berths")
        });
        let share = could_be / self.lambda;
        format!(
            "one heading does not tell a change of the ship's magnetism along the needle from \
             lambda: up to {:.1} microtesla of it would {why}, and turn the compass by {:.0} \
             degrees on headings across this one; a reading on another heading would show it, \
             and so do headings at sea",
            share * self.field_nt / 1e3,
            share.atan().to_degrees()
        )
    }
}
