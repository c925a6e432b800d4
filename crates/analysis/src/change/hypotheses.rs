//! Alternative hypotheses: filters forked at earlier rows, each with one jump applied.
//!
//! Hypotheses of a step always run. The other kinds run only while a step leads or
//! innovations are excessive in one row after another. They start from the filters at the
//! forks and the recent measurements, and stop when nothing leads.
//!
//! At most [`CAPACITY`] forks are kept, at ages spaced about geometrically; the fork of the
//! likeliest hypothesis of every kind is among them.

use super::filter::{Filter, Measurement, NoiseVariances};
use super::hypothesis_kind::{
    ALL_KINDS, HypothesisKind, OTHER_KINDS, REFERENCE_STEPS, STEPS, TRANSIENTS,
};
use super::jump_models::{
    EarlierState, USUAL_TRANSIENT, apply_jump, apply_reference_step, reset_variation,
    transient_noise,
};
use crate::change::thresholds::{
    AWAKE_MIN_ROWS, ROW_FORGOTTEN_EXCESS_LOSS, ROW_MAX_EXCESS_LOSS, SEVERE_TRANSIENT_DEG,
    SLEEP_LOG_LIKELIHOOD_RATIO, STEP_DROPPED_LOG_LIKELIHOOD_RATIO, STEP_DROPPED_MIN_ROWS,
    TRANSIENT_END_FORK_LOG_LIKELIHOOD_RATIO, TRANSIENT_MAX_S, WAKE_EXCESS_LOSS,
    WAKE_LOG_LIKELIHOOD_RATIO,
};
use std::collections::VecDeque;

/// Greatest number of forks.
const CAPACITY: usize = 16;
/// Age at which a fork is dropped, rows.
const MAX_AGE_ROWS: usize = 4320;
/// Number of recent measurements from which the other hypotheses start.
const REMEMBERED_ROWS: usize = 432;

/// Filters that share the row of their jump.
#[derive(Clone, Debug)]
pub(crate) struct Fork {
    /// First row after the jump.
    pub(crate) at: usize,
    /// The filter before the jump; boxed, because forks move when one is dropped.
    origin: Box<Filter>,
    /// First row of the transient whose end is supposed.
    pub(crate) transient_from: Option<usize>,
    /// Filters by kind; boxed, because most are none.
    hypotheses: [Option<Box<Filter>>; ALL_KINDS.len()],
    age_s: f64,
    /// Greatest innovation since, degrees where H is 24 µT.
    disturbance_deg: f64,
    /// True if the next reading gives the size of a reference's step.
    awaits_reading: bool,
    /// Prior log odds of the step here, against a step at sea.
    prior_log_odds: f64,
}

impl Fork {
    /// Starts the hypotheses of all kinds but steps.
    fn start_other_hypotheses(&mut self, earlier_state: Option<EarlierState<'_>>) {
        let now = &self.origin;
        for kind in REFERENCE_STEPS {
            self.hypotheses[kind as usize] = Some(now.clone());
        }
        self.hypotheses[HypothesisKind::Transient as usize] =
            Some(Box::new(apply_jump(now, HypothesisKind::Transient)));
        self.hypotheses[HypothesisKind::Return as usize] =
            earlier_state.map(|earlier_state| Box::new(earlier_state.restore(now)));
        self.awaits_reading = true;
    }

    /// Reads a row with hypotheses of some kinds, except large steps, which read rows
    /// linearised at their own state.
    fn observe(&mut self, m: &Measurement, noise: &NoiseVariances, kinds: &[HypothesisKind]) {
        let goes_on = self.age_s < TRANSIENT_MAX_S;
        self.age_s += m.seconds;
        if let Some(transient) = &self.hypotheses[HypothesisKind::Transient as usize] {
            self.disturbance_deg = self
                .disturbance_deg
                .max(self.origin.variation_innovation_deg(m));
            if self.disturbance_deg > SEVERE_TRANSIENT_DEG
                && self.hypotheses[HypothesisKind::SevereTransient as usize].is_none()
            {
                self.hypotheses[HypothesisKind::SevereTransient as usize] = Some(transient.clone());
            }
        }
        let transient = |kind: HypothesisKind| match kind {
            HypothesisKind::Transient if goes_on => Some(USUAL_TRANSIENT),
            HypothesisKind::SevereTransient if goes_on => {
                Some(transient_noise(self.disturbance_deg))
            }
            _ => None,
        };
        if kinds.contains(&HypothesisKind::ReferenceStep)
            && std::mem::take(&mut self.awaits_reading)
        {
            if m.difference.is_none() {
                // The kind of a lone reference does not matter: one hypothesis suffices.
                self.hypotheses[HypothesisKind::SatelliteStep as usize] = None;
            }
            for kind in REFERENCE_STEPS {
                if let Some(hypothesis) = &mut self.hypotheses[kind as usize] {
                    **hypothesis = apply_reference_step(hypothesis, m, kind);
                }
            }
        }
        for &kind in kinds
            .iter()
            .filter(|kind| **kind != HypothesisKind::LargeStep)
        {
            let transient = transient(kind);
            if let Some(hypothesis) = &mut self.hypotheses[kind as usize] {
                hypothesis.observe(m, noise, transient.as_ref());
            }
        }
    }

