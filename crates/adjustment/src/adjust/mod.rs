//! Adjusting at the berth, without a swing: from the model, one magnetometer reading
//! and the binnacle's correctors to settings, predictions and instructions.
//!
//! The ship herself is what was measured less what the correctors did then; any other
//! setting is put to her with all its interactions (docs/science.md, §11). What always
//! holds: a plan uses only what is on board, its predictions carry the errors of model,
//! λ and correctors together, and where that is not good enough there is no plan but a
//! refusal that says what would cure it. Nothing here is a certificate.

mod again;
mod berth;
mod beyond;
mod candidates;
mod card;
mod condition;
mod form;
mod given;
mod heeling;
mod instructions;
mod limits;
mod mistakes;
mod moves;
mod notes;
mod objective;
mod places;
mod predicted;
mod read;
mod reading_of_card;
mod recheck;
mod refusal;
mod search;
mod since;
mod spheres;
mod strength;
mod thinned;
mod tolerance;
mod verify;
mod vertical;

pub use again::{Again, AgainForm, Done, Learnt, Part, Slip, Verdict, by_compass, read_again};
pub use berth::{BerthCheck, Seen};
pub use card::Card;
pub use form::{AfterForm, Berth, BerthForm, FieldForm, FormError, WaterForm};
pub use heeling::{HeelingPlan, VerticalReading};
pub use instructions::{Action, Corrector, Place, Step};
pub use limits::Limits;
pub use mistakes::{Mistake, mistakes};
pub use predicted::{PredictedRow, PredictedTable};
pub use read::{HeadingFrom, Magnetometer, NumberError, ReadingForm, Unit};
pub use recheck::{InAll, Proven, Recheck, recheck, recheck_elsewhere, turned_in_all};
pub use refusal::{Coefficient, Cure, Refusal};
pub use since::{Compared, EarlierLambda};
pub use verify::{Needed, Settled, Verification, verify};

use crate::berth::{BerthError, BerthReading};
use crate::binnacle::{Binnacle, Setting};
use binnacle_compass::deviation::DeviationError;
use binnacle_compass::model::Model;
use binnacle_compass::ship::EarthField;
use condition::Condition;
use search::{Found, Front};
use serde::{Deserialize, Serialize};
use vertical::Vertical;

/// Everything that a plan rests on.
#[derive(Clone, Debug)]
pub struct Adjustment<'a> {
    /// The ship's model, fitted while the correctors stood as `binnacle` says.
    pub model: &'a Model,
    /// The earth's field at the berth.
    pub earth: EarthField,
    /// What the magnetometer read in the bowl's place, correctors as they were.
    pub reading: &'a BerthReading,
    /// Relative standard deviation of the magnetometer's scale.
    pub scale_sd: f64,
    /// What the compass reads at the berth with the correctors as they stand now, degrees.
    pub compass_deg: Option<f64>,
    /// Vertical field there, if it was read.
    pub vertical: Option<VerticalReading>,
    /// The binnacle with its correctors as they stood for model and reading.
    pub binnacle: &'a Binnacle,
    /// How they stand now, where they were moved since.
    pub now: Option<&'a Setting>,
    /// Where the vessel trades: what the search makes small. Limits hold at the berth as well.
    pub waters: &'a [Water],
    /// What the model and the ship are like.
    pub circumstances: Circumstances,
    /// What a plan must keep to.
    pub limits: Limits,
}

/// A place where the vessel trades.
#[derive(Clone, Debug, PartialEq, Serialize, Deserialize)]
pub struct Water {
    /// What it is called.
    pub name: String,
    /// Horizontal field, nT.
    pub h_nt: f64,
    /// Vertical field, nT, down positive.
    pub z_nt: f64,
    /// How much of her time she is there; only ratios count.
    pub weight: f64,
}

/// What the model and the ship are like at the berth.
#[derive(Clone, Copy, Debug, Default, PartialEq)]
pub struct Circumstances {
    /// Days since the model's last sample.
    pub model_age_days: Option<f64>,
    /// Whether magnetic cargo is on board that the model does not know.
    pub cargo_on_board: bool,
    /// λ as an earlier berth of the same compass told it.
    pub earlier_lambda: Option<EarlierLambda>,
    /// Whether the model has learnt from a reading at this berth: then its covariance has what
    /// may have become of the ship before it.
    pub has_learnt_here: bool,
}

