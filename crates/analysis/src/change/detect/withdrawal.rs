//! Withdrawal of a step that later rows do not support.
//!
//! Filters without the step, with and without a transient, read the same rows as the filter
//! with it. A withdrawn step stays withdrawn, and keeps its place in the list of events.

use super::dating::DatedChange;
use super::state::{Detector, Leads};
use super::state::{ExtraDrift, NoStepHypotheses};
use crate::change::event::EventKind;
use crate::change::hypothesis_kind::HypothesisKind;
use crate::change::jump_models::reset_variation;
use crate::change::thresholds::{
    NO_STEP_DROPPED_EARLY_LOG_LIKELIHOOD_RATIO, NO_STEP_DROPPED_LOG_LIKELIHOOD_RATIO,
    WITHDRAWAL_LOG_LIKELIHOOD_RATIO, WITHDRAWAL_MAX_TRANSIENT_LOG_LIKELIHOOD_RATIO,
    WITHDRAWAL_MIN_ROWS,
};

impl Detector<'_> {
    /// Returns the hypotheses without a step that was just dated and is the last event.
    pub(crate) fn no_step_hypotheses(
        &self,
        k: usize,
        dated: &DatedChange,
        leads: &Leads,
    ) -> NoStepHypotheses {
        let (before, rows) = (&dated.before, dated.first..k + 1);
        let without_change = self.run_filter(before.clone(), rows, &before.unknowns());
        let with_transient = leads[HypothesisKind::Transient as usize].and_then(|lead| {
            let hypothesis = self.bank.forks[lead.fork].hypothesis(lead.kind)?;
            Some(match lead.kind {
                HypothesisKind::SevereTransient => reset_variation(hypothesis, &self.noise),
                _ => hypothesis.clone(),
            })
        });
        NoStepHypotheses {
            event: self.events.len() - 1,
            detected_row: k,
            learn_from: self.learn_from,
            without: std::iter::once(without_change)
                .chain(with_transient)
                .collect(),
        }
    }

    /// Reads row `k` with the hypotheses without the step.
    pub(crate) fn observe_no_step(&mut self, k: usize) {
        let Some(mut no_step) = self.no_step.take() else {
            return;
        };
        for filter in &mut no_step.without {
            // Without a step nothing decays.
            let m = self.measure_settled(k, &filter.unknowns());
            filter.observe(&m, &self.noise, None);
        }
        let largest_deficit = if k < no_step.detected_row + WITHDRAWAL_MIN_ROWS {
            NO_STEP_DROPPED_EARLY_LOG_LIKELIHOOD_RATIO
        } else {
            NO_STEP_DROPPED_LOG_LIKELIHOOD_RATIO
        };
        let lower_bound = self.null.log_likelihood - largest_deficit;
        no_step
            .without
            .retain(|filter| filter.log_likelihood > lower_bound);
        self.no_step = Some(no_step).filter(|no_step| !no_step.without.is_empty());
    }

    /// Withdraws the last step, if the rows since are likelier without it.
    pub(crate) fn decide_withdrawal(&mut self, k: usize, leads: &Leads) -> bool {
        let ratio_of = |kind: HypothesisKind| {
            leads[kind as usize].map_or(0.0, |lead| lead.log_likelihood_ratio)
        };
        if self.transient.is_some()
            || ratio_of(HypothesisKind::Transient) > WITHDRAWAL_MAX_TRANSIENT_LOG_LIKELIHOOD_RATIO
        {
            return false;
        }
        let likelier = |no_step: &NoStepHypotheses| {
            let each = no_step.without.iter().enumerate();
            let each = each.map(|(i, filter)| (i, filter.log_likelihood));
            let (place, ratio) = each.max_by(|a, b| a.1.total_cmp(&b.1))?;
            let threshold = self.null.log_likelihood + WITHDRAWAL_LOG_LIKELIHOOD_RATIO;
            (k >= no_step.detected_row + WITHDRAWAL_MIN_ROWS && ratio > threshold).then_some(place)
        };
        let Some(place) = self.no_step.as_ref().and_then(likelier) else {
            return false;
        };
        let Some(mut no_step) = self.no_step.take() else {
            return false;
        };
        let event = &mut self.events[no_step.event];
        event.confirmed = false;
        event.withdrawn = Some(k);
        self.returns.forget(no_step.event);
        self.extra_drift = ExtraDrift::default();
        self.replace_null(k, no_step.without.swap_remove(place), no_step.learn_from);
        true
    }

    /// Returns true if an event is a step that was not withdrawn.
    pub(crate) fn is_step_in_force(&self, event: usize) -> bool {
        let event = &self.events[event];
        event.kind == EventKind::Step && event.withdrawn.is_none()
    }
}
