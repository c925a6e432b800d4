//! Hours of a firm's teams that orders have booked.
//!
//! Invariants: orders of one vessel at one place whose hours overlap are one visit. Each visit
//! takes one team for its hours.

use super::port_names::{day, place};
use binnacle_platform::db::{Db, Tx, rows};
use binnacle_platform::error::Result;
use binnacle_platform::ids::{FirmId, OperatorId, OrderId, VesselId};
use binnacle_platform::time::Time;
use binnacle_schedule::bookings::{Booking, assign_teams};
use binnacle_schedule::input::{Firm, Taken, TakenHours};
use binnacle_schedule::ports::PortCode;
use binnacle_schedule::time::Instant;
use chrono::NaiveDate;

/// Order that a firm has been offered, or has.
#[derive(Clone, Debug, sqlx::FromRow)]
pub struct StoredBooking {
    /// Operator of the vessel.
    pub operator_id: OperatorId,
    /// The vessel.
    pub vessel_id: VesselId,
    /// Its name.
    pub vessel_name: String,
    /// The order.
    pub order_id: OrderId,
    pub(super) port: String,
    planned_at: Time,
    planned_until: Time,
    pub(super) team: Option<String>,
    /// True if the firm has it, false if it has an offer only.
    pub is_taken: bool,
}

/// Visit of a firm to a vessel.
pub struct Visit<'a> {
    /// Operator of the order.
    pub operator: OperatorId,
    /// Vessel to visit.
    pub vessel: VesselId,
    /// The order.
    pub order: OrderId,
    /// Port, as the order names it.
    pub port: &'a str,
    /// Beginning.
    pub from: Time,
    /// End.
    pub until: Time,
    /// Team that is expected, if it has a name.
    pub team: Option<&'a str>,
}

macro_rules! bookings_sql {
    ($where:literal) => {
        concat!(
            "SELECT v.operator_id, o.vessel_id, v.name AS vessel_name, o.id AS order_id,
                    COALESCE(c.port, o.port) AS port, o.planned_at,
                    o.planned_at + o.job_us AS planned_until, f.team,
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
pub async fn list_bookings(db: &Db, firm: FirmId, from: Time) -> Result<Vec<StoredBooking>> {
    Ok(rows!(
        db,
        StoredBooking,
        bookings_sql!("AND o.planned_at + o.job_us >= $2"),
        firm,
        from
    )?)
}

/// Lists a firm's offers and orders between two times, but for one order.
pub(super) async fn list_around(
    tx: &mut Tx,
    firm: FirmId,
    between: [Time; 2],
    not_of: OrderId,
) -> Result<Vec<StoredBooking>> {
    Ok(rows!(
        in tx,
        StoredBooking,
        bookings_sql!("AND o.planned_at + o.job_us >= $2 AND o.planned_at <= $3 AND o.id <> $4"),
        firm,
        between[0],
        between[1],
        not_of
    )?)
}

impl StoredBooking {
    /// A visit that is about to be booked, by a team.
    pub(super) fn new(visit: &Visit<'_>, team: Option<String>) -> StoredBooking {
        StoredBooking {
            operator_id: visit.operator,
            vessel_id: visit.vessel,
            vessel_name: String::new(),
            order_id: visit.order,
            port: visit.port.to_owned(),
            planned_at: visit.from,
            planned_until: visit.until,
            team,
            is_taken: true,
        }
    }

    /// Day in the port's time.
    pub(super) fn day(&self) -> NaiveDate {
        day(&self.port, self.planned_at)
    }

    /// Returns whether one team does this order and a visit at once, on board one vessel.
    pub(super) fn is_beside(&self, visit: &Visit<'_>) -> bool {
        self.vessel_id == visit.vessel
            && place(&self.port) == place(visit.port)
            && self.planned_at < visit.until
            && visit.from < self.planned_until
    }

    /// Booking of a team.
    pub(super) fn booking(&self) -> Booking {
        Booking {
            day: self.day(),
            from: Instant(self.planned_at.0),
            to: Instant(self.planned_until.0),
            place: place(&self.port),
            team: self.team.clone(),
        }
    }
}

/// Visit of a team to a vessel, for one or more orders.
pub(super) struct TeamVisit<'a> {
    pub(super) orders: Vec<&'a StoredBooking>,
    pub(super) booking: Booking,
}

/// Returns the visits of some orders, in order of time. A team that the firm no longer has is
/// left open.
pub(super) fn visits<'a>(
    firm: &Firm,
    orders: impl IntoIterator<Item = &'a StoredBooking>,
) -> Vec<TeamVisit<'a>> {
    let mut orders: Vec<&StoredBooking> = orders.into_iter().collect();
    orders.sort_by_key(|order| (order.planned_at, order.order_id.0));
    let mut visits: Vec<TeamVisit<'a>> = Vec::new();
    for order in orders {
        let mut booking = order.booking();
        let named = firm.teams.named();
        booking.team = booking
            .team
            .filter(|asked| named.iter().any(|team| team.name == *asked));
        let joined = visits.iter_mut().find(|visit| {
            visit.orders[0].vessel_id == order.vessel_id
                && visit.booking.place == booking.place
                && booking.from < visit.booking.to
        });
        match joined {
            Some(visit) => {
                visit.booking.to = visit.booking.to.max(booking.to);
                visit.booking.team = visit.booking.team.take().or(booking.team);
                visit.orders.push(order);
            }
            None => visits.push(TeamVisit {
                orders: vec![order],
                booking,
            }),
        }
    }
    visits
}

/// Returns the hours of a firm's teams that orders outside a plan take. `planned` tells the orders
/// whose jobs are the plan's.
pub fn teams_taken(
    firm: &Firm,
    orders: &[StoredBooking],
    planned: impl Fn(&StoredBooking) -> bool,
) -> Vec<Taken> {
    let visits = visits(firm, orders);
    let bookings: Vec<Booking> = visits.iter().map(|visit| visit.booking.clone()).collect();
    let teams = assign_teams(firm, &bookings);
    let beside = visits.iter().enumerate();
    let beside = beside.filter(|(_, visit)| !visit.orders.iter().any(|order| planned(order)));
    let taken = beside.map(|(at, visit)| {
        let team = teams.as_ref().map_or(0, |teams| teams[at]);
        let assigned = firm.teams.named().get(team).map(|team| team.name.clone());
        // Where fewer teams are left than were booked, each visit takes one for its day.
        let hours = teams
            .as_ref()
            .and_then(|_| taken_hours(firm, &visit.booking));
        Taken {
            day: visit.booking.day,
            teams: 1,
            team: visit.booking.team.clone().or(assigned),
            hours,
        }
    });
    taken.collect()
}

/// Returns the hours of a visit; `None`, the whole day, where its way from the firm's ports is not
/// known to the plan.
fn taken_hours(firm: &Firm, booking: &Booking) -> Option<TakenHours> {
    let port = PortCode::parse(&booking.place).ok()?;
    firm.travel(port)?;
    Some(TakenHours {
        from: booking.from,
        to: booking.to,
        port: Some(port),
    })
}
