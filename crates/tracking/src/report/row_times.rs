//! Times of the rows that were read, and the dates of events between them.

use crate::state_space::row::PORT_GAP_S;
use binnacle_analysis::analyse::logbook_rules::reported_cause;
use binnacle_compass::logbook::LogbookEntry;
use binnacle_compass::time::Timestamp;

/// Times of the rows that were read, in order, with the logbook.
pub(super) struct RowTimes<'a> {
    times: Vec<Timestamp>,
    logbook: &'a [LogbookEntry],
}

impl<'a> RowTimes<'a> {
    pub(super) fn new(times: Vec<Timestamp>, logbook: &'a [LogbookEntry]) -> RowTimes<'a> {
        RowTimes { times, logbook }
    }

    /// Returns the time of the first row after a time.
    pub(super) fn next(&self, time: Timestamp) -> Option<Timestamp> {
        let place = self.times.partition_point(|row| *row <= time);
        self.times.get(place).copied()
    }

    /// Returns the time of the last row.
    pub(super) fn last(&self) -> Option<Timestamp> {
        self.times.last().copied()
    }

    /// Returns true if the vessel was in port between a row and the next.
    pub(super) fn is_port_call_after(&self, row: Timestamp) -> bool {
        self.next(row)
            .is_some_and(|next| next.seconds_since(row) > PORT_GAP_S)
    }

    /// Returns the date of an event between a row and the next: a reported time, or half way.
    pub(super) fn date(&self, row: Timestamp) -> Timestamp {
        let Some(next) = self.next(row) else {
            return row;
        };
        let reports = self.logbook.iter();
        let reports = reports.filter(|entry| reported_cause(entry.kind).is_some());
        let between = reports
            .map(|entry| entry.from)
            .filter(|time| row < *time && *time < next);
        between
            .min()
            .unwrap_or_else(|| row.plus_seconds(next.seconds_since(row) / 2.0))
    }
}
