//! The firms to plan with: their teams, and what they have said no to.

use super::names::Names;
use super::orders::Order;
use crate::port_calls::Row;
use crate::schedule::plan::{LeftOut, NO_TERMS};
use binnacle_orders::firms;
use binnacle_platform::app::App;
use binnacle_platform::error::Result;
use binnacle_platform::ids::{FirmId, OperatorId, OrderId};
use binnacle_platform::time::Time;
use binnacle_schedule::input::{Declined, Firm, Taken};
use std::collections::BTreeMap;
use uuid::Uuid;

/// The firms to plan with, and those that cannot be planned with.
pub(super) async fn firms_of(
    app: &App,
    operator: OperatorId,
    names: &mut Names,
) -> Result<(Vec<Firm>, Vec<LeftOut>)> {
    let (mut planned_with, mut left_out) = (Vec::new(), Vec::new());
    for (firm_id, firm_name, terms) in firms::of_operator(&app.db, operator).await? {
        names.firms.insert(firm_id, firm_name.clone());
        let problems = terms.as_ref().map(firms::Terms::problems);
        match (terms, problems.as_deref()) {
            (Some(terms), Some([])) => {
                planned_with.push(terms.firm(&firm_id.to_string(), Some(&firm_name)));
            }
            (_, problems) => left_out.push(LeftOut {
                firm_id,
                firm_name,
                why: problems
                    .and_then(<[String]>::first)
                    .map_or(NO_TERMS, String::as_str)
                    .to_owned(),
            }),
        }
    }
    Ok((planned_with, left_out))
}

/// Takes out the teams that orders have which are no jobs of the plan with that firm: other
/// operators', and this one's beside it or with several firms that are asked at once.
pub(super) async fn book(
    app: &App,
    operator: OperatorId,
    as_of: Time,
    planned: &BTreeMap<OrderId, FirmId>,
    firms: &mut [Firm],
) -> Result<()> {
    let from = Time(as_of.0.plus_seconds(-86_400.0));
    for firm in firms {
        let id = FirmId(Uuid::parse_str(&firm.id).map_err(anyhow::Error::from)?);
        let all = firms::bookings(&app.db, id, from).await?;
        let elsewhere = all.iter().filter(|one| {
            let counts = one.is_taken || one.operator_id == operator;
            counts && planned.get(&one.order_id) != Some(&id)
        });
        let days = firms::teams_taken(elsewhere, firm.jobs_a_team_day).into_iter();
        firm.taken = days.map(|(day, teams)| Taken { day, teams }).collect();
    }
    Ok(())
}

/// A firm's no to an order: to its call, as long as that is ahead. Where none is known it is to
/// whatever the order is for while it stands.
pub(super) fn declined(no: &Order, ahead: &[Row]) -> Option<Declined> {
    let call = no.call(ahead);
    let is_ahead = call.is_some_and(|call| ahead.iter().any(|row| row.id == call));
    if !is_ahead && (call.is_some() || no.is_cancelled()) {
        return None;
    }
    Some(Declined {
        need: no.compass_id.to_string(),
        firm: no.firm_id?.to_string(),
        day: None,
        call: call.map(|call| call.to_string()),
    })
}
