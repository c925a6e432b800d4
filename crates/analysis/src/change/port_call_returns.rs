//! Port calls at which a ship may have become what she was before a step: cargo
//! is discharged where it was loaded, in port.
//!
//! What always holds: at most [`MAX_PORT_CALLS`] calls and [`MAX_BASELINES`] earlier states are kept,
//! and what has become unlikely is given up, so that the work a row is bounded.

use super::filter::{Filter, Measurement, NoiseVariances};
use super::jump_models::restore_vessel;
use super::likelihood_ratio::LIKELIHOOD_TEMPER;
use crate::change::priors;
use crate::change::thresholds::RETURN_DROPPED_LOG_LIKELIHOOD_RATIO;
use crate::estimate::Unknowns;
use binnacle_compass::time::Timestamp;

/// Calls and earlier states that are kept, the latest of each.
const MAX_PORT_CALLS: usize = 4;
const MAX_BASELINES: usize = 3;

/// What the logbook tells of cargo at a port call.
#[derive(Clone, Copy, Debug)]
pub(crate) enum LoggedCargo {
    Nothing,
    /// Cargo that had been loaded not before a time was discharged, and none stayed.
    Discharged {
        loaded: Timestamp,
        /// Whether she lay somewhere then, as far as the rows tell.
        at_port: bool,
    },
    /// Some stayed on board.
    OnBoard,
}

/// Where a step happened, as far as the rows tell.
pub(crate) enum StepOrigin {
    AtPort,
    /// At sea, so soon after cargo came on board by the logbook that it may be that.
    SaidLoaded,
    /// At a port call, or at sea in the days after it.
    NoticedLate,
    /// At sea, soon after a port call, from which she had sailed so: if it was cargo, it was
    /// on board by then.
    SoonAfter(Box<Filter>),
    AtSea,
}

/// The ship as she was before a step.
pub(crate) struct Baseline {
    /// The step's place in the list of events.
    pub(crate) event: usize,
    pub(crate) filter: Filter,
    pub(crate) origin: StepOrigin,
    /// When the step happened at the latest.
    pub(crate) latest: Option<Timestamp>,
    /// Port calls since.
    pub(crate) port_calls: i32,
}

impl Baseline {
    /// How likely the ship is herself again at the next port call: what has stayed
    /// through many was no cargo.
    fn return_probability(&self) -> f64 {
        let is_cargo = match self.origin {
            StepOrigin::AtPort | StepOrigin::SaidLoaded => priors::CARGO,
            StepOrigin::NoticedLate => priors::CARGO_NOTICED_LATE,
            StepOrigin::SoonAfter(_) => priors::CARGO_SOON_AFTER_CALL,
            StepOrigin::AtSea => return priors::RETURN_AFTER_CHANGE_AT_SEA,
        };
        let still = is_cargo * (1.0 - priors::DISCHARGE).powi(self.port_calls);
        priors::DISCHARGE * still / (still + 1.0 - is_cargo)
    }

    /// What began at sea may end there.
    pub(crate) fn began_at_port_call(&self) -> bool {
        matches!(self.origin, StepOrigin::AtPort)
    }

    /// Whether it came on board with cargo, as far as logbook and rows tell.
    pub(crate) fn is_cargo(&self) -> bool {
        matches!(self.origin, StepOrigin::AtPort | StepOrigin::SaidLoaded)
    }

    /// The ship without what changed her.
    pub(crate) fn without_cargo(&self) -> &Filter {
        match &self.origin {
            StepOrigin::SoonAfter(departure_before) => departure_before,
            _ => &self.filter,
        }
    }
}

/// A port call after a step.
struct Call {
    /// The first row after it.
    at: usize,
    returns: Vec<Return>,
}

/// What the filter would be, were the ship herself again since a call.
struct Return {
    event: usize,
    prior_odds: f64,
    filter: Filter,
}

/// A return that may have been.
#[derive(Clone, Debug)]
pub(crate) struct ReturnCandidate {
    /// The step that it would be the end of.
    pub(crate) event: usize,
    /// The first row after it.
    pub(crate) at: usize,
    /// By how much it is likelier than none by the rows alone.
    pub(crate) log_likelihood_ratio: f64,
    /// How likely the ship is again what she was before that step, at whatever call, and how
    /// likely any return is.
    pub(crate) probability: f64,
    pub(crate) any: f64,
    pub(crate) filter: Filter,
}

#[derive(Default)]
pub(crate) struct PortCallReturns {
    /// From the earliest step to the latest.
    pub(crate) baselines: Vec<Baseline>,
    calls: Vec<Call>,
}

impl PortCallReturns {
    pub(crate) fn add_baseline(&mut self, base: Baseline) {
        if self.baselines.len() == MAX_BASELINES {
            // The first is the ship without any cargo, and stays.
            self.baselines.remove(1);
        }
        self.baselines.push(base);
    }

