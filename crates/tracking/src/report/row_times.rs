//! Times of the rows that were read, and the dates of events between them.

use super::voyage::TrackedRow;
use binnacle_analysis::readings::logbook_rules::reported_cause;
use binnacle_compass::logbook::LogbookEntry;
use binnacle_compass::time::Timestamp;

/// Times of the rows that were read, in order, with the logbook.
pub(super) struct RowTimes<'a> {
    rows: &'a [TrackedRow],
    logbook: &'a [LogbookEntry],
}

impl<'a> RowTimes<'a> {
    pub(super) fn new(rows: &'a [TrackedRow], logbook: &'a [LogbookEntry]) -> RowTimes<'a> {
        RowTimes { rows, logbook }
    }

    fn row_after(&self, time: Timestamp) -> Option<&TrackedRow> {
        let place = self.rows.partition_point(|row| row.time <= time);
        self.rows.get(place)
    }

    /// Returns the time of the first row after a time.
    pub(super) fn next(&self, time: Timestamp) -> Option<Timestamp> {
        self.row_after(time).map(|row| row.time)
    }

    /// Returns the time of the last row.
    pub(super) fn last(&self) -> Option<Timestamp> {
        self.rows.last().map(|row| row.time)
    }

    /// Returns true if the vessel was in port between a row and the next.
    pub(super) fn is_port_call_after(&self, row: Timestamp) -> bool {
        self.row_after(row).is_some_and(|next| next.after_port)
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
