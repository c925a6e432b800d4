//! Detection row by row.
//!
//! Every row is read once, in order of time, and no later row affects what it shows. Every
//! event lies between two rows. The search ends.

use super::acceptance::FilterChange;
use super::state::{Detector, LearningSchedule, LearntNoise, earlier_state};
use crate::change::priors;
use crate::change::thresholds::{
    FIRST_TRANSIENT_ROW, FORK_AFTER_GAP_S, FORK_INNOVATION_MIN_ROWS, FORK_INNOVATION_SD,
    FORK_INTERVAL_ROWS, SUSPICION_LOG_LIKELIHOOD_RATIO,
};

use crate::change::detection::{Detection, DetectionInput, PossibleReturn};
use crate::change::event::{EventKind, RowSpan};
use crate::change::filter::Measurement;
use crate::change::hypotheses::Lead;
use crate::change::hypothesis_kind::HypothesisKind;
use crate::estimate::are_times_plausible;
use crate::observation::Observation;

/// Searches rows in order of time for changes. Rows without a time, or most of which share
/// theirs, cannot be dated.
pub(crate) fn detect(observations: &[Observation], input: &DetectionInput<'_>) -> Detection {
    if !are_times_plausible(observations) {
        return Detection::default();
    }
    let Some(learnt) = LearntNoise::first(observations, input.prior, input.levels) else {
        return Detection::default();
    };
    let mut search = Detector::new(observations, input, &learnt);
    for k in 0..observations.len() {
        search.read_row(k);
    }
    search.finish()
}

