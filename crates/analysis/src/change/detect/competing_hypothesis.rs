//! Competing explanations of the last step: an alignment change of the compass, or a drift.
//!
//! On one heading either looks like a step, so that a step is reported first. An
//! explanation that later rows make far likelier replaces it, once; it remains one change.

use super::dating::DatedChange;
use super::state::CompetingHypothesis;
use super::state::{Detector, ExtraDrift, FilterBefore, Leads};
use crate::change::event::{Event, EventKind, RowSpan, remove_events, snapshot};
use crate::change::filter::{CONSTANT_STATE, Filter, Measurement};
use crate::change::hypotheses::Fork;
use crate::change::hypothesis_kind::HypothesisKind;
use crate::change::jump_models::apply_alignment_step;
use crate::change::port_call_returns::{Baseline, StepOrigin};
use crate::change::priors;
use crate::change::thresholds::{
    ALIGNMENT_SECTOR_ROWS, ALIGNMENT_SECTORS, ALIGNMENT_SECTORS_BETWEEN,
    COMPETING_DEFICIT_LOG_LIKELIHOOD_RATIO, COMPETING_DROPPED_LOG_LIKELIHOOD_RATIO,
    COMPETING_LOG_LIKELIHOOD_RATIO, COMPETING_MAX_ROWS,
    COMPETING_WITH_SEVERAL_LOG_LIKELIHOOD_RATIO, DRIFT_BEFORE_CARGO_ROWS,
    DRIFT_WITH_CARGO_EXTRA_LOG_LIKELIHOOD_RATIO, STEP_KEPT_LOG_LIKELIHOOD_RATIO,
};

/// Rounds in which the rows are linearised at the state of the last round.
const LINEARISATION_ROUNDS: usize = 3;

