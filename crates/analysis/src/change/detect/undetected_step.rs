//! Steps at port calls that the rows since do not show.
//!
//! Such a step is no event and changes no date. It widens the band by what is unknown.

use super::state::{Detector, Leads};
use crate::change::detection::UndetectedStep;
use crate::change::event::{Event, EventKind};
use crate::change::filter::Filter;
use crate::change::hypothesis_kind::HypothesisKind;
use crate::change::jump_models::apply_jump;
use crate::change::likelihood_ratio::tempered_odds;
use crate::change::priors;
use crate::change::thresholds::{CARGO_NOTICED_LATE_S, UNDETECTED_STEP_ROWS};

/// Odds above this count as certainty.
const MAX_ODDS: f64 = 1e9;

impl Detector<'_> {
    /// Returns the last port call and its filter, if it was soon before `row`: cargo
    /// noticed at sea was on board by then. None where another lasting event in
    /// `earlier_events` was detected since.
    pub(crate) fn departure_before(
        &self,
        row: usize,
        earlier_events: &[Event],
    ) -> Option<(usize, &Filter)> {
        let (at, filter) = self.departures.0.iter().rfind(|(at, _)| *at <= row)?;
        let is_later =
            |event: &Event| event.detected_row >= *at && event.kind != EventKind::Transient;
        let times = self.observations[*at].time.zip(self.observations[row].time);
        let is_soon =
            times.is_some_and(|(departed, now)| now.seconds_since(departed) < CARGO_NOTICED_LATE_S);
        (is_soon && !earlier_events.iter().any(is_later)).then_some((*at, filter))
    }

    /// Returns the likeliest port call for an undetected step, and the probability of a
    /// step at any of them; `returned` is the probability of a return.
    pub(crate) fn undetected_step(&self, leads: &Leads, returned: f64) -> Option<UndetectedStep> {
        let last = self.observations.len().checked_sub(1)?;
        let earliest = last
            .saturating_sub(UNDETECTED_STEP_ROWS)
            .max(self.first_change_row());
        // A filter from before the last lasting event is of no use.
        let lasting = |event: &&Event| {
            !matches!(event.kind, EventKind::Transient | EventKind::ReferenceFault)
        };
        let lasting = self
            .events
            .iter()
            .filter(lasting)
            .map(|event| event.detected_row);
        let earliest = lasting
            .max()
            .map_or(earliest, |lasting| earliest.max(lasting + 1));
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
        let sum: f64 = likely.iter().map(|(_, odds)| odds).sum();
        // Alternatives: no change, a reference's fault, a transient, and a return.
        let fault = leads[HypothesisKind::ReferenceStep as usize]
            .filter(|lead| self.bank.forks[lead.fork].at >= *first)
            .map_or(0.0, |lead| {
                priors::REFERENCE_FAULT * tempered_odds(lead.log_likelihood_ratio).min(MAX_ODDS)
            });
        // A current transient explains the same rows.
        let transient = leads[HypothesisKind::Transient as usize].map_or(0.0, |lead| {
            priors::TRANSIENT * tempered_odds(lead.log_likelihood_ratio.max(0.0)).min(MAX_ODDS)
        });
        let others = (1.0 + fault + transient) / (1.0 - returned).max(f64::MIN_POSITIVE);
        Some(UndetectedStep {
            first: *first,
            probability: sum / (sum + others),
        })
    }

    /// Returns the log-likelihood ratio of a step before row `call`, by the undisturbed
    /// rows.
    fn step_log_likelihood_ratio(&self, call: usize, before: &Filter) -> f64 {
        let rows: Vec<usize> = (call..self.observations.len())
            .filter(|row| !self.is_disturbed(*row))
            .collect();
        let run = |filter: &Filter| {
            let mut at = self.null.unknowns();
            let mut end = filter.clone();
            // Two rounds, because rows are to be linearised at the present state.
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

    /// Returns true if a past transient or a reference's fault covers this row.
    fn is_disturbed(&self, row: usize) -> bool {
        let mut events = self.events.iter().enumerate();
        events.any(|(place, event)| {
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
