//! A large step that is neither certain nor out of question when the rows end.
//!
//! What always holds: it is no event; until the rows tell, the band is to hold both the ship
//! that she was and the one that she may be.

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

/// The rows are linearised so often, each time at the ship that the last supposed: deviation
/// is not linear in a large step.
const LINEARISATION_ROUNDS: usize = 4;
/// Of so many rows the middle one is astray while a compass is.
const MEDIAN_ROWS: usize = 3;
/// Where H is this, an error of the variation has its nominal size.
const NOMINAL_H_NT: f64 = 24_000.0;

impl Detector<'_> {
    /// What the step that may have been adds to the variance of bx and by, nT².
    pub(crate) fn undecided_step_nt2(&self, leads: &Leads) -> Option<f64> {
        let last = self.observations.len().checked_sub(1)?;
        let others = leads.iter().flatten().map(|lead| lead.log_likelihood_ratio);
        let likeliest = others.fold(0.0, f64::max);
        let passed = self
            .before_transient
            .as_ref()
            .filter(|(at, _)| last < at + UNDECIDED_STEP_ROWS);
        if likeliest < UNDECIDED_STEP_LOG_LIKELIHOOD_RATIO && passed.is_none() {
            return None;
        }
        let forks = self
            .bank
            .forks
            .iter()
            .filter(|s| last < s.at + UNDECIDED_STEP_ROWS);
        let forks = forks.map(|fork| (fork.at, fork.origin()));
        let open = forks
            .chain(passed.map(|(at, before)| (*at, before)))
            // The reading in which it happened is of neither ship.
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
        let wild = self.severe_transient_nt(leads, last);
        let seen_nt = open.into_iter().chain(wild).max_by(f64::total_cmp)?;
        Some(unseen_sd_nt(seen_nt).powi(2))
    }

    /// How far the compass is astray now, as a field in nT, while it swings by more than any
    /// storm makes it: whatever that is, the base model does not say what she shows.
    fn severe_transient_nt(&self, leads: &Leads, last: usize) -> Option<f64> {
        let lead = leads[HypothesisKind::Transient as usize]
            .filter(|lead| lead.kind == HypothesisKind::SevereTransient)?;
        let fork = &self.bank.forks[lead.fork];
        let origin = fork.origin();
        let at = origin.unknowns();
        let rows = fork.at.max((last + 1).saturating_sub(MEDIAN_ROWS))..=last;
        let astray = rows.map(|row| origin.variation_innovation_deg(&self.measure(row, &at)));
        let mut astray: Vec<f64> = astray.collect();
        if astray.len() < MEDIAN_ROWS {
            return None;
        }
        astray.sort_by(f64::total_cmp);
        let median = astray
            .get(astray.len() / 2)
            .filter(|deg| **deg > SEVERE_TRANSIENT_DEG)?;
        Some(median.to_radians().min(1.0) * NOMINAL_H_NT)
    }

    /// The filter of a ship that was as `before` until the end of the rows `undisturbed_rows`, and struck
    /// then, at the last row.
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
