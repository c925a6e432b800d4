//! Returns to an earlier state at port calls: cargo is discharged in port, where it was
//! loaded.
//!
//! At most [`MAX_PORT_CALLS`] calls and [`MAX_BASELINES`] earlier states are kept, and
//! unlikely returns are dropped, so that the work per row is bounded.

use super::filter::{Filter, Measurement, NoiseVariances};
use super::jump_models::restore_vessel;
use super::likelihood_ratio::LIKELIHOOD_TEMPER;
use crate::change::priors;
use crate::change::thresholds::RETURN_DROPPED_LOG_LIKELIHOOD_RATIO;
use crate::estimate::Unknowns;
use binnacle_compass::time::Timestamp;

/// Greatest numbers of port calls and of earlier states; the latest are kept.
const MAX_PORT_CALLS: usize = 4;
const MAX_BASELINES: usize = 3;

/// Logbook entries of cargo at a port call.
#[derive(Clone, Copy, Debug)]
pub(crate) enum LoggedCargo {
    Nothing,
    /// Cargo that was loaded at `loaded` or later was discharged, and none stayed.
    Discharged {
        loaded: Timestamp,
        /// True if the vessel lay in port then, by the rows.
        at_port: bool,
    },
    /// Some cargo stayed on board.
    OnBoard,
}

/// Origin of a step, by rows and logbook.
pub(crate) enum StepOrigin {
    AtPort,
    /// At sea, soon after the logbook has cargo loaded.
    LoggedLoading,
    /// At a port call, or at sea in the days after it.
    NoticedLate,
    /// At sea, soon after a port call; the filter is that of the departure, with any cargo
    /// on board.
    SoonAfter(Box<Filter>),
    AtSea,
}

/// State of the vessel before a step.
pub(crate) struct Baseline {
    /// Place of the step in the list of events.
    pub(crate) event: usize,
    pub(crate) filter: Filter,
    pub(crate) origin: StepOrigin,
    /// Latest possible time of the step.
    pub(crate) latest: Option<Timestamp>,
    /// Number of port calls since.
    pub(crate) port_calls: i32,
}

impl Baseline {
    /// Returns the probability of a return at the next port call: a change that lasted
    /// through many calls is no cargo.
    fn return_probability(&self) -> f64 {
        let is_cargo = match self.origin {
            StepOrigin::AtPort | StepOrigin::LoggedLoading => priors::CARGO,
            StepOrigin::NoticedLate => priors::CARGO_NOTICED_LATE,
            StepOrigin::SoonAfter(_) => priors::CARGO_SOON_AFTER_CALL,
            StepOrigin::AtSea => return priors::RETURN_AFTER_CHANGE_AT_SEA,
        };
        let still = is_cargo * (1.0 - priors::DISCHARGE).powi(self.port_calls);
        priors::DISCHARGE * still / (still + 1.0 - is_cargo)
    }

    /// Returns true if the step happened at a port call: only a change at sea may end at
    /// sea.
    pub(crate) fn began_at_port_call(&self) -> bool {
        matches!(self.origin, StepOrigin::AtPort)
    }

    /// Returns true if the step is cargo, by logbook and rows.
    pub(crate) fn is_cargo(&self) -> bool {
        matches!(self.origin, StepOrigin::AtPort | StepOrigin::LoggedLoading)
    }

    /// Returns the state of the vessel without the change.
    pub(crate) fn without_cargo(&self) -> &Filter {
        match &self.origin {
            StepOrigin::SoonAfter(departure_before) => departure_before,
            _ => &self.filter,
        }
    }
}

/// A port call after a step.
struct PortCall {
    /// First row after it.
    at: usize,
    returns: Vec<ReturnHypothesis>,
}

/// Filter of a vessel that returned at a port call.
struct ReturnHypothesis {
    event: usize,
    prior_odds: f64,
    filter: Filter,
}

/// A possible return.
#[derive(Clone, Debug)]
pub(crate) struct ReturnCandidate {
    /// Place of the step that it would end.
    pub(crate) event: usize,
    /// First row after the return.
    pub(crate) at: usize,
    /// Log-likelihood ratio against no return.
    pub(crate) log_likelihood_ratio: f64,
    /// Posterior probability of a return to the state before that step, at any call, and
    /// that of any return.
    pub(crate) probability: f64,
    pub(crate) any: f64,
    pub(crate) filter: Filter,
}

#[derive(Default)]
pub(crate) struct PortCallReturns {
    /// Earlier states, from the earliest step to the latest.
    pub(crate) baselines: Vec<Baseline>,
    calls: Vec<PortCall>,
}

impl PortCallReturns {
    pub(crate) fn add_baseline(&mut self, base: Baseline) {
        if self.baselines.len() == MAX_BASELINES {
            // The first is the vessel without any cargo, and stays.
            self.baselines.remove(1);
        }
        self.baselines.push(base);
    }

