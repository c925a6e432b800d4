//! Second reading of the magnetometer after the steps, which shows errors that the compass
//! on one heading cannot.
//!
//! With the bowl out again, the same magnetometer is in the same place. The innovation is
//! attributed to expected errors, which update the model, or to slips of the hand, which
//! are named. Invariants: a fitting reading narrows the band no further than the remaining
//! hypotheses allow. A reading better explained by a slip names the step. An unexplained
//! reading confirms nothing (docs/science.md, §11).

mod result;

mod hypotheses;
mod innovation;

mod judge;
mod update;

pub use result::{CompletedStep, FieldComponent, PostCheck, Slip, UpdatedPrediction, Verdict};

use super::inputs::{self, AdjustError, Adjustment, Unit, VerticalReading};
use super::state::MagneticState;
use crate::berth::BerthReading;
pub(crate) use hypotheses::{MOMENT_SD, OTHER_MOMENT};
use hypotheses::{weigh_by_compass, weigh_hypotheses};
use innovation::Innovation;
use judge::Judge;
use update::update_prediction;

/// Judges a second reading by the same magnetometer, with the correctors in the setting
/// `adjustment.now` after these steps. `named` is the entered unit of its figures,
/// `compass_deg` the compass heading before the bowl was taken out.
///
/// # Errors
/// Fails when the input of the adjustment is invalid.
pub fn check_second_reading(
    adjustment: &Adjustment<'_>,
    done: &[CompletedStep],
    reading: &BerthReading,
    vertical: Option<VerticalReading>,
    compass_deg: Option<f64>,
    named: Unit,
) -> Result<PostCheck, AdjustError> {
    inputs::validate(adjustment)?;
    if let Some(vertical) = vertical {
        vertical.check_range()?;
    }
    let state = MagneticState::new(adjustment)?;
    let known = state.with_setting(adjustment.standing())?;
    let innovation = Innovation::new(adjustment, &state, &known, reading, vertical);
    let posterior = weigh_hypotheses(adjustment, &state, &known, &innovation, done);
    let judge = Judge {
        adjustment,
        state: &state,
        known: &known,
        reading,
        vertical,
        compass_deg,
        named,
    };
    let card = judge.card(reading)?;
    let verdict = if card.is_some_and(|card| card.is_refused()) {
        Verdict::Unexplained {
            misreadings: judge.misreadings(),
        }
    } else {
        judge.verdict(&innovation, &posterior)?
    };
    Ok(PostCheck {
        parts: parts(&innovation),
        card,
        verdict,
    })
}

/// Predicts the deviation for the setting `adjustment.now` after these steps, without a
/// second reading: slips and moments that the compass leaves open widen the band.
///
/// # Errors
/// Fails when the input of the adjustment is invalid.
pub fn predict_by_compass(
    adjustment: &Adjustment<'_>,
    done: &[CompletedStep],
) -> Result<UpdatedPrediction, AdjustError> {
    inputs::validate(adjustment)?;
    let state = MagneticState::new(adjustment)?;
    let known = state.with_setting(adjustment.standing())?;
    let reading = adjustment.reading;
    let innovation = Innovation::new(adjustment, &state, &known, reading, adjustment.vertical);
    let posterior = weigh_by_compass(adjustment, &state, &known, &innovation, done);
    update_prediction(adjustment, &known, &posterior)
}

fn parts(innovation: &Innovation) -> Vec<FieldComponent> {
    let count = if innovation.is_vertical_known { 3 } else { 2 };
    let part = |axis: usize| FieldComponent {
        expected_nt: innovation.expected[axis],
        read_nt: innovation.read[axis],
        standard_error_nt: innovation.spread[(axis, axis)].sqrt(),
    };
    (0..count).map(part).collect()
}

#[cfg(test)]
mod tests;
