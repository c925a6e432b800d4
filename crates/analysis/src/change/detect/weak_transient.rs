//! Transients that one vessel alone cannot confirm: other vessels may.

use super::state::WeakTransient;
use super::state::{Detector, Leads};
use crate::change::event::{EventKind, RowSpan};
use crate::change::hypotheses::Lead;
use crate::change::hypothesis_kind::HypothesisKind;
use crate::change::thresholds::{
    TRANSIENT_MAX_S, TRANSIENT_OVER_CHANGE_LOG_LIKELIHOOD_RATIO,
    WEAK_TRANSIENT_LOG_LIKELIHOOD_RATIO, WEAK_TRANSIENT_OVER_ROWS,
};

impl Detector<'_> {
    /// Notes a transient whose lead is below the threshold.
    pub(crate) fn note_weak_transient(&mut self, k: usize, leads: Leads, over_lasting: f64) {
        // A weak and severe transient is a few wild readings.
        let may_be_noted =
            |lead: &Lead| self.transient.is_none() && lead.kind != HypothesisKind::SevereTransient;
        let Some(lead) = leads[HypothesisKind::Transient as usize].filter(may_be_noted) else {
            return;
        };
        let most = self
            .weak_transient
            .as_ref()
            .and_then(|f| f.leads[HypothesisKind::Transient as usize]);
        let is_more = most.is_none_or(|most| lead.log_likelihood_ratio > most.log_likelihood_ratio);
        if lead.log_likelihood_ratio > WEAK_TRANSIENT_LOG_LIKELIHOOD_RATIO
            && over_lasting > TRANSIENT_OVER_CHANGE_LOG_LIKELIHOOD_RATIO
            && is_more
        {
            let first = self.transient_start(lead);
            if self.same_transient(first).is_none() && self.may_continue(first, k) {
                let last = k;
                self.weak_transient = Some(WeakTransient { first, last, leads });
            }
        }
    }

    /// Returns true if a transient since row `first` may still go on.
    pub(crate) fn may_continue(&self, first: usize, k: usize) -> bool {
        let time = |row: usize| self.observations[row].time;
        let age_s = time(k)
            .zip(time(first))
            .map(|(now, then)| now.seconds_since(then));
        age_s.is_some_and(|age_s| age_s < TRANSIENT_MAX_S)
    }

    /// Records the noted transient as an unconfirmed event, once it or the rows have ended.
    pub(crate) fn close_weak_transient(&mut self, k: usize, is_last: bool) {
        let is_transient_over = |weak_transient: &mut WeakTransient| {
            is_last || k > weak_transient.last + WEAK_TRANSIENT_OVER_ROWS
        };
        let Some(weak_transient) = self.weak_transient.take_if(is_transient_over) else {
            return;
        };
        let WeakTransient { first, last, leads } = weak_transient;
        self.record_event(
            k,
            EventKind::Transient,
            first,
            RowSpan::at(first),
            leads,
            None,
        );
        if let Some(event) = self.events.last_mut() {
            event.last = Some(last.max(first));
            event.confirmed = false;
        }
    }
}
