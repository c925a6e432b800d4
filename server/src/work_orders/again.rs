//! The magnetometer read once more, after the steps: whether the correctors do what was
//! planned, also where the compass could not show it on the berth's heading.
//!
//! What always holds: it is optional, and what it says is kept. One that confirms the plan
//! gives the order its model and its residuals; one that does not holds back completion
//! until the field was read as foretold, a plan was made from this very reading, or someone
//! has found the correctors to stand otherwise.

use super::basis::{Basis, Prepared};
use super::entry::Content;
use super::order::{Order, State};
use super::plan::{calculate, must_still_hold};
use super::reading::{Read, check, must_be_numbers};
use super::refusal::Refusal;
use super::standing::Standing;
use super::{completion, request, shown};
use crate::access::PartyWriter;
use crate::app::App;
use crate::error::{Error, Problem, Result};
use crate::http::{Id, Json, Valid};
use crate::idempotency::Key;
use crate::ids::OrderId;
use axum::extract::State as Shared;
use binnacle_magnetics::adjust::{
    AdjustError, Again, AgainForm, Card, Corrector, Done, Learnt, Part, ReadingForm, Slip, Verdict,
    read_again,
};
use binnacle_magnetics::berth::BerthReading;
use binnacle_magnetics::binnacle::Setting;
use serde::{Deserialize, Serialize};
use utoipa::ToSchema;
use utoipa_axum::router::OpenApiRouter;
use utoipa_axum::routes;

/// A second reading as the log has it.
#[derive(Clone, Debug, Serialize, Deserialize)]
pub struct ReadAgain {
    /// What was read.
    pub given: AgainForm,
    /// What it told.
    #[serde(flatten)]
    pub said: AgainSaid,
    /// What is foretold now, where it told that.
    pub learnt: Option<Learnt>,
    /// The reading to plan from anew, where what is left is beyond the limits.
    pub anew: Option<Box<Read>>,
}

impl ReadAgain {
    /// Whether it does not confirm how the correctors stand.
    pub(super) fn is_disproof(&self) -> bool {
        self.said.verdict != AgainVerdict::AsPlanned
    }
}

/// What a second reading told.
#[derive(Clone, Debug, Serialize, Deserialize, ToSchema)]
#[schema(as = SecondReadingSaid)]
pub struct AgainSaid {
    /// In a word.
    pub verdict: AgainVerdict,
    /// In words.
    pub words: String,
    /// Forward, to starboard and, where it was read both times, down.
    #[schema(value_type = Vec<PartSchema>)]
    pub parts: Vec<Part>,
    /// The step that is suspected, of all that were done since the first reading, from 1.
    #[serde(default, skip_serializing_if = "Option::is_none")]
    pub step: Option<u32>,
    /// How the correctors would stand with that slip.
    #[serde(default, skip_serializing_if = "Option::is_none")]
    #[schema(value_type = Option<crate::binnacles::SettingSchema>)]
    pub setting: Option<Setting>,
    /// The worst residual foretold now, degrees.
    #[serde(default, skip_serializing_if = "Option::is_none")]
    pub worst_residual_deg: Option<f64>,
    /// The widest 95 % band now, degrees.
    #[serde(default, skip_serializing_if = "Option::is_none")]
    pub widest_band_deg: Option<f64>,
    /// What is beyond the limits.
    #[serde(default, skip_serializing_if = "Vec::is_empty")]
    #[schema(required = false)]
    pub refusals: Vec<Refusal>,
    /// Mistakes each of which alone would explain it.
    #[serde(default, skip_serializing_if = "Vec::is_empty")]
    #[schema(required = false)]
    pub could_be: Vec<String>,
}

