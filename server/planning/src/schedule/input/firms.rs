//! Firms to plan with: their teams and declined jobs.

use super::names::Names;
use super::orders::Order;
use crate::port_calls::StoredCall;
use crate::schedule::plan::{LeftOut, NO_TERMS};
use binnacle_orders::firms::{self, StoredBooking};
use binnacle_platform::app::App;
use binnacle_platform::error::Result;
use binnacle_platform::ids::{FirmId, OperatorId, OrderId};
use binnacle_platform::time::Time;
use binnacle_schedule::input::{Declined, Firm};
use std::collections::BTreeMap;
use uuid::Uuid;

/// Returns the firms to plan with, and those left out.
pub(super) async fn load_firms(
    app: &App,
    operator: OperatorId,
    names: &mut Names,
) -> Result<(Vec<Firm>, Vec<LeftOut>)> {
    let (mut planned_with, mut left_out) = (Vec::new(), Vec::new());
    for engaged in firms::of_operator(&app.db, operator).await? {
        names.firms.insert(engaged.id, engaged.name.clone());
        let Some(firm) = engaged.planned() else {
            left_out.push(LeftOut {
                firm_id: engaged.id,
                firm_name: engaged.name,
                why: NO_TERMS.to_owned(),
            });
            continue;
        };
        match engaged.problems().first() {
            None => planned_with.push(firm),
            Some(why) => left_out.push(LeftOut {
                firm_id: engaged.id,
                firm_name: engaged.name,
                why: why.clone(),
            }),
        }
    }
    Ok((planned_with, left_out))
}

/// Books the hours of teams for orders that are not jobs of the plan with that firm: other
/// operators' orders, and this operator's beside the plan or offered to several firms at once.
pub(super) async fn book_teams(
    app: &App,
    operator: OperatorId,
    as_of: Time,
    planned: &BTreeMap<OrderId, FirmId>,
    firms: &mut [Firm],
) -> Result<()> {
    let from = Time(as_of.0.plus_seconds(-86_400.0));
    for firm in firms {
        let id = FirmId(Uuid::parse_str(&firm.id).map_err(anyhow::Error::from)?);
        let mut booked = firms::list_bookings(&app.db, id, from).await?;
        booked.retain(|one| one.is_taken || one.operator_id == operator);
        let is_planned = |one: &StoredBooking| planned.get(&one.order_id) == Some(&id);
        firm.taken = firms::teams_taken(firm, &booked, is_planned);
    }
    Ok(())
}

/// Returns what a firm has declined: the order's call while it is upcoming. Without a known call it
/// is any job of the compass until the order is cancelled.
pub(super) fn find_declined(order: &Order, upcoming: &[StoredCall]) -> Option<Declined> {
    let call = order.call(upcoming);
    let is_upcoming = call.is_some_and(|call| upcoming.iter().any(|row| row.id == call));
    if !is_upcoming && (call.is_some() || order.is_cancelled()) {
        return None;
    }
    Some(Declined {
        need: order.compass_id.to_string(),
        firm: order.firm_id?.to_string(),
        day: None,
        call: call.map(|call| call.to_string()),
    })
}
