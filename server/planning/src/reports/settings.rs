//! `/reports/settings`: cost of a swing, and recipients of the monthly report.
//!
//! Invariant: each recipient is a receiver of the outbox, added and removed with the settings.

use axum::extract::{FromRef, State};
use binnacle_platform::access::{Reader, Writer};
use binnacle_platform::app::App;
use binnacle_platform::audit::RequestContext;
use binnacle_platform::db::{Db, Tx, execute, row, rows};
use binnacle_platform::error::{Error, Problem, Result};
use binnacle_platform::http::{Json, Valid};
use binnacle_platform::ids::{OperatorId, RecipientId};
use binnacle_platform::mail;
use binnacle_platform::outbox::{self, Channel};
use binnacle_platform::session;
use binnacle_platform::time::Time;
use serde::{Deserialize, Serialize};
use utoipa::ToSchema;
use utoipa_axum::router::OpenApiRouter;
use utoipa_axum::routes;

/// Maximum number of recipients of the monthly report.
const MAX_RECIPIENTS: usize = 20;
/// Maximum cost of a swing, euros.
const MAX_SWING_EUR: f64 = 1e6;
/// Maximum duration of a swing, hours.
const MAX_SWING_H: f64 = 72.0;

pub(super) fn router<S>() -> OpenApiRouter<S>
where
    App: FromRef<S>,
    S: Clone + Send + Sync + 'static,
{
    OpenApiRouter::new().routes(routes!(find_report_settings, set_report_settings))
}

/// Cost figures for reports, and recipients of the monthly report.
#[derive(Clone, Debug, PartialEq, Serialize, Deserialize, ToSchema)]
#[serde(default, deny_unknown_fields)]
#[schema(as = ReportSettings, example = json!({
    "swing_eur": 6000.0, "swing_h": 3.0, "monthly_to": ["superintendent@example.com"]
}))]
pub(super) struct Settings {
    /// Cost of swinging a vessel, euros: tugs, pilot, adjuster and the vessel's time.
    #[schema(minimum = 0, maximum = 1_000_000)]
    pub(super) swing_eur: f64,
    /// Duration of a swing, hours.
    #[schema(minimum = 0, maximum = 72)]
    pub(super) swing_h: f64,
    /// Recipients of the report of a month by mail after its end; at most 20 addresses.
    pub(super) monthly_to: Vec<String>,
}

impl Default for Settings {
    /// The figures of Basterretxea-Iribar, Sotés and Uriarte 2016.
    fn default() -> Settings {
        Settings {
            swing_eur: 6000.0,
            swing_h: 3.0,
            monthly_to: Vec::new(),
        }
    }
}

/// See the settings of reports
#[utoipa::path(get, path = "/reports/settings", tag = "fleet",
    responses((status = 200, body = Settings), (status = 401, body = Problem)))]
async fn find_report_settings(State(app): State<App>, reader: Reader) -> Result<Json<Settings>> {
    Ok(Json(find(&app.db, reader.operator).await?))
}

/// Change the settings of reports
///
/// A recipient added to `monthly_to` gets the report of the current month after its end, and of
/// each later one.
#[utoipa::path(put, path = "/reports/settings", tag = "fleet", request_body = Settings,
    responses((status = 200, body = Settings), (status = 401, body = Problem),
              (status = 403, body = Problem),
              (status = 409, description = "This server is not set up to send mail", body = Problem),
              (status = 422, body = Problem)))]
async fn set_report_settings(
    State(app): State<App>,
    request: RequestContext,
    writer: Writer,
    Valid(settings): Valid<Settings>,
) -> Result<Json<Settings>> {
    let settings = settings.checked()?;
    if !settings.monthly_to.is_empty() {
        mail::must_be_set_up(&app)?;
    }
    let now = app.clock.now().into();
    let mut tx = request.begin().await?;
    let by = session::name_of(&mut tx, writer.user).await?;
    put(&mut tx, writer.operator, &settings, &by, now).await?;
    reconcile_recipients(&mut tx, writer.operator, &settings.monthly_to, now).await?;
    tx.commit().await?;
    Ok(Json(settings))
}

/// Returns an operator's settings, or the defaults.
pub(super) async fn find(db: &Db, operator: OperatorId) -> Result<Settings> {
    let found = row!(
        db,
        (String,),
        "SELECT settings FROM report_settings WHERE operator_id = $1 ORDER BY operator_id",
        operator
    )?;
    Ok(found.map_or_else(
        || Ok(Settings::default()),
        |(text,)| serde_json::from_str(&text),
    )?)
}

async fn put(
    tx: &mut Tx,
    operator: OperatorId,
    settings: &Settings,
    by: &str,
    now: Time,
) -> Result<()> {
    execute!(
        tx,
        "INSERT INTO report_settings (operator_id, settings, changed_at, changed_by)
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

/// Adds new recipients to the outbox and removes former ones.
async fn reconcile_recipients(
    tx: &mut Tx,
    operator: OperatorId,
    addresses: &[String],
    now: Time,
) -> Result<()> {
    let known = rows!(
        in &mut *tx,
        (RecipientId, String),
        "SELECT id, address FROM report_recipients WHERE operator_id = $1 ORDER BY id",
        operator
    )?;
    for (id, address) in &known {
        if !addresses.contains(address) {
            outbox::forget(tx, id.0).await?;
        }
    }
    for address in addresses {
        if known.iter().any(|(_, known)| known == address) {
            continue;
        }
        let id = RecipientId::new();
        outbox::insert(tx, operator, id.0, Channel::Mail, true).await?;
        execute!(
            &mut *tx,
            "INSERT INTO report_recipients (id, operator_id, address, created_at)
             VALUES ($1, $2, $3, $4)",
            id,
            operator,
            address.as_str(),
            now
        )?;
    }
    Ok(())
}

impl Settings {
    fn checked(self) -> Result<Settings> {
        let invalid = |field, detail: String| Err(Error::Invalid { field, detail });
        if !(0.0..=MAX_SWING_EUR).contains(&self.swing_eur) {
            let detail = format!("{} is outside 0 to {MAX_SWING_EUR}", self.swing_eur);
            return invalid("swing_eur", detail);
        }
        if !(0.0..=MAX_SWING_H).contains(&self.swing_h) {
            let detail = format!("{} is outside 0 to {MAX_SWING_H}", self.swing_h);
            return invalid("swing_h", detail);
        }
        if self.monthly_to.len() > MAX_RECIPIENTS {
            return invalid(
                "monthly_to",
                format!("has more than {MAX_RECIPIENTS} addresses"),
            );
        }
        let mut monthly_to: Vec<String> = Vec::new();
        for address in &self.monthly_to {
            let address = mail::address("monthly_to", address)?;
            if !monthly_to.contains(&address) {
                monthly_to.push(address);
            }
        }
        Ok(Settings { monthly_to, ..self })
    }
}