    /// Adds a port call before row `at`, with the filter `now` and the baselines of steps
    /// before `until`, a place in the list of events.
    pub(crate) fn add_port_call(
        &mut self,
        at: usize,
        now: &Filter,
        until: usize,
        logged: LoggedCargo,
    ) {
        let without_cargo = match logged {
            LoggedCargo::Discharged { loaded, at_port } => self.before_loading(loaded, at_port),
            _ => None,
        };
        let before = self.baselines.iter_mut().filter(|base| base.event < until);
        let returns: Vec<ReturnHypothesis> = before
            .map(|base| {
                let return_probability = match (logged, without_cargo) {
                    (_, Some((event, return_probability))) if event == base.event => {
                        return_probability
                    }
                    (LoggedCargo::OnBoard, _) => {
                        priors::LOGGED_ON_BOARD_FACTOR * base.return_probability()
                    }
                    _ => base.return_probability(),
                };
                base.port_calls += 1;
                ReturnHypothesis {
                    event: base.event,
                    prior_odds: return_probability / (1.0 - return_probability),
                    filter: restore_vessel(now, base.without_cargo()),
                }
            })
            .collect();
        if returns.is_empty() {
            return;
        }
        self.calls.retain(|call| call.at != at);
        if self.calls.len() == MAX_PORT_CALLS {
            self.calls.remove(0);
        }
        self.calls.push(PortCall { at, returns });
    }

    /// Returns the first step since the cargo was loaded, and the probability of a return
    /// to the state before it. A change at sea does not leave with the cargo, but little
    /// cargo may be noticed only at sea.
    fn before_loading(&self, loaded: Timestamp, at_port: bool) -> Option<(usize, f64)> {
        let since = |base: &&Baseline| base.latest.is_some_and(|latest| latest >= loaded);
        let mut since = self.baselines.iter().filter(since);
        let first = since.next()?;
        if !since.all(Baseline::is_cargo) {
            return None;
        }
        let return_probability = match (first.is_cargo(), at_port) {
            (true, true) => priors::LOGGED_DISCHARGE,
            (true, false) => priors::LOGGED_DISCHARGE_UNDER_WAY,
            (false, _) => priors::LOGGED_DISCHARGE_NOTICED_AT_SEA,
        };
        Some((first.event, return_probability))
    }

    /// Reads a row, linearised at the state of each return.
    pub(crate) fn observe(
        &mut self,
        measure: impl Fn(&Unknowns) -> Measurement,
        noise: &NoiseVariances,
        null: &Filter,
    ) {
        for call in &mut self.calls {
            for candidate in &mut call.returns {
                let m = measure(&candidate.filter.unknowns());
                candidate.filter.observe(&m, noise, None);
            }
            call.returns.retain(|candidate| {
                candidate.filter.log_likelihood
                    > null.log_likelihood - RETURN_DROPPED_LOG_LIKELIHOOD_RATIO
            });
        }
        self.calls.retain(|call| !call.returns.is_empty());
    }

    /// Reads a row for the calls at row `first` and later, which are being replayed.
    pub(crate) fn observe_since(
        &mut self,
        first: usize,
        measure: impl Fn(&Unknowns) -> Measurement,
        noise: &NoiseVariances,
    ) {
        for call in self.calls.iter_mut().filter(|call| call.at >= first) {
            for candidate in &mut call.returns {
                let m = measure(&candidate.filter.unknowns());
                candidate.filter.observe(&m, noise, None);
            }
        }
    }

    /// Returns the likeliest return. `transient` is the log-likelihood ratio of the
    /// likeliest transient. While an accepted transient goes on (`is_disturbed`), the rows
    /// speak neither for a return nor against it, because both are possible.
    pub(crate) fn likeliest(
        &self,
        null: &Filter,
        transient: f64,
        is_disturbed: bool,
    ) -> Option<ReturnCandidate> {
        let tempered_odds = |candidate: &ReturnHypothesis| {
            let ratio = candidate.filter.log_likelihood - null.log_likelihood;
            let beside = if is_disturbed {
                ratio.min(0.0)
            } else {
                f64::NEG_INFINITY
            };
            let evidence = (ratio - transient).max(beside);
            (
                ratio,
                candidate.prior_odds * (LIKELIHOOD_TEMPER * evidence).exp(),
            )
        };
        let each = || {
            let calls = self.calls.iter();
            calls.flat_map(|call| {
                call.returns
                    .iter()
                    .map(move |candidate| (call.at, candidate))
            })
        };
        let of_event = |event: usize| -> f64 {
            let same = each().filter(|(_, candidate)| candidate.event == event);
            same.map(|(_, candidate)| tempered_odds(candidate).1).sum()
        };
        let sum: f64 = each()
            .map(|(_, candidate)| tempered_odds(candidate).1)
            .sum();
        // The call matters less than the state to which the vessel returned.
        let event = self
            .baselines
            .iter()
            .map(|base| base.event)
            .max_by(|a, b| of_event(*a).total_cmp(&of_event(*b)))?;
        let (at, candidate) = each()
            .filter(|(_, candidate)| candidate.event == event)
            .max_by(|a, b| tempered_odds(a.1).1.total_cmp(&tempered_odds(b.1).1))?;
        Some(ReturnCandidate {
            event,
            at,
            log_likelihood_ratio: tempered_odds(candidate).0,
            probability: of_event(event) / (1.0 + sum),
            any: sum / (1.0 + sum),
            filter: candidate.filter.clone(),
        })
    }

