//! `/schedule/settings`: what counts how much, and how far ahead.

use axum::extract::{FromRef, State};
use binnacle_platform::access::{Reader, Writer};
use binnacle_platform::app::App;
use binnacle_platform::audit::RequestContext;
use binnacle_platform::db::{Db, execute, row};
use binnacle_platform::error::{Error, Problem, Result};
use binnacle_platform::http::{Json, Valid};
use binnacle_platform::ids::OperatorId;
use binnacle_platform::session;
use binnacle_schedule::input::Weights;
use binnacle_schedule::needs::Terms;
use serde::{Deserialize, Serialize};
use utoipa::ToSchema;
use utoipa_axum::router::OpenApiRouter;
use utoipa_axum::routes;

pub(super) fn router<S>() -> OpenApiRouter<S>
where
    App: FromRef<S>,
    S: Clone + Send + Sync + 'static,
{
    OpenApiRouter::new().routes(routes!(find_schedule_settings, set_settings))
}

/// Cost weights, terms and horizon of the schedule.
#[derive(Clone, Debug, PartialEq, Serialize, Deserialize, ToSchema)]
#[serde(default, deny_unknown_fields)]
#[schema(as = ScheduleSettings, example = json!({
    "horizon_days": 180,
    "weights": { "changed_eur": 150, "withdrawn_eur": 500, "late_days": 0, "job_h": 3 },
    "terms": { "after_event_days": 30, "over_limit_days": 14, "urgent_days": 14 }
}))]
pub(super) struct Settings {
    /// Days ahead to plan for; a compass that is due later is left out.
    #[schema(minimum = 1, maximum = 730)]
    pub horizon_days: u32,
    /// Cost weights in euros; a weight that is left out has its default. docs/schedule.md
    /// explains each.
    #[schema(value_type = Object)]
    pub weights: Weights,
    /// The terms by which compasses are due where a rule gives no date.
    #[schema(value_type = Object)]
    pub terms: Terms,
}

impl Default for Settings {
    fn default() -> Settings {
        Settings {
            horizon_days: 180,
            weights: Weights::default(),
            terms: Terms::default(),
        }
    }
}

/// See what counts how much in the schedule
#[utoipa::path(get, path = "/schedule/settings", tag = "adjusting",
    responses((status = 200, body = Settings), (status = 401, body = Problem)))]
async fn find_schedule_settings(State(app): State<App>, reader: Reader) -> Result<Json<Settings>> {
    Ok(Json(find(&app.db, reader.operator).await?))
}

/// Say what counts how much in the schedule
#[utoipa::path(put, path = "/schedule/settings", tag = "adjusting", request_body = Settings,
    responses((status = 200, body = Settings), (status = 401, body = Problem),
              (status = 403, body = Problem), (status = 422, body = Problem)))]
async fn set_settings(
    State(app): State<App>,
    request: RequestContext,
    writer: Writer,
    Valid(settings): Valid<Settings>,
) -> Result<Json<Settings>> {
    settings.check()?;
    let now = app.clock.now().into();
    let mut tx = request.begin().await?;
    let by = session::name_of(&mut tx, writer.user).await?;
    execute!(
        &mut tx,
        "INSERT INTO schedule_settings (operator_id, settings, changed_at, changed_by)
         VALUES ($1, $2, $3, $4)
         ON CONFLICT (operator_id) DO UPDATE
         SET settings = excluded.settings, changed_at = excluded.changed_at,
             changed_by = excluded.changed_by",
        writer.operator,
        serde_json::to_string(&settings)?,
        now,
        by
    )?;
    super::store::ask(&mut tx, writer.operator, now).await?;
    tx.commit().await?;
    Ok(Json(settings))
}

/// An operator's settings, or the defaults.
pub(super) async fn find(db: &Db, operator: OperatorId) -> Result<Settings> {
    let found = row!(
        db,
        (String,),
        "SELECT settings FROM schedule_settings WHERE operator_id = $1 ORDER BY operator_id",
        operator
    )?;
    Ok(found.map_or_else(
        || Ok(Settings::default()),
        |(text,)| serde_json::from_str(&text),
    )?)
}

/// The terms by which an operator's compasses are due where a rule gives no date.
pub async fn terms(db: &Db, operator: OperatorId) -> Result<Terms> {
    Ok(find(db, operator).await?.terms)
}

impl Settings {
    fn check(&self) -> Result<()> {
        let invalid = |field, detail: String| Err(Error::Invalid { field, detail });
        if !(1..=730).contains(&self.horizon_days) {
            let detail = format!("{} is not within 1 to 730", self.horizon_days);
            return invalid("horizon_days", detail);
        }
        if !(0.5..=24.0).contains(&self.weights.job_h) {
            let detail = format!("{} is not within 0.5 to 24", self.weights.job_h);
            return invalid("weights.job_h", detail);
        }
        Ok(())
    }
}
