//! Dating of a change to the row.

use super::state::{Detector, earlier_state};
use crate::change::event::{Event, EventKind, RowSpan};
use crate::change::filter::{Filter, Measurement};
use crate::change::hypothesis_kind::HypothesisKind;
use crate::change::jump_models::{apply_jump, apply_reference_step};
use crate::change::thresholds::{
    DATE_AT_PORT_CALL_LOG_LIKELIHOOD_RATIO, DATE_AT_PORT_CALL_ROWS, DATE_LOG_LIKELIHOOD_RATIO,
    FORK_AFTER_GAP_S,
};
use crate::estimate::Unknowns;

/// Dates tried in each of two rounds.
const DATES_PER_ROUND: usize = 40;
/// Usual time between rows, seconds.
const ROW_S: f64 = 600.0;

/// Number of port calls tried as dates.
const PORT_CALLS_TRIED: usize = 3;

/// A dated change.
pub(crate) struct DatedChange {
    pub(crate) first: usize,
    pub(crate) between: RowSpan,
    pub(crate) kind: HypothesisKind,
    /// Filters just before the change, and with it, at the present row.
    pub(crate) before: Filter,
    pub(crate) filter: Filter,
    /// True if it is dated at a port call though the likeliest row is days later, or
    /// follows a transient.
    pub(crate) noticed_late: bool,
}

/// Returns the state at which rows before a change are linearised. Before a large step that
/// is the vessel's earlier state, which is quite another.
fn linearisation_before(kind: HypothesisKind, origin: &Filter, after: &Unknowns) -> Unknowns {
    match kind {
        HypothesisKind::LargeStep => origin.unknowns(),
        _ => *after,
    }
}

