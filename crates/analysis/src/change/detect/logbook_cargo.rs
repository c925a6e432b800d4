//! What the logbook tells of cargo where the ship lay, or may have.

use super::state::Detector;
use crate::change::detection::CargoPeriod;
use crate::change::port_call_returns::LoggedCargo;
use crate::change::port_calls::rows_since;
use crate::change::thresholds::{LOGBOOK_TOLERANCE_S, OPEN_CARGO_ENTRY_S, SAILED_SINCE_ROWS};
use binnacle_compass::time::Timestamp;

impl Detector<'_> {
    /// What the logbook tells of the cargo on board after the time between a row and the
    /// one before.
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

    /// Whether the logbook has it that cargo came on board when a step happened.
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

    /// Whether the logbook has it that cargo was on board when a row was read.
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

    /// Whether the logbook has it that cargo was discharged between a row and the one
    /// before, whether or not she seems to have lain there.
    pub(crate) fn is_discharge_logged(&self, k: usize) -> bool {
        let Some((before, after)) = self.interval_before(k) else {
            return false;
        };
        let ends = self.cargo.iter().filter_map(|loaded| loaded.to);
        ends.into_iter().any(|to| before < to && to <= after)
    }

    /// The time between a row and the one before.
    fn interval_before(&self, k: usize) -> Option<(Timestamp, Timestamp)> {
        let before = self.observations[k.checked_sub(1)?].time?;
        Some((before, self.observations[k].time?))
    }
}
