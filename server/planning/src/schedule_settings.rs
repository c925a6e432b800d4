//! Settings of an operator's schedule: cost weights, terms and horizon.

use binnacle_platform::db::{Db, Tx, execute, row};
use binnacle_platform::error::{Error, Result};
use binnacle_platform::ids::OperatorId;
use binnacle_platform::time::Time;
use binnacle_schedule::input::Weights;
use binnacle_schedule::needs::Terms;
use serde::{Deserialize, Serialize};
use utoipa::ToSchema;

/// Cost weights, terms and horizon of the schedule.
#[derive(Clone, Debug, PartialEq, Serialize, Deserialize, ToSchema)]
#[serde(default, deny_unknown_fields)]
#[schema(as = ScheduleSettings, example = json!({
    "horizon_days": 180,
    "weights": { "changed_eur": 150, "withdrawn_eur": 500, "late_days": 0, "job_h": 3 },
    "terms": { "after_event_days": 30, "over_limit_days": 14, "urgent_days": 14 }
}))]
pub(crate) struct ScheduleSettings {
    /// Planning horizon, days; a compass that is due later is left out.
    #[schema(minimum = 1, maximum = 730)]
    pub horizon_days: u32,
    /// Cost weights in euros, each with a default. docs/schedule.md explains them.
    #[schema(value_type = Object)]
    pub weights: Weights,
    /// Terms of due dates for which a rule gives no date.
    #[schema(value_type = Object)]
    pub terms: Terms,
}

impl Default for ScheduleSettings {
    fn default() -> ScheduleSettings {
        ScheduleSettings {
            horizon_days: 180,
            weights: Weights::default(),
            terms: Terms::default(),
        }
    }
}

/// Returns an operator's settings, or the defaults.
pub(crate) async fn find(db: &Db, operator: OperatorId) -> Result<ScheduleSettings> {
    let found = row!(
        db,
        (String,),
        "SELECT settings FROM schedule_settings WHERE operator_id = $1 ORDER BY operator_id",
        operator
    )?;
    Ok(found.map_or_else(
        || Ok(ScheduleSettings::default()),
        |(text,)| serde_json::from_str(&text),
    )?)
}

/// Returns an operator's terms of due dates for which a rule gives no date.
pub(crate) async fn terms(db: &Db, operator: OperatorId) -> Result<Terms> {
    Ok(find(db, operator).await?.terms)
}

/// Stores an operator's settings, in place of the earlier ones.
pub(crate) async fn put(
    tx: &mut Tx,
    operator: OperatorId,
    settings: &ScheduleSettings,
    by: &str,
    now: Time,
) -> Result<()> {
    execute!(
        tx,
        "INSERT INTO schedule_settings (operator_id, settings, changed_at, changed_by)
         VALUES ($1, $2, $3, $4)
         ON CONFLICT (operator_id) DO UPDATE
         SET settings = excluded.settings, changed_at = excluded.changed_at,
             changed_by = excluded.changed_by",
        operator,
        serde_json::to_string(settings)?,
        now,
        by
    )?;
    Ok(())
}

impl ScheduleSettings {
    pub(crate) fn check(&self) -> Result<()> {
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
