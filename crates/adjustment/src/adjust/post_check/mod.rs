//! The magnetometer read once more, after the steps: what the compass on one heading cannot
//! show, the field can.
//!
//! With the bowl out again the same magnetometer lies in the same place. What it reads less
//! what was foretold is told apart into errors that were to be expected, which sharpen the
//! model, and slips of the hand, which are named. What always holds: a reading that fits
//! makes the band no narrower than all that may still be wrong together leaves it; one that
//! a slip explains better names the step; one that nothing explains confirms nothing
//! (docs/science.md, §11).

mod result;

mod hypotheses;
mod innovation;

mod judge;
mod update;

pub use result::{Again, Done, Learnt, Part, Slip, Verdict};

use super::inputs::{self, AdjustError, Adjustment, Unit, VerticalReading};
use super::state::Condition;
use crate::berth::BerthReading;
use hypotheses::{weigh, weigh_by_compass};
use innovation::News;
use judge::Judge;
use update::learnt;

/// Judges a second reading by the same magnetometer, the correctors standing as
/// `adjustment.now` says after these steps. `named` is the unit that its figures were said
/// to be in, `compass_deg` what the compass read before the bowl was taken out.
///
/// # Errors
/// When the adjustment itself cannot be.
pub fn read_again(
    adjustment: &Adjustment<'_>,
    done: &[Done],
    reading: &BerthReading,
    vertical: Option<VerticalReading>,
    compass_deg: Option<f64>,
    named: Unit,
) -> Result<Again, AdjustError> {
    inputs::check(adjustment)?;
    if let Some(vertical) = vertical {
        vertical.must_be_a_field()?;
    }
    let condition = Condition::new(adjustment)?;
    let known = condition.known_with(adjustment.standing())?;
    let news = News::new(adjustment, &condition, &known, reading, vertical);
    let weighed = weigh(adjustment, &condition, &known, &news, done);
    let judge = Judge {
        adjustment,
        condition: &condition,
        known: &known,
        reading,
        vertical,
        compass_deg,
        named,
    };
    let card = judge.card(reading)?;
    let verdict = if card.is_some_and(|card| card.is_refused()) {
        Verdict::Unexplained {
            mistakes: judge.mistakes(),
        }
    } else {
        judge.verdict(&news, &weighed)?
    };
    Ok(Again {
        parts: parts(&news),
        card,
        verdict,
    })
}

/// What is foretold of correctors that stand as `adjustment.now` says after these steps,
/// where the field was not read again: what the compass leaves open of slips and of
/// magnets' moments is in the band.
///
/// # Errors
/// When the adjustment itself cannot be.
pub fn by_compass(adjustment: &Adjustment<'_>, done: &[Done]) -> Result<Learnt, AdjustError> {
    inputs::check(adjustment)?;
    let condition = Condition::new(adjustment)?;
    let known = condition.known_with(adjustment.standing())?;
    let reading = adjustment.reading;
    let news = News::new(adjustment, &condition, &known, reading, adjustment.vertical);
    let weighed = weigh_by_compass(adjustment, &condition, &known, &news, done);
    learnt(adjustment, &condition, &known, &weighed)
}

fn parts(news: &News) -> Vec<Part> {
    let count = if news.is_vertical_known { 3 } else { 2 };
    let part = |axis: usize| Part {
        expected_nt: news.expected[axis],
        read_nt: news.read[axis],
        standard_error_nt: news.spread[(axis, axis)].sqrt(),
    };
    (0..count).map(part).collect()
}

#[cfg(test)]
mod tests;