    /// Applies `now`, a change or repair of a reference, to every return, each of which
    /// becomes likelier by `gained` as the null filter did.
    pub(crate) fn apply_reference_change(&mut self, gained: f64, now: impl Fn(&Filter) -> Filter) {
        let returns = self.calls.iter_mut().flat_map(|call| &mut call.returns);
        for candidate in returns {
            candidate.filter = now(&candidate.filter);
            candidate.filter.log_likelihood += gained;
        }
    }

    /// Credits the returns with `gained`, by which an accepted transient made the null
    /// filter likelier, but without a lead: the transient may explain what a return led by.
    pub(crate) fn credit_transient(&mut self, null: &Filter, gained: f64) {
        let returns = self.calls.iter_mut().flat_map(|call| &mut call.returns);
        for candidate in returns {
            let led = candidate.filter.log_likelihood - null.log_likelihood;
            let leads = led.min(0.0).max(led - gained);
            candidate.filter.log_likelihood = null.log_likelihood + gained + leads;
        }
    }

    /// Drops `event` and later steps: the vessel returned to the state before it, or it was
    /// no step of the vessel.
    pub(crate) fn forget(&mut self, event: usize) {
        self.baselines.retain(|base| base.event < event);
        self.calls.clear();
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::estimate::Prior;
    use binnacle_compass::result::NoiseLevels;

    fn vessel() -> Filter {
        let noise = NoiseVariances::new(&NoiseLevels::TYPICAL);
        Filter::new(&Prior::population(0.5), &noise)
    }

    /// Returns of a vessel that loaded cargo at a call and has made two calls since, with
    /// these log-likelihood ratios.
    fn after_two_calls(leads: [f64; 2]) -> PortCallReturns {
        let mut calls = PortCallReturns::default();
        calls.add_baseline(Baseline {
            event: 0,
            filter: vessel(),
            origin: StepOrigin::AtPort,
            latest: None,
            port_calls: 0,
        });
        for at in [10, 20] {
            calls.add_port_call(at, &vessel(), usize::MAX, LoggedCargo::Nothing);
        }
        for (call, ratio) in calls.calls.iter_mut().zip(leads) {
            call.returns[0].filter.log_likelihood = ratio;
        }
        calls
    }

    #[test]
    fn that_she_is_herself_again_is_as_likely_as_all_calls_of_it_together() {
        let both = after_two_calls([3.0, 3.0]);
        let both = both.likeliest(&vessel(), 0.0, false).unwrap();
        let one = after_two_calls([3.0, -30.0]);
        let one = one.likeliest(&vessel(), 0.0, false).unwrap();
        assert!(both.probability > one.probability + 0.05, "{both:?}");
        assert!((both.probability - both.any).abs() < 1e-12);
        assert_eq!(both.at, 10, "the first call is the likelier beforehand");
    }

    #[test]
    fn a_disturbance_that_was_reported_speaks_neither_for_a_return_nor_against_it() {
        let calls = after_two_calls([5.0, -30.0]);
        let probability = |is_disturbed: bool| {
            let likeliest = calls.likeliest(&vessel(), 60.0, is_disturbed);
            likeliest.unwrap().probability
        };
        assert!(probability(false) < 1e-6);
        let beforehand = probability(true);
        assert!((beforehand - 0.504).abs() < 0.001, "{beforehand}");
    }

    #[test]
    fn what_passed_leaves_a_return_as_likely_as_it_was_but_lends_it_no_lead() {
        let null = vessel();
        for (led, gained, leads) in [(5.0, 20.0, 0.0), (-3.0, 20.0, -3.0), (5.0, 2.0, 3.0)] {
            let mut calls = after_two_calls([led, led]);
            calls.credit_transient(&null, gained);
            let now = calls.calls[0].returns[0].filter.log_likelihood - gained;
            assert!((now - leads).abs() < 1e-9, "{led}, {gained}: {now}");
        }
    }
}
