//! A port call that moves, or is withdrawn, while an order is to be done at it.
//!
//! What always holds: whoever is asked for the order or has it, and its operator, are told
//! in the transaction that moves the call; the time that was agreed stands until both
//! agree on another.

use crate::dispatch::call_links;
use crate::work_orders::log_entry::{Author, OrderEvent};
use crate::work_orders::offer_state::{Exchange, Offer};
use crate::work_orders::publish::{self, Before};
use crate::work_orders::store;
use binnacle_platform::db::{Tx, execute, rows};
use binnacle_platform::error::Result;
use binnacle_platform::events::Event;
use binnacle_platform::ids::{CallId, OrderId, VesselId};
use binnacle_platform::time::Time;
use binnacle_schedule::input::JOB_H;
use binnacle_schedule::ports::{self, PortCode};
use binnacle_schedule::time::Instant;
use binnacle_schedule::zone::Zone;
use chrono::{Days, SecondsFormat};
use serde::{Deserialize, Serialize};
use utoipa::ToSchema;
use uuid::Uuid;

/// How an order's time lies in its port call.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Serialize, Deserialize, ToSchema, sqlx::Type)]
#[serde(rename_all = "snake_case")]
#[sqlx(type_name = "text", rename_all = "snake_case")]
#[schema(as = WorkOrderCallFit)]
pub enum CallFit {
    /// She is alongside then, for three hours at least.
    Fits,
    /// She is alongside for three hours on that day, but not from that hour.
    OtherHour,
    /// She is not alongside on that day: agree on another.
    NeedsNewDay,
    /// The call is withdrawn, or is at another port.
    NoCall,
}

/// Where and when a vessel is alongside.
#[derive(Clone, Debug, PartialEq, Serialize, Deserialize, ToSchema)]
#[schema(as = WorkOrderAlongside)]
pub struct Alongside {
    /// UN/LOCODE of the port.
    pub port: String,
    /// When she is expected alongside.
    pub eta: Time,
    /// When she is expected to leave.
    pub etd: Time,
    /// The ETA in the port's time.
    #[schema(example = "2026-12-08T07:00:00+01:00")]
    pub eta_local: String,
    /// The ETD in the port's time.
    #[schema(example = "2026-12-10T19:00:00+01:00")]
    pub etd_local: String,
}

/// What became of a port call.
#[derive(Clone, Debug, PartialEq, Serialize, Deserialize, ToSchema)]
#[schema(as = WorkOrderCallChange)]
pub struct CallChange {
    /// The call.
    pub call_id: CallId,
    /// As it was.
    pub was: Alongside,
    /// As it is; none where it is withdrawn.
    #[schema(required)]
    pub is: Option<Alongside>,
    /// How the agreed time lies in it now.
    pub fit: CallFit,
    /// Who moved it.
    pub by: String,
}

/// The same as an entry of an order's log, told to one firm.
#[derive(Clone, Debug, Serialize, Deserialize)]
pub struct CallMoved {
    /// To whom, and in words.
    #[serde(flatten)]
    pub said: Exchange,
    /// What became of the call.
    pub call: CallChange,
}

/// A call about to be written otherwise.
pub struct CallUpdate {
    /// The call as it is known.
    pub call_id: CallId,
    /// The call that is there afterwards; another one where a file names it anew.
    pub then_id: CallId,
    /// As it was.
    pub was: Alongside,
    /// As it will be; none where it is withdrawn.
    pub is: Option<Alongside>,
}

impl Alongside {
    /// At a port, from and to.
    pub fn new(port: PortCode, eta: Time, etd: Time) -> Alongside {
        let zone = ports::zone(port);
        Alongside {
            port: port.to_string(),
            eta,
            etd,
            eta_local: local(eta, zone),
            etd_local: local(etd, zone),
        }
    }

    /// How a time lies in it, of an order that is for a port.
    pub fn fit(&self, port: &str, planned_at: Time) -> CallFit {
        if self.port != port {
            return CallFit::NoCall;
        }
        let (eta, etd) = (Instant(self.eta.0), Instant(self.etd.0));
        let planned = Instant(planned_at.0);
        if planned >= eta && etd.hours_since(planned) >= JOB_H {
            return CallFit::Fits;
        }
        let zone = zone_of(port);
        let day = planned.date(zone);
        let [begins, ends] = [day, day + Days::new(1)].map(|day| zone.midnight(day));
        let alongside_h = etd.min(ends).hours_since(eta.max(begins));
        if alongside_h >= JOB_H {
            CallFit::OtherHour
        } else {
            CallFit::NeedsNewDay
        }
    }

    pub(crate) fn describe(&self) -> String {
        let zone = zone_of(&self.port);
        let (eta, etd) = (both(self.eta, zone), both(self.etd, zone));
        format!("from {eta} to {etd}")
    }
}

