//! Refit of a reported step when later rows do not fit it.
//!
//! The step remains one change of the same date. The refit is at most a little less likely
//! than the alternative.
//!
//! On one course rows show the step across the needle, and hardly the step along it. A
//! filter that relied on the latter cannot follow a turn: that speaks against the filter
//! and not against the step.

use super::dating::DatedChange;
use super::state::Detector;
use crate::change::event::{EventKind, snapshot};
use crate::change::filter::Filter;
use crate::change::hypothesis_kind::HypothesisKind;
use crate::change::jump_models::apply_jump;
use crate::change::large_step::relinearise;
use crate::change::thresholds::{SAME_STEP_ROWS, STEP_KEPT_LOG_LIKELIHOOD_RATIO};

/// Rounds in which all rows are linearised at the state of the last round.
const LINEARISATION_ROUNDS: usize = 3;

impl Detector<'_> {
    /// Returns the filter with a step before row `first` or within it, after all rows up to
    /// `k`. The reading during the step fits neither state.
    pub(crate) fn refit_step(&self, k: usize, before: &Filter, first: usize) -> Filter {
        let mut likeliest = self.filter_with_step(k, before, first, HypothesisKind::Step);
        let after = (first + 1).min(k);
        let within = self.run_filter(before.clone(), first..after, &before.unknowns());
        for (before, first, kind) in [
            (before, first, HypothesisKind::LargeStep),
            (&within, after, HypothesisKind::Step),
            (&within, after, HypothesisKind::LargeStep),
        ] {
            let refitted = self.filter_with_step(k, before, first, kind);
            if refitted.log_likelihood > likeliest.log_likelihood {
                likeliest = refitted;
            }
        }
        likeliest
    }

    fn filter_with_step(
        &self,
        k: usize,
        before: &Filter,
        first: usize,
        kind: HypothesisKind,
    ) -> Filter {
        let mut filter = apply_jump(before, kind);
        for row in self.undisturbed_rows(first..k + 1) {
            let m = relinearise(&filter, &self.noise, |at| self.measure(row, at));
            filter.observe(&m, &self.noise, None);
        }
        for _ in 0..LINEARISATION_ROUNDS {
            let at = filter.unknowns();
            filter = self.run_filter(apply_jump(before, kind), first..k + 1, &at);
        }
        filter
    }

    /// Returns the previous step with its refitted filter, if that step alone explains the
    /// rows.
    pub(crate) fn same_step(&self, k: usize, dated: &DatedChange) -> Option<(usize, Filter)> {
        let base = self.returns.baselines.last()?;
        let event = self.events.get(base.event)?;
        let later = &self.events[base.event + 1..];
        let is_last = later.iter().all(|event| event.kind == EventKind::Transient);
        if !is_last || !self.is_step_in_force(base.event) || k > event.first + SAME_STEP_ROWS {
            return None;
        }
        let filter = self.refit_step(k, &base.filter, event.first);
        let threshold = dated.filter.log_likelihood - STEP_KEPT_LOG_LIKELIHOOD_RATIO;
        (filter.log_likelihood > threshold).then_some((base.event, filter))
    }

    /// Replaces the state after the step by `filter`, and removes later steps.
    pub(crate) fn replace_step(&mut self, k: usize, step: usize, filter: Filter) {
        self.remove_later_steps(step);
        let event = &mut self.events[step];
        event.after = snapshot(&filter);
        let first = event.first;
        let (competing, no_step) = (std::mem::take(&mut self.competing), self.no_step.take());
        self.replace_null(k, filter, first);
        (self.competing, self.no_step) = (competing, no_step);
    }
}