    pub(crate) fn origin(&self) -> &Filter {
        &self.origin
    }

    pub(crate) fn hypothesis(&self, kind: HypothesisKind) -> Option<&Filter> {
        self.hypotheses[kind as usize].as_deref()
    }

    pub(crate) fn hypothesis_mut(&mut self, kind: HypothesisKind) -> Option<&mut Filter> {
        self.hypotheses[kind as usize].as_deref_mut()
    }

    pub(crate) fn set_hypothesis(&mut self, kind: HypothesisKind, hypothesis: Filter) {
        self.hypotheses[kind as usize] = Some(Box::new(hypothesis));
    }

    pub(crate) fn disturbance_deg(&self) -> f64 {
        self.disturbance_deg
    }
}

/// The leading hypothesis of a kind.
#[derive(Clone, Copy, Debug)]
pub(crate) struct Lead {
    pub(crate) log_likelihood_ratio: f64,
    pub(crate) kind: HypothesisKind,
    /// Place of its fork in the bank.
    pub(crate) fork: usize,
}

#[derive(Default)]
pub(crate) struct HypothesisBank {
    /// Forks, from the oldest to the latest.
    pub(crate) forks: Vec<Fork>,
    /// Recent measurements, the latest last, and the latest row.
    recent: VecDeque<Measurement>,
    latest_row: usize,
    other_kinds_run: bool,
    /// Row until which the other hypotheses run at least.
    run_others_until: usize,
    /// Sum of excess losses since the other hypotheses last started.
    excess_loss: f64,
}

impl HypothesisBank {
    /// Drops the hypotheses of lasting changes.
    pub(crate) fn drop_lasting(&mut self) {
        let lasting = [
            HypothesisKind::Step,
            HypothesisKind::LargeStep,
            HypothesisKind::ReferenceStep,
            HypothesisKind::SatelliteStep,
        ];
        for fork in &mut self.forks {
            for kind in lasting {
                fork.hypotheses[kind as usize] = None;
            }
        }
    }

    /// Drops all hypotheses.
    pub(crate) fn clear(&mut self) {
        self.forks.clear();
        self.other_kinds_run = false;
    }

    /// Forks the filter `now` before row `at`.
    pub(crate) fn fork(
        &mut self,
        at: usize,
        now: &Filter,
        noise: &NoiseVariances,
        earlier_state: Option<EarlierState<'_>>,
        step_prior_log_odds: f64,
    ) {
        self.thin(at, now);
        self.stop_idle_hypotheses(at, now);
        let mut fork = Fork {
            at,
            transient_from: None,
            origin: Box::new(now.clone()),
            hypotheses: [const { None }; ALL_KINDS.len()],
            age_s: 0.0,
            disturbance_deg: 0.0,
            awaits_reading: false,
            prior_log_odds: step_prior_log_odds,
        };
        let mut step = apply_jump(now, HypothesisKind::Step);
        step.log_likelihood += fork.prior_log_odds;
        fork.hypotheses[HypothesisKind::Step as usize] = Some(Box::new(step));
        if self.other_kinds_run {
            fork.start_other_hypotheses(earlier_state);
            let transient = self.likeliest(&TRANSIENTS, now);
            if let Some(lead) = transient
                .filter(|lead| lead.log_likelihood_ratio > TRANSIENT_END_FORK_LOG_LIKELIHOOD_RATIO)
            {
                let transient = &self.forks[lead.fork];
                fork.transient_from = Some(transient.at);
                let ended = transient
                    .hypothesis(lead.kind)
                    .map(|hypothesis| match lead.kind {
                        HypothesisKind::SevereTransient => reset_variation(hypothesis, noise),
                        _ => hypothesis.clone(),
                    });
                fork.hypotheses[HypothesisKind::TransientEnd as usize] = ended.map(Box::new);
            }
        }
        self.forks.push(fork);
    }

    /// Reads row `at`, which `null` has read before with this excess loss.
    pub(crate) fn observe(
        &mut self,
        at: usize,
        m: Measurement,
        noise: &NoiseVariances,
        null: &Filter,
        excess_loss: f64,
        earlier_state: Option<EarlierState<'_>>,
    ) {
        for fork in &mut self.forks {
            fork.observe(&m, noise, &ALL_KINDS);
        }
        if self.recent.len() == REMEMBERED_ROWS {
            self.recent.pop_front();
        }
        self.recent.push_back(m);
        self.latest_row = at;
        let counted = excess_loss.min(ROW_MAX_EXCESS_LOSS) - ROW_FORGOTTEN_EXCESS_LOSS;
        self.excess_loss = (self.excess_loss + counted).max(0.0);
        let step = self
            .lead(HypothesisKind::Step, null)
            .map_or(0.0, |lead| lead.log_likelihood_ratio);
        let is_excessive = self.excess_loss > WAKE_EXCESS_LOSS;
        if is_excessive {
            self.excess_loss = 0.0;
            self.run_others_until = at + AWAKE_MIN_ROWS;
        }
        if (is_excessive || step > WAKE_LOG_LIKELIHOOD_RATIO) && !self.other_kinds_run {
            self.start_other_hypotheses(noise, earlier_state);
        }
    }

