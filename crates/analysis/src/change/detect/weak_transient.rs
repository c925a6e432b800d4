//! Disturbances that the ship alone cannot be sure of: other ships may speak for them.

use super::state::Faint;
use super::state::{Leads, Search};
use crate::change::event::What;
use crate::change::hypotheses::Lead;
use crate::change::hypothesis_kind::Kind;
use crate::change::thresholds::{
    TRANSIENT_MAX_S, TRANSIENT_OVER_CHANGE_LOG_LIKELIHOOD_RATIO,
    WEAK_TRANSIENT_LOG_LIKELIHOOD_RATIO, WEAK_TRANSIENT_OVER_ROWS,
};

impl Search<'_> {
    /// Keeps in mind what leads by too little to be told.
    pub(crate) fn note_faint(&mut self, k: usize, leads: Leads, over_lasting: f64) {
        // What is wild and faint is a few wild readings.
        let is_news = |lead: &Lead| self.burst.is_none() && lead.kind != Kind::Wild;
        let Some(lead) = leads[Kind::Burst as usize].filter(is_news) else {
            return;
        };
        let most = self
            .faint
            .as_ref()
            .and_then(|f| f.leads[Kind::Burst as usize]);
        let is_more = most.is_none_or(|most| lead.nats > most.nats);
        if lead.nats > WEAK_TRANSIENT_LOG_LIKELIHOOD_RATIO
            && over_lasting > TRANSIENT_OVER_CHANGE_LOG_LIKELIHOOD_RATIO
            && is_more
        {
            let first = self.began(lead);
            if self.same_burst(first).is_none() && self.has_time_left(first, k) {
                let last = k;
                self.faint = Some(Faint { first, last, leads });
            }
        }
    }

    /// Whether a burst of row `first` may go on still.
    pub(crate) fn has_time_left(&self, first: usize, k: usize) -> bool {
        let time = |row: usize| self.observations[row].time;
        let age_s = time(k)
            .zip(time(first))
            .map(|(now, then)| now.seconds_since(then));
        age_s.is_some_and(|age_s| age_s < TRANSIENT_MAX_S)
    }

    /// Puts it among the events, unconfirmed, once it is over or the rows are.
    pub(crate) fn settle_faint(&mut self, k: usize, is_last: bool) {
        let is_over = |faint: &mut Faint| is_last || k > faint.last + WEAK_TRANSIENT_OVER_ROWS;
        let Some(faint) = self.faint.take_if(is_over) else {
            return;
        };
        let Faint { first, last, leads } = faint;
        self.push(k, What::Burst, first, (first, first), leads, None);
        if let Some(event) = self.events.last_mut() {
            event.last = Some(last.max(first));
            event.confirmed = false;
        }
    }
}