    /// The ship lay in port before row `at`; `now` is the filter there, and the
    /// baselines are those of steps before `until`, a place in the list of events.
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
        let returns: Vec<Return> = before
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
                Return {
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
        self.calls.push(Call { at, returns });
    }

    /// The ship as she was before the first step since her cargo came on board: the step's
    /// place in the list of events, and how likely she is that again. What struck her at sea
    /// does not leave with the cargo, but cargo that moves the compass by little may be
    /// noticed at sea only.
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

    /// Takes in a row, linearised at what each return has of the ship.
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

    /// The same for calls at row `first` and later, which are being retraced.
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

    /// The likeliest return. `transient` is by how much the likeliest passing disturbance leads;
    /// while one goes on that was told, `is_disturbed`, the rows speak for no return, but not
    /// against one either, for both may be.
    pub(crate) fn likeliest(
        &self,
        null: &Filter,
        transient: f64,
        is_disturbed: bool,
    ) -> Option<ReturnCandidate> {
        let tempered_odds = |candidate: &Return| {
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
        // Which call it was matters less than whether she is the ship she was.
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

    /// A reference's error changed, or is again what it was: `now` does that to each return,
    /// and each is likelier by what the filter gained by it.
    pub(crate) fn apply_reference_change(&mut self, gained: f64, now: impl Fn(&Filter) -> Filter) {
        let returns = self.calls.iter_mut().flat_map(|call| &mut call.returns);
        for candidate in returns {
            candidate.filter = now(&candidate.filter);
            candidate.filter.log_likelihood += gained;
        }
    }

    /// The filter, `null`, is likelier by `gained` now that it knows of a disturbance that
    /// passed. So would a return be, but by no more than that it leads no longer: what it led
    /// by may be what the disturbance explains.
    pub(crate) fn credit_transient(&mut self, null: &Filter, gained: f64) {
        let returns = self.calls.iter_mut().flat_map(|call| &mut call.returns);
        for candidate in returns {
            let led = candidate.filter.log_likelihood - null.log_likelihood;
            let leads = led.min(0.0).max(led - gained);
            candidate.filter.log_likelihood = null.log_likelihood + gained + leads;
        }
    }

    /// The ship is as she was before `event`, or it was no step of hers: later ones are of the
    /// past.
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

    fn ship() -> Filter {
        let noise = NoiseVariances::new(&NoiseLevels::TYPICAL);
        Filter::new(&Prior::population(0.5), &noise)
    }

    /// A ship that was laden at a call, and has lain at two since; by how much her being
    /// herself again leads from each.
    fn after_two_calls(leads: [f64; 2]) -> PortCallReturns {
        let mut calls = PortCallReturns::default();
        calls.add_baseline(Baseline {
            event: 0,
            filter: ship(),
            origin: StepOrigin::AtPort,
            latest: None,
            port_calls: 0,
        });
        for at in [10, 20] {
            calls.add_port_call(at, &ship(), usize::MAX, LoggedCargo::Nothing);
        }
        for (call, ratio) in calls.calls.iter_mut().zip(leads) {
            call.returns[0].filter.log_likelihood = ratio;
        }
        calls
    }

    #[test]
    fn that_she_is_herself_again_is_as_likely_as_all_calls_of_it_together() {
        let both = after_two_calls([3.0, 3.0]);
        let both = both.likeliest(&ship(), 0.0, false).unwrap();
        let one = after_two_calls([3.0, -30.0]);
        let one = one.likeliest(&ship(), 0.0, false).unwrap();
        assert!(both.probability > one.probability + 0.05, "{both:?}");
        assert!((both.probability - both.any).abs() < 1e-12);
        assert_eq!(both.at, 10, "the first call is the likelier beforehand");
    }

    #[test]
    fn a_disturbance_that_was_told_speaks_neither_for_a_return_nor_against_it() {
        let calls = after_two_calls([5.0, -30.0]);
        let probability = |is_disturbed: bool| {
            let likeliest = calls.likeliest(&ship(), 60.0, is_disturbed);
            likeliest.unwrap().probability
        };
        assert!(probability(false) < 1e-6);
        let beforehand = probability(true);
        assert!((beforehand - 0.504).abs() < 0.001, "{beforehand}");
    }

    #[test]
    fn what_passed_leaves_a_return_as_likely_as_it_was_but_lends_it_no_lead() {
        let null = ship();
        for (led, gained, leads) in [(5.0, 20.0, 0.0), (-3.0, 20.0, -3.0), (5.0, 2.0, 3.0)] {
            let mut calls = after_two_calls([led, led]);
            calls.credit_transient(&null, gained);
            let now = calls.calls[0].returns[0].filter.log_likelihood - gained;
            assert!((now - leads).abs() < 1e-9, "{led}, {gained}: {now}");
        }
    }
}
