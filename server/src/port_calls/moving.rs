//! What work orders must hear of calls that are written otherwise.

use super::call::Content;
use super::file::Taken;
use super::store::Row;
use crate::error::Result;
use crate::ids::CallId;
use crate::work_orders::{Alongside, Moving};

/// A call without a name of its own that comes anew with a file is taken for the one that
/// is in the file no more where their ETAs are so close.
const SAME_CALL_H: f64 = 21.0 * 24.0;

/// A call that is amended; none where it is where and when it was, or counted no more.
pub(super) fn amended(row: &Row, call: &Content) -> Result<Option<Moving>> {
    let (was, is) = (row.alongside()?, alongside(call));
    if was == is && row.withdrawn_at.is_none() {
        return Ok(None);
    }
    Ok(Some(Moving {
        call_id: row.id,
        then_id: row.id,
        was,
        is: Some(is),
    }))
}

/// A call that is withdrawn.
pub(super) fn withdrawn(row: &Row) -> Result<Moving> {
    Ok(Moving {
        call_id: row.id,
        then_id: row.id,
        was: row.alongside()?,
        is: None,
    })
}

/// What a file moves; its new calls have these ids.
pub(super) fn taken(taken: &Taken<'_>, new: &[(CallId, &Content)]) -> Result<Vec<Moving>> {
    let mut all = Vec::new();
    let mut free: Vec<&(CallId, &Content)> = new.iter().collect();
    free.sort_by(|(_, one), (_, other)| one.eta.0.seconds_since(other.eta.0).total_cmp(&0.0));
    for (row, call) in &taken.amended {
        all.extend(amended(row, call)?);
    }
    for (row, _) in &taken.withdrawn {
        let moving = withdrawn(row)?;
        let gone = taken.withdrawn.iter();
        let gone = gone.filter(|(gone, _)| gone.port == row.port);
        let came = new.iter().filter(|(_, call)| is_at(row, call));
        let becomes = becomes(row, &mut free, gone.count() == came.count());
        all.push(match becomes {
            Some((then_id, call)) => Moving {
                then_id: *then_id,
                is: Some(alongside(call)),
                ..moving
            },
            None => moving,
        });
    }
    Ok(all)
}

fn is_at(row: &Row, call: &Content) -> bool {
    call.port.to_string() == row.port
}

/// Which of the new calls, in the order of time, one that is gone has become, each for one
/// only: the next where as many came as went, else the nearest.
fn becomes<'a>(
    row: &Row,
    free: &mut Vec<&'a (CallId, &'a Content)>,
    in_order: bool,
) -> Option<&'a (CallId, &'a Content)> {
    let apart_h = |call: &Content| (call.eta.0.seconds_since(row.eta.0) / 3600.0).abs();
    let mut could_be = (0..free.len()).filter(|at| {
        let call = free[*at].1;
        is_at(row, call) && apart_h(call) <= SAME_CALL_H
    });
    let found = if in_order {
        could_be.next()
    } else {
        could_be.min_by(|one, other| apart_h(free[*one].1).total_cmp(&apart_h(free[*other].1)))
    };
    found.map(|at| free.remove(at))
}

/// Where and when a call has her alongside.
pub(super) fn alongside(call: &Content) -> Alongside {
    Alongside::new(call.port, call.eta, call.etd)
}
