//! Large steps that are neither certain nor excluded when the rows end.
//!
//! Such a step is no event. The band covers both states of the vessel until later rows
//! decide.

use super::state::{Detector, Leads};
use crate::change::filter::Filter;
use crate::change::hypothesis_kind::HypothesisKind;
use crate::change::jump_models::apply_large_step;
use crate::change::thresholds::{
    EXCLUDED_STEP_LOG_LIKELIHOOD_RATIO, SEVERE_TRANSIENT_DEG, UNDECIDED_STEP_LOG_LIKELIHOOD_RATIO,
    UNDECIDED_STEP_MIN_SIZE, UNDECIDED_STEP_ROWS,
};
use crate::estimate::{POPULATION_SD, unseen_sd_nt};
use std::ops::Range;

/// Rounds in which the rows are linearised at the state of the last round: deviation is not
/// linear in a large step.
const LINEARISATION_ROUNDS: usize = 4;
/// Number of rows whose median innovation counts.
const MEDIAN_ROWS: usize = 3;
/// Horizontal field at which the variation's error has its nominal size.
const NOMINAL_H_NT: f64 = 24_000.0;

impl Detector<'_> {
    /// Returns the variance that a possible step adds to bx and to by, nT².
    pub(crate) fn undecided_step_nt2(&self, leads: &Leads) -> Option<f64> {
        let last = self.observations.len().checked_sub(1)?;
        let others = leads.iter().flatten().map(|lead| lead.log_likelihood_ratio);
        let likeliest = others.fold(0.0, f64::max);
        let past_transient = self
            .before_transient
            .as_ref()
            .filter(|(at, _)| last < at + UNDECIDED_STEP_ROWS);
        if likeliest < UNDECIDED_STEP_LOG_LIKELIHOOD_RATIO && past_transient.is_none() {
            return None;
        }
        let forks = self
            .bank
            .forks
            .iter()
            .filter(|s| last < s.at + UNDECIDED_STEP_ROWS);
        let forks = forks.map(|fork| (fork.at, fork.origin()));
        let open = forks
            .chain(past_transient.map(|(at, before)| (*at, before)))
            // The reading during the step fits neither state.
            .flat_map(|(at, before)| [at, at + 1].map(|first| (at, first, before)))
            .filter_map(|(at, first, before)| {
                let after = self.filter_after_large_step(at..first, before);
                let ratio = after.log_likelihood - self.null.log_likelihood;
                let size = after.permanent_distance(before);
                let is_open = size > UNDECIDED_STEP_MIN_SIZE
                    && ratio
                        > UNDECIDED_STEP_LOG_LIKELIHOOD_RATIO
                            .max(likeliest - EXCLUDED_STEP_LOG_LIKELIHOOD_RATIO);
                is_open.then_some((ratio, size))
            })
            .max_by(|a, b| a.0.total_cmp(&b.0))
            .map(|(_, size)| size * POPULATION_SD[0]);
        let severe = self.severe_transient_nt(leads, last);
        let seen_nt = open.into_iter().chain(severe).max_by(f64::total_cmp)?;
        Some(unseen_sd_nt(seen_nt).powi(2))
    }

    /// Returns the present innovation as a field in nT, during a severe transient: the
    /// model does not describe what the compass shows then.
    fn severe_transient_nt(&self, leads: &Leads, last: usize) -> Option<f64> {
        let lead = leads[HypothesisKind::Transient as usize]
            .filter(|lead| lead.kind == HypothesisKind::SevereTransient)?;
        let fork = &self.bank.forks[lead.fork];
        let origin = fork.origin();
        let at = origin.unknowns();
        let rows = fork.at.max((last + 1).saturating_sub(MEDIAN_ROWS))..=last;
        let innovations_deg =
            rows.map(|row| origin.variation_innovation_deg(&self.measure(row, &at)));
        let mut innovations_deg: Vec<f64> = innovations_deg.collect();
        if innovations_deg.len() < MEDIAN_ROWS {
            return None;
        }
        innovations_deg.sort_by(f64::total_cmp);
        let median = innovations_deg
            .get(innovations_deg.len() / 2)
            .filter(|deg| **deg > SEVERE_TRANSIENT_DEG)?;
        Some(median.to_radians().min(1.0) * NOMINAL_H_NT)
    }

    /// Returns the filter of a vessel in the state `before` during some rows, with a large
    /// step at their end, after all rows.
    fn filter_after_large_step(&self, undisturbed_rows: Range<usize>, before: &Filter) -> Filter {
        let first = undisturbed_rows.end;
        let before = self.run_filter(before.clone(), undisturbed_rows, &before.unknowns());
        let begun = apply_large_step(&before);
        let rows = first..self.observations.len();
        let mut after = before;
        for _ in 0..LINEARISATION_ROUNDS {
            after = self.run_filter(begun.clone(), rows.clone(), &after.unknowns());
        }
        after
    }
}
