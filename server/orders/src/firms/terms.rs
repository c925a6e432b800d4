//! On what terms a firm works for an operator: where, when, for whom, for how much.
//!
//! What always holds: terms are the operator's own record of the firm, and no other
//! operator sees them. A firm without days or ports can be written, and is said to be of
//! no use until it has some.

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

/// No list in terms is longer.
const MOST: usize = 1000;

/// An operator has other terms with a firm.
pub struct TermsChanged {
    /// Whose terms.
    pub operator: OperatorId,
    /// When.
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

/// On what terms a firm works.
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
    /// The ports it serves, UN/LOCODE, with what a team's day there costs in travel.
    #[serde(default)]
    #[schema(value_type = Vec<ServedPortSchema>)]
    pub ports: Vec<ServedPort>,
    /// The fee for a job, euros.
    #[schema(value_type = f64, minimum = 0, maximum = 1_000_000)]
    pub fee_eur: Eur,
    /// For each compass after the first on the same job, euros.
    #[serde(default)]
    #[schema(value_type = f64, minimum = 0, maximum = 1_000_000)]
    pub extra_compass_eur: Eur,
    /// Teams that it has for you on a working day; 1 if not said.
    #[serde(default = "one")]
    #[schema(maximum = 1000)]
    pub teams: u32,
    /// Jobs that a team does on one day in one port; 1 if not said.
    #[serde(default = "one")]
    #[schema(minimum = 1, maximum = 20)]
    pub jobs_a_team_day: u32,
    /// Days of the week on which it works, as `Mon`; Monday to Friday if not said.
    #[serde(default = "working_week")]
    #[schema(value_type = Vec<String>)]
    pub working_days: Vec<Weekday>,
    /// Days on which it does not work.
    #[serde(default)]
    pub closed: Vec<NaiveDate>,
    /// The hour at which its day begins, in the port's time; 8 if not said.
    #[serde(default = "eight")]
    #[schema(minimum = 0, maximum = 24)]
    pub first_hour: f64,
    /// The hour at which its day ends; 18 if not said.
    #[serde(default = "eighteen")]
    #[schema(minimum = 0, maximum = 24)]
    pub last_hour: f64,
    /// Hours from being asked to the beginning of the job.
    #[serde(default)]
    #[schema(minimum = 0, maximum = 8760)]
    pub lead_time_h: f64,
    /// Licences that it holds.
    #[serde(default)]
    pub licences: Vec<String>,
    /// Flags that accept its adjusters, ISO 3166; all, where it is empty.
    #[serde(default)]
    #[schema(value_type = Vec<String>)]
    pub flags: Vec<Flag>,
}

/// A port that a firm serves.
#[derive(ToSchema)]
#[schema(as = ServedPort)]
#[allow(dead_code, reason = "describes binnacle_schedule::input::ServedPort")]
struct ServedPortSchema {
    /// UN/LOCODE.
    #[schema(example = "NLRTM")]
    port: String,
    /// What it costs to send a team there for a day, euros.
    #[schema(required = false, minimum = 0, maximum = 1_000_000)]
    travel_eur: f64,
}

fn one() -> u32 {
    1
}

fn working_week() -> Vec<Weekday> {
    use Weekday::{Fri, Mon, Thu, Tue, Wed};
    vec![Mon, Tue, Wed, Thu, Fri]
}

fn eight() -> f64 {
    8.0
}

fn eighteen() -> f64 {
    18.0
}

/// A firm that an operator works with, and on what terms.
#[derive(Serialize, ToSchema)]
#[schema(as = FirmWithTerms)]
struct FirmWithTerms {
    /// The firm.
    firm_id: FirmId,
    /// Its name.
    firm_name: String,
    /// Its terms; none where nobody has said them.
    #[schema(required)]
    terms: Option<Terms>,
    /// Why the schedule leaves the firm out; empty when it does not.
    #[schema(example = json!(["working_days: a firm that works on no day of the week serves nobody"]))]
    problems: Vec<String>,
}

/// All firms that an operator works with.
#[derive(Serialize, ToSchema)]
#[schema(as = FirmTermsList)]
struct TermsList {
    /// In the order in which they were entered.
    items: Vec<FirmWithTerms>,
}

