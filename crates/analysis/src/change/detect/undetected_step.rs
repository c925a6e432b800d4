//! What a port call may have changed that the rows since have not told.
//!
//! What always holds: it is no event and moves no date; it is only to make the band as
//! wide as what is not known.

use super::state::{Detector, Leads};
use crate::change::detection::UndetectedStep;
use crate::change::event::{Event, EventKind};
use crate::change::filter::Filter;
use crate::change::hypothesis_kind::HypothesisKind;
use crate::change::jump_models::apply_jump;
use crate::change::likelihood_ratio::tempered_odds;
use crate::change::priors;
use crate::change::thresholds::{CARGO_NOTICED_LATE_S, UNDETECTED_STEP_ROWS};

/// Odds beyond this are certainty.
const MAX_ODDS: f64 = 1e9;

impl Detector<'_> {
    /// The last port call, if that was soon before row `row`, and the ship as she sailed from
    /// it: cargo that was noticed at sea was on board by then. None where something else that
    /// lasts was told since, `earlier_state` being all that has been.
    pub(crate) fn departure_before(
        &self,
        row: usize,
        earlier_state: &[Event],
    ) -> Option<(usize, &Filter)> {
        let (at, filter) = self.departures.0.iter().rfind(|(at, _)| *at <= row)?;
        let is_news =
            |event: &Event| event.detected_row >= *at && event.kind != EventKind::Transient;
        let times = self.observations[*at].time.zip(self.observations[row].time);
        let is_soon = times.is_some_and(|(departure_before, now)| {
            now.seconds_since(departure_before) < CARGO_NOTICED_LATE_S
        });
        (is_soon && !earlier_state.iter().any(is_news)).then_some((*at, filter))
    }

    /// The likeliest of the last port calls for a step that has not been told, and how
    /// likely one at any of them is; `returned` is how likely she is herself again.
    pub(crate) fn undetected_step(&self, leads: &Leads, returned: f64) -> Option<UndetectedStep> {
        let last = self.observations.len().checked_sub(1)?;
        let earliest = last
            .saturating_sub(UNDETECTED_STEP_ROWS)
            .max(self.first_change_row());
        // A filter that did not know of what was told since is of no use.
        let told = |event: &&Event| {
            !matches!(event.kind, EventKind::Transient | EventKind::ReferenceFault)
        };
        let told = self
            .events
            .iter()
            .filter(told)
            .map(|event| event.detected_row);
        let earliest = told.max().map_or(earliest, |told| earliest.max(told + 1));
        let departures = self.departures.0.iter().filter(|(at, _)| *at >= earliest);
        let likely: Vec<(usize, f64)> = departures
            .map(|(at, before)| {
                let ratio = self.step_log_likelihood_ratio(*at, before);
                (
                    *at,
                    priors::CHANGE_AT_PORT_CALL / (1.0 - priors::CHANGE_AT_PORT_CALL)
                        * tempered_odds(ratio).min(MAX_ODDS),
                )
            })
            .collect();
        let (first, _) = likely.iter().max_by(|a, b| a.1.total_cmp(&b.1))?;
        let sum: f64 = likely.iter().map(|(_, tempered_odds)| tempered_odds).sum();
        // Against nothing, a reference's fault, what passes, and her being herself again.
        let fault = leads[HypothesisKind::ReferenceStep as usize]
            .filter(|lead| self.bank.forks[lead.fork].at >= *first)
            .map_or(0.0, |lead| {
                priors::REFERENCE_FAULT * tempered_odds(lead.log_likelihood_ratio).min(MAX_ODDS)
            });
        // What passes explains the same rows, where it is not known to be over.
        let astray = leads[HypothesisKind::Transient as usize].map_or(0.0, |lead| {
            priors::TRANSIENT * tempered_odds(lead.log_likelihood_ratio.max(0.0)).min(MAX_ODDS)
        });
        let others = (1.0 + fault + astray) / (1.0 - returned).max(f64::MIN_POSITIVE);
        Some(UndetectedStep {
            first: *first,
            probability: sum / (sum + others),
        })
    }

    /// By how much likelier it is that the ship changed before row `call` than that she did
    /// not, by the rows that nothing spoilt that is over.
    fn step_log_likelihood_ratio(&self, call: usize, before: &Filter) -> f64 {
        let rows: Vec<usize> = (call..self.observations.len())
            .filter(|row| !self.is_disturbed(*row))
            .collect();
        let run = |filter: &Filter| {
            let mut at = self.null.unknowns();
            let mut end = filter.clone();
            // Twice, for the rows are to be linearised at where the ship would be now.
            for _ in 0..2 {
                end = rows.iter().fold(filter.clone(), |mut filter, row| {
                    filter.observe(&self.measure(*row, &at), &self.noise, None);
                    filter
                });
                at = end.unknowns();
            }
            end.log_likelihood
        };
        run(&apply_jump(before, HypothesisKind::Step)) - run(before)
    }

    /// Whether a passing disturbance that is over, or a fault of a reference, is of this row.
    fn is_disturbed(&self, row: usize) -> bool {
        let mut told = self.events.iter().enumerate();
        told.any(|(place, event)| {
            let last = match event.kind {
                EventKind::Transient if self.transient == Some(place) => return false,
                EventKind::Transient => event.last,
                EventKind::ReferenceFault => self.events[place + 1..]
                    .iter()
                    .find(|later| later.kind == EventKind::Return(place))
                    .map(|later| later.first.saturating_sub(1)),
                _ => return false,
            };
            (event.first..=last.unwrap_or(usize::MAX)).contains(&row)
        })
    }
}
