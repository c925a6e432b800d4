//! Moves of port calls, as work orders must learn of them.

use super::call::Content;
use super::file::Taken;
use super::store::Row;
use binnacle_orders::dispatch::CallUpdate;
use binnacle_orders::work_orders::Alongside;
use binnacle_platform::error::Result;
use binnacle_platform::ids::CallId;
use std::collections::BTreeMap;

/// A call without a name of its own that comes anew with a file is taken for the one that
/// is in the file no more where their ETAs are so close.
const SAME_CALL_H: f64 = 21.0 * 24.0;

/// A call that is amended; none where it is where and when it was, or counted no more.
pub(super) fn amended(row: &Row, call: &Content) -> Result<Option<CallUpdate>> {
    let (was, is) = (row.alongside()?, alongside(call));
    if was == is && row.withdrawn_at.is_none() {
        return Ok(None);
    }
    Ok(Some(CallUpdate {
        call_id: row.id,
        then_id: row.id,
        was,
        is: Some(is),
    }))
}

/// A call that is withdrawn.
pub(super) fn withdrawn(row: &Row) -> Result<CallUpdate> {
    Ok(CallUpdate {
        call_id: row.id,
        then_id: row.id,
        was: row.alongside()?,
        is: None,
    })
}

/// Returns the moves that a file brings about; its new calls have these ids.
pub(super) fn taken(taken: &Taken<'_>, new: &[(CallId, &Content)]) -> Result<Vec<CallUpdate>> {
    let mut all = Vec::new();
    for (row, call) in &taken.amended {
        all.extend(amended(row, call)?);
    }
    let mut at_port: BTreeMap<String, AtPort<'_>> = BTreeMap::new();
    let mut in_order: Vec<&(CallId, &Content)> = new.iter().collect();
    in_order.sort_by_key(|(_, call)| call.eta);
    for one in in_order {
        let port = at_port.entry(one.1.port.to_string()).or_default();
        port.came.push((one, false));
    }
    for (row, _) in &taken.withdrawn {
        if let Some(port) = at_port.get_mut(&row.port) {
            port.gone += 1;
        }
    }
    for (row, _) in &taken.withdrawn {
        let moving = withdrawn(row)?;
        let port = at_port.get_mut(&row.port);
        all.push(match port.and_then(|port| port.becomes(row)) {
            Some((then_id, call)) => CallUpdate {
                then_id: *then_id,
                is: Some(alongside(call)),
                ..moving
            },
            None => moving,
        });
    }
    Ok(all)
}

/// Effect of a file on the calls at one port.
#[derive(Default)]
struct AtPort<'a> {
    /// Number of calls that are gone.
    gone: usize,
    /// Its new calls, in the order of time, and whether each is what one that is gone has become.
    came: Vec<(&'a (CallId, &'a Content), bool)>,
}

impl<'a> AtPort<'a> {
    /// Returns the new call that replaces one that is gone, each used once: the next one where as
    /// many came as went, else the nearest.
    fn becomes(&mut self, row: &Row) -> Option<&'a (CallId, &'a Content)> {
        let after_h = |one: &(CallId, &Content)| one.1.eta.0.seconds_since(row.eta.0) / 3600.0;
        let came = &self.came;
        let first = came.partition_point(|(one, _)| after_h(one) < -SAME_CALL_H);
        let end = came.partition_point(|(one, _)| after_h(one) <= SAME_CALL_H);
        let mut could_be = (first..end).filter(|at| !came[*at].1);
        let found = if self.gone == came.len() {
            could_be.next()
        } else {
            let apart_h = |at: &usize| after_h(came[*at].0).abs();
            could_be.min_by(|one, other| apart_h(one).total_cmp(&apart_h(other)))
        };
        let (one, is_taken) = &mut self.came[found?];
        *is_taken = true;
        Some(one)
    }
}

/// Returns the port and times of a call.
pub(super) fn alongside(call: &Content) -> Alongside {
    Alongside::new(call.port, call.eta, call.etd)
}