/// What came of it.
#[derive(Clone, Debug, PartialEq, Serialize, Deserialize)]
pub struct Outcome {
    /// What the berth told; none when its reading was refused.
    pub berth: Option<BerthCheck>,
    /// Why there is no plan; empty when there is one.
    pub refusals: Vec<Refused>,
    /// What the adjuster should know of it.
    pub notes: Vec<String>,
    /// The recommended plan first, then others that cost more or less.
    pub plans: Vec<Plan>,
    /// How well the search knows that nothing is better.
    pub optimality: Option<Optimality>,
}

/// A refusal with what would cure it.
#[derive(Clone, Debug, PartialEq, Serialize, Deserialize)]
pub struct Refused {
    /// What is wrong.
    #[serde(flatten)]
    pub refusal: Refusal,
    /// The same in words.
    pub words: String,
    /// What would cure it, the easiest first.
    pub cures: Vec<Cure>,
}

/// How well the search knows that nothing is better.
#[derive(Clone, Copy, Debug, PartialEq, Serialize, Deserialize)]
pub struct Optimality {
    /// Whether every setting of the catalogue was gone through or excluded: none is better
    /// by more than a gap that no card shows.
    pub proven: bool,
    /// No setting's worst residual, weighted over the waters, is better than the best
    /// plan's by more than this, degrees.
    pub gap_deg: f64,
    /// Boxes of settings that were looked at.
    pub nodes: u64,
    /// Most trays or holes of fore-and-aft and athwartship magnets in use at once.
    pub trays_in_use: [u8; 2],
}

/// One way to set the correctors.
#[derive(Clone, Debug, PartialEq, Serialize, Deserialize)]
pub struct Plan {
    /// How they will stand.
    pub setting: Setting,
    /// Movements of hand that it takes.
    pub moves: u32,
    /// Worst foretold residual on any heading, weighted over the waters, degrees.
    pub worst_residual_deg: f64,
    /// The widest 95 % band in any of them, degrees.
    pub widest_band_deg: f64,
    /// λ with this setting.
    pub lambda: f64,
    /// Deviations as they are, at the berth and in the waters.
    pub before: Vec<PredictedTable>,
    /// Residuals as they will be.
    pub after: Vec<PredictedTable>,
    /// What becomes of the heeling magnets.
    pub heeling: HeelingPlan,
    /// What to do, in order.
    pub steps: Vec<Step>,
    /// The model that holds from the last step on, its covariance with the errors of λ
    /// and of the correctors that were moved.
    pub model_after: Model,
}

