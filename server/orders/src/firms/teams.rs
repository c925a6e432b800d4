//! Teams of a firm and their travel times, as the firm states them to all its operators.
//!
//! Invariants: only the firm's own people state them. A firm that states no teams has as many as
//! each operator's terms say, all alike. What a team leaves open is as in the terms.

use super::store;
use super::terms::{Terms, TermsChanged};
use axum::extract::{FromRef, State};
use binnacle_platform::access::{Caller, PartyWriter};
use binnacle_platform::app::App;
use binnacle_platform::audit::RequestContext;
use binnacle_platform::db::{Db, Tx, execute, row, rows};
use binnacle_platform::error::{Error, Problem, Result};
use binnacle_platform::http::{Id, Json, Valid, text};
use binnacle_platform::ids::{FirmId, OperatorId};
use binnacle_platform::session;
use binnacle_platform::tenants::Tenant;
use binnacle_platform::time::Time;
use binnacle_schedule::input::{self, ServedPort, Team, Teams, TravelTime};
use binnacle_schedule::ports::PortCode;
use binnacle_schedule::time::Eur;
use serde::{Deserialize, Serialize};
use std::collections::BTreeSet;
use utoipa::ToSchema;
use utoipa_axum::router::OpenApiRouter;
use utoipa_axum::routes;

/// Longest list.
const MAX_LIST_LEN: usize = 1000;

pub(super) fn router<S>() -> OpenApiRouter<S>
where
    App: FromRef<S>,
    S: Clone + Send + Sync + 'static,
{
    OpenApiRouter::new().routes(routes!(find_teams, set_teams))
}

/// Teams of a firm, and how long they travel.
#[derive(Clone, Debug, Default, PartialEq, Serialize, Deserialize, ToSchema)]
#[serde(deny_unknown_fields)]
#[schema(as = FirmTeams, example = json!({
    "teams": [
        { "name": "Jansen", "first_hour": 7, "last_hour": 15, "ports": ["NLRTM"] },
        { "name": "Peeters", "working_days": ["Mon", "Tue", "Sat"], "licences": ["NL-114"] }
    ],
    "travel_times": [{ "from": "NLRTM", "to": "BEANR", "hours": 1.5 }]
}))]
pub(super) struct StatedTeams {
    /// Teams, each by its name; without any, operators plan with the number in their terms.
    #[serde(default)]
    pub teams: Vec<Team>,
    /// Travel between two ports, either way, or between the berths of one, where the firm knows
    /// better than the distance.
    #[serde(default)]
    pub travel_times: Vec<TravelTime>,
}

/// Teams as they were stated last.
#[derive(Default, Serialize, ToSchema)]
#[schema(as = FirmTeamsStated)]
struct LastStated {
    /// Teams, each by its name; empty if the firm states none.
    teams: Vec<Team>,
    /// Travel between two ports or two berths, where the firm knows better than the distance.
    travel_times: Vec<TravelTime>,
    /// Time of the statement; `null` if there is none.
    #[schema(required)]
    changed_at: Option<Time>,
    /// Its author.
    #[schema(required)]
    changed_by: Option<String>,
}

/// See a firm's teams
///
/// As the firm states them: hours, days, licences and ports of each, and travel times.
#[utoipa::path(get, path = "/firms/{id}/teams", tag = "adjusting",
    params(("id" = FirmId, Path)),
    responses((status = 200, body = LastStated), (status = 401, body = Problem),
              (status = 404, body = Problem)))]
async fn find_teams(
    State(app): State<App>,
    caller: Caller,
    Id(firm): Id<FirmId>,
) -> Result<Json<LastStated>> {
    caller.must_have_second_factor()?;
    let seen = store::find(&app.db, caller.tenant(), firm).await?;
    seen.ok_or(Error::NotFound("firm"))?;
    let found = find_statement(&app.db, firm).await?;
    Ok(Json(found.unwrap_or_default()))
}

/// State the teams of your firm
///
/// Schedules of all your operators plan with them from then on. Accepted orders stay.
#[utoipa::path(put, path = "/firms/{id}/teams", tag = "adjusting",
    params(("id" = FirmId, Path)), request_body = StatedTeams,
    responses((status = 200, body = LastStated), (status = 401, body = Problem),
              (status = 403, body = Problem),
              (status = 404, description = "Also when it is not your firm", body = Problem),
              (status = 422, body = Problem)))]
async fn set_teams(
    State(app): State<App>,
    request: RequestContext,
    writer: PartyWriter,
    Id(firm): Id<FirmId>,
    Valid(stated): Valid<StatedTeams>,
) -> Result<Json<LastStated>> {
    if writer.tenant != Tenant::Firm(firm) {
        return Err(Error::NotFound("firm"));
    }
    let stated = stated.checked()?;
    let now: Time = app.clock.now().into();
    let mut tx = request.begin().await?;
    let by = session::name_of(&mut tx, writer.user).await?;
    put(&mut tx, firm, &stated, &by, now).await?;
    for operator in list_operators(&mut tx, firm).await? {
        tx.publish(&TermsChanged { operator, at: now }).await?;
    }
    tx.commit().await?;
    Ok(Json(LastStated {
        teams: stated.teams,
        travel_times: stated.travel_times,
        changed_at: Some(now),
        changed_by: Some(by),
    }))
}