/// A port's legal time.
fn zone_of(port: &str) -> Zone {
    PortCode::parse(port).map_or_else(|_| Zone::utc(), ports::zone)
}

fn local(at: Time, zone: Zone) -> String {
    let there = Instant(at.0).in_zone(zone);
    there.to_rfc3339_opts(SecondsFormat::Secs, false)
}

/// In UTC and in the port's time.
fn both(at: Time, zone: Zone) -> String {
    let there = Instant(at.0).in_zone(zone).format("%Y-%m-%d %H:%M");
    let offset = Instant(at.0).in_zone(zone).format("%:z");
    format!("{} ({there} port's time, UTC{offset})", at.to_the_minute())
}

/// An order that may be done at a call.
#[derive(sqlx::FromRow)]
pub(crate) struct AffectedOrder {
    pub(crate) id: OrderId,
    pub(crate) planned_at: Time,
    call_id: Option<CallId>,
    /// Whether it is at no call that stands.
    pub(crate) is_adrift: bool,
}

/// Tells of calls of one vessel that are about to move or to be withdrawn, whose row is
/// held; the live events, to be published after the commit.
///
/// # Errors
/// When the database cannot be written.
pub async fn announce_call_updates(
    tx: &mut Tx,
    vessel: VesselId,
    moving: &[CallUpdate],
    by: &str,
    now: Time,
) -> Result<Vec<Event>> {
    if moving.is_empty() {
        return Ok(Vec::new());
    }
    let mut told = Vec::new();
    for order in under_way(tx, vessel).await? {
        let at = |one: &&CallUpdate| {
            let is_then = one.was.eta <= order.planned_at && order.planned_at <= one.was.etd;
            order.call_id == Some(one.call_id) || order.is_adrift && is_then
        };
        if let Some(one) = moving.iter().find(at) {
            call_links::link(tx, vessel, order.id, one.then_id).await?;
            told.extend(tell(tx, vessel, order.id, one, by, now).await?);
        }
    }
    Ok(told)
}

/// The orders of a vessel that may be done at a call, none of which changes until the
/// transaction ends.
pub(crate) async fn under_way(tx: &mut Tx, vessel: VesselId) -> Result<Vec<AffectedOrder>> {
    // Who agrees to another time meanwhile waits, or is waited for.
    execute!(
        &mut *tx,
        "UPDATE work_orders SET state = state
         WHERE vessel_id = $1
           AND state IN ('offered', 'proposed', 'accepted', 'on_board', 'measured', 'adjusting')",
        vessel
    )?;
    Ok(rows!(
        in &mut *tx,
        AffectedOrder,
        "SELECT o.id, o.planned_at, l.call_id,
                CASE WHEN c.id IS NULL OR c.withdrawn_at IS NOT NULL THEN TRUE ELSE FALSE END
                    AS is_adrift
         FROM work_orders o
         LEFT JOIN schedule_orders l ON l.vessel_id = o.vessel_id AND l.order_id = o.id
         LEFT JOIN port_calls c ON c.vessel_id = l.vessel_id AND c.id = l.call_id
         WHERE o.vessel_id = $1
           AND o.state IN ('offered', 'proposed', 'accepted', 'on_board', 'measured', 'adjusting')
         ORDER BY o.id",
        vessel
    )?)
}

pub(crate) async fn tell(
    tx: &mut Tx,
    vessel: VesselId,
    order: OrderId,
    moving: &CallUpdate,
    by: &str,
    now: Time,
) -> Result<Vec<Event>> {
    let mut whole = store::lock(tx, vessel, order).await?;
    let standing = whole.standing();
    let before = Before::of(&whole);
    // The order is for the port that its call was at when it was written.
    let port = standing.port.as_ref().unwrap_or(&moving.was.port);
    let planned_at = whole.summary.planned_at;
    let fit = moving
        .is
        .as_ref()
        .map_or(CallFit::NoCall, |is| is.fit(port, planned_at));
    let call = CallChange {
        call_id: moving.then_id,
        was: moving.was.clone(),
        is: moving.is.clone(),
        fit,
        by: by.to_owned(),
    };
    let seen = |offer: &&Offer| offer.state.is_seen();
    for offer in standing.offers.all.iter().filter(seen) {
        let said = Exchange {
            text: Some(call.describe(planned_at)),
            ..Exchange::with(offer.firm())
        };
        let call = call.clone();
        let moved = OrderEvent::CallMoved(Box::new(CallMoved { said, call }));
        store::append(
            tx,
            &mut whole,
            Uuid::now_v7(),
            &Author::server(),
            now,
            moved,
        )
        .await?;
    }
    publish::tell(tx, &whole, &before, now).await
}

