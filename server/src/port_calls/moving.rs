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
    for (row, call) in &taken.amended {
        all.extend(amended(row, call)?);
    }
    for row in &taken.withdrawn {
        let moving = withdrawn(row)?;
        let apart_h = |call: &Content| (call.eta.0.seconds_since(row.eta.0) / 3600.0).abs();
        let near = new
            .iter()
            .filter(|(_, call)| call.port.to_string() == row.port && apart_h(call) <= SAME_CALL_H)
            .min_by(|(_, one), (_, other)| apart_h(one).total_cmp(&apart_h(other)));
        all.push(match near {
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

fn alongside(call: &Content) -> Alongside {
    Alongside::new(call.port, call.eta, call.etd)
}