/// What a second reading came to, in a word.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Serialize, Deserialize, ToSchema)]
#[serde(rename_all = "snake_case")]
#[schema(as = SecondReadingVerdict)]
pub enum AgainVerdict {
    /// The correctors do what was planned.
    AsPlanned,
    /// They do, but what is left is beyond the limits: plan anew from this reading.
    Replan,
    /// A step is suspected: look at it, and say how the correctors stand.
    Slip,
    /// Nothing explains it: read again.
    Unexplained,
}

/// One part of the field, nT.
#[derive(ToSchema)]
#[schema(as = SecondReadingPart)]
#[allow(
    dead_code,
    clippy::struct_field_names,
    reason = "describes binnacle_magnetics::adjust::Part"
)]
struct PartSchema {
    /// What was foretold.
    expected_nt: f64,
    read_nt: f64,
    /// Of the difference.
    standard_error_nt: f64,
}

/// What the magnetometer of the first reading read after the steps, in the same place.
#[derive(ToSchema)]
#[schema(as = SecondReading, example = json!({
    "at": "2026-11-22T10:05:00Z", "forward": 15.1, "starboard": 17.7, "unit": "microtesla"
}))]
#[allow(dead_code, reason = "describes binnacle_magnetics::adjust::AgainForm")]
struct AgainSchema {
    /// When it was read.
    at: crate::time::Time,
    /// Horizontal field at the card's centre, bowl out, forward positive.
    forward: f64,
    /// The same, starboard positive.
    starboard: f64,
    /// Vertical field there, down positive.
    down: Option<f64>,
    /// What all three are in.
    unit: super::asked::FieldUnit,
    /// The ship's true heading, by the same means, where it is no longer what it was.
    #[schema(minimum = 0, maximum = 360)]
    heading_true_deg: Option<f64>,
    /// What the compass read before the bowl was taken out, degrees.
    #[schema(minimum = 0, maximum = 360)]
    compass_deg: Option<f64>,
}

pub(super) fn router() -> OpenApiRouter<App> {
    OpenApiRouter::new().routes(routes!(read_field_again))
}

/// Send what the magnetometer reads after the steps
///
/// With it a slip that the berth's heading hides is found: the field shows what the compass
/// on one heading cannot. Optional; without it such a slip can only be found at sea.
#[utoipa::path(post, path = "/work-orders/{id}/second-reading", tag = "adjusting",
    params(("id" = OrderId, Path), Key), request_body = AgainSchema,
    responses((status = 200, body = Order), (status = 401, body = Problem),
              (status = 403, body = Problem), (status = 404, body = Problem),
              (status = 409, description = "Not before all steps are done, or nothing was moved", body = Problem),
              (status = 422, body = Problem)))]
async fn read_field_again(
    Shared(app): Shared<App>,
    writer: PartyWriter,
    Id(id): Id<OrderId>,
    key: Key,
    Valid(given): Valid<AgainForm>,
) -> Result<Json<Order>> {
    let request = request(&app, writer, id, key, "second reading", &given)?;
    let (whole, done) = request.look().await?;
    if done.is_some() {
        return shown(&app, writer.tenant, id).await;
    }
    let mut standing = whole.standing();
    standing.step_back();
    must_be_done(&standing)?;
    let prepared = standing.prepared()?;
    must_still_hold(&app, &whole.summary, &prepared).await?;
    let second = Second::new(given, &prepared)?;
    let form = second.form.clone();
    must_be_numbers(&form, app.clock.now().into())?;
    completion::must_follow_the_steps(&whole, form.at.into())?;
    must_answer_a_disproof(&standing, &form)?;
    // Of a step that someone has looked at since, no slip is suspected any more.
    let looked_at = standing.looked_at;
    let steps = standing.steps[looked_at..].to_vec();
    let planned = standing.plan.is_some();
    let judge = move || second.judge(&prepared, &steps, looked_at, planned);
    let (mut judged, basis) = calculate(&app, judge).await?;
    judged.anew = basis.map(|basis| from_here(basis, form)).transpose()?;
    if let Some(mut change) = request.begin(&whole).await? {
        change
            .append(Content::SecondReading(Box::new(judged)))
            .await?;
        change.commit().await?;
    }
    shown(&app, writer.tenant, id).await
}