impl Detector<'_> {
    /// Dates a change to the row.
    pub(crate) fn date_change(
        &self,
        leading_fork: usize,
        kind: HypothesisKind,
        k: usize,
    ) -> DatedChange {
        let forks = &self.bank.forks;
        let origin = &forks[leading_fork.saturating_sub(1)];
        let until = forks.get(leading_fork + 1).map_or(k, |s| s.at);
        let earlier_state = earlier_state(
            self.reference_fault.as_ref(),
            self.alignment_change.as_ref(),
            &self.returns,
        );
        let with_jump = |filter: &Filter, next: &Measurement| match (kind, earlier_state) {
            (HypothesisKind::Return, Some(earlier_state)) => earlier_state.restore(filter),
            (HypothesisKind::ReferenceStep | HypothesisKind::SatelliteStep, _) => {
                apply_reference_step(filter, next, kind)
            }
            _ => apply_jump(filter, kind),
        };
        // Two rounds, because rows are to be linearised at the present state.
        let mut at = match kind {
            HypothesisKind::LargeStep => forks[leading_fork]
                .hypothesis(kind)
                .map_or_else(|| self.linearisation_point(k), Filter::unknowns),
            _ => self.linearisation_point(k),
        };
        let next = self.measure(origin.at, &at);
        let mut best = (origin.at, with_jump(origin.origin(), &next));
        let mut likely = Vec::new();
        for round in 0..2 {
            let (low, high) = if round == 0 {
                (origin.at, until)
            } else {
                let stride = (until - origin.at) / DATES_PER_ROUND + 1;
                let low = best.0.saturating_sub(stride).max(origin.at);
                (low, (best.0 + stride).min(until))
            };
            let stride = (high - low) / DATES_PER_ROUND + 1;
            let rows = origin.at..k + 1;
            let measure = |at: &Unknowns| -> Vec<Measurement> {
                rows.clone().map(|row| self.measure(row, at)).collect()
            };
            let measured = measure(&at);
            let since = |row: usize| &measured[row - origin.at..];
            let before_change = measure(&linearisation_before(kind, origin.origin(), &at));
            let mut before =
                self.observe_all(origin.origin().clone(), &before_change[..low - origin.at]);
            let mut tried: Vec<(usize, Filter)> = Vec::new();
            let mut row = low;
            while row <= high.min(k) {
                let filter = self.observe_all(with_jump(&before, &since(row)[0]), since(row));
                tried.push((row, filter));
                let next = row + stride;
                let until = next.min(k + 1);
                before =
                    self.observe_all(before, &before_change[row - origin.at..until - origin.at]);
                row = next;
            }
            let ratio = |(row, f): &(usize, Filter)| f.log_likelihood + self.gap_log_odds(*row);
            likely.extend(tried.iter().map(|one| (round, one.0, ratio(one))));
            if let Some(found) = tried
                .into_iter()
                .max_by(|a, b| ratio(a).total_cmp(&ratio(b)))
            {
                best = found;
            }
            at = best.1.unknowns();
        }
        let (first, filter) = best;
        if matches!(kind, HypothesisKind::Step | HypothesisKind::LargeStep)
            && let Some(dated) = self.date_at_port_call(leading_fork, kind, &filter, first, k)
        {
            return dated;
        }
        let near = |round: usize| {
            let of_round = likely.iter().filter(move |(r, _, _)| *r == round);
            let most = of_round
                .clone()
                .map(|x| x.2)
                .fold(f64::NEG_INFINITY, f64::max);
            of_round
                .filter(move |x| x.2 > most - DATE_LOG_LIKELIHOOD_RATIO)
                .map(|x| x.1)
                .collect::<Vec<_>>()
        };
        let rows: Vec<usize> = near(0).into_iter().chain(near(1)).chain([first]).collect();
        let earliest = rows.iter().copied().min().unwrap_or(first);
        let latest = rows.iter().copied().max().unwrap_or(first);
        let at_before = linearisation_before(kind, origin.origin(), &filter.unknowns());
        DatedChange {
            first,
            between: RowSpan { earliest, latest },
            kind,
            before: self.run_filter(origin.origin().clone(), origin.at..first, &at_before),
            filter,
            noticed_late: false,
        }
    }

    /// Returns the prior log odds of a change in the gap before a row, against one between
    /// two rows: proportional to the length of the gap.
    fn gap_log_odds(&self, row: usize) -> f64 {
        let seconds = self.seconds_since_previous(row);
        if seconds > FORK_AFTER_GAP_S {
            (seconds / ROW_S).ln()
        } else {
            0.0
        }
    }

    /// Returns the filter after some measurements.
    fn observe_all(&self, mut filter: Filter, measured: &[Measurement]) -> Filter {
        for m in measured {
            filter.observe(m, &self.noise, None);
        }
        filter
    }

    /// Returns the change dated at a port call, if that is about as likely as the likeliest
    /// row, of which `filter` is: many more steps happen there than at sea.
    fn date_at_port_call(
        &self,
        leading_fork: usize,
        kind: HypothesisKind,
        filter: &Filter,
        row: usize,
        k: usize,
    ) -> Option<DatedChange> {
        let forks = &self.bank.forks;
        let since = row.saturating_sub(DATE_AT_PORT_CALL_ROWS);
        let from = forks.partition_point(|s| s.at <= since).saturating_sub(1);
        let origin = &forks[from.min(leading_fork)];
        let until = forks
            .get(leading_fork + 1)
            .map_or(k, |s| s.at)
            .max(row + DATE_AT_PORT_CALL_ROWS);
        let calls = (origin.at.max(since).max(1)..=until.min(k)).rev();
        let calls = calls
            .filter(|&row| self.is_port_call(row))
            .take(PORT_CALLS_TRIED);
        let at = filter.unknowns();
        let at_before = linearisation_before(kind, origin.origin(), &at);
        let before = calls.map(|call| {
            let rows = origin.at..call;
            (
                call,
                self.run_filter(origin.origin().clone(), rows, &at_before),
            )
        });
        let departure = self.departure_before(row, &self.events);
        let departure = departure.filter(|(call, _)| *call < origin.at);
        let tried = before.chain(departure.map(|(call, before)| {
            // As likely as a null filter that may have been credited with a transient
            // since.
            let nothing = self.run_filter(before.clone(), call..k + 1, &self.null.unknowns());
            let mut before = before.clone();
            before.log_likelihood += self.null.log_likelihood - nothing.log_likelihood;
            (call, before)
        }));
        let (call, before, filter) = tried
            .map(|(call, before)| {
                let filter = self.run_filter(apply_jump(&before, kind), call..k + 1, &at);
                (call, before, filter)
            })
            .filter(|(_, _, at_call)| {
                at_call.log_likelihood
                    > filter.log_likelihood - DATE_AT_PORT_CALL_LOG_LIKELIHOOD_RATIO
            })
            .max_by(|a, b| a.2.log_likelihood.total_cmp(&b.2.log_likelihood))?;
        let was_transient_since = |event: &Event| {
            event.kind == EventKind::Transient
                && event.first > call
                && event.last.is_some_and(|last| last < row)
        };
        let noticed_late = call < origin.at || self.events.iter().any(was_transient_since);
        Some(DatedChange {
            first: call,
            between: RowSpan {
                earliest: call.min(row),
                latest: call.max(row),
            },
            kind,
            before,
            filter,
            noticed_late,
        })
    }
}
