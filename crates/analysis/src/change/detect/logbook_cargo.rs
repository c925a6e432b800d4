//! Logbook entries of cargo, by row.

use super::state::Detector;
use crate::change::detection::CargoPeriod;
use crate::change::port_call_returns::LoggedCargo;
use crate::change::port_calls::rows_since;
use crate::change::thresholds::{LOGBOOK_TOLERANCE_S, OPEN_CARGO_ENTRY_S, SAILED_SINCE_ROWS};
use binnacle_compass::time::Timestamp;

impl Detector<'_> {
    /// Returns the logbook's cargo after the interval before a row.
    pub(crate) fn logged_cargo_at(&self, k: usize) -> LoggedCargo {
        let Some((before, after)) = self.interval_before(k) else {
            return LoggedCargo::Nothing;
        };
        let stays = |loaded: &&CargoPeriod| {
            loaded.from.seconds_since(before) < -LOGBOOK_TOLERANCE_S
                && loaded
                    .to
                    .is_some_and(|to| to.seconds_since(after) > LOGBOOK_TOLERANCE_S)
        };
        if self.cargo.iter().any(|loaded| stays(&loaded)) {
            return LoggedCargo::OnBoard;
        }
        let ended = self.cargo.iter().filter(|loaded| {
            let is_about = |to: Timestamp| {
                to.seconds_since(before) > -LOGBOOK_TOLERANCE_S
                    && to.seconds_since(after) < LOGBOOK_TOLERANCE_S
            };
            loaded.to.is_some_and(is_about)
        });
        let from = ended.map(|loaded| loaded.from).min();
        from.map_or(LoggedCargo::Nothing, |from| LoggedCargo::Discharged {
            loaded: from.plus_seconds(-LOGBOOK_TOLERANCE_S),
            at_port: self.is_port_call(k),
        })
    }

    /// Returns true if the logbook has cargo loaded at the time of a step.
    pub(crate) fn is_loading_logged(&self, earliest: usize, latest: usize) -> bool {
        let departure_before = &self.observations[..earliest];
        let earliest = self
            .interval_before(earliest)
            .map(|interval_before| interval_before.0);
        let Some((earliest, latest)) = earliest.zip(self.observations[latest].time) else {
            return false;
        };
        self.cargo.iter().any(|loaded| {
            loaded.from.seconds_since(earliest) > -2.0 * LOGBOOK_TOLERANCE_S
                && loaded.from.seconds_since(latest) < LOGBOOK_TOLERANCE_S
                && rows_since(departure_before, loaded.from) < SAILED_SINCE_ROWS
        })
    }

    /// Returns true if the logbook has cargo on board at a row.
    pub(crate) fn is_cargo_logged(&self, k: usize) -> bool {
        let Some(time) = self.observations[k].time else {
            return false;
        };
        let on_board = |loaded: &CargoPeriod| {
            let until = loaded
                .to
                .unwrap_or(loaded.from.plus_seconds(OPEN_CARGO_ENTRY_S));
            (loaded.from..=until).contains(&time)
        };
        self.cargo.iter().any(on_board)
    }

    /// Returns true if the logbook has cargo discharged in the interval before a row, in
    /// port or not.
    pub(crate) fn is_discharge_logged(&self, k: usize) -> bool {
        let Some((before, after)) = self.interval_before(k) else {
            return false;
        };
        let ends = self.cargo.iter().filter_map(|loaded| loaded.to);
        ends.into_iter().any(|to| before < to && to <= after)
    }

    /// Returns the times of the previous row and of this one.
    fn interval_before(&self, k: usize) -> Option<(Timestamp, Timestamp)> {
        let before = self.observations[k.checked_sub(1)?].time?;
        Some((before, self.observations[k].time?))
    }
}