fn must_be_done(standing: &Standing) -> Result<()> {
    if let Some(step) = standing.next_step() {
        let number = step.number;
        return Err(Error::WrongState(format!("step {number} is not done")));
    }
    let is_moved = standing.state == State::Measured && standing.was_moved();
    if standing.state == State::Adjusting || is_moved {
        return Ok(());
    }
    Err(Error::WrongState(
        "no corrector was moved since the berth was read".to_owned(),
    ))
}

/// What a part of the field disproved is not confirmed without that part.
fn must_answer_a_disproof(standing: &Standing, form: &ReadingForm) -> Result<()> {
    let disproof = standing.disproof();
    let was_whole = disproof.is_some_and(|again| again.said.parts.len() == WHOLE);
    if form.down.is_some() || !was_whole {
        return Ok(());
    }
    Err(Error::Invalid {
        field: "down",
        detail: "the last reading did not confirm the steps, and had a vertical part: read that \
                 again too"
            .to_owned(),
    })
}

/// Parts of a reading that has the vertical one.
pub(super) const WHOLE: usize = 3;

/// A second reading as it was given, as one of its own, and as the science takes it.
struct Second {
    given: AgainForm,
    form: ReadingForm,
    reading: BerthReading,
}

impl Second {
    fn new(given: AgainForm, prepared: &Prepared) -> Result<Second> {
        let form = given.as_reading(&prepared.given);
        let form = form.map_err(|error| Error::Invalid {
            field: error.field,
            detail: error.what,
        })?;
        let reading = form.reading(prepared.basis.variation()?);
        let reading = reading.map_err(|error| Error::Invalid {
            field: "forward, starboard",
            detail: error.to_string(),
        })?;
        Ok(Second {
            given,
            form,
            reading,
        })
    }

    fn read(&self, prepared: &Prepared, steps: &[Done]) -> std::result::Result<Again, AdjustError> {
        read_again(
            &prepared.adjustment(),
            steps,
            &self.reading,
            self.form.vertical(),
            self.form.compass_deg,
            self.form.unit,
        )
    }
}

/// Whether the reading that did not fit fits the correctors as they are said to stand now.
pub(super) async fn is_explained_by(
    app: &App,
    standing: &Standing,
    setting: &Setting,
) -> Result<bool> {
    let Some(disproof) = standing.disproof() else {
        return Ok(false);
    };
    let mut before = standing.clone();
    before.step_back();
    let mut prepared = before.prepared()?;
    prepared.moved_to = Some(setting.clone());
    let second = Second::new(disproof.given.clone(), &prepared)?;
    let again = calculate(app, move || second.read(&prepared, &[])).await?;
    Ok(matches!(
        again.verdict,
        Verdict::AsPlanned { .. } | Verdict::Replan { .. }
    ))
}