impl StatedTeams {
    fn checked(mut self) -> Result<StatedTeams> {
        let lengths = [
            ("teams", self.teams.len()),
            ("travel_times", self.travel_times.len()),
        ];
        for (field, length) in lengths {
            if length > MAX_LIST_LEN {
                let detail = format!("has {length} entries, more than {MAX_LIST_LEN}");
                return Err(Error::Invalid { field, detail });
            }
        }
        for team in &mut self.teams {
            team.name = text("teams", &team.name)?;
            for licence in team.licences.iter_mut().flatten() {
                *licence = text("teams", licence)?;
            }
        }
        let mut pairs = BTreeSet::new();
        for time in &self.travel_times {
            let pair = (time.from.min(time.to), time.from.max(time.to));
            if !pairs.insert(pair) {
                let detail = format!("{} to {} appears twice", time.from, time.to);
                return Err(Error::Invalid {
                    field: "travel_times",
                    detail,
                });
            }
        }
        match input::check_firm(&self.alone()) {
            Ok(()) | Err(input::FirmError { idle: true, .. }) => Ok(self),
            Err(error) => Err(Error::Invalid {
                field: error.field,
                detail: error.detail,
            }),
        }
    }

    /// A firm with these teams and the usual hours, at all ports that they name.
    fn alone(&self) -> input::Firm {
        let of_teams = self
            .teams
            .iter()
            .flat_map(|team| team.ports.iter().flatten());
        let of_ways = self
            .travel_times
            .iter()
            .flat_map(|time| [&time.from, &time.to]);
        let ports: BTreeSet<PortCode> = of_teams.copied().collect();
        let ways: BTreeSet<PortCode> = of_ways.copied().collect();
        // A team without a list serves the others too.
        let everywhere = self.teams.iter().any(|team| team.ports.is_none());
        let served = if everywhere || self.teams.is_empty() {
            ports.union(&ways).copied().collect()
        } else {
            ports
        };
        let served: Vec<ServedPort> = served
            .into_iter()
            .map(|port| ServedPort {
                port,
                travel_eur: Eur::default(),
            })
            .collect();
        let mut firm = Terms::usual(served).firm("", None);
        firm.travel_times.clone_from(&self.travel_times);
        if !self.teams.is_empty() {
            firm.teams = Teams::Named(self.teams.clone());
        }
        firm
    }
}

/// Joins a firm by terms with its own statement: its teams take the place of the number, and its
/// times that of the distance. A port where no team works is not served.
pub(super) fn join(mut firm: input::Firm, stated: &StatedTeams) -> input::Firm {
    let served: BTreeSet<PortCode> = firm.ports.iter().map(|served| served.port).collect();
    if !stated.teams.is_empty() {
        let mut teams = stated.teams.clone();
        for ports in teams.iter_mut().filter_map(|team| team.ports.as_mut()) {
            ports.retain(|port| served.contains(port));
        }
        let works_at = |port: PortCode| {
            let own = |team: &Team| team.ports.as_ref().is_none_or(|all| all.contains(&port));
            teams.iter().any(own)
        };
        firm.ports.retain(|served| works_at(served.port));
        firm.teams = Teams::Named(teams);
    }
    let served: BTreeSet<PortCode> = firm.ports.iter().map(|served| served.port).collect();
    firm.travel_times.clone_from(&stated.travel_times);
    let known = |time: &TravelTime| served.contains(&time.from) && served.contains(&time.to);
    firm.travel_times.retain(known);
    firm
}

/// Reads a statement as it is stored.
pub(super) fn read(stored: Option<&str>) -> Result<StatedTeams> {
    Ok(stored.map_or_else(|| Ok(StatedTeams::default()), serde_json::from_str)?)
}

/// Finds what a firm states; nothing, if it states nothing.
pub(super) async fn find_stated(tx: &mut Tx, firm: FirmId) -> Result<StatedTeams> {
    let found = row!(
        in tx,
        (String,),
        "SELECT teams FROM firm_teams WHERE firm_id = $1 ORDER BY firm_id",
        firm
    )?;
    read(found.as_ref().map(|(teams,)| teams.as_str()))
}

async fn find_statement(db: &Db, firm: FirmId) -> Result<Option<LastStated>> {
    let found = row!(
        db,
        (String, Time, String),
        "SELECT teams, changed_at, changed_by FROM firm_teams
         WHERE firm_id = $1
         ORDER BY firm_id",
        firm
    )?;
    let Some((teams, at, by)) = found else {
        return Ok(None);
    };
    let stated = read(Some(&teams))?;
    Ok(Some(LastStated {
        teams: stated.teams,
        travel_times: stated.travel_times,
        changed_at: Some(at),
        changed_by: Some(by),
    }))
}

async fn put(tx: &mut Tx, firm: FirmId, stated: &StatedTeams, by: &str, now: Time) -> Result<()> {
    execute!(
        tx,
        "INSERT INTO firm_teams (firm_id, teams, changed_at, changed_by) VALUES ($1, $2, $3, $4)
         ON CONFLICT (firm_id) DO UPDATE
         SET teams = excluded.teams, changed_at = excluded.changed_at,
             changed_by = excluded.changed_by",
        firm,
        serde_json::to_string(stated)?,
        now,
        by
    )?;
    Ok(())
}

async fn list_operators(tx: &mut Tx, firm: FirmId) -> Result<Vec<OperatorId>> {
    let found = rows!(
        in tx,
        (OperatorId,),
        "SELECT operator_id FROM operator_firms WHERE firm_id = $1 ORDER BY operator_id",
        firm
    )?;
    Ok(found.into_iter().map(|(operator,)| operator).collect())
}
