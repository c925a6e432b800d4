//! End of a transient.

use super::state::Detector;
use crate::change::filter::VARIATION;
use crate::change::hypothesis_kind::HypothesisKind;
use crate::change::jump_models::{apply_jump, transient_noise};
use crate::change::thresholds::{
    DISTURBED_VARIATION_DEG, ENDED_TRANSIENT_OVER_CHANGE_LOG_LIKELIHOOD_RATIO, TRANSIENT_MAX_S,
    TRANSIENT_OVER_FOR_S,
};

impl Detector<'_> {
    /// Ends a transient after its greatest duration. Its filter becomes the null filter if
    /// it is the likeliest, so that the transient is not attributed to the vessel.
    pub(crate) fn end_transient(&mut self, k: usize) {
        let age_s = |row: usize| match (self.observations[row].time, self.observations[k].time) {
            (Some(then), Some(now)) => now.seconds_since(then),
            _ => 0.0,
        };
        let leads = self.leads();
        let ratio = |kind: HypothesisKind| {
            leads[kind as usize].map_or(0.0, |lead| lead.log_likelihood_ratio)
        };
        let others = [
            HypothesisKind::Step,
            HypothesisKind::ReferenceStep,
            HypothesisKind::Return,
        ]
        .map(ratio);
        let others = others.into_iter().fold(0.0, f64::max);
        let ended = self
            .bank
            .lead(HypothesisKind::TransientEnd, &self.null)
            .filter(|lead| {
                age_s(self.bank.forks[lead.fork].at) >= TRANSIENT_OVER_FOR_S
                    && lead.log_likelihood_ratio
                        > others + ENDED_TRANSIENT_OVER_CHANGE_LOG_LIKELIHOOD_RATIO
            });
        let ended = ended.map(|lead| &self.bank.forks[lead.fork]);
        let ended = ended.and_then(|fork| {
            Some((
                fork.at,
                fork.hypothesis(HypothesisKind::TransientEnd)?.clone(),
            ))
        });
        let is_overdue = self
            .transient
            .is_some_and(|event| age_s(self.events[event].first) >= 1.2 * TRANSIENT_MAX_S);
        if ended.is_none() && !is_overdue {
            return;
        }
        if let Some(event) = self.transient.take() {
            let first = self.events[event].first;
            let until = ended.as_ref().map_or(k, |(until, _)| *until);
            self.events[event].last = Some(self.last_disturbed_row(first, until));
        }
        if let Some((_, filter)) = ended {
            self.credit_alternatives(HypothesisKind::TransientEnd);
            let gained = filter.log_likelihood - self.null.log_likelihood;
            self.returns.credit_transient(&self.null, gained);
            self.null = filter;
            self.bank.clear();
            self.last_fork = k;
        }
    }

    /// Returns the last row from `first` to `k` with a disturbed variation, by a filter
    /// that expects a transient.
    pub(crate) fn last_disturbed_row(&self, first: usize, k: usize) -> usize {
        let Some(fork) = self.bank.forks.iter().rfind(|s| s.at <= first) else {
            return first;
        };
        let at = self.null.unknowns();
        let measured: Vec<_> = (fork.at..k).map(|row| self.measure(row, &at)).collect();
        let innovation_deg = |m| fork.origin().variation_innovation_deg(m);
        let most_deg = measured.iter().map(innovation_deg).fold(0.0, f64::max);
        let transient = transient_noise(most_deg);
        let mut filter = apply_jump(fork.origin(), HypothesisKind::Transient);
        let mut last = first;
        for (row, m) in (fork.at..k).zip(&measured) {
            filter.observe(m, &self.noise, Some(&transient));
            if row >= first && filter.mean[VARIATION].abs() > DISTURBED_VARIATION_DEG {
                last = row;
            }
        }
        last
    }
}
