//! Steps at the binnacle: what the compass read after each, and what follows.

use crate::berth_session::plan::{ChosenPlan, refusals, run_planner};
use crate::berth_session::planning_inputs::PlanRequest;
use crate::work_orders::order_state::{InferredStrength, OrderState};
use crate::work_orders::refusal::Refusal;
use binnacle_adjustment::adjust::{
    AdjustError, Outcome, Step, StepCheck, check_step, check_step_with_setting, check_total_turn,
};
use binnacle_adjustment::binnacle::{Binnacle, Setting};
use binnacle_platform::app::App;
use binnacle_platform::error::Result;
use binnacle_platform::time::Time;
use serde::{Deserialize, Serialize};
use utoipa::ToSchema;

/// What the compass read after a step.
#[derive(Clone, Debug, Serialize, Deserialize, ToSchema)]
#[serde(deny_unknown_fields)]
#[schema(as = StepReading, example = json!({ "after_deg": 308.5 }))]
pub(crate) struct StepReading {
    /// What it read before; the last reading where it is not said.
    #[schema(minimum = 0, maximum = 360)]
    pub before_deg: Option<f64>,
    /// What it reads now.
    #[schema(minimum = 0, maximum = 360)]
    pub after_deg: f64,
}

/// What became of a step.
#[derive(Clone, Debug, PartialEq, Serialize, Deserialize)]
pub struct StepResult {
    /// The step's number in its plan.
    pub number: u32,
    /// What the compass read before.
    pub before_deg: f64,
    /// What it read after.
    pub after_deg: f64,
    /// By how much it should have turned.
    pub expected_change_deg: f64,
    /// How far off that may be.
    pub tolerance_deg: f64,
    /// In a word.
    pub verdict: StepVerdict,
    /// In words.
    pub words: String,
}

/// What became of a step, in a word.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Serialize, Deserialize, ToSchema)]
#[serde(rename_all = "snake_case")]
#[schema(as = StepVerdict)]
pub enum StepVerdict {
    /// It did what was expected.
    Confirmed,
    /// On this heading the compass does not show it, and showed nothing.
    NotSeen,
    /// The magnets are in with the wrong end; there is a new plan.
    WrongEnd,
    /// The corrector is of another strength than was taken; there is a new plan.
    OtherStrength,
    /// Nothing explains it: read again.
    Unexplained,
}

/// A step as the log has it.
#[derive(Clone, Debug, Serialize, Deserialize)]
pub struct RecordedStep {
    /// What became of it.
    #[serde(flatten)]
    pub said: StepResult,
    /// The step.
    pub step: Step,
    /// How the correctors stand now; none when that is not known to be otherwise.
    pub setting: Option<Setting>,
    /// The binnacle, where a corrector was found to be of another strength.
    pub binnacle: Option<Binnacle>,
    /// The plan from there.
    pub replanned: Option<Box<ChosenPlan>>,
    /// Why there is none from there.
    pub refusals: Vec<Refusal>,
}

/// How the correctors stand, as someone found or set them.
#[derive(Clone, Debug, Serialize, Deserialize, ToSchema)]
#[serde(deny_unknown_fields)]
#[schema(as = CorrectorSettings)]
pub(crate) struct CorrectorReport {
    /// How each stands.
    #[schema(value_type = binnacle_fleet::binnacles::SettingSchema)]
    pub setting: Setting,
    /// What the compass reads then, degrees.
    #[serde(default)]
    #[schema(minimum = 0, maximum = 360)]
    pub compass_deg: Option<f64>,
    /// Why they do not stand as planned.
    #[serde(default)]
    #[schema(max_length = 200)]
    pub note: Option<String>,
}

/// The same as the log has it.
#[derive(Clone, Debug, Serialize, Deserialize)]
pub struct CorrectorMove {
    /// How they stood before.
    pub before: Setting,
    /// How they stand now.
    pub after: Setting,
    /// What the compass reads then, degrees.
    pub compass_deg: Option<f64>,
    /// Why.
    pub note: Option<String>,
    /// Whether a second reading that did not fit before fits them as they stand now.
    #[serde(default)]
    pub explains_reading: bool,
    /// What is known instead of a strength that was learnt from how they did not stand.
    #[serde(default, skip_serializing_if = "Option::is_none")]
    pub learnt_anew: Option<Box<RevisedStrength>>,
    /// When.
    pub at: Time,
}

/// What is known instead of a strength that was learnt before.
#[derive(Clone, Debug, Serialize, Deserialize)]
pub struct RevisedStrength {
    /// The step from which it was learnt, its corrector where it stands.
    pub step: Step,
    /// The binnacle as it is now believed to be.
    pub binnacle: Binnacle,
}

impl StepResult {
    /// Whether the next step may follow.
    pub fn is_confirmed(&self) -> bool {
        matches!(self.verdict, StepVerdict::Confirmed | StepVerdict::NotSeen)
    }
}