/// Why there is nothing to plan with.
#[derive(Clone, Debug, PartialEq, thiserror::Error)]
pub enum AdjustError {
    /// Of the reading, the model or the field at the berth.
    #[error(transparent)]
    Berth(#[from] BerthError),
    /// Of a place where the vessel trades.
    #[error("waters[{index}].{field} is {value}, not a number between {least} and {greatest}")]
    Water {
        /// Which.
        index: usize,
        /// Its field.
        field: &'static str,
        /// What it was.
        value: f64,
        /// The least accepted.
        least: f64,
        /// The greatest accepted.
        greatest: f64,
    },
    /// There are none, or none with a weight.
    #[error("waters: there are none with a weight")]
    NoWaters,
    /// A limit, or another number, that cannot be.
    #[error("{field} is {value}, not a number between {least} and {greatest}")]
    Value {
        /// Which.
        field: &'static str,
        /// What it was.
        value: f64,
        /// The least accepted.
        least: f64,
        /// The greatest accepted.
        greatest: f64,
    },
    /// The correctors cannot stand as they are said to.
    #[error(transparent)]
    Binnacle(#[from] crate::binnacle::BinnacleError),
    /// The ship cannot be foretold.
    #[error(transparent)]
    Deviation(#[from] DeviationError),
}

/// The best few ways to set the correctors, or why there is none.
///
/// # Errors
/// When something given cannot be. An inconsistent berth, a model too old and the like
/// are no errors but refusals.
pub fn plan(adjustment: &Adjustment<'_>) -> Result<Outcome, AdjustError> {
    given::check(adjustment)?;
    let mut refusals = refusal::beforehand(adjustment);
    let condition = match Condition::new(adjustment) {
        Ok(condition) => condition,
        Err(AdjustError::Berth(error)) => {
            refusals.push(refusal::of_berth(adjustment, error)?);
            return Ok(refused(None, refusals));
        }
        Err(error) => return Err(error),
    };
    let berth = BerthCheck::new(adjustment, &condition);
    let card = adjustment.card();
    refusals.extend(card.filter(Card::is_refused).map(Refusal::CardDisagrees));
    refusals.extend(condition.since.refusal());
    let vertical = adjustment.vertical_judged();
    refusals.extend(vertical.and_then(|vertical| vertical.refusal()));
    if !refusals.is_empty() {
        return Ok(refused(Some(berth), refusals));
    }
    let front = search::search(adjustment, &condition);
    let mut plans = Vec::new();
    for found in chosen(&front, adjustment.limits.near_equal_deg) {
        let plan = whole(adjustment, &condition, found)?;
        if plan.beyond(&adjustment.limits, adjustment.waters).is_none() {
            plans.push(plan);
        } else if refusals.is_empty() {
            // Of the plan that would be recommended.
            refusals =
                beyond::beyond_limits(adjustment, &condition, &plan.after, &plan.model_after);
        }
    }
    // What is beyond the limits is no alternative either.
    if plans.is_empty() {
        return Ok(Outcome {
            notes: notes::left_out(&front.optimality).into_iter().collect(),
            optimality: Some(front.optimality),
            ..refused(Some(berth), refusals)
        });
    }
    Ok(Outcome {
        notes: notes::notes(adjustment, &condition, &berth, &plans, &front.optimality),
        berth: Some(berth),
        refusals: Vec::new(),
        plans,
        optimality: Some(front.optimality),
    })
}

fn refused(berth: Option<BerthCheck>, refusals: Vec<Refusal>) -> Outcome {
    Outcome {
        berth,
        refusals: refusals.into_iter().map(Refusal::with_cures).collect(),
        notes: Vec::new(),
        plans: Vec::new(),
        optimality: None,
    }
}

/// How many plans are shown.
const PLANS: usize = 5;

/// The fewest moves among near-equals first, then what is better for more moves, then
/// what is cheaper.
fn chosen(front: &Front, near_equal_deg: f64) -> Vec<&Found> {
    let found = front.undominated();
    let Some(best) = found.last() else {
        return Vec::new();
    };
    let good_enough = best.worst_deg + near_equal_deg;
    let first = found.iter().position(|f| f.worst_deg <= good_enough);
    let first = first.unwrap_or(found.len() - 1);
    let mut order = vec![found[first]];
    order.extend(found[first + 1..].iter().rev().take(1));
    order.extend(found[..first].iter().rev());
    order.truncate(PLANS);
    order
}

fn whole(
    adjustment: &Adjustment<'_>,
    condition: &Condition<'_>,
    found: &Found,
) -> Result<Plan, AdjustError> {
    let tables = |setting: &Setting| predicted::tables(adjustment, condition, setting);
    let after = tables(&found.setting)?;
    let widest = after.iter().filter_map(|table| table.widest_band_deg);
    Ok(Plan {
        moves: found.moves,
        worst_residual_deg: found.worst_deg,
        widest_band_deg: widest.fold(0.0, f64::max),
        lambda: condition.lambda_with(&found.setting),
        before: tables(&adjustment.binnacle.setting)?,
        after,
        heeling: heeling::said(adjustment, condition, &found.setting),
        steps: instructions::steps(adjustment, condition, &found.setting),
        model_after: condition.model_with(&found.setting)?,
        setting: found.setting.clone(),
    })
}

impl Adjustment<'_> {
    /// How the correctors stand now.
    pub fn standing(&self) -> &Setting {
        self.now.unwrap_or(&self.binnacle.setting)
    }

    /// The vertical field held against the earth's.
    fn vertical_judged(&self) -> Option<Vertical> {
        let judged = |read| Vertical::new(read, self.earth, self.binnacle);
        self.vertical.map(judged)
    }

    /// The compass held against the field, while the correctors stand as they did when
    /// both were read.
    fn card(&self) -> Option<Card> {
        if *self.standing() != self.binnacle.setting {
            return None;
        }
        let constant_deg = self.model.constant_deg;
        let card = |read_deg| {
            Card::new(
                read_deg,
                self.reading,
                self.earth,
                self.binnacle,
                constant_deg,
            )
        };
        self.compass_deg.map(card)
    }
}

impl Water {
    /// Its field.
    pub fn earth(&self) -> EarthField {
        EarthField {
            h_nt: self.h_nt,
            z_nt: self.z_nt,
        }
    }
}

#[cfg(test)]
pub(crate) mod tests;