impl Detector<'_> {
    /// Returns the hypotheses that compete with a step just dated.
    pub(crate) fn competing_hypotheses(
        &self,
        k: usize,
        dated: &DatedChange,
    ) -> Vec<CompetingHypothesis> {
        let drifts = priors::DRIFT_VARIANCES
            .iter()
            .filter_map(|drift| self.drift_hypothesis(k, dated, *drift));
        let alignment = self
            .has_both_references(k)
            .then(|| self.alignment_hypothesis(k, dated));
        drifts.chain(alignment).collect()
    }

    /// Returns the hypothesis of an alignment change at the date of the step.
    fn alignment_hypothesis(&self, k: usize, dated: &DatedChange) -> CompetingHypothesis {
        CompetingHypothesis {
            kind: EventKind::Alignment,
            event: self.events.len() - 1,
            drift: 0.0,
            first: dated.first,
            between: dated.between,
            filter: self.filter_with_alignment_change(k, &dated.before, dated.first),
            before: dated.before.clone(),
        }
    }

    /// Returns the filter with an alignment change before row `first`, after all rows up to
    /// `k`.
    fn filter_with_alignment_change(&self, k: usize, before: &Filter, first: usize) -> Filter {
        let mut filter = before.clone();
        // Rows are to be linearised at the final state.
        for _ in 0..LINEARISATION_ROUNDS {
            let at = filter.unknowns();
            let moved_deg = filter.mean[CONSTANT_STATE] - before.mean[CONSTANT_STATE];
            let next = self.measure(first, &at);
            let size_deg = before
                .innovation_deg(&next)
                .max(priors::ALIGNMENT_STEP_SD_DEG);
            let moved = apply_alignment_step(before, moved_deg, size_deg);
            filter = self.run_filter(moved, first..k + 1, &at);
        }
        filter
    }

    /// Returns the hypothesis of a drift since the likeliest fork.
    fn drift_hypothesis(
        &self,
        k: usize,
        dated: &DatedChange,
        drift: f64,
    ) -> Option<CompetingHypothesis> {
        let forks = &self.bank.forks;
        let oldest = forks.first()?.at;
        let at = dated.filter.unknowns();
        let rows = oldest..k + 1;
        let measured: Vec<Measurement> = rows
            .map(|row| self.measure_drifting(row, &at, drift))
            .collect();
        let run = |(place, fork): (usize, &Fork)| {
            let mut filter = fork.origin().clone();
            for m in &measured[fork.at - oldest..] {
                filter.observe(m, &self.noise, None);
            }
            (place, filter)
        };
        let runs = forks.iter().enumerate().map(run);
        let (place, filter) =
            runs.max_by(|a, b| a.1.log_likelihood.total_cmp(&b.1.log_likelihood))?;
        let row = |place: usize| forks[place].at;
        let first = row(place).max(1);
        Some(CompetingHypothesis {
            kind: EventKind::Drift,
            event: self.events.len() - 1,
            drift,
            first,
            between: RowSpan {
                earliest: row(place.saturating_sub(1)).clamp(1, first),
                latest: row((place + 1).min(forks.len() - 1)).max(first),
            },
            filter,
            before: forks[place].origin().clone(),
        })
    }

    /// Reads row `k` with the competing hypotheses.
    pub(crate) fn observe_competing(&mut self, k: usize) {
        let mut competing = std::mem::take(&mut self.competing);
        for competitor in &mut competing {
            let at = competitor.filter.unknowns();
            let m = self.measure_drifting(k, &at, competitor.drift);
            competitor.filter.observe(&m, &self.noise, None);
        }
        let lower_bound = self.null.log_likelihood - COMPETING_DROPPED_LOG_LIKELIHOOD_RATIO;
        competing
            .retain(|r| r.filter.log_likelihood > lower_bound && k < r.first + COMPETING_MAX_ROWS);
        self.competing = competing;
    }

    /// Replaces the last step by the likeliest competing hypothesis, if that explains the
    /// rows far better, and no less well than another step would.
    pub(crate) fn decide_competing(&mut self, k: usize, leads: &Leads) -> bool {
        let ratio_of = |kind: HypothesisKind| {
            leads[kind as usize].map_or(0.0, |lead| lead.log_likelihood_ratio)
        };
        let (step, transient) = (
            ratio_of(HypothesisKind::Step),
            ratio_of(HypothesisKind::Transient),
        );
        // A drifting vessel may well have returned: a return is simpler.
        let returned = self
            .return_candidate(leads)
            .map_or(0.0, |returned| returned.log_likelihood_ratio);
        let returned = returned.max(ratio_of(HypothesisKind::Return));
        let lead = |competitor: &CompetingHypothesis| {
            competitor.filter.log_likelihood - self.null.log_likelihood
        };
        let later = |competitor: &CompetingHypothesis| {
            let later = competitor.event + 1..self.events.len();
            later.filter(|event| self.is_step_in_force(*event)).count()
        };
        let score = |place: usize| {
            let competitor = &self.competing[place];
            lead(competitor) + priors::SPARED_STEP_LOG_ODDS * later(competitor) as f64
        };
        let likeliest = (0..self.competing.len()).max_by(|&a, &b| score(a).total_cmp(&score(b)));
        let Some(place) = likeliest else {
            return false;
        };
        let (ratio, of) = (lead(&self.competing[place]), self.competing[place].event);
        let mut steps = (of..self.events.len()).filter(|&e| self.is_step_in_force(e));
        let is_drift = self.competing[place].kind == EventKind::Drift;
        let with_cargo = is_drift && steps.all(|event| self.is_cargo_likely(event));
        let mut threshold = if later(&self.competing[place]) > 0 {
            COMPETING_WITH_SEVERAL_LOG_LIKELIHOOD_RATIO
        } else {
            COMPETING_LOG_LIKELIHOOD_RATIO
        };
        if with_cargo {
            // Cargo comes on board at once: no drift precedes it.
            if self.competing[place].first + DRIFT_BEFORE_CARGO_ROWS
                > self.events[of].between.earliest
            {
                return false;
            }
            threshold += DRIFT_WITH_CARGO_EXTRA_LOG_LIKELIHOOD_RATIO;
        }
        if ratio < threshold
            || ratio < step - COMPETING_DEFICIT_LOG_LIKELIHOOD_RATIO
            || ratio < transient
            || ratio < returned
        {
            return false;
        }
        // A second step on the first is far rarer.
        let is_needless = step > COMPETING_LOG_LIKELIHOOD_RATIO;
        if self.competing[place].kind == EventKind::Alignment
            && !is_needless
            && !self.headings_tell_alignment(place, k)
        {
            return false;
        }
        if self.competing[place].kind == EventKind::Alignment {
            let competitor = &self.competing[place];
            let mut step = self.refit_step(k, &competitor.before, competitor.first);
            let zero = self.filter_with_alignment_change(k, &competitor.before, competitor.first);
            let trails = zero.log_likelihood - step.log_likelihood;
            if trails < STEP_KEPT_LOG_LIKELIHOOD_RATIO {
                // Credited transients count for the step, too.
                step.log_likelihood = competitor.filter.log_likelihood - trails;
                self.replace_step(k, of, step);
                return true;
            }
        }
        self.accept_competitor(k, place, ratio);
        true
    }

    /// Puts a competing hypothesis in the place of its step; `ratio` is its log-likelihood ratio
    /// against the step.
    fn accept_competitor(&mut self, k: usize, place: usize, ratio: f64) {
        let competitor = self.competing.swap_remove(place);
        let of = competitor.event;
        self.competing.clear();
        self.returns.forget(of);
        self.remove_later_steps(of);
        let event = &mut self.events[of];
        let replaced = CompetingHypothesis {
            kind: event.kind,
            event: of,
            drift: 0.0,
            first: event.first,
            between: event.between,
            filter: self.null.clone(),
            before: competitor.before.clone(),
        };
        event.kind = competitor.kind;
        event.over_step_log_likelihood_ratio = if competitor.kind == EventKind::Step {
            0.0
        } else {
            ratio
        };
        event.before = snapshot(&competitor.before);
        event.after = snapshot(&competitor.filter);
        (event.first, event.between) = (competitor.first, competitor.between);
        self.extra_drift = match competitor.kind {
            EventKind::Drift => ExtraDrift::from_drift(k, competitor.drift),
            _ => ExtraDrift::default(),
        };
        self.alignment_change = None;
        // Two courses may fit either, and the next one only one.
        let mut competing = Vec::new();
        match competitor.kind {
            EventKind::Alignment => {
                competing.push(replaced);
                self.alignment_change = Some(FilterBefore {
                    event: of,
                    before: competitor.before,
                });
            }
            EventKind::Step => self.revert_to_step(&competitor),
            _ => {}
        }
        self.replace_null(k, competitor.filter, competitor.first);
        self.competing = competing;
    }

    /// Restores a step that had been replaced by an alignment change.
    fn revert_to_step(&mut self, step: &CompetingHypothesis) {
        let at_port = self.began_at_port(step.event);
        if !at_port {
            self.extra_drift = ExtraDrift::from_step(step.first, &step.before, &step.filter);
        }
        self.returns.add_baseline(Baseline {
            event: step.event,
            filter: step.before.clone(),
            origin: if at_port {
                StepOrigin::AtPort
            } else {
                StepOrigin::AtSea
            },
            latest: self.observations[step.between.latest].time,
            port_calls: 0,
        });
    }

    /// Records the log-likelihood ratio of an alignment change against each step where it
    /// is open.
    pub(crate) fn record_alignment_ratios(&mut self) {
        for competitor in self
            .competing
            .iter()
            .filter(|r| r.kind == EventKind::Alignment)
        {
            let ratio = competitor.filter.log_likelihood - self.null.log_likelihood;
            if let Some(event) = self.events.get_mut(competitor.event) {
                event.alignment_over_step_log_likelihood_ratio = Some(ratio);
            }
        }
    }

    /// Returns true if the headings sailed since tell an alignment change from a step: on
    /// one heading, and on two that lie close, a step does the same.
    fn headings_tell_alignment(&self, place: usize, k: usize) -> bool {
        let mut rows = [0; ALIGNMENT_SECTORS];
        for o in &self.observations[self.competing[place].first..=k] {
            rows[(o.compass.degrees() / 360.0 * ALIGNMENT_SECTORS as f64) as usize
                % ALIGNMENT_SECTORS] += 1;
        }
        let is_sailed = |sector: usize| rows[sector % ALIGNMENT_SECTORS] >= ALIGNMENT_SECTOR_ROWS;
        let apart = ALIGNMENT_SECTORS_BETWEEN + 1..ALIGNMENT_SECTORS - ALIGNMENT_SECTORS_BETWEEN;
        (0..ALIGNMENT_SECTORS)
            .any(|one| is_sailed(one) && apart.clone().any(|far| is_sailed(one + far)))
    }

    /// Removes later steps, which were the same change.
    pub(crate) fn remove_later_steps(&mut self, of: usize) {
        let is_removed = |place: usize, event: &Event| match event.kind {
            EventKind::Step => place > of,
            EventKind::Return(step) => step >= of && self.events[step].kind == EventKind::Step,
            _ => false,
        };
        let removed: Vec<bool> = self
            .events
            .iter()
            .enumerate()
            .map(|(p, e)| is_removed(p, e))
            .collect();
        let moved = remove_events(&mut self.events, removed);
        self.transient = self.transient.map(&moved);
        if let Some(fault) = &mut self.reference_fault {
            fault.event = moved(fault.event);
        }
    }

    fn is_cargo_likely(&self, event: usize) -> bool {
        self.began_at_port(event) || self.is_cargo_logged(self.events[event].first)
    }

    fn began_at_port(&self, event: usize) -> bool {
        let RowSpan { earliest, latest } = self.events[event].between;
        (earliest..=latest).any(|row| self.is_port_call(row))
    }

    /// Credits the alternatives with the likelihood that the null filter gains by a
    /// transient.
    pub(crate) fn credit_alternatives(&mut self, kind: HypothesisKind) {
        let gained = self
            .bank
            .lead(kind, &self.null)
            .map_or(0.0, |l| l.log_likelihood_ratio);
        let competing = self
            .competing
            .iter_mut()
            .map(|competitor| &mut competitor.filter);
        let no_steps = self
            .no_step
            .iter_mut()
            .flat_map(|no_step| &mut no_step.without);
        for filter in competing.chain(no_steps) {
            filter.log_likelihood += gained;
        }
    }
}
