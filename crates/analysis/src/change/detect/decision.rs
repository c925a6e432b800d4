//! Decision of the detector: whether the leading hypothesis is accepted.
//!
//! The thresholds are in [`crate::change::thresholds`], the prior odds in
//! [`crate::change::priors`]. Hypotheses are considered in this order: a return at a port
//! call, a competing explanation or the withdrawal of the last step, the repair of a
//! reference, a return at sea, a step or a reference's fault, a transient.

use super::state::{Detector, Leads};
use crate::change::event::{Event, EventKind, RowSpan};
use crate::change::filter::Filter;
use crate::change::hypotheses::Lead;
use crate::change::hypothesis_kind::HypothesisKind;
use crate::change::port_call_returns::{Baseline, ReturnCandidate};
use crate::change::priors;
use crate::change::thresholds::{
    BOTH_REFERENCES_ROWS, CARGO_RETURN_AT_SEA_LOG_LIKELIHOOD_RATIO,
    CLEAR_AGAINST_NULL_LOG_LIKELIHOOD_RATIO, CLEAR_STEP_LOG_LIKELIHOOD_RATIO,
    DRIFTING_EXTRA_LOG_LIKELIHOOD_RATIO, FORK_INTERVAL_ROWS, NEW_VESSEL_EXTRA_LOG_LIKELIHOOD_RATIO,
    NEW_VESSEL_S, ONE_REFERENCE_LOG_LIKELIHOOD_RATIO, ONE_REFERENCE_SHARE,
    REFERENCE_REPAIR_DEFICIT_LOG_LIKELIHOOD_RATIO, REFERENCE_REPAIR_LOG_LIKELIHOOD_RATIO,
    REFERENCE_STEP_LOG_LIKELIHOOD_RATIO, REFERENCE_STEP_MIN_ROWS,
    RETURN_AT_SEA_LOG_LIKELIHOOD_RATIO, RETURN_DEFICIT_LOG_LIKELIHOOD_RATIO,
    RETURN_FOR_STEP_DEFICIT_LOG_LIKELIHOOD_RATIO, RETURN_FOR_STEP_POSTERIOR,
    RETURN_FOR_STEP_ROWS_AFTER, RETURN_FOR_STEP_ROWS_BEFORE, RETURN_POSTERIOR,
    STEP_LOG_LIKELIHOOD_RATIO, STEP_MIN_ROWS, TRANSIENT_LOG_LIKELIHOOD_RATIO,
    TRANSIENT_OVER_CHANGE_LOG_LIKELIHOOD_RATIO, VESSEL_OR_REFERENCE_LOG_LIKELIHOOD_RATIO,
};
use crate::observation::Observation;

