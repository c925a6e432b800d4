//! Firms that work for an operator: terms, and what the firm states of itself.

use super::port_names::zone;
use super::teams::{self, StatedTeams};
use super::terms::Terms;
use super::{named_port, store};
use binnacle_platform::db::Db;
use binnacle_platform::error::Result;
use binnacle_platform::ids::{FirmId, OperatorId};
use binnacle_platform::time::Time;
use binnacle_schedule::input::{self, Team};
use binnacle_schedule::rules::Flag;
use binnacle_schedule::time::Instant;
use chrono::{Datelike, NaiveDate};

/// Firm that works for an operator.
pub struct EngagedFirm {
    /// Its id.
    pub id: FirmId,
    /// Its name.
    pub name: String,
    /// Its terms for the operator, if any.
    pub terms: Option<Terms>,
    /// Its own statement of its teams.
    pub(super) stated: StatedTeams,
}

/// Lists the firms that work for an operator.
pub async fn of_operator(db: &Db, operator: OperatorId) -> Result<Vec<EngagedFirm>> {
    let found = store::list_with_terms(db, operator).await?;
    let read = |stored: store::StoredFirm| {
        let terms = stored.terms.as_deref().map(serde_json::from_str);
        Ok(EngagedFirm {
            id: stored.id,
            name: stored.name,
            terms: terms.transpose()?,
            stated: teams::read(stored.teams.as_deref())?,
        })
    };
    found.into_iter().map(read).collect()
}

impl EngagedFirm {
    /// Firm as the schedule's input; `None` without terms.
    pub fn planned(&self) -> Option<input::Firm> {
        let terms = self.terms.as_ref()?;
        let firm = terms.firm(&self.id.to_string(), Some(&self.name));
        Some(teams::join(firm, &self.stated))
    }

    /// Reasons for which the schedule leaves the firm out.
    pub fn problems(&self) -> Vec<String> {
        let Some(firm) = self.planned() else {
            return vec!["terms: no terms are set".to_owned()];
        };
        let error = input::check_firm(&firm).err();
        let wrong = error.map(|error| format!("{}: {}", error.field, error.detail));
        let none = || "teams: a firm without teams does no jobs".to_owned();
        let none = (firm.teams.count() == 0).then(none);
        wrong.into_iter().chain(none).collect()
    }
}

/// Hours of a job at a port, however that is named.
#[derive(Clone, Copy)]
pub(super) struct JobHours<'a> {
    pub(super) port: &'a str,
    pub(super) from: Time,
    pub(super) until: Time,
}

/// Returns the names of a firm's teams that may do a job, one empty name for teams without names.
/// It is an error, in words, when none may.
pub(super) fn suitable_teams(
    firm: &input::Firm,
    job: &JobHours<'_>,
    flag: Option<Flag>,
    licence: Option<&str>,
) -> std::result::Result<Vec<Option<String>>, Unsuitable> {
    if let Some(flag) = flag
        && !firm.is_accepted_by(Some(flag))
    {
        let why = format!("is not accepted by flag {}", flag.letters());
        return Err(Unsuitable::Firm(why));
    }
    let teams: Vec<Option<&Team>> = match firm.teams.named() {
        [] => vec![None],
        named => named.iter().map(Some).collect(),
    };
    let mut first = None;
    let mut suitable = Vec::new();
    for team in teams {
        match obstacle(firm, team, job, licence) {
            None => suitable.push(team.map(|team| team.name.clone())),
            Some(why) => first = first.or(Some(why)),
        }
    }
    match first {
        Some(why) if suitable.is_empty() => Err(why),
        _ => Ok(suitable),
    }
}

/// Reason for which a firm may not do a job.
pub(super) enum Unsuitable {
    /// It does not work then.
    Time(String),
    /// It may not adjust the vessel.
    Firm(String),
}

