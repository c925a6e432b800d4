//! Moves of port calls, for the work orders planned at them.

use super::call::Content;
use super::store::StoredCall;
use super::uploaded_file::{FileChanges, WithdrawnCall};
use binnacle_orders::dispatch::{CallUpdate, NewCall};
use binnacle_orders::work_orders::Alongside;
use binnacle_platform::error::Result;
use binnacle_platform::ids::CallId;
use std::collections::BTreeMap;

/// Maximum difference of ETAs, hours, at which a new call of a file replaces a withdrawn one.
const MAX_SHIFT_H: f64 = 21.0 * 24.0;

/// Returns the move of an amended call; `None` when port and times stay.
pub(super) fn amended(row: &StoredCall, call: &Content) -> Result<Option<CallUpdate>> {
    let (before, after) = (row.alongside()?, alongside(call));
    if before == after && row.withdrawn_at.is_none() {
        return Ok(None);
    }
    Ok(Some(CallUpdate {
        call_id: row.id,
        then_id: row.id,
        was: before,
        is: Some(after),
    }))
}

/// Returns the move of a withdrawn call.
pub(super) fn withdrawn(row: &StoredCall) -> Result<CallUpdate> {
    Ok(CallUpdate {
        call_id: row.id,
        then_id: row.id,
        was: row.alongside()?,
        is: None,
    })
}

/// Returns the moves of a file's changes; `new` are its new calls with their ids.
pub(super) fn of_file(
    changes: &FileChanges<'_>,
    new: &[(CallId, &Content)],
) -> Result<Vec<CallUpdate>> {
    let mut all = Vec::new();
    for call in &changes.amended {
        all.extend(amended(call.stored, &call.content)?);
    }
    let mut at_port: BTreeMap<String, AtPort<'_>> = BTreeMap::new();
    let mut in_order: Vec<&(CallId, &Content)> = new.iter().collect();
    in_order.sort_by_key(|(_, call)| call.eta);
    for one in in_order {
        let port = at_port.entry(one.1.port.to_string()).or_default();
        port.new.push((one, false));
    }
    for call in &changes.withdrawn {
        if let Some(port) = at_port.get_mut(&call.stored.port) {
            port.withdrawn += 1;
        }
    }
    for WithdrawnCall { stored: row, .. } in &changes.withdrawn {
        let moving = withdrawn(row)?;
        let port = at_port.get_mut(&row.port);
        all.push(match port.and_then(|port| port.successor(row)) {
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

/// Changes of a file to the calls at one port.
#[derive(Default)]
struct AtPort<'a> {
    /// Number of withdrawn calls.
    withdrawn: usize,
    /// New calls in order of time, and whether each replaces a withdrawn one already.
    new: Vec<(&'a (CallId, &'a Content), bool)>,
}

impl<'a> AtPort<'a> {
    /// Returns the new call that replaces a withdrawn one, each used once: the next one when there
    /// are as many new as withdrawn calls, else the nearest.
    fn successor(&mut self, row: &StoredCall) -> Option<&'a (CallId, &'a Content)> {
        let after_h = |one: &(CallId, &Content)| one.1.eta.0.seconds_since(row.eta.0) / 3600.0;
        let new = &self.new;
        let first = new.partition_point(|(one, _)| after_h(one) < -MAX_SHIFT_H);
        let end = new.partition_point(|(one, _)| after_h(one) <= MAX_SHIFT_H);
        let mut candidates = (first..end).filter(|at| !new[*at].1);
        let found = if self.withdrawn == new.len() {
            candidates.next()
        } else {
            let apart_h = |at: &usize| after_h(new[*at].0).abs();
            candidates.min_by(|one, other| apart_h(one).total_cmp(&apart_h(other)))
        };
        let (one, is_used) = &mut self.new[found?];
        *is_used = true;
        Some(one)
    }
}

/// Returns a call with an id as orders without one may get it.
pub(super) fn new_call(id: CallId, call: &Content) -> NewCall {
    NewCall {
        id,
        alongside: alongside(call),
    }
}

/// Returns the port and times of a call.
pub(super) fn alongside(call: &Content) -> Alongside {
    Alongside::new(call.port, call.eta, call.etd)
}