impl Second {
    /// What it told, and what to plan from where it calls for a plan from itself: also
    /// where it fits, and there is no plan that was followed.
    fn judge(
        self,
        prepared: &Prepared,
        steps: &[Done],
        looked_at: usize,
        planned: bool,
    ) -> std::result::Result<(ReadAgain, Option<Basis>), AdjustError> {
        let second = self;
        let again = second.read(prepared, steps)?;
        let mut said = AgainSaid {
            verdict: AgainVerdict::AsPlanned,
            words: as_planned(steps, again.parts.len()),
            parts: again.parts,
            step: None,
            setting: None,
            worst_residual_deg: None,
            widest_band_deg: None,
            refusals: Vec::new(),
            could_be: Vec::new(),
        };
        let (mut foretold, mut anew) = (None, None);
        match again.verdict {
            Verdict::AsPlanned { learnt } if planned => foretold = Some(*learnt),
            Verdict::AsPlanned { learnt } => {
                said.verdict = AgainVerdict::Replan;
                "the correctors do what they should where they are said to stand: plan anew from this \
             reading"
                .clone_into(&mut said.words);
                let standing = prepared.adjustment().standing().clone();
                let mut basis = prepared.basis.clone();
                basis.model.model = learnt.model_after.clone();
                basis.binnacle = prepared.binnacle.with_setting(standing)?;
                anew = Some(basis);
                foretold = Some(*learnt);
            }
            Verdict::Replan {
                learnt,
                refusals,
                binnacle,
                ..
            } => {
                said.verdict = AgainVerdict::Replan;
                "the correctors seem to stand as planned, but more is left than the limits allow: read \
             once more, away from steel and cranes; if it is so again, plan anew from this reading"
                .clone_into(&mut said.words);
                said.refusals = refusals.iter().map(Refusal::from).collect();
                let mut basis = prepared.basis.clone();
                basis.model.model = learnt.model_after.clone();
                basis.binnacle = *binnacle;
                anew = Some(basis);
                foretold = Some(*learnt);
            }
            Verdict::Slip {
                step,
                slip,
                setting,
                ..
            } => {
                said.verdict = AgainVerdict::Slip;
                said.words = suspected(steps, step, slip);
                said.step = u32::try_from(looked_at).ok().map(|before| before + step);
                said.setting = Some(setting);
            }
            Verdict::Unexplained { mistakes } => {
                said.verdict = AgainVerdict::Unexplained;
                said.words = unexplained(looked_at);
                said.could_be = mistakes.iter().map(ToString::to_string).collect();
                if let Some(card) = again.card.filter(Card::is_refused) {
                    said.words = card.found();
                    said.could_be = card.suspects();
                }
            }
        }
        said.worst_residual_deg = foretold.as_ref().map(|learnt| learnt.worst_residual_deg);
        said.widest_band_deg = foretold.as_ref().map(|learnt| learnt.widest_band_deg);
        let read = ReadAgain {
            given: second.given,
            said,
            learnt: foretold,
            anew: None,
        };
        Ok((read, anew))
    }
}

fn unexplained(looked_at: usize) -> String {
    let steps = match looked_at {
        0 => "one of its steps",
        _ => "a step that nobody has looked at since",
    };
    format!(
        "neither the plan nor a slip in {steps} explains what was read: look at every step and at \
         the magnetometer, and read again"
    )
}

/// The second reading as one to plan from, held against what is known now.
fn from_here(basis: Basis, given: ReadingForm) -> Result<Box<Read>> {
    let (checked, refusal) = match check(&given, &basis)? {
        Ok(checked) => (Some(checked), None),
        Err(refusal) => (None, Some(refusal)),
    };
    Ok(Box::new(Read {
        given,
        basis: Some(basis),
        checked,
        refusal,
    }))
}

/// What is confirmed, and what is not.
fn as_planned(steps: &[Done], parts: usize) -> String {
    let heels = |done: &Done| done.step.corrector == Corrector::Heeling;
    let mut words = "the correctors do what was planned".to_owned();
    if parts < WHOLE && steps.iter().any(heels) {
        words += "; the vertical part was not read both times, and nothing confirms the heeling \
                  magnets";
    }
    words
}

fn suspected(steps: &[Done], number: u32, slip: Slip) -> String {
    let step = steps.get((number as usize).saturating_sub(1));
    let words = step.map_or("", |done| done.step.words.as_str());
    let how = match slip {
        Slip::WrongEnd => "the magnets went in with the wrong end".to_owned(),
        Slip::OtherHole { hole } => format!("the magnets stand at {hole}"),
        Slip::NotDone => "it was not done".to_owned(),
    };
    format!(
        "look at the step \"{words}\": by the field, {how}. Say how the correctors stand; where \
         they stand as planned, or are put right, read again"
    )
}