/// Returns true if a job that begins on a day lies within working hours. Those of days that are
/// worked round the clock join.
fn is_within(
    job: &JobHours<'_>,
    begins_on: NaiveDate,
    works_on: impl Fn(NaiveDate) -> bool,
    hours_on: impl Fn(NaiveDate) -> [Instant; 2],
) -> bool {
    let mut reached = Instant(job.from.0);
    for day in begins_on.iter_days() {
        let [opens, closes] = hours_on(day);
        if !works_on(day) || opens > reached || closes <= reached {
            return false;
        }
        reached = closes;
        if Instant(job.until.0) <= reached {
            return true;
        }
    }
    false
}

/// Reason for which a team may not do a job.
fn obstacle(
    firm: &input::Firm,
    team: Option<&Team>,
    job: &JobHours<'_>,
    licence: Option<&str>,
) -> Option<Unsuitable> {
    let port = named_port(job.port);
    let zone = zone(job.port);
    let day = Instant(job.from.0).date(zone);
    let time = |why| Some(Unsuitable::Time(why));
    if !works(firm, team, day) {
        return time(format!("does not work on {day}, a {}", day.format("%A")));
    }
    let first_hour = team.and_then(|team| team.first_hour);
    let last_hour = team.and_then(|team| team.last_hour);
    let hours = [
        first_hour.unwrap_or(firm.first_hour),
        last_hour.unwrap_or(firm.last_hour),
    ];
    let hours_on = |day| hours.map(|hour| Instant::at(day, hour, zone));
    let works_on = |day| works(firm, team, day);
    if port.is_some() && !is_within(job, day, works_on, hours_on) {
        let [opens, closes] = hours_on(day);
        return time(format!("works from {opens} to {closes} on {day}"));
    }
    let held = team.and_then(|team| team.licences.as_ref());
    let held = held.unwrap_or(&firm.licences);
    if let Some(licence) = licence.filter(|asked| !held.iter().any(|held| held == asked)) {
        return Some(Unsuitable::Firm(format!(
            "does not hold the licence that the vessel requires, {licence}"
        )));
    }
    let ports = team.and_then(|team| team.ports.as_ref());
    if let (Some(port), Some(ports)) = (port, ports)
        && !ports.contains(&port.code)
    {
        return Some(Unsuitable::Firm(format!("has no team at {}", port.name)));
    }
    None
}

fn works(firm: &input::Firm, team: Option<&Team>, day: NaiveDate) -> bool {
    let own = team.and_then(|team| team.working_days.as_ref());
    let days = own.unwrap_or(&firm.working_days);
    days.contains(&day.weekday()) && !firm.closed.contains(&day)
}

#[cfg(test)]
mod tests {
    use super::*;
    use chrono::Weekday;

    /// Returns whether a job in Rotterdam lies within hours that are worked on all days but Sundays.
    fn is_worked(hours: [f64; 2], from: &str, until: &str) -> bool {
        let zone = zone("Rotterdam (NLRTM)");
        let [from, until] = [from, until].map(|text| Instant::parse(text).unwrap());
        let job = JobHours {
            port: "Rotterdam (NLRTM)",
            from: Time(from.0),
            until: Time(until.0),
        };
        let works_on = |day: NaiveDate| day.weekday() != Weekday::Sun;
        let hours_on = |day| hours.map(|hour| Instant::at(day, hour, zone));
        is_within(&job, from.date(zone), works_on, hours_on)
    }

    #[test]
    fn a_night_lies_within_the_hours_of_days_worked_round_the_clock_only() {
        // From 23:00 on a Thursday to 02:00, in the port's time.
        let night = ["2026-11-26T22:00:00Z", "2026-11-27T01:00:00Z"];
        assert!(is_worked([0.0, 24.0], night[0], night[1]));
        assert!(!is_worked([0.0, 23.5], night[0], night[1]));
        assert!(!is_worked([8.0, 24.0], night[0], night[1]));
        // From a Saturday into a Sunday, in which the legal time changes once.
        assert!(!is_worked(
            [0.0, 24.0],
            "2026-10-24T21:00:00Z",
            "2026-10-25T00:00:00Z"
        ));
        assert!(is_worked(
            [0.0, 24.0],
            "2026-10-24T19:00:00Z",
            "2026-10-24T22:00:00Z"
        ));
    }
}
