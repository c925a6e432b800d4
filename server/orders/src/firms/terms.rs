//! Terms of a firm for an operator: places, times, vessels and fees.
//!
//! Invariants: terms are the operator's own record of the firm, hidden from other operators. Terms
//! without days or ports are stored, and reported as unusable.

use super::store;
use axum::extract::{FromRef, State};
use axum::http::StatusCode;
use binnacle_platform::access::{Reader, Writer};
use binnacle_platform::app::App;
use binnacle_platform::audit::RequestContext;
use binnacle_platform::db::{Db, DomainEvent, Tx};
use binnacle_platform::error::{Error, Problem, Result};
use binnacle_platform::http::{Id, Json, Valid, text};
use binnacle_platform::ids::{FirmId, OperatorId};
use binnacle_platform::session;
use binnacle_platform::time::Time;
use binnacle_schedule::input::{self, ServedPort};
use binnacle_schedule::ports::Port;
use binnacle_schedule::rules::Flag;
use binnacle_schedule::time::{Eur, Instant};
use binnacle_schedule::zone::Zone;
use chrono::{NaiveDate, Weekday};
use serde::{Deserialize, Serialize};
use utoipa::ToSchema;
use utoipa_axum::router::OpenApiRouter;
use utoipa_axum::routes;

/// Longest list in terms.
const MAX_LIST_LEN: usize = 1000;

/// Change of a firm's terms for an operator.
pub struct TermsChanged {
    /// Operator of the terms.
    pub operator: OperatorId,
    /// Time of the change.
    pub at: Time,
}

impl DomainEvent for TermsChanged {}

pub(super) fn router<S>() -> OpenApiRouter<S>
where
    App: FromRef<S>,
    S: Clone + Send + Sync + 'static,
{
    OpenApiRouter::new()
        .routes(routes!(list_terms))
        .routes(routes!(set_terms, end_terms))
}

/// Terms of a firm.
#[derive(Clone, Debug, PartialEq, Serialize, Deserialize, ToSchema)]
#[serde(deny_unknown_fields)]
#[schema(as = FirmTerms, example = json!({
    "ports": [{ "port": "NLRTM", "travel_eur": 150 }, { "port": "BEANR", "travel_eur": 400 }],
    "fee_eur": 1800, "extra_compass_eur": 400, "teams": 1, "jobs_a_team_day": 2,
    "working_days": ["Mon", "Tue", "Wed", "Thu", "Fri"], "closed": ["2026-12-25"],
    "first_hour": 8, "last_hour": 18, "lead_time_h": 72, "licences": ["NL-114"],
    "flags": ["PA", "MH", "NL"]
}))]
pub struct Terms {
    /// Ports served, UN/LOCODE, with the travel cost of a team's day there.
    #[serde(default)]
    pub ports: Vec<ServedPort>,
    /// Fee for a job, euros.
    #[schema(value_type = f64, minimum = 0, maximum = 1_000_000)]
    pub fee_eur: Eur,
    /// Fee for each further compass on the same job, euros.
    #[serde(default)]
    #[schema(value_type = f64, minimum = 0, maximum = 1_000_000)]
    pub extra_compass_eur: Eur,
    /// Teams for you on a working day; 1 by default.
    #[serde(default = "default_count")]
    #[schema(maximum = 1000)]
    pub teams: u32,
    /// Jobs of a team on one day in one port; 1 by default.
    #[serde(default = "default_count")]
    #[schema(minimum = 1, maximum = 20)]
    pub jobs_a_team_day: u32,
    /// Working days of the week, as `Mon`; Monday to Friday by default.
    #[serde(default = "default_working_days")]
    #[schema(value_type = Vec<String>)]
    pub working_days: Vec<Weekday>,
    /// Days without work.
    #[serde(default)]
    pub closed: Vec<NaiveDate>,
    /// Hour at which its day begins, in the port's time; 8 by default.
    #[serde(default = "default_first_hour")]
    #[schema(minimum = 0, maximum = 24)]
    pub first_hour: f64,
    /// Hour at which its day ends; 18 by default.
    #[serde(default = "default_last_hour")]
    #[schema(minimum = 0, maximum = 24)]
    pub last_hour: f64,
    /// Notice before a job, hours.
    #[serde(default)]
    #[schema(minimum = 0, maximum = 8760)]
    pub lead_time_h: f64,
    /// Licences held.
    #[serde(default)]
    pub licences: Vec<String>,
    /// Flags that accept its adjusters, ISO 3166; all, if empty.
    #[serde(default)]
    #[schema(value_type = Vec<String>)]
    pub flags: Vec<Flag>,
}

