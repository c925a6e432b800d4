//! Epochs as ranges of readings, with the ship at their ends.

use super::boundaries::{Boundaries, Boundary};
use crate::report::past::Piece;
use crate::state_space::ship_state::ShipState;
use binnacle_analysis::readings::reading::Reading;
use binnacle_compass::logbook::LogbookKind;
use binnacle_compass::result::Cause;
use binnacle_compass::time::Timestamp;
use std::ops::Range;

/// Epoch before its model.
#[derive(Clone)]
pub(crate) struct Span<'a> {
    pub(crate) from: Option<Timestamp>,
    pub(crate) to: Option<Timestamp>,
    pub(crate) begun_by: Option<LogbookKind>,
    /// Place of the logged work that begins it.
    pub(crate) work: Option<usize>,
    /// Place and cause of the detected event that begins it, or by whose end it begins.
    pub(crate) event: Option<usize>,
    pub(crate) begun_by_change: Option<Cause>,
    pub(crate) is_return: bool,
    /// Earlier epoch with the same magnetism.
    pub(crate) resumes: Option<usize>,
    /// Its settled readings.
    pub(crate) past: &'a [Piece],
    /// Places of its readings that are not settled.
    pub(crate) own: Range<usize>,
    /// Ship at its end; none without a row until then.
    pub(crate) ship: Option<&'a ShipState>,
}

impl Span<'_> {
    /// Returns true if it has no readings.
    pub(crate) fn is_empty(&self) -> bool {
        self.past.is_empty() && self.own.is_empty()
    }
}

/// Detected event that lasts, and the epoch that it ended.
struct Lasting {
    event: usize,
    ended: usize,
}

/// Returns the epochs between boundaries; `current` is the ship from the last row on, and `past`
/// are the settled readings.
pub(crate) fn spans<'a>(
    boundaries: &Boundaries<'a>,
    current: Option<&'a ShipState>,
    readings: &[Reading],
    past: &'a [Piece],
) -> Vec<Span<'a>> {
    let piece = |time: Timestamp| past.partition_point(|piece| piece.from < time);
    let place = |time: Timestamp| readings.partition_point(|r| r.sample().time < time);
    let list = &boundaries.list;
    let mut lasting: Vec<Lasting> = Vec::new();
    let mut spans: Vec<Span<'a>> = Vec::with_capacity(list.len() + 1);
    for nth in 0..=list.len() {
        let from = nth.checked_sub(1).map(|before| &list[before]);
        let next = list.get(nth);
        let begin = from.map_or(0, |boundary| place(boundary.at));
        let end = next.map_or(readings.len(), |boundary| place(boundary.at));
        spans.push(Span {
            from: from.map(|boundary| boundary.at),
            to: next.map(|boundary| boundary.at),
            begun_by: from.and_then(|boundary| boundary.begun_by),
            work: from.and_then(|boundary| boundary.work),
            event: from.and_then(|boundary| boundary.event),
            begun_by_change: from.and_then(|boundary| boundary.cause),
            is_return: from.is_some_and(|boundary| boundary.is_return),
            resumes: from.and_then(|boundary| resumed(boundary, &mut lasting)),
            past: &past[from.map_or(0, |boundary| piece(boundary.at))
                ..next.map_or(past.len(), |boundary| piece(boundary.at))],
            own: begin..end,
            ship: next.map_or(current, |boundary| boundary.ship_before),
        });
        if let Some(event) = next
            .filter(|next| !next.is_return)
            .and_then(|next| next.event)
        {
            lasting.push(Lasting { event, ended: nth });
        }
        if next.is_some_and(|next| next.work.is_some()) {
            lasting.clear();
        }
    }
    spans
}

/// Returns the epoch that the end of an event resumes: none where the ship changed otherwise
/// since.
fn resumed(boundary: &Boundary<'_>, lasting: &mut Vec<Lasting>) -> Option<usize> {
    if !boundary.is_return {
        return None;
    }
    let place = lasting
        .iter()
        .position(|one| Some(one.event) == boundary.event)?;
    let is_last = place + 1 == lasting.len();
    let ended = lasting.remove(place).ended;
    is_last.then_some(ended)
}