    /// Starts the other hypotheses as if they had run all along.
    fn start_other_hypotheses(
        &mut self,
        noise: &NoiseVariances,
        earlier_state: Option<EarlierState<'_>>,
    ) {
        self.other_kinds_run = true;
        let known_from = self.latest_row + 1 - self.recent.len();
        for fork in self.forks.iter_mut().filter(|s| s.at >= known_from) {
            fork.start_other_hypotheses(earlier_state);
            fork.age_s = 0.0;
            fork.disturbance_deg = 0.0;
            for m in self.recent.iter().skip(fork.at - known_from) {
                fork.observe(m, noise, &OTHER_KINDS);
            }
        }
    }

    /// Stops the other hypotheses when nothing leads, and drops steps that trail.
    fn stop_idle_hypotheses(&mut self, at: usize, null: &Filter) {
        let leads = ALL_KINDS.map(|kind| {
            self.lead(kind, null)
                .map_or(0.0, |lead| lead.log_likelihood_ratio)
        });
        if at >= self.run_others_until
            && leads
                .iter()
                .all(|ratio| *ratio < SLEEP_LOG_LIKELIHOOD_RATIO)
        {
            self.other_kinds_run = false;
            for fork in &mut self.forks {
                for kind in ALL_KINDS
                    .into_iter()
                    .filter(|kind| *kind != HypothesisKind::Step)
                {
                    fork.hypotheses[kind as usize] = None;
                }
            }
        }
        let lower_bound = null.log_likelihood - STEP_DROPPED_LOG_LIKELIHOOD_RATIO;
        for fork in self
            .forks
            .iter_mut()
            .filter(|s| at - s.at > STEP_DROPPED_MIN_ROWS)
        {
            let step = &mut fork.hypotheses[HypothesisKind::Step as usize];
            if step
                .as_ref()
                .is_some_and(|s| s.log_likelihood <= lower_bound)
            {
                *step = None;
            }
        }
    }

    /// Returns the leading hypothesis of a kind.
    pub(crate) fn lead(&self, kind: HypothesisKind, null: &Filter) -> Option<Lead> {
        // While stopped there are none.
        if kind != HypothesisKind::Step && !self.other_kinds_run {
            return None;
        }
        let leads = self.forks.iter().enumerate();
        leads
            .filter_map(|(fork, s)| {
                let ratio = s.hypothesis(kind)?.log_likelihood - null.log_likelihood;
                Some(Lead {
                    log_likelihood_ratio: ratio,
                    kind,
                    fork,
                })
            })
            .max_by(|a, b| a.log_likelihood_ratio.total_cmp(&b.log_likelihood_ratio))
    }

    /// Returns the prior log odds of the leading step against one at another time.
    pub(crate) fn prior_log_odds(&self, lead: Lead) -> f64 {
        match lead.kind {
            HypothesisKind::Step => self.forks[lead.fork].prior_log_odds,
            _ => 0.0,
        }
    }

    pub(crate) fn other_kinds_run(&self) -> bool {
        self.other_kinds_run
    }

    /// Returns the leading hypothesis of a lasting change of the vessel.
    pub(crate) fn step(&self, null: &Filter) -> Option<Lead> {
        self.likeliest(&STEPS, null)
    }

    /// Returns the leading hypothesis of a transient, ended or not.
    pub(crate) fn transient_lead(&self, null: &Filter) -> Option<Lead> {
        self.likeliest(
            &[
                HypothesisKind::Transient,
                HypothesisKind::SevereTransient,
                HypothesisKind::TransientEnd,
            ],
            null,
        )
    }

    /// Returns the leading hypothesis of a reference's step.
    pub(crate) fn reference_step(&self, null: &Filter) -> Option<Lead> {
        self.likeliest(&REFERENCE_STEPS, null)
    }

    fn likeliest(&self, kinds: &[HypothesisKind], null: &Filter) -> Option<Lead> {
        let leads = kinds.iter().filter_map(|kind| self.lead(*kind, null));
        leads.max_by(|a, b| a.log_likelihood_ratio.total_cmp(&b.log_likelihood_ratio))
    }

    /// Drops forks that are too old, and the closest one to make room.
    fn thin(&mut self, at: usize, null: &Filter) {
        self.forks.retain(|s| at - s.at <= MAX_AGE_ROWS);
        if self.forks.len() < CAPACITY {
            return;
        }
        let leaders = ALL_KINDS.map(|kind| self.lead(kind, null).map(|lead| lead.fork));
        let age = |i: usize| (at - self.forks[i].at) as f64;
        let closest = (1..self.forks.len() - 1)
            .filter(|&i| !leaders.contains(&Some(i)))
            .min_by(|&i, &j| {
                let gap = |i: usize| age(i - 1) / age(i + 1);
                gap(i).total_cmp(&gap(j))
            });
        if let Some(closest) = closest {
            self.forks.remove(closest);
        }
    }
}