impl Detector<'_> {
    /// Decides at row `k` whether the leading hypothesis is accepted.
    pub(crate) fn decide(&mut self, k: usize) {
        let leads = self.leads();
        let ratio = |kind: HypothesisKind| {
            leads[kind as usize].map_or(0.0, |lead| lead.log_likelihood_ratio)
        };
        if k < self.warm_up_rows() {
            return self.decide_transient(k, leads);
        }
        let transient = ratio(HypothesisKind::Transient).max(0.0);
        let returned = ratio(HypothesisKind::Return);
        if let Some(return_candidate) = self.return_candidate(&leads)
            && return_candidate.probability > RETURN_POSTERIOR
        {
            return self.accept_port_call_return(k, return_candidate, leads);
        }
        if self.reference_fault.is_none()
            && (self.decide_competing(k, &leads) || self.decide_withdrawal(k, &leads))
        {
            return;
        }
        let largest_change = ratio(HypothesisKind::Step).max(ratio(HypothesisKind::ReferenceStep));
        if self.reference_fault.is_some()
            && returned - transient > REFERENCE_REPAIR_LOG_LIKELIHOOD_RATIO
            && returned > largest_change - REFERENCE_REPAIR_DEFICIT_LOG_LIKELIHOOD_RATIO
        {
            return self.accept_reference_repair(k, leads);
        }
        let baseline = self.returns.baselines.last();
        let threshold = if self.alignment_change.is_none()
            && baseline.is_some_and(Baseline::began_at_port_call)
        {
            CARGO_RETURN_AT_SEA_LOG_LIKELIHOOD_RATIO
        } else {
            RETURN_AT_SEA_LOG_LIKELIHOOD_RATIO
        };
        if self.reference_fault.is_none()
            && returned - transient > threshold
            && returned > ratio(HypothesisKind::Step)
        {
            return self.accept_return(k, leads);
        }
        let (kind, lasting, other) =
            if ratio(HypothesisKind::Step) >= ratio(HypothesisKind::ReferenceStep) {
                (
                    HypothesisKind::Step,
                    ratio(HypothesisKind::Step),
                    ratio(HypothesisKind::ReferenceStep),
                )
            } else {
                (
                    HypothesisKind::ReferenceStep,
                    ratio(HypothesisKind::ReferenceStep),
                    ratio(HypothesisKind::Step),
                )
            };
        let over_transient = lasting - transient;
        // On one heading one reference cannot tell its own fault from a change of the
        // vessel.
        let clear = lasting - self.prior_log_odds(kind, &leads) - other.max(0.0);
        let is_clear =
            clear > VESSEL_OR_REFERENCE_LOG_LIKELIHOOD_RATIO || self.has_both_references(k);
        let is_accepted = is_clear
            && match kind {
                HypothesisKind::ReferenceStep => {
                    self.has_lasted(REFERENCE_STEP_MIN_ROWS, kind, k, &leads)
                        && over_transient > REFERENCE_STEP_LOG_LIKELIHOOD_RATIO
                }
                _ => {
                    self.has_lasted(STEP_MIN_ROWS, kind, k, &leads)
                        && self.passes_step_threshold(k, lasting, over_transient, &leads)
                }
            };
        if is_accepted {
            let returned =
                self.return_candidate_within(&leads, RETURN_FOR_STEP_DEFICIT_LOG_LIKELIHOOD_RATIO);
            if let Some(returned) = returned.filter(|returned| self.replaces_step(&leads, returned))
                && kind == HypothesisKind::Step
            {
                return self.accept_port_call_return(k, returned, leads);
            }
            if kind == HypothesisKind::Step && self.is_discharge(k, &leads) {
                return self.accept_return(k, leads);
            }
            return self.accept_change(k, kind, leads);
        }
        self.decide_transient(k, leads);
    }

    /// Decides whether a transient is accepted, where no lasting change was.
    fn decide_transient(&mut self, k: usize, leads: Leads) {
        let ratio = |kind: HypothesisKind| {
            leads[kind as usize].map_or(0.0, |lead| lead.log_likelihood_ratio)
        };
        let transient = ratio(HypothesisKind::Transient);
        let lasting = ratio(HypothesisKind::Step).max(ratio(HypothesisKind::ReferenceStep));
        if self.transient.is_none()
            && transient > TRANSIENT_LOG_LIKELIHOOD_RATIO + self.new_vessel_extra(k)
            && transient - lasting > TRANSIENT_OVER_CHANGE_LOG_LIKELIHOOD_RATIO
            && leads[HypothesisKind::Transient as usize]
                .is_some_and(|lead| self.has_enough_rows(k, lead))
        {
            let Some(lead) = leads[HypothesisKind::Transient as usize] else {
                return;
            };
            let first = self.transient_start(lead);
            match self.same_transient(first) {
                // A past transient keeps its lead, but is reported once.
                Some(event) if event.confirmed => return,
                Some(_) => _ = self.events.pop(),
                None => {}
            }
            self.transient = Some(self.events.len());
            self.before_transient = self.last_fork_before(first);
            self.weak_transient = None;
            self.record_event(
                k,
                EventKind::Transient,
                first,
                RowSpan::at(first),
                leads,
                None,
            );
        } else {
            self.note_weak_transient(k, leads, transient - lasting);
        }
    }

    /// Returns true if a severe transient has lasted beyond a few wild readings.
    fn has_enough_rows(&self, k: usize, lead: Lead) -> bool {
        lead.kind != HypothesisKind::SevereTransient
            || k + 1 >= self.bank.forks[lead.fork].at + STEP_MIN_ROWS
    }

    /// Returns the extra threshold while the vessel drifts, because a drift goes on.
    fn drifting_extra(&self, k: usize) -> f64 {
        if self.extra_drift.is_drifting(self.observations, k) {
            DRIFTING_EXTRA_LOG_LIKELIHOOD_RATIO
        } else {
            0.0
        }
    }

    /// Returns the extra threshold while little is known of the vessel's noise.
    fn new_vessel_extra(&self, k: usize) -> f64 {
        let since = self.observations[0].time.zip(self.observations[k].time);
        let is_new = since.is_some_and(|(first, now)| now.seconds_since(first) < NEW_VESSEL_S);
        if is_new && !self.is_noise_known {
            NEW_VESSEL_EXTRA_LOG_LIKELIHOOD_RATIO
        } else {
            0.0
        }
    }

    /// Returns the last fork up to a row, and its filter before the jump.
    fn last_fork_before(&self, row: usize) -> Option<(usize, Filter)> {
        let mut forks = self.bank.forks.iter();
        let fork = forks.rfind(|fork| fork.at <= row)?;
        Some((fork.at, fork.origin().clone()))
    }

    /// Returns the last event, if it is this transient.
    pub(crate) fn same_transient(&self, first: usize) -> Option<&Event> {
        let last = self.events.last();
        last.filter(|event| {
            event.kind == EventKind::Transient && event.first + FORK_INTERVAL_ROWS >= first
        })
    }

    /// Returns the first row of a transient.
    pub(crate) fn transient_start(&self, lead: Lead) -> usize {
        let fork = &self.bank.forks[lead.fork];
        let over = fork.transient_from.filter(|_| self.is_transient_over(lead));
        over.unwrap_or(fork.at)
    }

    fn has_lasted(&self, rows: usize, kind: HypothesisKind, k: usize, leads: &Leads) -> bool {
        leads[kind as usize].is_some_and(|lead| k + 1 >= self.bank.forks[lead.fork].at + rows)
    }

    /// Returns the prior log odds of the leading hypothesis against one at another time.
    fn prior_log_odds(&self, kind: HypothesisKind, leads: &Leads) -> f64 {
        leads[kind as usize].map_or(0.0, |lead| self.bank.prior_log_odds(lead))
    }

    /// Returns true if a step leads by enough to be accepted.
    pub(crate) fn passes_step_threshold(
        &self,
        k: usize,
        lead: f64,
        over_transient: f64,
        leads: &Leads,
    ) -> bool {
        let step = leads[HypothesisKind::Step as usize];
        // A large step would explain the first hour of a storm, too.
        let is_usual = step.is_some_and(|lead| lead.kind == HypothesisKind::Step);
        // A step that is likelier beforehand must be as clear from the rows.
        let beforehand = self.prior_log_odds(HypothesisKind::Step, leads);
        if over_transient - beforehand <= CLEAR_STEP_LOG_LIKELIHOOD_RATIO
            || (over_transient
                <= STEP_LOG_LIKELIHOOD_RATIO + self.new_vessel_extra(k) + self.drifting_extra(k)
                && !(is_usual && lead - beforehand > CLEAR_AGAINST_NULL_LOG_LIKELIHOOD_RATIO))
        {
            return false;
        }
        let since = step.map_or(k, |lead| self.bank.forks[lead.fork].at);
        let with_one = |rows: &[Observation]| {
            let one = rows.iter().filter(|o| o.gyro_less_satellite_deg.is_none());
            one.count() as f64 > ONE_REFERENCE_SHARE * rows.len() as f64
        };
        let usually = &self.observations[..since.max(1)];
        let lost_reference = with_one(&self.observations[since..=k]) && !with_one(usually);
        over_transient > ONE_REFERENCE_LOG_LIKELIHOOD_RATIO || !lost_reference
    }

    /// Returns the likeliest return at a port call, unless a step to another state is far
    /// likelier.
    pub(crate) fn return_candidate(&self, leads: &Leads) -> Option<ReturnCandidate> {
        self.return_candidate_within(leads, RETURN_DEFICIT_LOG_LIKELIHOOD_RATIO)
    }

    fn return_candidate_within(&self, leads: &Leads, deficit: f64) -> Option<ReturnCandidate> {
        let ratio = |kind: HypothesisKind| {
            leads[kind as usize].map_or(0.0, |lead| lead.log_likelihood_ratio)
        };
        let transient =
            (ratio(HypothesisKind::Transient) - priors::RETURN_OVER_TRANSIENT_LOG_ODDS).max(0.0);
        let is_disturbed = self.transient.is_some()
            && ratio(HypothesisKind::Transient) > ratio(HypothesisKind::Step);
        let likeliest = self
            .returns
            .likeliest(&self.null, transient, is_disturbed)?;
        (is_disturbed || likeliest.log_likelihood_ratio > ratio(HypothesisKind::Step) - deficit)
            .then_some(likeliest)
    }

    /// Returns true if a certain step is rather the discharge of cargo: a return explains
    /// the rows better, with nothing left free, and the vessel was in port at about that
    /// time. A few disturbed readings just before may speak against a return at the call
    /// itself.
    fn is_discharge(&self, k: usize, leads: &Leads) -> bool {
        let [step, _, _, returned] = *leads;
        step.zip(returned).is_some_and(|(step, returned)| {
            let at = self.bank.forks[returned.fork].at;
            returned.log_likelihood_ratio > step.log_likelihood_ratio
                && self.discharge_near(at, k).is_some()
        })
    }

    /// Returns the port call near row `at`, up to row `k`, at which cargo may have been
    /// discharged.
    pub(crate) fn discharge_near(&self, at: usize, k: usize) -> Option<usize> {
        let baseline = self
            .returns
            .baselines
            .last()
            .filter(|base| base.is_cargo())?;
        if self.alignment_change.is_some() || self.reference_fault.is_some() {
            return None;
        }
        let loaded = self.events[baseline.event].first;
        let rows = at.saturating_sub(RETURN_FOR_STEP_ROWS_AFTER)
            ..=(at + RETURN_FOR_STEP_ROWS_BEFORE).min(k);
        let calls = rows.filter(|row| *row > loaded && self.is_port_call(*row));
        calls.min_by_key(|row| row.abs_diff(at))
    }

    /// Returns true if a return at this call may replace a certain step.
    fn replaces_step(&self, leads: &Leads, returned: &ReturnCandidate) -> bool {
        let step = leads[HypothesisKind::Step as usize].map(|lead| self.bank.forks[lead.fork].at);
        let near = returned.at.saturating_sub(RETURN_FOR_STEP_ROWS_BEFORE)
            ..=returned.at + RETURN_FOR_STEP_ROWS_AFTER;
        returned.probability > RETURN_FOR_STEP_POSTERIOR
            && step.is_some_and(|at| near.contains(&at))
    }

    /// Returns true if both references were read lately.
    pub(crate) fn has_both_references(&self, k: usize) -> bool {
        let lately = &self.observations[k.saturating_sub(BOTH_REFERENCES_ROWS)..=k];
        lately.iter().any(|o| o.gyro_less_satellite_deg.is_some())
    }

    /// Returns true if the leading transient is over.
    pub(crate) fn is_transient_over(&self, lead: Lead) -> bool {
        let over = self.bank.lead(HypothesisKind::TransientEnd, &self.null);
        over.is_some_and(|over| {
            over.fork == lead.fork && over.log_likelihood_ratio >= lead.log_likelihood_ratio
        })
    }
}