impl Detector<'_> {
    fn read_row(&mut self, k: usize) {
        if k >= self.next_learning.at {
            self.relearn(k);
        }
        if k == self.first_change_row() {
            self.bank.drop_lasting();
        }
        let is_fork_due = k >= FIRST_TRANSIENT_ROW && self.is_fork_due(k);
        if is_fork_due {
            self.end_transient(k);
        }
        let m = self.measure_next(k);
        if is_fork_due || (k >= FIRST_TRANSIENT_ROW && self.is_outlying(k, &m)) {
            let earlier_state = earlier_state(
                self.reference_fault.as_ref(),
                self.alignment_change.as_ref(),
                &self.returns,
            );
            let step_prior_log_odds = if self.is_port_call(k) {
                priors::STEP_AT_PORT_CALL_LOG_ODDS
            } else {
                0.0
            };
            self.bank.fork(
                k,
                &self.null,
                &self.noise,
                earlier_state,
                step_prior_log_odds,
            );
            self.last_fork = k;
        }
        if self.is_port_call(k) || self.is_discharge_logged(k) {
            let logged = self.logged_cargo_at(k);
            self.returns
                .add_port_call(k, &self.null, usize::MAX, logged);
        }
        if self.is_port_call(k) {
            self.departures.add(k, &self.null);
        }
        let excess_loss = self.null.observe(&m, &self.noise, None);
        let mut returns = std::mem::take(&mut self.returns);
        returns.observe(|at| self.measure(k, at), &self.noise, &self.null);
        self.returns = returns;
        self.observe_competing(k);
        self.observe_no_step(k);
        let earlier_state = earlier_state(
            self.reference_fault.as_ref(),
            self.alignment_change.as_ref(),
            &self.returns,
        );
        self.bank
            .observe(k, m, &self.noise, &self.null, excess_loss, earlier_state);
        let mut bank = std::mem::take(&mut self.bank);
        bank.observe_large_steps(k, &self.noise, |row, at| self.measure(row, at));
        self.bank = bank;
        if k >= FIRST_TRANSIENT_ROW {
            self.decide(k);
            self.close_weak_transient(k, false);
        }
    }

    fn is_fork_due(&self, k: usize) -> bool {
        let reported = || {
            let Some((before, now)) = k
                .checked_sub(1)
                .and_then(|j| self.observations[j].time)
                .zip(self.observations[k].time)
            else {
                return false;
            };
            self.reported.iter().any(|t| before < *t && *t <= now)
        };
        k >= self.last_fork + FORK_INTERVAL_ROWS
            || (k > 0 && self.seconds_since_previous(k) > FORK_AFTER_GAP_S)
            || reported()
    }

    /// Returns true if the row is an outlier from which a jump may date.
    fn is_outlying(&self, k: usize, m: &Measurement) -> bool {
        k >= self.last_fork + FORK_INNOVATION_MIN_ROWS
            && self.null.z_squared(m) > FORK_INNOVATION_SD * FORK_INNOVATION_SD
    }

    /// Learns the noise levels again, from the longer stretch of rows.
    fn relearn(&mut self, k: usize) {
        let rows = self.learn_from..k;
        if let Some(learnt) =
            LearntNoise::from_rows(self.observations, rows, self.prior, Some(&self.levels))
        {
            self.levels = learnt.levels;
            self.noise = learnt.noise;
        }
        self.learnt_days = self.next_learning.days;
        self.next_learning = LearningSchedule::next(self.observations, self.learn_from, k, 0.0);
    }

    /// Reports what is open when the rows end.
    fn finish(mut self) -> Detection {
        let leads = self.leads();
        let possible_return =
            self.return_candidate(&leads)
                .map(|return_candidate| PossibleReturn {
                    event: return_candidate.event,
                    first: return_candidate.at,
                    probability: return_candidate.any,
                });
        let returned = possible_return.map_or(0.0, |possible_return| possible_return.probability);
        let undetected_step = self.undetected_step(&leads, returned);
        let undecided_step_nt2 = self.undecided_step_nt2(&leads);
        self.record_alignment_ratios();
        self.report_suspicion();
        self.close_weak_transient(self.observations.len().saturating_sub(1), true);
        Detection {
            events: self.events,
            possible_return,
            undetected_step,
            undecided_step_nt2,
            is_watched: true,
        }
    }

    fn report_suspicion(&mut self) {
        let Some(k) = self.observations.len().checked_sub(1) else {
            return;
        };
        if let Some(event) = self.transient {
            let last = self.last_disturbed_row(self.events[event].first, k + 1);
            self.events[event].last = (last + FORK_INTERVAL_ROWS < k).then_some(last);
            return;
        }
        let leads = self.leads();
        let ratio = |kind: HypothesisKind| {
            leads[kind as usize].map_or(0.0, |lead| lead.log_likelihood_ratio)
        };
        let likeliest = [
            HypothesisKind::Step,
            HypothesisKind::ReferenceStep,
            HypothesisKind::Transient,
        ]
        .into_iter()
        .max_by(|a, b| ratio(*a).total_cmp(&ratio(*b)))
        .filter(|kind| ratio(*kind) > SUSPICION_LOG_LIKELIHOOD_RATIO);
        // A past transient keeps its lead.
        let may_continue = |lead: Lead| self.may_continue(self.bank.forks[lead.fork].at, k);
        let Some((kind, lead)) = likeliest.and_then(|kind| Some((kind, leads[kind as usize]?)))
        else {
            return;
        };
        if k < self.warm_up_rows() || (kind == HypothesisKind::Transient && !may_continue(lead)) {
            return;
        }
        let event_kind = match kind {
            HypothesisKind::ReferenceStep => EventKind::ReferenceFault,
            HypothesisKind::Transient => EventKind::Transient,
            _ => EventKind::Step,
        };
        let fork = &self.bank.forks[lead.fork];
        let first = fork.at;
        let filters = fork
            .hypothesis(lead.kind)
            .map(|f| (fork.origin().clone(), f.clone()));
        let change = filters
            .as_ref()
            .map(|(before, after)| FilterChange { before, after });
        self.record_event(k, event_kind, first, RowSpan::at(first), leads, change);
        if let Some(event) = self.events.last_mut() {
            event.confirmed = false;
        }
    }
}
