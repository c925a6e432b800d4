//! Steps at the binnacle: the compass reading after each, and the consequence.

use crate::berth_session::plan::refusals;
use crate::berth_session::plan_slots::CorrectorPlanSlots;
use crate::berth_session::planning_inputs::PlanRequest;
use crate::work_orders::events::{CorrectorMove, OrderEvent, RecordedStep, RevisedStrength};
use crate::work_orders::order_state::{InferredStrength, OrderState};
use crate::work_orders::payload::chosen_plan::ChosenPlan;
use crate::work_orders::payload::step_result::{StepResult, StepVerdict};
use crate::work_orders::refusal::Refusal;
use crate::work_orders::store::StoredOrder;
use binnacle_adjustment::adjust::{
    AdjustError, Outcome, Step, StepCheck, check_step, check_step_with_setting, check_total_turn,
};
use binnacle_adjustment::binnacle::{Binnacle, Setting};
use binnacle_platform::error::{Error, Result};
use binnacle_platform::time::Time;
use serde::{Deserialize, Serialize};
use utoipa::ToSchema;

/// Compass reading after a step.
#[derive(Clone, Debug, Serialize, Deserialize, ToSchema)]
#[serde(deny_unknown_fields)]
#[schema(as = StepReading, example = json!({ "after_deg": 308.5 }))]
pub(crate) struct StepReading {
    /// Reading before the step; the last known reading by default.
    #[schema(minimum = 0, maximum = 360)]
    pub before_deg: Option<f64>,
    /// Reading after the step.
    #[schema(minimum = 0, maximum = 360)]
    pub after_deg: f64,
}

/// Settings of the correctors, as someone found or made them.
#[derive(Clone, Debug, Serialize, Deserialize, ToSchema)]
#[serde(deny_unknown_fields)]
#[schema(as = CorrectorSettings)]
pub(crate) struct CorrectorReport {
    /// Setting of each corrector.
    pub setting: Setting,
    /// Compass reading with these settings, degrees.
    #[serde(default)]
    #[schema(minimum = 0, maximum = 360)]
    pub compass_deg: Option<f64>,
    /// Reason for settings other than planned.
    #[serde(default)]
    #[schema(max_length = 200)]
    pub note: Option<String>,
}

/// Longest delay of a request that was made offline, seconds.
const MAX_SEND_DELAY_S: f64 = 12.0 * 3600.0;

/// Refuses a time long before the last move of a corrector.
pub(crate) fn require_after_last_step(stored: &StoredOrder, at: Time) -> Result<()> {
    let moved = stored.log.iter().rev().find(|entry| {
        matches!(
            entry.content,
            OrderEvent::Step(_) | OrderEvent::CorrectorSettings(_)
        )
    });
    if moved.is_some_and(|moved| moved.at.0.seconds_since(at.0) > MAX_SEND_DELAY_S) {
        return Err(Error::Invalid {
            field: "at",
            detail: "lies long before the last step".to_owned(),
        });
    }
    Ok(())
}

/// Judges a step by the compass before and after it. Takes seconds if a new plan is needed.
///
/// # Errors
/// Fails when the readings are not headings.
pub(crate) fn judge(
    plan_request: &PlanRequest,
    step: Step,
    before_deg: f64,
    after_deg: f64,
) -> std::result::Result<RecordedStep, AdjustError> {
    let check = check_step(&plan_request.adjustment(), &step, before_deg, after_deg)?;
    let judged = Judged::of(&step, check);
    let result = StepResult {
        number: step.number,
        before_deg,
        after_deg,
        expected_change_deg: step.change_deg,
        tolerance_deg: step.tolerance_deg,
        verdict: judged.verdict,
        words: judged.words,
    };
    let result = match &judged.setting {
        Some(setting) if result.is_confirmed() => add_total_turn(plan_request, result, setting)?,
        _ => result,
    };
    let (replanned, refusals) = judged
        .outcome
        .map_or((None, Vec::new()), |outcome| split_outcome(*outcome));
    Ok(RecordedStep {
        result,
        step,
        setting: judged.setting,
        binnacle: judged.binnacle,
        replanned,
        refusals,
    })
}

/// Verdict on a step, in words, and what follows from it.
struct Judged {
    verdict: StepVerdict,
    words: String,
    /// Setting of the correctors after the step, where it was done.
    setting: Option<Setting>,
    /// Binnacle as it turned out to be, where it is another than recorded.
    binnacle: Option<Binnacle>,
    /// Outcome of a new plan.
    outcome: Option<Box<Outcome>>,
}