impl CallChange {
    /// What became of the call, and what is to be done, in sentences.
    fn describe(&self, planned_at: Time) -> String {
        let became = match &self.is {
            None => format!(
                "The port call at {}, {}, is withdrawn.",
                self.was.port,
                self.was.describe()
            ),
            Some(is) if is.port != self.was.port => format!(
                "The port call at {}, {}, is at {} now, {}.",
                self.was.port,
                self.was.describe(),
                is.port,
                is.describe()
            ),
            Some(is) if *is == self.was => {
                format!(
                    "The port call at {} is there again, {}.",
                    is.port,
                    is.describe()
                )
            }
            Some(is) => format!(
                "The port call at {} has moved: it was {}, and is {}.",
                is.port,
                self.was.describe(),
                is.describe()
            ),
        };
        let agreed = both(planned_at, zone_of(&self.was.port));
        let what = match self.fit {
            CallFit::Fits => format!("The job's time, {agreed}, still lies in it."),
            CallFit::OtherHour => format!(
                "The job's day still lies in it, but not its hour, {agreed}: agree on another."
            ),
            CallFit::NeedsNewDay => {
                format!("The job's time, {agreed}, lies in it no more: agree on a new day.")
            }
            CallFit::NoCall => {
                format!(
                    "The job's time, {agreed}, stands without a call: agree on another or cancel."
                )
            }
        };
        format!("{became} {what}")
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    fn time(text: &str) -> Time {
        Time(Instant::parse(text).unwrap().0)
    }

    fn rotterdam(eta: &str, etd: &str) -> Alongside {
        Alongside::new(PortCode::parse("NLRTM").unwrap(), time(eta), time(etd))
    }

    #[test]
    fn a_time_fits_a_call_for_three_hours_before_she_leaves() {
        let call = rotterdam("2026-12-08T06:00:00Z", "2026-12-08T18:00:00Z");
        for (at, fit) in [
            ("2026-12-08T05:59:00Z", CallFit::OtherHour),
            ("2026-12-08T06:00:00Z", CallFit::Fits),
            ("2026-12-08T15:00:00Z", CallFit::Fits),
            ("2026-12-08T15:01:00Z", CallFit::OtherHour),
            ("2026-12-07T12:00:00Z", CallFit::NeedsNewDay),
            ("2026-12-09T12:00:00Z", CallFit::NeedsNewDay),
        ] {
            assert_eq!(call.fit("NLRTM", time(at)), fit, "{at}");
        }
        let there = time("2026-12-08T08:00:00Z");
        assert_eq!(call.fit("BEANR", there), CallFit::NoCall);
    }

    #[test]
    fn a_day_is_the_ports() {
        // In Yokohama, nine hours ahead, the ninth begins at 15:00 UTC of the eighth.
        let port = PortCode::parse("JPYOK").unwrap();
        let call = Alongside::new(
            port,
            time("2026-12-08T16:00:00Z"),
            time("2026-12-08T23:00:00Z"),
        );
        assert_eq!(call.eta_local, "2026-12-09T01:00:00+09:00");
        let noon = time("2026-12-09T03:00:00Z");
        assert_eq!(call.fit("JPYOK", noon), CallFit::OtherHour);
        let eighth = time("2026-12-08T03:00:00Z");
        assert_eq!(call.fit("JPYOK", eighth), CallFit::NeedsNewDay);
    }

    #[test]
    fn west_of_greenwich_a_ports_time_is_behind() {
        let port = PortCode::parse("USNYC").unwrap();
        let at = time("2026-12-08T03:00:00Z");
        let call = Alongside::new(port, at, time("2026-12-09T00:00:00Z"));
        assert_eq!(call.eta_local, "2026-12-07T22:00:00-05:00");
    }

    #[test]
    fn a_day_on_which_clocks_go_back_is_an_hour_longer() {
        let port = PortCode::parse("ESVGO").unwrap();
        // From 21:00 on, Vigo's time, which is 20:00 UTC in winter.
        let (eta, etd) = (time("2026-10-25T20:00:00Z"), time("2026-10-26T20:00:00Z"));
        let call = Alongside::new(port, eta, etd);
        assert_eq!(call.eta_local, "2026-10-25T21:00:00+01:00");
        let noon = time("2026-10-25T11:00:00Z");
        assert_eq!(call.fit("ESVGO", noon), CallFit::OtherHour);
        let later = Alongside::new(port, time("2026-10-25T20:01:00Z"), etd);
        assert_eq!(later.fit("ESVGO", noon), CallFit::NeedsNewDay);
        // In summer the same hour is 19:00 UTC.
        let july = Alongside::new(port, time("2026-07-15T19:00:00Z"), etd);
        assert_eq!(july.eta_local, "2026-07-15T21:00:00+02:00");
    }
}
