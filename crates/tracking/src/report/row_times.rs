//! Times of the rows that were read, and the dates of events between them.

use super::kept::micros;
use binnacle_analysis::readings::logbook_rules::reported_cause;
use binnacle_compass::logbook::LogbookEntry;
use binnacle_compass::ship::EarthField;
use binnacle_compass::time::Timestamp;
use serde::{Deserialize, Serialize};

/// Time of a row.
#[derive(Clone, Copy, Debug, PartialEq, Serialize, Deserialize)]
pub(super) struct RowTime {
    #[serde(with = "micros")]
    pub(super) time: Timestamp,
    /// True if the vessel was in port since the row before.
    pub(super) after_port: bool,
    pub(super) earth: EarthField,
}

/// Times of the rows that were read, in order, with the logbook.
pub(super) struct RowTimes<'a> {
    rows: &'a [RowTime],
    logbook: &'a [LogbookEntry],
}

impl<'a> RowTimes<'a> {
    pub(super) fn new(rows: &'a [RowTime], logbook: &'a [LogbookEntry]) -> RowTimes<'a> {
        RowTimes { rows, logbook }
    }

    fn row_after(&self, time: Timestamp) -> Option<&RowTime> {
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

    /// Returns the field at the last row until a time.
    pub(super) fn earth(&self, until: Timestamp) -> Option<EarthField> {
        let after = self.rows.partition_point(|row| row.time <= until);
        self.rows[..after].last().map(|row| row.earth)
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

/// Returns the rows before a time that stand next to one of some dates.
pub(super) fn next_to(rows: &[RowTime], dates: &[Timestamp], before: Timestamp) -> Vec<RowTime> {
    let mut places: Vec<usize> = Vec::new();
    for date in dates {
        let at = rows.partition_point(|row| row.time < *date);
        let after = rows.partition_point(|row| row.time <= *date);
        places.extend(at.checked_sub(1));
        places.extend([at, after]);
    }
    places.sort_unstable();
    places.dedup();
    let rows = places.into_iter().filter_map(|place| rows.get(place));
    rows.filter(|row| row.time < before).copied().collect()
}
