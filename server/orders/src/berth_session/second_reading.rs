//! Judgement of a second reading, and the reading to replan from.
//!
//! Invariant: it is compared with the reported settings of the correctors, by the first reading
//! and its model.

use crate::berth_session::berth_reading::check;
use crate::berth_session::plan_slots::CorrectorPlanSlots;
use crate::berth_session::planning_inputs::PlanRequest;
use crate::work_orders::events::CorrectorMove;
use crate::work_orders::order_state::OrderState;
use crate::work_orders::payload::plan_basis::Basis;
use crate::work_orders::payload::recorded_reading::RecordedReading;
use crate::work_orders::payload::recorded_second_reading::{
    PARTS_WITH_VERTICAL, RecordedSecondReading, SecondReadingResult, SecondReadingVerdict,
};
use crate::work_orders::refusal::Refusal;
use binnacle_adjustment::adjust::{
    AdjustError, CardCheck, CompletedStep, Corrector, PostCheck, ReadingForm, SecondReadingForm,
    Slip, UpdatedPrediction, Verdict, check_second_reading,
};
use binnacle_adjustment::berth::BerthReading;
use binnacle_adjustment::binnacle::Binnacle;
use binnacle_platform::error::{Error, Result};

const FITS_UNPLANNED: &str =
    "the correctors act as they should at the reported settings: replan from this reading";
const BEYOND_LIMITS: &str = "the correctors seem to stand as planned, but the residuals exceed \
    the limits: read again, away from steel and cranes; if the result is the same, replan from \
    this reading";

/// Second reading as it was sent, as a form of its own, and as the planner takes it.
pub(crate) struct SecondReading {
    given: SecondReadingForm,
    pub(crate) form: ReadingForm,
    reading: BerthReading,
}

impl SecondReading {
    pub(crate) fn new(
        given: SecondReadingForm,
        plan_request: &PlanRequest,
    ) -> Result<SecondReading> {
        let form = given.as_reading(&plan_request.given);
        let form = form.map_err(|error| Error::Invalid {
            field: error.field,
            detail: error.what,
        })?;
        let reading = form.reading(plan_request.basis.variation()?);
        let reading = reading.map_err(|error| Error::Invalid {
            field: "forward, starboard",
            detail: error.to_string(),
        })?;
        Ok(SecondReading {
            given,
            form,
            reading,
        })
    }

    fn read(
        &self,
        plan_request: &PlanRequest,
        steps: &[CompletedStep],
    ) -> std::result::Result<PostCheck, AdjustError> {
        check_second_reading(
            &plan_request.adjustment(),
            steps,
            &self.reading,
            self.form.vertical(),
            self.form.compass_deg,
            self.form.unit,
        )
    }

    /// Judges the reading; returns also the basis for a new plan, if one is needed. A reading
    /// that fits needs one where no plan was followed.
    pub(crate) fn judge(
        self,
        plan_request: &PlanRequest,
        steps: &[CompletedStep],
        inspected_steps: usize,
        planned: bool,
    ) -> std::result::Result<(RecordedSecondReading, Option<Basis>), AdjustError> {
        let check = self.read(plan_request, steps)?;
        let mut result = SecondReadingResult {
            verdict: SecondReadingVerdict::AsPlanned,
            words: confirmation_text(steps, check.parts.len()),
            parts: check.parts,
            step: None,
            setting: None,
            worst_residual_deg: None,
            widest_band_deg: None,
            refusals: Vec::new(),
            could_be: Vec::new(),
        };
        let from_here = |updated: &UpdatedPrediction, binnacle: Binnacle| {
            let mut basis = plan_request.basis.clone();
            basis.model.model = updated.model_after.clone();
            basis.binnacle = binnacle;
            // The first reading was already compared with it.
            basis.earlier = None;
            basis.is_updated_here = true;
            basis
        };
        let (mut prediction, mut basis_to_plan_from) = (None, None);
        match check.verdict {
            Verdict::AsPlanned { updated } if planned => prediction = Some(*updated),
            Verdict::AsPlanned { updated } => {
                result.verdict = SecondReadingVerdict::Replan;
                FITS_UNPLANNED.clone_into(&mut result.words);
                let setting = plan_request.adjustment().standing().clone();
                basis_to_plan_from = Some(from_here(
                    &updated,
                    plan_request.binnacle.with_setting(setting)?,
                ));
                prediction = Some(*updated);
            }
            Verdict::Replan {
                updated,
                refusals,
                binnacle,
                ..
            } => {
                result.verdict = SecondReadingVerdict::Replan;
                BEYOND_LIMITS.clone_into(&mut result.words);
                result.refusals = refusals.iter().map(Refusal::from).collect();
                basis_to_plan_from = Some(from_here(&updated, *binnacle));
                prediction = Some(*updated);
            }
            Verdict::Slip {
                step,
                slip,
                setting,
                ..
            } => {
                result.verdict = SecondReadingVerdict::Slip;
                result.words = slip_text(steps, step, slip);
                result.step = u32::try_from(inspected_steps)
                    .ok()
                    .map(|before| before + step);
                result.setting = Some(setting);
            }
            Verdict::Unexplained {
                misreadings: mistakes,
            } => {
                result.verdict = SecondReadingVerdict::Unexplained;
                result.words = unexplained_text(inspected_steps);
                result.could_be = mistakes.iter().map(ToString::to_string).collect();
                if let Some(card) = check.card.filter(CardCheck::is_refused) {
                    result.words = card.summary();
                    result.could_be.extend(card.suspects());
                }
            }
        }
        result.worst_residual_deg = prediction
            .as_ref()
            .map(|updated| updated.worst_residual_deg);
        result.widest_band_deg = prediction.as_ref().map(|updated| updated.widest_band_deg);
        let recorded = RecordedSecondReading {
            given: self.given,
            result,
            prediction,
            reading_to_plan_from: None,
        };
        Ok((recorded, basis_to_plan_from))
    }
}

