//! Corrector plans: conditions for planning, the plans offered, and the prediction.

use crate::berth_session::plan_slots::CorrectorPlanSlots;
use crate::berth_session::planning_inputs::PlanRequest;
use crate::work_orders::order_state::OrderState;
use crate::work_orders::refusal::{Cure, Refusal, not_adjustable};
use crate::work_orders::summary::Summary;
use binnacle_adjustment::adjust::{
    Outcome, UpdatedPrediction, check_total_turn, plan, predict_by_compass,
};
use binnacle_compass::logbook::LogbookKind;
use binnacle_fleet::alerts::{self, PlanEffect};
use binnacle_fleet::binnacles;
use binnacle_fleet::logbook;
use binnacle_fleet::models;
use binnacle_platform::app::App;
use binnacle_platform::error::{Error, Result};
use binnacle_platform::time::Time;
use serde::{Deserialize, Serialize};
use utoipa::ToSchema;

/// Choice of a plan.
#[derive(Clone, Copy, Debug, Default, Serialize, Deserialize, ToSchema)]
#[serde(deny_unknown_fields)]
#[schema(as = PlanChoice, example = json!({ "plan": 1 }))]
pub(crate) struct PlanChoice {
    /// Number of the plan among those offered, from 1; the recommended one by default.
    #[schema(minimum = 1)]
    pub plan: Option<usize>,
}

impl OrderState {
    /// Input of the planner for the present state.
    ///
    /// # Errors
    /// [`Error::WrongState`] before there is a reading.
    pub(crate) fn plan_request(&self) -> Result<PlanRequest> {
        let wrong = || Error::WrongState("there is no reading to plan from yet".to_owned());
        let read = self.reading.as_ref().ok_or_else(wrong)?;
        let basis = read.basis.clone().ok_or_else(wrong)?;
        let reading = read
            .given
            .reading(basis.variation()?)
            .map_err(|error| anyhow::anyhow!("a reading that was taken: {error}"))?;
        let shifted = read.given.shifted_reading(basis.variation()?);
        let shifted =
            shifted.map_err(|error| anyhow::anyhow!("a reading that was taken: {error}"))?;
        Ok(PlanRequest {
            reading,
            shifted,
            given: read.given.clone(),
            binnacle: self.binnacle.clone().ok_or_else(wrong)?,
            moved_to: self.moved_to.clone(),
            compass_deg: self.compass_deg,
            limits: self.limits,
            basis,
        })
    }
}

/// Validity of a reading at a berth, seconds: later the vessel may lie elsewhere.
pub(crate) const READING_VALIDITY_S: f64 = 48.0 * 3600.0;

/// Refuses a reading that is too old, or older than a change of the ship's magnetism, of the
/// binnacle or of the cargo.
///
/// # Errors
/// [`Error::WrongState`].
pub(crate) async fn require_current_reading(
    app: &App,
    summary: &Summary,
    plan_request: &PlanRequest,
) -> Result<()> {
    let age_s = app.clock.now().seconds_since(plan_request.given.at);
    if age_s > READING_VALIDITY_S {
        let hours = age_s / 3600.0;
        let words = format!("the berth was read {hours:.0} hours ago: read it again");
        return Err(Error::WrongState(words));
    }
    refuse_magnetic_cargo(app, summary, plan_request).await?;
    let (vessel, compass) = (summary.vessel_id, summary.compass_id);
    let binnacle = binnacles::current(&app.db, vessel, compass).await?;
    if binnacle.is_some_and(|now| now.revision != plan_request.basis.binnacle_revision) {
        return Err(Error::WrongState(
            "the binnacle was revised after the berth reading: read the berth again".to_owned(),
        ));
    }
    let model = models::current(&app.db, vessel, compass).await?;
    let known_until = plan_request.basis.model.data_until;
    let holds = model.is_some_and(|model| model.epoch_from.is_none_or(|from| from <= known_until));
    if !holds {
        return Err(Error::WrongState(
            "the ship's magnetism has changed since the model of the berth reading: wait for a \
                new model, then read the berth again"
                .to_owned(),
        ));
    }
    Ok(())
}

/// Refuses a reading taken before magnetic cargo was loaded, or with cargo that the logbook no
/// longer has. The planner refuses cargo that was on board then and now.
///
/// # Errors
/// [`Error::WrongState`].
pub(crate) async fn refuse_magnetic_cargo(
    app: &App,
    summary: &Summary,
    plan_request: &PlanRequest,
) -> Result<()> {
    let logbook = logbook::of_compass(&app.db, summary.vessel_id, summary.compass_id).await?;
    let (read_at, now) = (plan_request.given.at, app.clock.now());
    let mut since = logbook.iter().filter(|entry| {
        entry.kind == LogbookKind::MagneticCargo
            && entry.from <= now
            && entry.to.is_none_or(|to| to > read_at)
    });
    if plan_request.basis.cargo_on_board {
        if plan_request.given.cargo_on_board || since.any(|entry| entry.from <= read_at) {
            return Ok(());
        }
        return Err(Error::WrongState(
            "the logbook no longer shows magnetic cargo on board at the berth reading: read the \
                berth again"
                .to_owned(),
        ));
    }
    let Some(cargo) = since.next() else {
        return Ok(());
    };
    Err(Error::WrongState(format!(
        "the logbook shows magnetic cargo on board since {}, and the berth was read without it: \
            if the entry is wrong, correct or withdraw it there; otherwise wait until the cargo \
            is ashore, put the moved correctors back, report their settings, and read the berth \
            again",
        Time(cargo.from).to_the_minute()
    )))
}

