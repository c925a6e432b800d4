//! Capacity of a firm: whether one of its teams has the hours for a visit, beside its orders of all
//! operators.
//!
//! Invariants: a booking holds the firm's lock until the transaction ends, so that a team's hours
//! are booked once. A team is in one place at a time and has the time to travel between. An
//! operator learns of others' orders only that no team is left; the firm sees its own. An operator
//! offers no job at hours at which no suitable team works, by its terms and the firm's statement.
//! A firm without terms and teams accepts any hours.

use super::engaged::{JobHours, Unsuitable, suitable_teams};
use super::port_names::{day, zone};
use super::store;
use super::taken::{StoredBooking, Visit, list_around, visits};
use super::teams::{self, StatedTeams};
use super::terms::Terms;
use binnacle_fleet::particulars;
use binnacle_platform::db::{Tx, execute};
use binnacle_platform::error::{Error, Result};
use binnacle_platform::ids::{FirmId, OperatorId};
use binnacle_platform::time::Time;
use binnacle_schedule::bookings::{Booking, assign_teams};
use binnacle_schedule::input::{Firm, Teams};
use binnacle_schedule::time::Instant;
use std::collections::BTreeSet;

/// Time around a visit in which other orders may keep a team from it, hours: the longest way.
const AROUND_H: f64 = 72.0;
/// Most jobs of a team on a day where no terms say: as in terms.
const MAX_JOBS_A_TEAM_DAY: u32 = 20;

/// Party that books a visit.
#[derive(Clone, Copy, PartialEq, Eq)]
pub enum Requester {
    /// The operator, for whom its own open offers count too.
    Operator,
    /// The firm, which accepts.
    Firm,
}

/// Terms and teams by which a firm's capacity is judged.
struct Capacity {
    own: Option<Firm>,
    all: Firm,
    is_stated: bool,
}

impl Capacity {
    /// Combines all operators' terms; `None` where neither terms nor teams are known.
    fn new(
        all_terms: &[(OperatorId, Terms)],
        operator: OperatorId,
        stated: &StatedTeams,
    ) -> Option<Capacity> {
        let is_stated = !stated.teams.is_empty();
        if all_terms.is_empty() && !is_stated {
            return None;
        }
        let own = all_terms.iter().find(|(whose, _)| *whose == operator);
        let own = own.map(|(_, terms)| teams::join(terms.firm("", None), stated));
        // Each operator records the teams that work for it: the largest number counts as all.
        let most =
            |figure: fn(&Terms) -> u32| all_terms.iter().map(|(_, terms)| figure(terms)).max();
        let mut all = Terms::usual(Vec::new()).firm("", None);
        all.teams = most(|terms| terms.teams).unwrap_or(0).into();
        all.jobs_a_team_day = most(|terms| terms.jobs_a_team_day).unwrap_or(MAX_JOBS_A_TEAM_DAY);
        all.ports = all_terms
            .iter()
            .flat_map(|(_, terms)| terms.ports.clone())
            .collect();
        all.ports.sort_by_key(|served| served.port);
        all.ports.dedup_by_key(|served| served.port);
        let mut all = teams::join(all, stated);
        if is_stated {
            all.teams = Teams::Named(stated.teams.clone());
        }
        Some(Capacity {
            own,
            all,
            is_stated,
        })
    }

    /// Returns whether teams can do all of these visits.
    fn can_do(&self, orders: &[&StoredBooking], own: OperatorId) -> bool {
        let bookings = |firm: &Firm, orders: &[&StoredBooking]| -> Vec<Booking> {
            let visits = visits(firm, orders.iter().copied());
            visits.into_iter().map(|visit| visit.booking).collect()
        };
        if assign_teams(&self.all, &bookings(&self.all, orders)).is_none() {
            return false;
        }
        let Some(firm) = self.own.as_ref().filter(|_| !self.is_stated) else {
            return true;
        };
        // An operator may have fewer teams of the firm than there are.
        let of_own: Vec<&StoredBooking> = orders
            .iter()
            .copied()
            .filter(|order| order.operator_id == own)
            .collect();
        assign_teams(firm, &bookings(firm, &of_own)).is_some()
    }
}

