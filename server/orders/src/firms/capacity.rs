//! Capacity of a firm: the vessels it visits on a day, by orders of all operators, and its teams.
//!
//! Invariants: a booking holds the firm's lock until the transaction ends, so that the last team
//! is booked once. A team is in one port a day. An operator learns of others' orders only that no
//! team is left; the firm sees its own. An operator offers no job at a time at which the firm does
//! not work by the operator's terms. A firm without terms accepts any time.

use super::store;
use super::terms::Terms;
use binnacle_fleet::particulars;
use binnacle_platform::db::{Db, Tx, execute, rows};
use binnacle_platform::error::{Error, Result};
use binnacle_platform::ids::{FirmId, OperatorId, OrderId, VesselId};
use binnacle_platform::time::Time;
use binnacle_schedule::ports::{self, Port, PortCode};
use binnacle_schedule::time::Instant;
use binnacle_schedule::zone::Zone;
use chrono::NaiveDate;
use std::collections::{BTreeMap, BTreeSet};

/// Largest distance of a port's day from any of its instants, hours, in whatever zone.
const MAX_DAY_OFFSET_H: f64 = 40.0;

/// Order that a firm has been offered, or has.
#[derive(Clone, Debug, sqlx::FromRow)]
pub struct Booking {
    /// Operator of the vessel.
    pub operator_id: OperatorId,
    /// The vessel.
    pub vessel_id: VesselId,
    /// Its name.
    pub vessel_name: String,
    /// The order.
    pub order_id: OrderId,
    port: String,
    planned_at: Time,
    /// True if the firm has it, false if it has an offer only.
    pub is_taken: bool,
}

/// Visit of a firm to a vessel.
pub struct Visit<'a> {
    /// Operator of the order.
    pub operator: OperatorId,
    /// Vessel to visit.
    pub vessel: VesselId,
    /// Port, as the order names it.
    pub port: &'a str,
    /// Time of the visit.
    pub at: Time,
}

/// Party that books a visit.
#[derive(Clone, Copy, PartialEq, Eq)]
pub enum Requester {
    /// The operator, for whom its own open offers count too.
    Operator,
    /// The firm, which accepts.
    Firm,
}

/// Port that an order names: by its code, alone or behind its name, or by its name.
pub fn named_port(words: &str) -> Option<&'static Port> {
    let code = words
        .rsplit_once('(')
        .and_then(|(_, code)| code.strip_suffix(')'));
    let by_code = |text: &str| PortCode::parse(text).ok().and_then(ports::find);
    let named = |port: &&Port| {
        let words = words.trim();
        port.name.eq_ignore_ascii_case(words) || port.plain_name.eq_ignore_ascii_case(words)
    };
    code.and_then(by_code)
        .or_else(|| by_code(words))
        .or_else(|| {
            // A name shared by several ports is ambiguous.
            let mut all = ports::all().iter().filter(named);
            all.next().filter(|_| all.next().is_none())
        })
}

/// Key of a port, however its name is written.
fn place(words: &str) -> String {
    named_port(words).map_or_else(|| words.trim().to_lowercase(), |port| port.code.to_string())
}

/// Day of an instant in a port's time.
fn day(words: &str, at: Time) -> NaiveDate {
    Instant(at.0).date(named_port(words).map_or_else(Zone::utc, |port| port.zone))
}

impl Booking {
    /// Day in the port's time.
    pub fn day(&self) -> NaiveDate {
        day(&self.port, self.planned_at)
    }
}

/// Number of teams for these vessels on one day.
fn teams(at: impl IntoIterator<Item = (String, VesselId)>, jobs_a_team: u32) -> u32 {
    let mut there: BTreeMap<String, BTreeSet<VesselId>> = BTreeMap::new();
    for (place, vessel) in at {
        there.entry(place).or_default().insert(vessel);
    }
    let ships = there.values().map(|ships| u32::try_from(ships.len()));
    ships
        .map(|ships| ships.unwrap_or(u32::MAX).div_ceil(jobs_a_team.max(1)))
        .fold(0, u32::saturating_add)
}

/// Teams booked by orders outside a plan, day by day.
pub fn teams_taken<'a>(
    bookings: impl IntoIterator<Item = &'a Booking>,
    jobs_a_team: u32,
) -> BTreeMap<NaiveDate, u32> {
    let mut days: BTreeMap<NaiveDate, Vec<(String, VesselId)>> = BTreeMap::new();
    for booking in bookings {
        let there = (place(&booking.port), booking.vessel_id);
        days.entry(booking.day()).or_default().push(there);
    }
    let taken = days.into_iter();
    taken
        .map(|(day, there)| (day, teams(there, jobs_a_team)))
        .collect()
}

macro_rules! bookings_sql {
    ($where:literal) => {
        concat!(
            "SELECT v.operator_id, o.vessel_id, v.name AS vessel_name, o.id AS order_id,
                    COALESCE(c.port, o.port) AS port, o.planned_at,
                    CASE WHEN f.state = 'accepted' THEN TRUE ELSE FALSE END AS is_taken
             FROM work_order_offers f
             JOIN work_orders o ON o.vessel_id = f.vessel_id AND o.id = f.order_id
             JOIN vessels v ON v.id = o.vessel_id
             LEFT JOIN schedule_orders l ON l.vessel_id = o.vessel_id AND l.order_id = o.id
             LEFT JOIN port_calls c ON c.vessel_id = l.vessel_id AND c.id = l.call_id
             WHERE f.firm_id = $1 AND f.state IN ('open', 'proposed', 'accepted')
               AND o.state <> 'cancelled' ",
            $where,
            " ORDER BY o.planned_at, o.vessel_id, o.id"
        )
    };
}