/// Returns whether reported settings explain a second reading that did not fit.
pub(crate) async fn explains_second_reading(
    slots: &CorrectorPlanSlots,
    state: &OrderState,
    report: &CorrectorMove,
) -> Result<bool> {
    let Some(contradiction) = state.contradicting_reading() else {
        return Ok(false);
    };
    let mut before = state.clone();
    before.restore_first_reading();
    let mut plan_request = before.plan_request()?;
    plan_request.moved_to = Some(report.after.clone());
    if let Some(revised) = &report.revised_strength {
        plan_request.binnacle = revised.binnacle.clone();
    }
    let second = SecondReading::new(contradiction.given.clone(), &plan_request)?;
    let check = slots.run(move || second.read(&plan_request, &[])).await?;
    Ok(matches!(
        check.verdict,
        Verdict::AsPlanned { .. } | Verdict::Replan { .. }
    ))
}

/// Turns a second reading into one to plan from, checked against the present knowledge.
pub(crate) fn as_first_reading(basis: Basis, given: ReadingForm) -> Result<Box<RecordedReading>> {
    let (checked, refusal) = match check(&given, &basis)? {
        Ok(checked) => (Some(checked), None),
        Err(refusal) => (None, Some(refusal)),
    };
    Ok(Box::new(RecordedReading {
        given,
        basis: Some(basis),
        checked,
        refusal,
    }))
}

fn unexplained_text(inspected_steps: usize) -> String {
    let steps = match inspected_steps {
        0 => "one of its steps",
        _ => "a step that nobody has inspected since",
    };
    format!(
        "neither the plan nor a slip in {steps} explains the reading: inspect every step and the \
            magnetometer, and read again"
    )
}

/// Words for a reading that confirms the steps.
fn confirmation_text(steps: &[CompletedStep], parts: usize) -> String {
    let heels = |done: &CompletedStep| done.step.corrector == Corrector::Heeling;
    let mut words = "the correctors act as planned".to_owned();
    if parts < PARTS_WITH_VERTICAL && steps.iter().any(heels) {
        words += "; the vertical part was not read both times, so nothing confirms the heeling \
            magnets";
    }
    words
}

fn slip_text(steps: &[CompletedStep], number: u32, slip: Slip) -> String {
    let step = steps.get((number as usize).saturating_sub(1));
    let words = step.map_or("", |done| done.step.words.as_str());
    let how = match slip {
        Slip::WrongEnd => "the magnets went in with the wrong end".to_owned(),
        Slip::OtherHole { hole } => format!("the magnets stand at {hole}"),
        Slip::NotDone => "it was not done".to_owned(),
    };
    format!(
        "inspect the step \"{words}\": by the field, {how}. Report the settings of the \
            correctors; if they are as planned, or corrected, read again"
    )
}