/// List on what terms firms work for you
#[utoipa::path(get, path = "/firm-terms", tag = "adjusting",
    responses((status = 200, body = TermsList), (status = 401, body = Problem)))]
async fn list_terms(State(app): State<App>, reader: Reader) -> Result<Json<TermsList>> {
    let items = of_operator(&app.db, reader.operator).await?;
    let items = items.into_iter().map(FirmWithTerms::new).collect();
    Ok(Json(TermsList { items }))
}

/// The firms that an operator works with, with their terms where they are said.
pub async fn of_operator(
    db: &Db,
    operator: OperatorId,
) -> Result<Vec<(FirmId, String, Option<Terms>)>> {
    let read = |(id, name, text): (FirmId, String, Option<String>)| {
        let terms = text.map(|text| serde_json::from_str(&text)).transpose()?;
        Ok((id, name, terms))
    };
    let found = store::with_terms(db, operator).await?;
    found.into_iter().map(read).collect()
}

/// The terms on which a firm works for an operator; none where nobody has said them.
pub async fn terms_for(tx: &mut Tx, operator: OperatorId, firm: FirmId) -> Result<Option<Terms>> {
    let said = store::terms_of(tx, firm).await?;
    let said = said.into_iter().find(|(whose, _)| *whose == operator);
    let terms = said.map(|(_, text)| serde_json::from_str(&text));
    Ok(terms.transpose()?)
}

/// Say on what terms a firm works for you
///
/// The schedule plans with firms that have terms. Terms without days or ports are kept,
/// and said to be a problem.
#[utoipa::path(put, path = "/firms/{id}/terms", tag = "adjusting",
    params(("id" = FirmId, Path)), request_body = Terms,
    responses((status = 200, body = FirmWithTerms), (status = 401, body = Problem),
              (status = 403, body = Problem),
              (status = 404, description = "Also when you do not work with it", body = Problem),
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
    let name = store::name_for(&mut tx, writer.operator, firm)
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
    Ok(Json(FirmWithTerms::new((firm, name, Some(terms)))))
}

/// Plan with a firm no more
///
/// Its terms are removed; orders that it has stay with it.
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
    fn new((firm_id, firm_name, terms): (FirmId, String, Option<Terms>)) -> FirmWithTerms {
        let none = || vec!["terms: nobody has said on what terms it works".to_owned()];
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
        if let Some((field, length)) = lengths.into_iter().find(|(_, length)| *length > MOST) {
            return Err(Error::Invalid {
                field,
                detail: format!("{length} are more than {MOST}"),
            });
        }
        for licence in &mut self.licences {
            *licence = text("licences", licence)?;
        }
        match input::check_firm(&self.firm("", None)) {
            // That it is of no use is told, not refused.
            Ok(()) | Err(input::FirmError { idle: true, .. }) => Ok(self),
            Err(error) => Err(Error::Invalid {
                field: error.field,
                detail: error.detail,
            }),
        }
    }

    /// Why the firm does not work then, at a port; in UTC where that is not known.
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

    /// Why the firm may not adjust a vessel of a flag, where that is known, whose operator
    /// asks for a licence.
    pub(super) fn not_accepted(&self, flag: Option<Flag>, licence: Option<&str>) -> Option<String> {
        if let Some(flag) = flag
            && !self.firm("", None).is_accepted_by(Some(flag))
        {
            return Some(format!("is not accepted by flag {}", flag.letters()));
        }
        let licence = licence.filter(|asked| !self.licences.iter().any(|held| held == asked))?;
        Some(format!(
            "does not hold the licence that she asks for, {licence}"
        ))
    }

    /// Why the schedule leaves the firm out.
    pub fn problems(&self) -> Vec<String> {
        let error = input::check_firm(&self.firm("", None)).err();
        let wrong = error.map(|error| format!("{}: {}", error.field, error.detail));
        let none = (self.teams == 0).then(|| "teams: a firm without teams does nothing".to_owned());
        wrong.into_iter().chain(none).collect()
    }

    /// As the schedule has it.
    pub fn firm(&self, id: &str, name: Option<&str>) -> input::Firm {
        input::Firm {
            id: id.to_owned(),
            name: name.map(str::to_owned),
            ports: self.ports.clone(),
            licences: self.licences.clone(),
            flags: self.flags.clone(),
            teams: self.teams,
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