fn default_count() -> u32 {
    1
}

fn default_working_days() -> Vec<Weekday> {
    use Weekday::{Fri, Mon, Thu, Tue, Wed};
    vec![Mon, Tue, Wed, Thu, Fri]
}

fn default_first_hour() -> f64 {
    8.0
}

fn default_last_hour() -> f64 {
    18.0
}

/// Firm that works for an operator, with its terms.
#[derive(Serialize, ToSchema)]
#[schema(as = FirmWithTerms)]
struct FirmWithTerms {
    /// The firm.
    firm_id: FirmId,
    /// Its name.
    firm_name: String,
    /// Its terms; `null` before any were set.
    #[schema(required)]
    terms: Option<Terms>,
    /// Reasons for which the schedule leaves the firm out; empty when it does not.
    #[schema(example = json!(["working_days: a firm that works on no day of the week serves nobody"]))]
    problems: Vec<String>,
}

/// All firms that work for an operator.
#[derive(Serialize, ToSchema)]
#[schema(as = FirmTermsList)]
struct TermsList {
    /// Firms in the order of their creation.
    items: Vec<FirmWithTerms>,
}

/// List the terms of firms for you
#[utoipa::path(get, path = "/firm-terms", tag = "adjusting",
    responses((status = 200, body = TermsList), (status = 401, body = Problem)))]
async fn list_terms(State(app): State<App>, reader: Reader) -> Result<Json<TermsList>> {
    let items = of_operator(&app.db, reader.operator).await?;
    let items = items
        .into_iter()
        .map(|(firm, name, terms)| FirmWithTerms::new(firm, name, terms))
        .collect();
    Ok(Json(TermsList { items }))
}

/// Lists the firms that work for an operator, with their terms if any.
pub async fn of_operator(
    db: &Db,
    operator: OperatorId,
) -> Result<Vec<(FirmId, String, Option<Terms>)>> {
    let read = |(id, name, text): (FirmId, String, Option<String>)| {
        let terms = text.map(|text| serde_json::from_str(&text)).transpose()?;
        Ok((id, name, terms))
    };
    let found = store::list_with_terms(db, operator).await?;
    found.into_iter().map(read).collect()
}

/// Returns the terms of a firm for an operator, if any.
pub async fn find_terms(tx: &mut Tx, operator: OperatorId, firm: FirmId) -> Result<Option<Terms>> {
    let stored = store::list_terms(tx, firm).await?;
    let stored = stored.into_iter().find(|(whose, _)| *whose == operator);
    let terms = stored.map(|(_, text)| serde_json::from_str(&text));
    Ok(terms.transpose()?)
}

/// Set the terms of a firm for you
///
/// The schedule plans with firms that have terms. Terms without days or ports are stored, and
/// reported as a problem.
#[utoipa::path(put, path = "/firms/{id}/terms", tag = "adjusting",
    params(("id" = FirmId, Path)), request_body = Terms,
    responses((status = 200, body = FirmWithTerms), (status = 401, body = Problem),
              (status = 403, body = Problem),
              (status = 404, description = "Also when it does not work for you", body = Problem),
              (status = 422, body = Problem)))]
async fn set_terms(
    State(app): State<App>,
    request: RequestContext,
    writer: Writer,
    Id(firm): Id<FirmId>,
    Valid(terms): Valid<Terms>,
) -> Result<Json<FirmWithTerms>> {
    let terms = terms.checked()?;
    let now = app.clock.now().into();
    let mut tx = request.begin().await?;
    let name = store::find_name(&mut tx, writer.operator, firm)
        .await?
        .ok_or(Error::NotFound("firm"))?;
    let by = session::name_of(&mut tx, writer.user).await?;
    let json = serde_json::to_string(&terms)?;
    store::put_terms(&mut tx, writer.operator, firm, &json, &by, now).await?;
    tx.publish(&TermsChanged {
        operator: writer.operator,
        at: now,
    })
    .await?;
    tx.commit().await?;
    Ok(Json(FirmWithTerms::new(firm, name, Some(terms))))
}

/// Remove the terms of a firm for you
///
/// The schedule no longer plans with the firm. It keeps its orders.
#[utoipa::path(delete, path = "/firms/{id}/terms", tag = "adjusting",
    params(("id" = FirmId, Path)),
    responses((status = 204), (status = 401, body = Problem), (status = 403, body = Problem),
              (status = 404, description = "Also when it has no terms", body = Problem)))]
