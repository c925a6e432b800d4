//! Work orders as the schedule sees them.
//!
//! What always holds: an order that a firm is asked for or has accepted is a job of the
//! plan, at the call that it was offered for; one that is being done, or is offered to
//! nobody, is beside the plan.

use crate::port_calls::Row as Call;
use crate::schedule::plan::{LeftOut, NO_TERMS};
use binnacle_orders::firms::named_port;
use binnacle_orders::work_orders::{Alongside, CallFit, State};
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
pub(in crate::schedule) struct Order {
    pub(in crate::schedule) vessel_id: VesselId,
    pub(in crate::schedule) id: OrderId,
    pub(in crate::schedule) compass_id: CompassId,
    pub(in crate::schedule) state: State,
    /// In the operator's words, or as the schedule has it.
    port: String,
    pub(in crate::schedule) planned_at: Time,
    /// Firm that has been asked or has accepted.
    pub(in crate::schedule) firm_id: Option<FirmId>,
    /// At which call it is to be done, where that is known.
    pub(in crate::schedule) call_id: Option<CallId>,
}

/// An order that a firm has accepted, of which the plan cannot tell whether it is to be done.
#[derive(Clone, Debug)]
pub(in crate::schedule) struct Aside {
    pub(in crate::schedule) vessel_id: VesselId,
    pub(in crate::schedule) compass_id: CompassId,
    pub(in crate::schedule) order_id: OrderId,
    pub(in crate::schedule) firm_id: FirmId,
    pub(in crate::schedule) day: NaiveDate,
    /// Reason why it no longer fits, where that is known.
    pub(in crate::schedule) unfit: Option<String>,
}

/// Returns the reason why a firm's terms rule out any work, if they do.
fn useless(firm: FirmId, left_out: &[LeftOut]) -> Option<String> {
    let mut told = left_out.iter().filter(|one| one.why != NO_TERMS);
    let one = told.find(|one| one.firm_id == firm)?;
    Some(format!(
        "by its terms the firm is of no use now ({})",
        one.why
    ))
}

/// A fleet's orders that are under way; each once.
pub(in crate::schedule) async fn under_way(db: &Db, operator: OperatorId) -> Result<Vec<Order>> {
    let mut found = rows!(
        db,
        Order,
        "SELECT o.vessel_id, o.id, o.compass_id, o.state, o.port, o.planned_at, f.firm_id, l.call_id
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
    // Several firms may be asked at once.
    found.dedup_by_key(|order| order.id);
    Ok(found)
}

/// Orders, each with a firm that has said no to it, or nothing in time; also of those that
/// were cancelled since, for what they were is offered again. Who was asked anew says anew.
pub(in crate::schedule) async fn declined(db: &Db, operator: OperatorId) -> Result<Vec<Order>> {
    Ok(rows!(
        db,
        Order,
        "SELECT o.vessel_id, o.id, o.compass_id, o.state, o.port, o.planned_at, f.firm_id, l.call_id
         FROM work_order_offers f
         JOIN work_orders o ON o.vessel_id = f.vessel_id AND o.id = f.order_id
         JOIN vessels v ON v.id = o.vessel_id
         LEFT JOIN schedule_orders l ON l.vessel_id = o.vessel_id AND l.order_id = o.id
         WHERE v.operator_id = $1 AND f.state IN ('declined', 'lapsed')
           AND o.state IN ('offered', 'proposed', 'declined', 'accepted', 'cancelled')
           AND NOT EXISTS (
               SELECT 1 FROM work_order_offers again
               JOIN work_orders later
                 ON later.vessel_id = again.vessel_id AND later.id = again.order_id
               WHERE again.firm_id = f.firm_id AND again.state <> 'waiting'
                 AND later.vessel_id = o.vessel_id AND later.compass_id = o.compass_id
                 AND later.id > o.id)
         ORDER BY o.vessel_id, o.id, f.firm_id",
        operator
    )?)
}

impl Order {
    /// Returns its state as a job of the plan; `None` where it is beside the plan.
    pub(in crate::schedule) fn job_state(&self) -> Option<JobState> {
        match self.state {
            State::Offered | State::Proposed => Some(JobState::Offered),
            State::Accepted => Some(JobState::Confirmed),
            _ => None,
        }
    }

    /// The call that it is to be done at: as was noted, or the one at its port that its time
    /// lies in; at any port where its words mean none.
    pub(in crate::schedule) fn call(&self, calls: &[Call]) -> Option<CallId> {
        let hers = calls.iter().filter(|call| call.vessel_id == self.vessel_id);
        let meant = named_port(&self.port).map(|port| port.code.to_string());
        let there = hers.filter(|call| meant.as_ref().is_none_or(|code| *code == call.port));
        let mut then =
            there.filter(|call| call.eta <= self.planned_at && self.planned_at <= call.etd);
        self.call_id.or_else(|| then.next().map(|call| call.id))
    }

    /// As an order beside the plan; none where no firm has it, or its work has begun.
    pub(in crate::schedule) fn aside(
        &self,
        ahead: &[Call],
        left_out: &[LeftOut],
    ) -> Result<Option<Aside>> {
        let (Some(JobState::Confirmed), Some(firm_id)) = (self.job_state(), self.firm_id) else {
            return Ok(None);
        };
        let call = self.call(ahead);
        let row = ahead.iter().find(|row| Some(row.id) == call);
        let is_known = ahead.iter().any(|row| row.vessel_id == self.vessel_id);
        let unfit = match row {
            Some(row) => self
                .unfit(&row.alongside()?)
                .or_else(|| useless(firm_id, left_out)),
            None if call.is_some() => Some("its port call is cancelled or over".to_owned()),
            None => is_known.then(|| "no port call is known at its port and time".to_owned()),
        };
        Ok(Some(Aside {
            vessel_id: self.vessel_id,
            compass_id: self.compass_id,
            order_id: self.id,
            firm_id,
            day: self.day(row.map(|row| row.port.as_str())),
            unfit,
        }))
    }

    /// Returns the reason why its time lies outside its call, if it does.
    fn unfit(&self, there: &Alongside) -> Option<String> {
        let meant = named_port(&self.port).map(|port| port.code.to_string());
        let port = meant.unwrap_or_else(|| there.port.clone());
        match there.fit(&port, self.planned_at) {
            CallFit::Fits => None,
            CallFit::NoCall => Some(format!("its port call is at {} now", there.port)),
            CallFit::OtherHour | CallFit::NeedsNewDay => Some(format!(
                "the ship is now alongside from {} to {}",
                there.eta.to_the_minute(),
                there.etd.to_the_minute()
            )),
        }
    }

    /// Returns whether the order was cancelled.
    pub(in crate::schedule) fn is_cancelled(&self) -> bool {
        self.state == State::Cancelled
    }

    /// The day that it is to be done on, in a port's time.
    pub(in crate::schedule) fn day(&self, port: Option<&str>) -> NaiveDate {
        let port = port.and_then(|port| PortCode::parse(port).ok());
        let zone = port.map_or_else(Zone::utc, ports::zone);
        Instant(self.planned_at.0).date(zone)
    }
}