/// Judges a step by the compass before and after it; takes a while where there has to
/// be a new plan.
///
/// # Errors
/// When the readings are no headings.
pub(crate) fn judge(
    plan_request: &PlanRequest,
    step: Step,
    before_deg: f64,
    after_deg: f64,
) -> std::result::Result<RecordedStep, AdjustError> {
    let said = |verdict, words: String| StepResult {
        number: step.number,
        before_deg,
        after_deg,
        expected_change_deg: step.change_deg,
        tolerance_deg: step.tolerance_deg,
        verdict,
        words,
    };
    let rechecked = check_step(&plan_request.adjustment(), &step, before_deg, after_deg)?;
    let (said, setting, binnacle, outcome) = match rechecked {
        StepCheck::Confirmed { off_deg, proven } => (
            said(
                StepVerdict::Confirmed,
                format!("within {:.1} degrees: {}", off_deg.abs(), proven),
            ),
            Some(step.setting_after.clone()),
            None,
            None,
        ),
        StepCheck::NotSeen { .. } => (
            said(
                StepVerdict::NotSeen,
                "on this heading the compass does not show the step: look at it again".to_owned(),
            ),
            Some(step.setting_after.clone()),
            None,
            None,
        ),
        StepCheck::WrongEnd {
            turned_deg,
            setting,
            outcome,
        } => (
            said(
                StepVerdict::WrongEnd,
                format!(
                    "the compass turned by {turned_deg:.1} degrees: the magnets are in with \
                     the wrong end"
                ),
            ),
            Some(setting),
            None,
            Some(outcome),
        ),
        StepCheck::OtherStrength {
            share,
            other_hole,
            binnacle,
            setting,
            outcome,
            ..
        } => (
            said(StepVerdict::OtherStrength, strength_text(share, other_hole)),
            Some(setting),
            Some(*binnacle),
            Some(outcome),
        ),
        StepCheck::Unexplained { unmoved: true, .. } => (
            said(
                StepVerdict::Unexplained,
                format!(
                    "the compass stands as it stood, where {:.1} degrees were expected: was the \
                     step done, and does the card turn freely? Tap the bowl and read again",
                    step.change_deg
                ),
            ),
            None,
            None,
            None,
        ),
        StepCheck::Unexplained { off_deg, .. } => (
            said(
                StepVerdict::Unexplained,
                format!(
                    "it is off by {off_deg:.1} degrees, which no strength of the corrector \
                     explains: read again, see whether the ship moved, and look for magnetism \
                     in the iron"
                ),
            ),
            None,
            None,
            None,
        ),
    };
    let said = match &setting {
        Some(setting) if said.is_confirmed() => in_all(plan_request, said, setting)?,
        _ => said,
    };
    let (replanned, refusals) = outcome.map_or((None, Vec::new()), |outcome| followed(*outcome));
    Ok(RecordedStep {
        said,
        step,
        setting,
        binnacle,
        replanned,
        refusals,
    })
}

fn strength_text(share: f64, other_hole: Option<u16>) -> String {
    let words = format!("the corrector is {share:.2} times as strong as was taken");
    match other_hole {
        Some(hole) => format!(
            "{words}, or stands at hole {hole}: count again; if it does, say how the correctors \
             stand, or put it right and say so with what the compass then reads"
        ),
        None => words,
    }
}

/// What is known instead of a strength that this word disputes.
pub(crate) async fn revise_strength(
    app: &App,
    standing: &OrderState,
    moved: &CorrectorMove,
) -> Result<Option<Box<RevisedStrength>>> {
    let Some((plan_request, strength)) = disputed(standing, moved)? else {
        return Ok(None);
    };
    let (after, compass_deg) = (moved.after.clone(), moved.compass_deg);
    let learnt = run_planner(app, move || {
        let (adjustment, step) = (plan_request.adjustment(), &strength.step);
        check_step_with_setting(&adjustment, step, strength.before_deg, &after, compass_deg)
    });
    let (step, binnacle) = learnt.await?;
    Ok(Some(Box::new(RevisedStrength { step, binnacle })))
}

/// The strength that this word disputes, with what was known before it was learnt.
fn disputed(
    standing: &OrderState,
    moved: &CorrectorMove,
) -> Result<Option<(Box<PlanRequest>, Box<InferredStrength>)>> {
    let mut standing = standing.clone();
    if standing.setting() != Some(&moved.after) {
        standing.restore_first_reading();
    }
    let Some(strength) = standing.disputed_by(moved).cloned() else {
        return Ok(None);
    };
    let mut plan_request = standing.plan_request()?;
    plan_request.binnacle = strength.binnacle.clone();
    Ok(Some((Box::new(plan_request), Box::new(strength))))
}

/// With what the steps so far come to together, where that is not what was expected.
fn in_all(
    plan_request: &PlanRequest,
    said: StepResult,
    setting: &Setting,
) -> std::result::Result<StepResult, AdjustError> {
    let Some(first_deg) = plan_request.given.compass_deg else {
        return Ok(said);
    };
    let in_all = check_total_turn(
        &plan_request.adjustment(),
        first_deg,
        setting,
        said.after_deg,
    )?;
    if in_all.agrees() {
        return Ok(said);
    }
    let words = format!(
        "{}; but {}: see that each corrector stands as it should before you finish",
        said.words, in_all
    );
    Ok(StepResult { words, ..said })
}

fn followed(outcome: Outcome) -> (Option<Box<ChosenPlan>>, Vec<Refusal>) {
    let refused = refusals(&outcome);
    (ChosenPlan::of(outcome, 1).map(Box::new), refused)
}