async fn end_terms(
    State(app): State<App>,
    request: RequestContext,
    writer: Writer,
    Id(firm): Id<FirmId>,
) -> Result<StatusCode> {
    let mut tx = request.begin().await?;
    if !store::remove_terms(&mut tx, writer.operator, firm).await? {
        return Err(Error::NotFound("firm"));
    }
    tx.publish(&TermsChanged {
        operator: writer.operator,
        at: app.clock.now().into(),
    })
    .await?;
    tx.commit().await?;
    Ok(StatusCode::NO_CONTENT)
}

impl FirmWithTerms {
    fn new(firm_id: FirmId, firm_name: String, terms: Option<Terms>) -> FirmWithTerms {
        let none = || vec!["terms: no terms are set".to_owned()];
        FirmWithTerms {
            firm_id,
            firm_name,
            problems: terms.as_ref().map_or_else(none, Terms::problems),
            terms,
        }
    }
}

impl Terms {
    fn checked(mut self) -> Result<Terms> {
        let lengths = [
            ("ports", self.ports.len()),
            ("closed", self.closed.len()),
            ("licences", self.licences.len()),
            ("flags", self.flags.len()),
        ];
        if let Some((field, length)) = lengths
            .into_iter()
            .find(|(_, length)| *length > MAX_LIST_LEN)
        {
            return Err(Error::Invalid {
                field,
                detail: format!("has {length} entries, more than {MAX_LIST_LEN}"),
            });
        }
        for licence in &mut self.licences {
            *licence = text("licences", licence)?;
        }
        match input::check_firm(&self.firm("", None)) {
            // Unusable terms are reported, not refused.
            Ok(()) | Err(input::FirmError { idle: true, .. }) => Ok(self),
            Err(error) => Err(Error::Invalid {
                field: error.field,
                detail: error.detail,
            }),
        }
    }

    /// Reason for which the firm is closed at a time, at a port; in UTC for an unknown port.
    pub(super) fn closed_at(&self, at: Time, port: Option<&Port>) -> Option<String> {
        let (at, zone) = (Instant(at.0), port.map_or_else(Zone::utc, |port| port.zone));
        let day = at.date(zone);
        if !self.firm("", None).works(day) {
            return Some(format!("does not work on {day}, a {}", day.format("%A")));
        }
        let [opens, closes] =
            [self.first_hour, self.last_hour].map(|hour| Instant::at(day, hour, zone));
        (port.is_some() && !(opens <= at && at < closes))
            .then(|| format!("works from {opens} to {closes} on {day}"))
    }

    /// Reason for which the firm may not adjust a vessel with this flag and required licence.
    pub(super) fn not_accepted(&self, flag: Option<Flag>, licence: Option<&str>) -> Option<String> {
        if let Some(flag) = flag
            && !self.firm("", None).is_accepted_by(Some(flag))
        {
            return Some(format!("is not accepted by flag {}", flag.letters()));
        }
        let licence = licence.filter(|asked| !self.licences.iter().any(|held| held == asked))?;
        Some(format!(
            "does not hold the licence that the vessel requires, {licence}"
        ))
    }

    /// Reasons for which the schedule leaves the firm out.
    pub fn problems(&self) -> Vec<String> {
        let error = input::check_firm(&self.firm("", None)).err();
        let wrong = error.map(|error| format!("{}: {}", error.field, error.detail));
        let none = (self.teams == 0).then(|| "teams: a firm without teams does no jobs".to_owned());
        wrong.into_iter().chain(none).collect()
    }

    /// Firm as the schedule's input.
    pub fn firm(&self, id: &str, name: Option<&str>) -> input::Firm {
        input::Firm {
            id: id.to_owned(),
            name: name.map(str::to_owned),
            ports: self.ports.clone(),
            licences: self.licences.clone(),
            flags: self.flags.clone(),
            teams: self.teams.into(),
            travel_times: Vec::new(),
            taken: Vec::new(),
            jobs_a_team_day: self.jobs_a_team_day,
            working_days: self.working_days.clone(),
            closed: self.closed.clone(),
            first_hour: self.first_hour,
            last_hour: self.last_hour,
            fee_eur: self.fee_eur,
            extra_compass_eur: self.extra_compass_eur,
            lead_time_h: self.lead_time_h,
        }
    }
}