/// Lists a firm's offers and orders from a time on.
pub async fn bookings(db: &Db, firm: FirmId, from: Time) -> Result<Vec<Booking>> {
    Ok(rows!(
        db,
        Booking,
        bookings_sql!("AND o.planned_at >= $2"),
        firm,
        from
    )?)
}

/// Refuses a visit while a firm is closed, or to a vessel that it may not adjust.
async fn require_suitable_firm(
    tx: &mut Tx,
    firm_name: &str,
    terms: &Terms,
    visit: &Visit<'_>,
) -> Result<()> {
    let wrong = |why: String, instead: &str| {
        Err(Error::WrongState(format!(
            "by your terms, {firm_name} {why}: choose another {instead}, or change the terms"
        )))
    };
    if let Some(why) = terms.closed_at(visit.at, named_port(visit.port)) {
        return wrong(why, "time");
    }
    let (flag, licence) = particulars::adjuster_requirements(tx, visit.vessel).await?;
    match terms.not_accepted(flag, licence.as_deref()) {
        Some(why) => wrong(why, "firm"),
        None => Ok(()),
    }
}

/// Refuses a visit for which a firm has no team left, or which its terms exclude.
///
/// # Errors
/// [`Error::WrongState`], in words for the requester.
pub async fn require_capacity(
    tx: &mut Tx,
    firm: FirmId,
    firm_name: &str,
    visit: &Visit<'_>,
    requester: Requester,
) -> Result<()> {
    // Other bookings of the firm wait.
    execute!(&mut *tx, "UPDATE firms SET name = name WHERE id = $1", firm)?;
    let all_terms = store::list_terms(tx, firm).await?;
    let all_terms: Vec<(OperatorId, Terms)> = all_terms
        .into_iter()
        .map(|(operator, text)| Ok((operator, serde_json::from_str(&text)?)))
        .collect::<Result<_>>()?;
    if all_terms.is_empty() {
        return Ok(());
    }
    let (from, to) = (
        Time(visit.at.0.plus_seconds(-MAX_DAY_OFFSET_H * 3600.0)),
        Time(visit.at.0.plus_seconds(MAX_DAY_OFFSET_H * 3600.0)),
    );
    let around = rows!(
        in tx,
        Booking,
        bookings_sql!("AND o.planned_at >= $2 AND o.planned_at <= $3 AND o.vessel_id <> $4"),
        firm,
        from,
        to,
        visit.vessel
    )?;
    let own = all_terms
        .iter()
        .find(|(operator, _)| *operator == visit.operator);
    // Times and vessels are the operator's own record of the firm: they do not bind the firm
    // itself.
    if requester == Requester::Operator
        && let Some((_, terms)) = own
    {
        require_suitable_firm(tx, firm_name, terms, visit).await?;
    }
    let that_day = day(visit.port, visit.at);
    let there = (place(visit.port), visit.vessel);
    let others: Vec<&Booking> = around.iter().filter(|one| one.day() == that_day).collect();
    let counts = |one: &Booking| {
        one.is_taken || requester == Requester::Operator && one.operator_id == visit.operator
    };
    // Each operator records the teams that work for it: the largest number counts as all.
    let most = |figure: fn(&Terms) -> u32| all_terms.iter().map(|(_, terms)| figure(terms)).max();
    let all_teams = most(|terms| terms.teams).unwrap_or(0);
    let all_jobs = most(|terms| terms.jobs_a_team_day).unwrap_or(1);
    let needed = |whose: &dyn Fn(&Booking) -> bool, jobs: u32| {
        let ships = others.iter().filter(|one| counts(one) && whose(one));
        let ships = ships.map(|one| (place(&one.port), one.vessel_id));
        teams(ships.chain([there.clone()]), jobs)
    };
    let is_own = |one: &Booking| one.operator_id == visit.operator;
    let is_full = needed(&|_| true, all_jobs) > all_teams
        || own.is_some_and(|(_, terms)| needed(&is_own, terms.jobs_a_team_day) > terms.teams);
    if !is_full {
        return Ok(());
    }
    Err(Error::WrongState(match requester {
        Requester::Operator => {
            let own = others.iter().filter(|one| counts(one) && is_own(one));
            let own: Vec<String> = own
                .map(|one| {
                    let Booking {
                        order_id,
                        vessel_name,
                        port,
                        ..
                    } = one;
                    format!("work order {order_id} of {vessel_name} at {port}")
                })
                .collect();
            let holding = if own.is_empty() {
                String::new()
            } else {
                format!(": you have {}", own.join(", "))
            };
            format!("{firm_name} has no team left on {that_day}{holding}")
        }
        Requester::Firm => {
            let ships = others.iter().filter(|one| one.is_taken);
            let ships: BTreeSet<String> = ships
                .map(|one| format!("{} at {}", one.vessel_name, one.port))
                .collect();
            let ships: Vec<String> = ships.into_iter().collect();
            format!(
                "your firm has no team left on {that_day}: it goes to {}",
                ships.join(", ")
            )
        }
    }))
}
