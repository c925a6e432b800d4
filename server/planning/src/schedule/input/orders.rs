//! Work orders as the schedule sees them.
//!
//! Invariants: an order that is offered to a firm or accepted by it is a job of the plan, at the
//! call of the offer. An order in progress, or offered to no firm, is beside the plan.

use crate::port_calls::StoredCall as Call;
use crate::schedule::plan::{LeftOut, NO_TERMS};
use binnacle_orders::firms::named_port;
use binnacle_orders::work_orders::{Alongside, CallFit, Hours, State};
use binnacle_platform::db::{Db, rows};
use binnacle_platform::error::Result;
use binnacle_platform::ids::{CallId, CompassId, FirmId, OperatorId, OrderId, VesselId};
use binnacle_platform::time::Time;
use binnacle_schedule::input::JobState;
use binnacle_schedule::ports::{self, PortCode};
use binnacle_schedule::time::Instant;
use binnacle_schedule::zone::Zone;
use chrono::NaiveDate;

/// An order that is under way.
#[derive(Clone, Debug, sqlx::FromRow)]
pub(crate) struct Order {
    pub(crate) vessel_id: VesselId,
    pub(crate) id: OrderId,
    pub(crate) compass_id: CompassId,
    pub(crate) state: State,
    /// Port as the operator wrote it, or as the schedule names it.
    port: String,
    planned_at: Time,
    planned_until: Time,
    /// The firm's team, if it has a name.
    pub(crate) team: Option<String>,
    /// Firm to which it is offered or that has accepted it.
    pub(crate) firm_id: Option<FirmId>,
    /// Port call of the order, where known.
    pub(crate) call_id: Option<CallId>,
}

/// Accepted order beside the plan: the plan does not know whether it can be done.
#[derive(Clone, Debug)]
pub(crate) struct OrderBesidePlan {
    pub(crate) vessel_id: VesselId,
    pub(crate) compass_id: CompassId,
    pub(crate) order_id: OrderId,
    pub(crate) firm_id: FirmId,
    pub(crate) day: NaiveDate,
    /// Reason why it no longer fits, if one is known.
    pub(crate) problem: Option<String>,
}

/// Returns the reason why a firm's terms rule out any job, if they do.
fn problem_of_terms(firm: FirmId, left_out: &[LeftOut]) -> Option<String> {
    let mut with_terms = left_out.iter().filter(|one| one.why != NO_TERMS);
    let one = with_terms.find(|one| one.firm_id == firm)?;
    Some(format!("the firm's terms now allow no job ({})", one.why))
}

/// Returns a fleet's orders under way, each once.
pub(crate) async fn list_under_way(db: &Db, operator: OperatorId) -> Result<Vec<Order>> {
    let mut found = rows!(
        db,
        Order,
        "SELECT o.vessel_id, o.id, o.compass_id, o.state, o.port, o.planned_at,
                o.planned_at + o.job_us AS planned_until, f.team, f.firm_id, l.call_id
         FROM work_orders o
         JOIN vessels v ON v.id = o.vessel_id
         LEFT JOIN work_order_offers f ON f.vessel_id = o.vessel_id AND f.order_id = o.id
               AND f.state IN ('open', 'proposed', 'accepted')
         LEFT JOIN schedule_orders l ON l.vessel_id = o.vessel_id AND l.order_id = o.id
         WHERE v.operator_id = $1
           AND o.state NOT IN ('adjusted', 'verified', 'failed', 'closed',
                             'closed_unverified', 'cancelled')
         ORDER BY o.vessel_id, o.id, f.firm_id",
        operator
    )?;
    // An order may be offered to several firms at once.
    found.dedup_by_key(|order| order.id);
    Ok(found)
}

/// Returns orders that a firm declined or let lapse, one row for each firm, unless a later order of
/// the compass was offered to it. Orders cancelled since count too: their job is offered repeated.
pub(crate) async fn list_declined(db: &Db, operator: OperatorId) -> Result<Vec<Order>> {
    Ok(rows!(
        db,
        Order,
        "SELECT o.vessel_id, o.id, o.compass_id, o.state, o.port, o.planned_at,
                o.planned_at + o.job_us AS planned_until, f.team, f.firm_id, l.call_id
         FROM work_order_offers f
         JOIN work_orders o ON o.vessel_id = f.vessel_id AND o.id = f.order_id
         JOIN vessels v ON v.id = o.vessel_id
         LEFT JOIN schedule_orders l ON l.vessel_id = o.vessel_id AND l.order_id = o.id
         WHERE v.operator_id = $1 AND f.state IN ('declined', 'lapsed')
           AND o.state IN ('offered', 'proposed', 'declined', 'accepted', 'cancelled')
           AND NOT EXISTS (
               SELECT 1 FROM work_order_offers repeated
               JOIN work_orders later
                 ON later.vessel_id = repeated.vessel_id AND later.id = repeated.order_id
               WHERE repeated.firm_id = f.firm_id AND repeated.state <> 'waiting'
                 AND later.vessel_id = o.vessel_id AND later.compass_id = o.compass_id
                 AND later.id > o.id)
         ORDER BY o.vessel_id, o.id, f.firm_id",
        operator
    )?)
}