impl Judged {
    fn of(step: &Step, check: StepCheck) -> Judged {
        let judged = |verdict, words: String| Judged {
            verdict,
            words,
            setting: None,
            binnacle: None,
            outcome: None,
        };
        match check {
            StepCheck::Confirmed { off_deg, proven } => {
                let words = format!("within {:.1} degrees: {proven}", off_deg.abs());
                Judged {
                    setting: Some(step.setting_after.clone()),
                    ..judged(StepVerdict::Confirmed, words)
                }
            }
            StepCheck::NotSeen { .. } => {
                let words = "on this heading the compass does not show the step: inspect it again";
                Judged {
                    setting: Some(step.setting_after.clone()),
                    ..judged(StepVerdict::NotSeen, words.to_owned())
                }
            }
            StepCheck::WrongEnd {
                turned_deg,
                setting,
                outcome,
            } => {
                let words = format!(
                    "the compass turned by {turned_deg:.1} degrees: the magnets are in with the \
                     wrong end"
                );
                Judged {
                    setting: Some(setting),
                    outcome: Some(outcome),
                    ..judged(StepVerdict::WrongEnd, words)
                }
            }
            StepCheck::FoundOtherwise {
                turned_deg,
                binnacle,
                setting,
                outcome,
            } => {
                let words = format!(
                    "the compass turned by {turned_deg:.1} degrees: before this step the magnets \
                     stood with the other end than recorded"
                );
                Judged {
                    setting: Some(setting),
                    binnacle: Some(*binnacle),
                    outcome: Some(outcome),
                    ..judged(StepVerdict::FoundOtherwise, words)
                }
            }
            StepCheck::OtherStrength {
                share,
                other_hole,
                or_found_otherwise,
                binnacle,
                setting,
                outcome,
                ..
            } => Judged {
                setting: Some(setting),
                binnacle: Some(*binnacle),
                outcome: Some(outcome),
                ..judged(
                    StepVerdict::OtherStrength,
                    strength_text(share, other_hole, or_found_otherwise),
                )
            },
            StepCheck::Unexplained {
                off_deg, unmoved, ..
            } => judged(
                StepVerdict::Unexplained,
                unexplained_text(step, off_deg, unmoved),
            ),
        }
    }
}

fn unexplained_text(step: &Step, off_deg: f64, unmoved: bool) -> String {
    if unmoved {
        return format!(
            "the compass did not turn, where {:.1} degrees were expected: was the step done, and \
             does the card turn freely? Tap the bowl and read again",
            step.change_deg
        );
    }
    format!(
        "it is off by {off_deg:.1} degrees, which no strength of the corrector explains: read \
         again, check whether the ship moved, and look for magnetism in the iron"
    )
}

fn strength_text(share: f64, other_hole: Option<u16>, or_found_otherwise: bool) -> String {
    let words = format!("the corrector is {share:.2} times as strong as assumed");
    let mut words = match other_hole {
        Some(hole) => format!(
            "{words}, or stands at hole {hole}: count again; if it does, report the settings, or \
                correct it and report that with the new compass reading"
        ),
        None => words,
    };
    if or_found_otherwise {
        words += "; or before this step the magnets stood with the other end than recorded: look \
            at the photographs as found, and read the field again after the last step";
    }
    words
}

/// Recalculates a strength that this report disputes.
pub(crate) async fn revise_strength(
    slots: &CorrectorPlanSlots,
    state: &OrderState,
    report: &CorrectorMove,
) -> Result<Option<Box<RevisedStrength>>> {
    let Some((plan_request, strength)) = disputed(state, report)? else {
        return Ok(None);
    };
    let (after, compass_deg) = (report.after.clone(), report.compass_deg);
    let revised = slots.run(move || {
        let (adjustment, step) = (plan_request.adjustment(), &strength.step);
        check_step_with_setting(&adjustment, step, strength.before_deg, &after, compass_deg)
    });
    let (step, binnacle) = revised.await?;
    Ok(Some(Box::new(RevisedStrength { step, binnacle })))
}

/// Strength that this report disputes, with the binnacle as known before it.
fn disputed(
    state: &OrderState,
    report: &CorrectorMove,
) -> Result<Option<(Box<PlanRequest>, Box<InferredStrength>)>> {
    let mut state = state.clone();
    if state.setting() != Some(&report.after) {
        state.restore_first_reading();
    }
    let Some(strength) = report.disputed_strength(&state).cloned() else {
        return Ok(None);
    };
    if strength.verdict == StepVerdict::FoundOtherwise && report.compass_deg.is_none() {
        // The turn at the step still speaks against the record.
        return Ok(None);
    }
    let mut plan_request = state.plan_request()?;
    plan_request.binnacle = if strength.verdict == StepVerdict::FoundOtherwise {
        strength.binnacle.clone()
    } else {
        // What a later step showed of the record holds.
        let as_read = plan_request.binnacle.setting.clone();
        let before = strength.binnacle.with_setting(as_read);
        before.map_err(binnacle_fleet::binnacles::invalid_binnacle)?
    };
    Ok(Some((Box::new(plan_request), Box::new(strength))))
}

/// Adds a warning where the total turn of all steps differs from the plan.
fn add_total_turn(
    plan_request: &PlanRequest,
    result: StepResult,
    setting: &Setting,
) -> std::result::Result<StepResult, AdjustError> {
    let Some(first_deg) = plan_request.given.compass_deg else {
        return Ok(result);
    };
    let in_all = check_total_turn(
        &plan_request.adjustment(),
        first_deg,
        setting,
        result.after_deg,
    )?;
    if in_all.agrees() {
        return Ok(result);
    }
    let words = format!(
        "{}; but {}: check that each corrector stands as it should before you finish",
        result.words, in_all
    );
    Ok(StepResult { words, ..result })
}

fn split_outcome(outcome: Outcome) -> (Option<Box<ChosenPlan>>, Vec<Refusal>) {
    let refused = refusals(&outcome);
    (ChosenPlan::from_outcome(outcome, 1).map(Box::new), refused)
}