/// Refuses a visit for which no team of a firm has the hours, or which its terms exclude. Returns
/// the team that does it, where the firm's teams have names.
///
/// # Errors
/// [`Error::WrongState`], in words for the requester.
pub async fn require_capacity(
    tx: &mut Tx,
    firm: FirmId,
    firm_name: &str,
    visit: &Visit<'_>,
    requester: Requester,
) -> Result<Option<String>> {
    // Other bookings of the firm wait.
    execute!(&mut *tx, "UPDATE firms SET name = name WHERE id = $1", firm)?;
    let all_terms = store::list_terms(tx, firm).await?;
    let all_terms: Vec<(OperatorId, Terms)> = all_terms
        .into_iter()
        .map(|(operator, text)| Ok((operator, serde_json::from_str(&text)?)))
        .collect::<Result<_>>()?;
    let stated = teams::find_stated(tx, firm).await?;
    let Some(capacity) = Capacity::new(&all_terms, visit.operator, &stated) else {
        return Ok(None);
    };
    let mut candidates = candidates(tx, firm_name, &capacity, visit, requester).await?;
    let between = [
        Time(visit.from.0.plus_seconds(-AROUND_H * 3600.0)),
        Time(visit.until.0.plus_seconds(AROUND_H * 3600.0)),
    ];
    let around = list_around(tx, firm, between, visit.order).await?;
    let counts = |one: &&StoredBooking| {
        one.is_taken || requester == Requester::Operator && one.operator_id == visit.operator
    };
    let mut others: Vec<&StoredBooking> = around.iter().filter(counts).collect();
    if !capacity.can_do(&others, visit.operator) {
        // Fewer teams than were booked keep only their own days from further jobs.
        let that_day = day(visit.port, visit.from);
        others.retain(|one| one.day() == that_day);
    }
    // The team that comes for another compass of the vessel does this one too.
    let beside = others.iter().find(|one| one.is_beside(visit));
    let expected = beside.map_or(visit.team, |one| one.team.as_deref());
    candidates.sort_by_key(|team| team.as_deref() != expected);
    for team in candidates {
        let new = StoredBooking::new(visit, team.clone());
        let orders: Vec<&StoredBooking> = others.iter().copied().chain([&new]).collect();
        if capacity.can_do(&orders, visit.operator) {
            return Ok(team);
        }
    }
    Err(Error::WrongState(no_team_left(
        firm_name, visit, &others, requester,
    )))
}

/// Returns the teams that may do a visit.
///
/// # Errors
/// [`Error::WrongState`] when none may, by the operator's terms and the firm's statement. Terms
/// are the operator's own record: they do not bind the firm itself.
async fn candidates(
    tx: &mut Tx,
    firm_name: &str,
    capacity: &Capacity,
    visit: &Visit<'_>,
    requester: Requester,
) -> Result<Vec<Option<String>>> {
    let job = JobHours {
        port: visit.port,
        from: visit.from,
        until: visit.until,
    };
    let (flag, licence) = particulars::adjuster_requirements(tx, visit.vessel).await?;
    let judged = capacity
        .own
        .as_ref()
        .or(capacity.is_stated.then_some(&capacity.all));
    let suitable = judged.map_or(Ok(vec![None]), |firm| {
        suitable_teams(firm, &job, flag, licence.as_deref())
    });
    let mut teams = match (suitable, requester) {
        (Ok(teams), _) => teams,
        (Err(_), Requester::Firm) => Vec::new(),
        (Err(unsuitable), Requester::Operator) => {
            let (why, instead) = match unsuitable {
                Unsuitable::Time(why) => (why, "time"),
                Unsuitable::Firm(why) => (why, "firm"),
            };
            return Err(Error::WrongState(format!(
                "by your terms, {firm_name} {why}: choose another {instead}, or change the terms"
            )));
        }
    };
    if requester == Requester::Firm {
        let named = capacity.all.teams.named().iter();
        let any = named.map(|team| Some(team.name.clone()));
        let more: Vec<Option<String>> = any.filter(|team| !teams.contains(team)).collect();
        teams.extend(more);
        if teams.is_empty() {
            teams.push(None);
        }
    }
    Ok(teams)
}

/// Describes a lack of teams, in words for the requester.
fn no_team_left(
    firm_name: &str,
    visit: &Visit<'_>,
    others: &[&StoredBooking],
    requester: Requester,
) -> String {
    let that_day = day(visit.port, visit.from);
    let clock = |port: &str, at: Instant| zone(port).local(at).format("%H:%M").to_string();
    let [from, until] = [visit.from, visit.until].map(|at| clock(visit.port, Instant(at.0)));
    let near: Vec<&StoredBooking> = {
        let same = others.iter().copied().filter(|one| one.day() == that_day);
        let same: Vec<&StoredBooking> = same.collect();
        if same.is_empty() {
            others.to_vec()
        } else {
            same
        }
    };
    let hours = |one: &StoredBooking| {
        let booking = one.booking();
        let [from, until] = [booking.from, booking.to].map(|at| clock(&one.port, at));
        let day = booking.day;
        format!("from {from} to {until} on {day}")
    };
    match requester {
        Requester::Operator => {
            let own = near.iter().filter(|one| one.operator_id == visit.operator);
            let own: Vec<String> = own
                .map(|one| {
                    let (order, ship, port) = (one.order_id, &one.vessel_name, &one.port);
                    format!("work order {order} of {ship} at {port} {}", hours(one))
                })
                .collect();
            let holding = if own.is_empty() {
                String::new()
            } else {
                format!(": you have {}", own.join(", "))
            };
            format!("{firm_name} has no team left on {that_day} from {from} to {until}{holding}")
        }
        Requester::Firm => {
            let ships = near.iter().filter(|one| one.is_taken);
            let ships: BTreeSet<String> = ships
                .map(|one| format!("{} at {} {}", one.vessel_name, one.port, hours(one)))
                .collect();
            let ships: Vec<String> = ships.into_iter().collect();
            format!(
                "your firm has no team left on {that_day}: it goes to {}, and the job is from \
                 {from} to {until}",
                ships.join(", ")
            )
        }
    }
}