/// Refuses a plan that predicts values beyond the order's limits.
///
/// # Errors
/// `not-adjustable`, with the cures.
pub(crate) fn require_within_limits(state: &OrderState) -> Result<()> {
    let basis = state.reading.as_ref().and_then(|read| read.basis.as_ref());
    let followed = state.plan.as_ref().zip(basis);
    let violation =
        followed.and_then(|(plan, basis)| plan.plan.limit_violation(&state.limits, &basis.waters));
    match violation {
        Some(refused) => Err(not_adjustable(vec![Refusal::from(&refused)])),
        None => Ok(()),
    }
}

/// Refuses to complete an adjustment whose total turn of the compass differs from the plan,
/// unless a second reading or an inspection confirmed the settings: small errors of steps, each
/// within its tolerance, add up.
///
/// # Errors
/// [`Error::WrongState`].
pub(crate) async fn require_total_turn(
    slots: &CorrectorPlanSlots,
    state: &OrderState,
    plan_request: PlanRequest,
) -> Result<()> {
    let all_inspected = state.inspected_steps == state.steps.len();
    let read = (plan_request.given.compass_deg, plan_request.compass_deg);
    let (Some(first_deg), Some(now_deg)) = read else {
        return Ok(());
    };
    if state.confirmed_prediction().is_some() || all_inspected {
        return Ok(());
    }
    let in_all = slots.run(move || {
        let adjustment = plan_request.adjustment();
        check_total_turn(&adjustment, first_deg, adjustment.standing(), now_deg)
    });
    let in_all = in_all.await?;
    if in_all.agrees() {
        return Ok(());
    }
    Err(Error::WrongState(format!(
        "{in_all}: read the field again (second reading), or inspect each corrector and report \
            the settings"
    )))
}

/// Predicts the deviations for the present settings: by the second reading, or with more
/// uncertainty by the compass at each step.
///
/// # Errors
/// `not-adjustable` when the uncertainty is beyond the order's limits.
pub(crate) async fn predict(
    slots: &CorrectorPlanSlots,
    state: &OrderState,
) -> Result<UpdatedPrediction> {
    if let Some(prediction) = state.confirmed_prediction() {
        return Ok(prediction.clone());
    }
    let plan_request = state.plan_request()?;
    let (limits, waters) = (state.limits, plan_request.basis.waters.clone());
    let steps = state.steps.clone();
    let prediction = slots
        .run(move || predict_by_compass(&plan_request.adjustment(), &steps))
        .await?;
    let Some(violation) = prediction.limit_violation(&limits, &waters) else {
        return Ok(prediction);
    };
    let mut refusal = Refusal::from(&violation);
    refusal.words = format!(
        "by the compass readings of the steps, {}: read the field again",
        refusal.words
    );
    refusal.cures.insert(0, Cure::ReadAgain);
    Err(not_adjustable(vec![refusal]))
}

/// Returns the planner's plans with its notes.
///
/// # Errors
/// `not-adjustable`, with the cures.
pub(crate) async fn offer_plans(
    app: &App,
    slots: &CorrectorPlanSlots,
    summary: &Summary,
    plan_request: PlanRequest,
) -> Result<Outcome> {
    let (vessel, compass) = (summary.vessel_id, summary.compass_id);
    let alerts = alerts::list_in_force(&app.db, vessel, compass).await?;
    let unproved = plan_request.basis.model.headings_until;
    let mut outcome = slots.run(move || plan(&plan_request.adjustment())).await?;
    if let Some(until) = unproved {
        outcome.notes.insert(
            0,
            format!(
                "no heading at sea has confirmed the last adjustment, which predicted the model: \
                    the last heading behind it is from {}",
                until.to_the_minute()
            ),
        );
    }
    let notes = alerts
        .iter()
        .filter(|alert| alert.cause.effect_on_plan() == PlanEffect::Note);
    let notes =
        notes.map(|alert| format!("an alert about this compass is open: {}", alert.summary));
    outcome.notes.splice(0..0, notes);
    if outcome.plans.is_empty() {
        return Err(not_adjustable(refusals(&outcome)));
    }
    Ok(outcome)
}

/// Reasons for an outcome without plans.
pub(crate) fn refusals(outcome: &Outcome) -> Vec<Refusal> {
    outcome.refusals.iter().map(Refusal::from).collect()
}
