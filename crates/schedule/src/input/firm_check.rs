//! Checks that a firm can be scheduled.

use super::{Firm, Team};
use crate::ports;
use crate::time::Instant;
use crate::zone::Zone;
use std::collections::BTreeSet;

/// The reason why a firm cannot be scheduled.
#[derive(Clone, Debug, PartialEq, Eq, thiserror::Error)]
#[error("{field}: {detail}")]
pub struct FirmError {
    /// The field at fault.
    pub field: &'static str,
    /// The fault in it.
    pub detail: String,
    /// True if the only fault is that it has no working days or no ports.
    pub idle: bool,
}

/// Checks a firm; idleness is checked last.
///
/// # Errors
/// The first fault.
pub fn check_firm(firm: &Firm) -> Result<(), FirmError> {
    let wrong = |field, detail: &str| {
        let (detail, idle) = (detail.to_owned(), false);
        Err(FirmError {
            field,
            detail,
            idle,
        })
    };
    if firm.teams.count() > 1000 {
        return wrong("teams", "more than 1000");
    }
    if !(1..=20).contains(&firm.jobs_a_team_day) {
        return wrong("jobs_a_team_day", "is not within 1 to 20");
    }
    let hours = 0.0..=24.0;
    if !hours.contains(&firm.first_hour) {
        return wrong("first_hour", "is not within 0 to 24");
    }
    if !hours.contains(&firm.last_hour) || firm.last_hour <= firm.first_hour {
        return wrong("last_hour", "is not after first_hour and up to 24");
    }
    if !(0.0..=8760.0).contains(&firm.lead_time_h) {
        return wrong("lead_time_h", "is not within 0 to 8760");
    }
    let mut served = BTreeSet::new();
    for port in &firm.ports {
        if ports::find(port.port).is_none() {
            return wrong("ports", &ports::describe_unknown(port.port));
        }
        if !served.insert(port.port) {
            return wrong("ports", &format!("{} appears twice", port.port));
        }
    }
    check_teams(firm).or_else(|detail| wrong("teams", &detail))?;
    check_taken(firm).or_else(|detail| wrong("taken", &detail))?;
    for time in &firm.travel_times {
        for port in [time.from, time.to] {
            if !served.contains(&port) {
                return wrong("travel_times", &format!("{port} is not among its ports"));
            }
        }
        if !(0.0..=72.0).contains(&time.hours) {
            let detail = format!("{} hours are not within 0 to 72", time.hours);
            return wrong("travel_times", &detail);
        }
    }
    let idle = |field, detail: &str| {
        let (detail, idle) = (detail.to_owned(), true);
        Err(FirmError {
            field,
            detail,
            idle,
        })
    };
    if firm.working_days.is_empty() {
        return idle(
            "working_days",
            "a firm that works on no day of the week serves nobody",
        );
    }
    if firm.ports.is_empty() {
        return idle("ports", "a firm without ports serves nobody");
    }
    Ok(())
}

/// Checks teams with names.
fn check_teams(firm: &Firm) -> Result<(), String> {
    let mut names = BTreeSet::new();
    for team in firm.teams.named() {
        let name = team.name.as_str();
        if name.trim().is_empty() || name.chars().count() > 100 {
            return Err("a name is empty or longer than 100 characters".to_owned());
        }
        if !names.insert(name) {
            return Err(format!("{name:?} appears twice"));
        }
        let hours = [
            team.first_hour.unwrap_or(firm.first_hour),
            team.last_hour.unwrap_or(firm.last_hour),
        ];
        if hours.iter().any(|hour| !(0.0..=24.0).contains(hour)) || hours[1] <= hours[0] {
            return Err(format!(
                "the hours of {name:?} are not in order within 0 to 24"
            ));
        }
        if team.working_days.as_ref().is_some_and(Vec::is_empty) {
            return Err(format!("{name:?} works on no day of the week"));
        }
        let ports = team.ports.iter().flatten();
        if let Some(port) = { ports }.find(|port| firm.travel(**port).is_none()) {
            return Err(format!(
                "{name:?} works at {port}, which is not among the firm's ports"
            ));
        }
    }
    let works = |team: &Team, port| {
        team.ports
            .as_ref()
            .is_none_or(|ports| ports.contains(&port))
    };
    let teams = firm.teams.named();
    let mut ports = firm.ports.iter().map(|served| served.port);
    match ports.find(|port| !teams.is_empty() && !teams.iter().any(|team| works(team, *port))) {
        Some(port) => Err(format!("no team works at {port}")),
        None => Ok(()),
    }
}

/// Checks bookings elsewhere.
fn check_taken(firm: &Firm) -> Result<(), String> {
    for taken in &firm.taken {
        let day = taken.day;
        let named = firm.teams.named();
        match &taken.team {
            Some(name) if !named.iter().any(|team| team.name == *name) => {
                return Err(format!("there is no team {name:?}, {day}"));
            }
            None if !named.is_empty() => {
                return Err(format!("which team is taken is not said, {day}"));
            }
            Some(_) if taken.teams != 1 => {
                return Err(format!("a team with a name is one team, {day}"));
            }
            _ => {}
        }
        let Some(hours) = taken.hours else { continue };
        if hours.to <= hours.from {
            return Err(format!("{} is not after {}", hours.to, hours.from));
        }
        // A day of some zone begins 14 hours before one of universal time, and ends 12
        // hours after it.
        let since_h = hours.from.hours_since(Instant::at(day, 0.0, Zone::utc()));
        if !(-14.0..36.0).contains(&since_h) || hours.to.hours_since(hours.from) > 24.0 {
            return Err(format!(
                "{} to {} are not hours of {day}",
                hours.from, hours.to
            ));
        }
        if let Some(port) = hours.port.filter(|port| firm.travel(*port).is_none()) {
            return Err(format!("{port} is not among its ports"));
        }
    }
    Ok(())
}