impl Order {
    /// Returns the state of the job; `None` when the order is beside the plan.
    pub(crate) fn job_state(&self) -> Option<JobState> {
        match self.state {
            State::Offered | State::Proposed => Some(JobState::Offered),
            State::Accepted => Some(JobState::Confirmed),
            _ => None,
        }
    }

    /// Returns the call of the order: the recorded one, or the one at its port that covers its time.
    /// An unknown port matches every call.
    pub(crate) fn call(&self, calls: &[Call]) -> Option<CallId> {
        let of_vessel = calls.iter().filter(|call| call.vessel_id == self.vessel_id);
        let meant = named_port(&self.port).map(|port| port.code.to_string());
        let there = of_vessel.filter(|call| meant.as_ref().is_none_or(|code| *code == call.port));
        let mut then =
            there.filter(|call| call.eta <= self.planned_at && self.planned_at <= call.etd);
        self.call_id.or_else(|| then.next().map(|call| call.id))
    }

    /// Returns the order as one beside the plan; `None` when no firm has it or work has begun.
    pub(crate) fn beside_plan(
        &self,
        upcoming: &[Call],
        left_out: &[LeftOut],
    ) -> Result<Option<OrderBesidePlan>> {
        let (Some(JobState::Confirmed), Some(firm_id)) = (self.job_state(), self.firm_id) else {
            return Ok(None);
        };
        let call = self.call(upcoming);
        let row = upcoming.iter().find(|row| Some(row.id) == call);
        let is_known = upcoming.iter().any(|row| row.vessel_id == self.vessel_id);
        let problem = match row {
            Some(row) => self
                .problem_of_time(&row.alongside()?)
                .or_else(|| problem_of_terms(firm_id, left_out)),
            None if call.is_some() => Some("its port call is cancelled or over".to_owned()),
            None => is_known.then(|| "no port call is known at its port and time".to_owned()),
        };
        Ok(Some(OrderBesidePlan {
            vessel_id: self.vessel_id,
            compass_id: self.compass_id,
            order_id: self.id,
            firm_id,
            day: self.day(row.map(|row| row.port.as_str())),
            problem,
        }))
    }

    /// Returns the reason why the planned time lies outside the call, if it does.
    fn problem_of_time(&self, there: &Alongside) -> Option<String> {
        let meant = named_port(&self.port).map(|port| port.code.to_string());
        let port = meant.unwrap_or_else(|| there.port.clone());
        match there.fit(&port, self.hours()) {
            CallFit::Fits => None,
            CallFit::NoCall => Some(format!("its port call is now at {}", there.port)),
            CallFit::OtherHour | CallFit::NeedsNewDay => Some(format!(
                "the vessel is now alongside from {} to {}",
                there.eta.to_the_minute(),
                there.etd.to_the_minute()
            )),
        }
    }

    /// Returns whether the order was cancelled.
    pub(crate) fn is_cancelled(&self) -> bool {
        self.state == State::Cancelled
    }

    /// Returns the hours of the job, to the whole second as a plan has them.
    pub(crate) fn hours(&self) -> Hours {
        let [from, until] = [self.planned_at, self.planned_until].map(whole_second);
        Hours { from, until }
    }

    /// Returns the planned day, in a port's time.
    pub(crate) fn day(&self, port: Option<&str>) -> NaiveDate {
        let port = port.and_then(|port| PortCode::parse(port).ok());
        let zone = port.map_or_else(Zone::utc, ports::zone);
        Instant(self.planned_at.0).date(zone)
    }
}

/// Returns the begun second.
fn whole_second(at: Time) -> Time {
    let micros = at.0.micros().rem_euclid(1_000_000);
    #[allow(clippy::cast_precision_loss, reason = "less than a million")]
    let into_s = micros as f64 / 1e6;
    Time(at.0.plus_seconds(-into_s))
}
