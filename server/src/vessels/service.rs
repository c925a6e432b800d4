//! A vessel goes out of service, or comes back.

use super::store::{Row, set_out_of_service};
use crate::db::Tx;
use crate::error::{Error, Result};
use crate::events::{self, Event};
use crate::ids::OperatorId;
use crate::time::Time;
use crate::{alerts, analysis, schedule, work_orders};

/// Takes a vessel out of service, or back into it; what is so already stays.
///
/// # Errors
/// [`Error::WrongState`] when a work order of hers is under way.
pub(super) async fn set(
    tx: &mut Tx,
    operator: OperatorId,
    vessel: &Row,
    in_service: bool,
    now: Time,
) -> Result<Vec<Event>> {
    if in_service == vessel.out_of_service_at.is_none() {
        return Ok(Vec::new());
    }
    schedule::ask(tx, operator, now).await?;
    let mut told = vec![events::insert(tx, vessel.id, events::Kind::Need, now).await?];
    if in_service {
        set_out_of_service(tx, vessel.id, None).await?;
        // It raises what alerts there were again, if they still are called for.
        analysis::enqueue(tx, vessel.id, now, 0.0).await?;
        return Ok(told);
    }
    if work_orders::is_any_under_way(tx, vessel.id).await? {
        return Err(Error::WrongState(format!(
            "a work order of {} is under way: cancel it first, or have it done",
            vessel.name
        )));
    }
    set_out_of_service(tx, vessel.id, Some(now)).await?;
    told.extend(alerts::end_all(tx, vessel.id, now).await?);
    Ok(told)
}
