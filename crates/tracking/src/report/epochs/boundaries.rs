//! Boundaries between epochs: work in the logbook, and changes of the ship by the samples.

use crate::constants::DAY_S;
use crate::report::causes::likeliest_cause;
use crate::report::kept::LoggedWork;
use crate::report::row_times::RowTimes;
use crate::state_space::ship_state::ShipState;
use crate::weighing::records::{Class, Detected};
use binnacle_compass::logbook::{LogbookEntry, LogbookKind};
use binnacle_compass::result::Cause;
use binnacle_compass::time::Timestamp;

/// Boundary between two epochs.
#[derive(Clone, Copy)]
pub(crate) struct Boundary<'a> {
    pub(super) at: Timestamp,
    pub(super) ship_before: Option<&'a ShipState>,
    /// Kind and place of the logged work that begins the epoch.
    pub(super) begun_by: Option<LogbookKind>,
    pub(super) work: Option<usize>,
    /// Place and cause of the detected event that begins or ends.
    pub(super) event: Option<usize>,
    pub(super) cause: Option<Cause>,
    /// True if the event ends here.
    pub(super) is_return: bool,
}

/// Boundaries in order of time.
pub(crate) struct Boundaries<'a> {
    pub(super) list: Vec<Boundary<'a>>,
    /// Places of the detected events that are work in the logbook.
    pub(crate) logged: Vec<usize>,
}

/// Returns true if a detected event begins an epoch. A drift changes the ship within one.
pub(crate) fn begins_an_epoch(detected: &Detected, cause: Cause) -> bool {
    detected.class == Class::Ship && detected.withdrawn.is_none() && cause != Cause::Drift
}

impl<'a> Boundaries<'a> {
    /// Collects the boundaries. Work in the logbook that the samples date otherwise is dated by
    /// them.
    pub(crate) fn collect(
        works: &'a [LoggedWork],
        detected: &'a [Detected],
        times: &RowTimes<'_>,
        logbook: &[LogbookEntry],
    ) -> Boundaries<'a> {
        let mut boundaries = Boundaries {
            list: (works.iter().enumerate())
                .map(|(place, work)| of_work(place, work))
                .collect(),
            logged: Vec::new(),
        };
        for (event, detected) in detected.iter().enumerate() {
            let cause = likeliest_cause(detected, logbook);
            if !begins_an_epoch(detected, cause) {
                continue;
            }
            let at = times.date(detected.event.from);
            if cause == Cause::AdjustmentOrRepair {
                let latest = times.next(detected.event.from).unwrap_or(at);
                if boundaries.redate_work(at, detected, latest) {
                    boundaries.logged.push(event);
                    continue;
                }
            }
            let begin = Boundary {
                at,
                ship_before: Some(&detected.event.ship_before),
                begun_by: None,
                work: None,
                event: Some(event),
                cause: Some(cause),
                is_return: false,
            };
            boundaries.list.push(begin);
            let end = detected
                .event
                .until
                .zip(detected.event.ship_at_end.as_deref());
            boundaries.list.extend(end.map(|(until, ship)| Boundary {
                at: times.date(until),
                ship_before: Some(ship),
                is_return: true,
                ..begin
            }));
        }
        boundaries.list.sort_by_key(|boundary| boundary.at);
        boundaries.merge(times);
        boundaries
    }

    /// Returns the dates of boundaries and of all that was detected: those of which a report may
    /// ask for the rows next to them.
    pub(crate) fn dates(&self, works: &[LoggedWork], detected: &[Detected]) -> Vec<Timestamp> {
        let boundaries = self.list.iter().map(|boundary| boundary.at);
        let works = works.iter().map(|work| work.at);
        let mut dates: Vec<Timestamp> = boundaries.chain(works).collect();
        for Detected {
            event,
            posterior,
            at,
            ..
        } in detected
        {
            dates.extend([event.from, *at, posterior.earliest, posterior.latest]);
            dates.extend(event.until.into_iter().chain(posterior.end));
        }
        dates
    }

    /// Dates work of about the time of a change by that change. Returns false if the logbook has
    /// none.
    fn redate_work(&mut self, at: Timestamp, detected: &'a Detected, latest: Timestamp) -> bool {
        let earliest = detected.event.from;
        let apart_s = |work: &Boundary<'_>| {
            let before_s = earliest.seconds_since(work.at);
            before_s.max(work.at.seconds_since(latest)).max(0.0)
        };
        let works = self.list.iter_mut().filter(|b| b.work.is_some());
        let near = works.filter(|work| apart_s(work) < DAY_S);
        let Some(work) = near.min_by(|a, b| apart_s(a).total_cmp(&apart_s(b))) else {
            return false;
        };
        if at < work.at {
            // Until the entry the filters did not know of the work.
            work.ship_before = Some(&detected.event.ship_before);
        }
        work.at = at;
        true
    }

    /// Merges boundaries between which there is no row, but not those of work at different
    /// times. The later says what the ship is since.
    fn merge(&mut self, times: &RowTimes<'_>) {
        let mut merged: Vec<Boundary<'a>> = Vec::new();
        for next in self.list.drain(..) {
            let same = merged.last_mut().filter(|last| {
                let row = times.next(last.at.plus_seconds(-1e-6));
                let are_works = last.work.is_some() && next.work.is_some();
                row.is_none_or(|row| row >= next.at)
                    && ((row.is_some() && !are_works) || last.at == next.at)
            });
            let Some(last) = same else {
                merged.push(next);
                continue;
            };
            let begins = next.work.is_some() || !next.is_return;
            if begins {
                *last = Boundary {
                    at: next.at,
                    ship_before: last.ship_before,
                    begun_by: next.begun_by.or(last.begun_by),
                    work: next.work.or(last.work),
                    event: next.event.or(last.event),
                    cause: next.cause.or(last.cause),
                    is_return: next.is_return,
                };
            }
        }
        self.list = merged;
    }
}

fn of_work(place: usize, work: &LoggedWork) -> Boundary<'_> {
    Boundary {
        at: work.at,
        ship_before: work.ship_before.as_ref(),
        begun_by: Some(work.kind),
        work: Some(place),
        event: None,
        cause: None,
        is_return: false,
    }
}
