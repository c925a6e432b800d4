//! The plan: what the planner offers, and what was chosen of it.

use super::basis::Prepared;
use super::order::Summary;
use super::refusal::Refusal;
use super::standing::Standing;
use crate::app::App;
use crate::error::{Error, Result};
use crate::models;
use binnacle_magnetics::adjust::{AdjustError, Optimality, Outcome, Plan, plan};
use serde::{Deserialize, Serialize};
use utoipa::ToSchema;

/// A plan that was chosen.
#[derive(Clone, Debug, Serialize, Deserialize)]
pub struct Planned {
    /// Which of those that were offered, from 1.
    pub chosen: usize,
    /// All that were offered, in short.
    pub offered: Vec<InShort>,
    /// What the adjuster should know of it.
    pub notes: Vec<String>,
    /// How well the search knows that nothing is better.
    pub optimality: Option<Optimality>,
    /// The plan.
    pub plan: Plan,
}

/// A plan in short.
#[derive(Clone, Debug, Serialize, Deserialize)]
pub struct InShort {
    /// Movements of hand that it takes.
    pub moves: u32,
    /// Worst foretold residual, weighted over the waters, degrees.
    pub worst_residual_deg: f64,
    /// The widest 95 % band, degrees.
    pub widest_band_deg: f64,
}

/// Which plan.
#[derive(Clone, Copy, Debug, Default, Serialize, Deserialize, ToSchema)]
#[serde(deny_unknown_fields)]
#[schema(as = PlanChoice, example = json!({ "plan": 1 }))]
pub(super) struct Choice {
    /// Which of those that are offered, from 1: the recommended one where it is not said.
    #[schema(minimum = 1)]
    pub plan: Option<usize>,
}

impl Standing {
    /// What the planner is asked now.
    ///
    /// # Errors
    /// [`Error::WrongState`] before there is a reading.
    pub(super) fn prepared(&self) -> Result<Prepared> {
        let wrong = || Error::WrongState("there is no reading to plan from yet".to_owned());
        let read = self.read.as_ref().ok_or_else(wrong)?;
        let basis = read.basis.clone().ok_or_else(wrong)?;
        let reading = read
            .given
            .reading(basis.variation()?)
            .map_err(|error| anyhow::anyhow!("a reading that was taken: {error}"))?;
        Ok(Prepared {
            reading,
            given: read.given.clone(),
            binnacle: self.binnacle.clone().ok_or_else(wrong)?,
            moved_to: self.moved_to.clone(),
            compass_deg: self.compass_deg,
            limits: self.limits,
            basis,
        })
    }
}

/// What is read at a berth holds no longer: by then she may lie elsewhere.
pub(super) const READING_HOLDS_S: f64 = 48.0 * 3600.0;

/// Refuses a reading that is too old, or older than a change of the ship's magnetism.
///
/// # Errors
/// [`Error::WrongState`].
pub(super) async fn must_still_hold(
    app: &App,
    summary: &Summary,
    prepared: &Prepared,
) -> Result<()> {
    let age_s = app.clock.now().seconds_since(prepared.given.at);
    if age_s > READING_HOLDS_S {
        let hours = age_s / 3600.0;
        let words = format!("the berth was read {hours:.0} hours ago: read it again");
        return Err(Error::WrongState(words));
    }
    let model = models::current(&app.db, summary.vessel_id, summary.compass_id).await?;
    let known_until = prepared.basis.model.data_until;
    let holds = model.is_some_and(|model| model.epoch_from.is_none_or(|from| from <= known_until));
    if !holds {
        return Err(Error::WrongState(
            "the ship's magnetism has changed since the model that the berth was held against: \
             when there is a model again, read it again"
                .to_owned(),
        ));
    }
    Ok(())
}

/// Refuses what is foretold beyond the order's limits, however it came to be followed.
///
/// # Errors
/// [`Error::NotAdjustable`] with what would cure it.
pub(super) fn must_keep_to_limits(standing: &Standing) -> Result<()> {
    let basis = standing.read.as_ref().and_then(|read| read.basis.as_ref());
    let followed = standing.plan.as_ref().zip(basis);
    let beyond =
        followed.and_then(|(plan, basis)| plan.plan.beyond(&standing.limits, &basis.waters));
    match beyond {
        Some(refused) => Err(Error::NotAdjustable(vec![Refusal::from(&refused)])),
        None => Ok(()),
    }
}

/// What the planner offers, or why it offers nothing.
///
/// # Errors
/// [`Error::NotAdjustable`] with what would cure it.
pub(super) async fn offer(app: &App, prepared: Prepared) -> Result<Outcome> {
    let outcome = calculate(app, move || plan(&prepared.adjustment())).await?;
    if outcome.plans.is_empty() {
        return Err(Error::NotAdjustable(refusals(&outcome)));
    }
    Ok(outcome)
}

/// Runs the planner on a blocking thread, a few at a time.
pub(super) async fn calculate<T: Send + 'static>(
    app: &App,
    what: impl FnOnce() -> std::result::Result<T, AdjustError> + Send + 'static,
) -> Result<T> {
    let turn = app.planning.clone().acquire_owned().await;
    let turn = turn.map_err(|error| anyhow::anyhow!(error))?;
    let done = tokio::task::spawn_blocking(move || {
        let _turn = turn;
        what()
    });
    done.await?.map_err(|error| Error::Invalid {
        field: "plan",
        detail: error.to_string(),
    })
}

/// Why an outcome has no plans.
pub(super) fn refusals(outcome: &Outcome) -> Vec<Refusal> {
    outcome.refusals.iter().map(Refusal::from).collect()
}

impl Planned {
    /// What was chosen of an outcome, from 1; none when there are not so many.
    pub fn of(outcome: Outcome, chosen: usize) -> Option<Planned> {
        let in_short = |plan: &Plan| InShort {
            moves: plan.moves,
            worst_residual_deg: plan.worst_residual_deg,
            widest_band_deg: plan.widest_band_deg,
        };
        Some(Planned {
            chosen,
            offered: outcome.plans.iter().map(in_short).collect(),
            notes: outcome.notes,
            optimality: outcome.optimality,
            plan: outcome.plans.into_iter().nth(chosen.checked_sub(1)?)?,
        })
    }
}
