//! Whether what came after a step bears it out.
//!
//! What always holds: a ship to whom nothing happened, or by whom something passed, is
//! followed beside the filter that knows of the step, over the same rows; what is
//! withdrawn stays so, whatever comes later, and its place in the list of events is kept.

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
    /// The doubt of a step that was dated just now, and is the last event.
    pub(crate) fn doubt_of(
        &self,
        k: usize,
        dated: &DatedChange,
        leads: &Leads,
    ) -> NoStepHypotheses {
        let (before, rows) = (&dated.before, dated.first..k + 1);
        let nothing = self.run(before.clone(), rows, &before.unknowns());
        let passed = leads[HypothesisKind::Transient as usize].and_then(|lead| {
            let copy = self.bank.spawns[lead.spawn].copy(lead.kind)?;
            Some(match lead.kind {
                HypothesisKind::SevereTransient => reset_variation(copy, &self.noise),
                _ => copy.clone(),
            })
        });
        NoStepHypotheses {
            event: self.events.len() - 1,
            told: k,
            learn_from: self.learn_from,
            without: std::iter::once(nothing).chain(passed).collect(),
        }
    }

    /// It reads the row that the filter has read.
    pub(crate) fn take_in_doubt(&mut self, k: usize) {
        let Some(mut doubt) = self.doubt.take() else {
            return;
        };
        for filter in &mut doubt.without {
            // A ship that was not struck has nothing that fades.
            let m = self.measure_settled(k, &filter.unknowns());
            filter.take(&m, &self.noise, None);
        }
        let trails = if k < doubt.told + WITHDRAWAL_MIN_ROWS {
            NO_STEP_DROPPED_EARLY_LOG_LIKELIHOOD_RATIO
        } else {
            NO_STEP_DROPPED_LOG_LIKELIHOOD_RATIO
        };
        let hopeless = self.null.log_likelihood - trails;
        doubt
            .without
            .retain(|filter| filter.log_likelihood > hopeless);
        self.doubt = Some(doubt).filter(|doubt| !doubt.without.is_empty());
    }

    /// Withdraws the last step, if the rows since are likelier without it.
    pub(crate) fn settle_doubt(&mut self, k: usize, leads: &Leads) -> bool {
        let of_kind = |kind: HypothesisKind| leads[kind as usize].map_or(0.0, |lead| lead.nats);
        if self.burst.is_some()
            || of_kind(HypothesisKind::Transient) > WITHDRAWAL_MAX_TRANSIENT_LOG_LIKELIHOOD_RATIO
        {
            return false;
        }
        let likelier = |doubt: &NoStepHypotheses| {
            let each = doubt.without.iter().enumerate();
            let each = each.map(|(i, filter)| (i, filter.log_likelihood));
            let (place, nats) = each.max_by(|a, b| a.1.total_cmp(&b.1))?;
            let enough = self.null.log_likelihood + WITHDRAWAL_LOG_LIKELIHOOD_RATIO;
            (k >= doubt.told + WITHDRAWAL_MIN_ROWS && nats > enough).then_some(place)
        };
        let Some(place) = self.doubt.as_ref().and_then(likelier) else {
            return false;
        };
        let Some(mut doubt) = self.doubt.take() else {
            return false;
        };
        let event = &mut self.events[doubt.event];
        event.confirmed = false;
        event.withdrawn = Some(k);
        self.calls.forget(doubt.event);
        self.unsettled = ExtraDrift::default();
        self.take_over(k, doubt.without.swap_remove(place), doubt.learn_from);
        true
    }

    /// Whether an event is a step that still stands.
    pub(crate) fn is_standing_step(&self, event: usize) -> bool {
        let event = &self.events[event];
        event.what == EventKind::Step && event.withdrawn.is_none()
    }
}
