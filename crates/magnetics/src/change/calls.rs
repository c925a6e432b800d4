//! Port calls at which a ship may have become what she was before a step: cargo
//! is discharged where it was loaded, in port.
//!
//! What always holds: at most [`MOST`] calls and [`BASES`] earlier states are kept,
//! and what has become unlikely is given up, so that the work a row is bounded.

use super::filter::{Filter, Measurement, Noise};
use super::upset::set_back;
use crate::estimate::Unknowns;
use crate::time::Timestamp;

/// Calls and earlier states that are kept, the latest of each.
const MOST: usize = 4;
const BASES: usize = 3;
/// A return that trails by more than this is given up, nats.
const HOPELESS_NATS: f64 = 16.0;
/// Leads are of models that are only nearly right: they count for this much.
const TEMPER: f64 = 0.5;
/// How likely a ship is to become herself again at a port call after a change at sea.
const RETURN_AFTER_SEA: f64 = 0.01;
/// A change that began at a port call is cargo with this probability, and cargo is
/// discharged at any one call with that.
const IS_CARGO: f64 = 0.84;
const DISCHARGED: f64 = 0.6;

/// She is herself again so likely at a call at which the logbook says that her cargo was
/// discharged: it is believed at once. And so likely where it says that it stayed.
const SAID_DISCHARGED: f64 = 0.95;
const SAID_ON_BOARD: f64 = 0.05;

/// What the logbook tells of cargo at a port call.
#[derive(Clone, Copy, Debug)]
pub(super) enum Said {
    Nothing,
    /// Cargo that had been loaded not before a time was discharged, and none stayed.
    Discharged {
        loaded: Timestamp,
    },
    /// Some stayed on board.
    OnBoard,
}

/// The ship as she was before a step.
pub(super) struct Base {
    /// The step's place in the list of events.
    pub(super) event: usize,
    pub(super) filter: Filter,
    /// Whether the step began at a port call.
    pub(super) at_port: bool,
    /// When the step happened at the latest.
    pub(super) latest: Option<Timestamp>,
    /// Port calls since.
    pub(super) calls: i32,
}

impl Base {
    /// How likely the ship is herself again at the next port call: what has stayed
    /// through many was no cargo.
    fn chance(&self) -> f64 {
        if !self.at_port {
            return RETURN_AFTER_SEA;
        }
        let still = IS_CARGO * (1.0 - DISCHARGED).powi(self.calls);
        DISCHARGED * still / (still + 1.0 - IS_CARGO)
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
pub(super) struct Candidate {
    /// The step that it would be the end of.
    pub(super) event: usize,
    /// The first row after it.
    pub(super) at: usize,
    /// By how much it is likelier than none by the rows alone.
    pub(super) nats: f64,
    /// How likely it is, and how likely any return is.
    pub(super) probability: f64,
    pub(super) any: f64,
    pub(super) filter: Filter,
}

#[derive(Default)]
pub(super) struct Calls {
    /// From the earliest step to the latest.
    pub(super) bases: Vec<Base>,
    calls: Vec<Call>,
}

impl Calls {
    pub(super) fn step(&mut self, base: Base) {
        if self.bases.len() == BASES {
            // The first is the ship without any cargo, and stays.
            self.bases.remove(1);
        }
        self.bases.push(base);
    }

    /// The ship lay in port before row `at`; `now` is the filter there, and the
    /// bases are those of steps before `until`, a place in the list of events.
    pub(super) fn call(&mut self, at: usize, now: &Filter, until: usize, said: Said) {
        let unladen = match said {
            Said::Discharged { loaded } => self.before_loading(loaded),
            _ => None,
        };
        let before = self.bases.iter_mut().filter(|base| base.event < until);
        let returns: Vec<Return> = before
            .map(|base| {
                let chance = match said {
                    _ if unladen == Some(base.event) => SAID_DISCHARGED,
                    Said::OnBoard => SAID_ON_BOARD * base.chance(),
                    _ => base.chance(),
                };
                base.calls += 1;
                Return {
                    event: base.event,
                    prior_odds: chance / (1.0 - chance),
                    filter: set_back(now, &base.filter),
                }
            })
            .collect();
        if returns.is_empty() {
            return;
        }
        self.calls.retain(|call| call.at != at);
        if self.calls.len() == MOST {
            self.calls.remove(0);
        }
        self.calls.push(Call { at, returns });
    }

    /// The ship as she was before the first step since her cargo came on board, if that and
    /// all since were cargo's: the step's place in the list of events. What struck her at
    /// sea does not leave with the cargo.
    fn before_loading(&self, loaded: Timestamp) -> Option<usize> {
        let since = |base: &&Base| base.latest.is_some_and(|latest| latest >= loaded);
        let mut since = self.bases.iter().filter(since).peekable();
        let first = since.peek()?.event;
        since.all(|base| base.at_port).then_some(first)
    }

    /// Takes in a row, linearised at what each return has of the ship.
    pub(super) fn take(
        &mut self,
        measure: impl Fn(&Unknowns) -> Measurement,
        noise: &Noise,
        null: &Filter,
    ) {
        for call in &mut self.calls {
            for back in &mut call.returns {
                let m = measure(&back.filter.unknowns());
                back.filter.take(&m, noise, None);
            }
            call.returns
                .retain(|back| back.filter.log_likelihood > null.log_likelihood - HOPELESS_NATS);
        }
        self.calls.retain(|call| !call.returns.is_empty());
    }

    /// The same for calls at row `first` and later, which are being retraced.
    pub(super) fn take_since(
        &mut self,
        first: usize,
        measure: impl Fn(&Unknowns) -> Measurement,
        noise: &Noise,
    ) {
        for call in self.calls.iter_mut().filter(|call| call.at >= first) {
            for back in &mut call.returns {
                let m = measure(&back.filter.unknowns());
                back.filter.take(&m, noise, None);
            }
        }
    }

    /// The likeliest return; `rival` is by how much the likeliest passing
    /// disturbance leads.
    pub(super) fn likeliest(&self, null: &Filter, rival: f64) -> Option<Candidate> {
        let odds = |back: &Return| {
            let nats = back.filter.log_likelihood - null.log_likelihood;
            (nats, back.prior_odds * (TEMPER * (nats - rival)).exp())
        };
        let each = || {
            let calls = self.calls.iter();
            calls.flat_map(|call| call.returns.iter().map(move |back| (call.at, back)))
        };
        let sum: f64 = each().map(|(_, back)| odds(back).1).sum();
        let (at, back) = each().max_by(|a, b| odds(a.1).1.total_cmp(&odds(b.1).1))?;
        let (nats, odds) = odds(back);
        Some(Candidate {
            event: back.event,
            at,
            nats,
            probability: odds / (1.0 + sum),
            any: sum / (1.0 + sum),
            filter: back.filter.clone(),
        })
    }

    /// The step of `event` was none of the ship's, or none that is over at once.
    pub(super) fn forget(&mut self, event: usize) {
        self.bases.retain(|base| base.event != event);
        self.calls.clear();
    }

    /// The ship is as she was before `event`: later ones are of the past.
    pub(super) fn returned(&mut self, event: usize) {
        self.bases.retain(|base| base.event < event);
        self.calls.clear();
    }
}
