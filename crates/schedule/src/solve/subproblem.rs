//! The subproblem of the Lagrangian relaxation: the stays of each crew's teams
//! at given prices, and their loads. The price steps solve it thousands of times.

use super::flow::{self, Offer};
use super::problem::Problem;
use super::relaxation::Relaxation;

/// A solution of the subproblem, and its total cost.
pub(super) struct Solution {
    pub(super) cost: f64,
    pub(super) choices: Vec<usize>,
}

/// The choices by visit, contiguous in memory.
pub(super) struct Subproblem<'a> {
    problem: &'a Problem,
    relaxation: &'a Relaxation<'a>,
    seats: Vec<Seat>,
    /// Range of each visit's seats, and the most jobs of a team there.
    of_visit: Vec<(usize, usize, usize)>,
}

struct Seat {
    need: usize,
    cost: f64,
    choice: usize,
}

/// The jobs of one team on a visit, with their total gain, which is negative.
/// For a team that goes to several places, the load at the next is linked, and
/// the gain is that of all.
struct Load {
    gain: f64,
    first: usize,
    end: usize,
    next: Option<usize>,
}

/// Memory that is used again for each crew.
#[derive(Default)]
struct Scratch {
    /// Choices worth their price, with their gain and seat.
    kept: Vec<(f64, usize)>,
    /// Loads of single visits, which others link to.
    linked: Vec<Load>,
    /// Loads of a crew's stays, the best of each first.
    loads: Vec<Load>,
}

impl<'a> Subproblem<'a> {
    pub(super) fn new(relaxation: &'a Relaxation<'a>) -> Subproblem<'a> {
        let problem = relaxation.problem;
        let mut days = Subproblem {
            problem,
            relaxation,
            seats: Vec::with_capacity(problem.choices.len()),
            of_visit: Vec::with_capacity(problem.visits.len()),
        };
        for (choices, jobs) in relaxation.choices.iter().zip(&relaxation.jobs) {
            let first = days.seats.len();
            days.seats.extend(choices.iter().map(|choice| Seat {
                need: problem.choices[*choice].need,
                cost: problem.choices[*choice].cost as f64,
                choice: *choice,
            }));
            days.of_visit.push((first, days.seats.len(), *jobs));
        }
        days
    }

    pub(super) fn solve(&self, prices: &[f64]) -> Solution {
        let mut solution = Solution {
            cost: prices.iter().sum(),
            choices: Vec::new(),
        };
        let mut scratch = Scratch::default();
        for (crew, stays) in self.problem.crews.iter().zip(&self.relaxation.stays) {
            scratch.loads.clear();
            scratch.linked.clear();
            scratch.kept.clear();
            // The stays that are worth a team, with the range of their loads.
            let mut worthwhile = Vec::new();
            for (at, stay) in stays.iter().enumerate().filter(|(_, stay)| stay.teams > 0) {
                let begin = scratch.loads.len();
                for &visit in &stay.visits {
                    self.add_loads(visit, stay.teams, prices, begin, &mut scratch);
                }
                if scratch.loads.len() > begin {
                    worthwhile.push((at, begin..scratch.loads.len()));
                }
            }
            let gains: Vec<f64> = scratch.loads.iter().map(|load| load.gain).collect();
            let offers = worthwhile.iter().map(|(stay, range)| Offer {
                stay: *stay,
                gains: &gains[range.clone()],
            });
            let offers: Vec<Offer<'_>> = offers.collect();
            let flow = flow::send(stays, &offers, crew.teams as usize);
            solution.cost += flow.gain;
            for ((_, range), taken) in worthwhile.iter().zip(&flow.taken) {
                for load in &scratch.loads[range.start..range.start + taken] {
                    self.add_choices(load, &scratch, &mut solution.choices);
                }
            }
        }
        solution
    }

    /// Adds the choices of a load, and of those linked to it.
    fn add_choices(&self, load: &Load, scratch: &Scratch, choices: &mut Vec<usize>) {
        let mut at = Some(load);
        while let Some(load) = at {
            let done = scratch.kept[load.first..load.end].iter();
            choices.extend(done.map(|(_, seat)| self.seats[*seat].choice));
            at = load.next.map(|next| &scratch.linked[next]);
        }
    }

    /// Adds the profitable loads of a visit, the best first, as many as there
    /// are teams, to those of its stay, which begin at `begin`.
    fn add_loads(
        &self,
        index: usize,
        teams: usize,
        prices: &[f64],
        begin: usize,
        scratch: &mut Scratch,
    ) {
        let travel = self.problem.visits[index].travel as f64;
        let (first, end, jobs) = self.of_visit[index];
        let kept = &mut scratch.kept;
        let before = kept.len();
        for (at, seat) in self.seats[first..end].iter().enumerate() {
            let gain = seat.cost - prices[seat.need];
            if gain < 0.0 {
                kept.push((gain, first + at));
            }
        }
        let by_gain = |one: &(f64, usize), other: &(f64, usize)| {
            one.0.total_cmp(&other.0).then(one.1.cmp(&other.1))
        };
        let most = jobs.saturating_mul(teams);
        if kept.len() - before > most {
            kept[before..].select_nth_unstable_by(most - 1, by_gain);
            kept.truncate(before + most);
        }
        kept[before..].sort_unstable_by(by_gain);
        let mut first = before;
        for (at, load) in kept[before..].chunks(jobs).enumerate() {
            let gain = travel + load.iter().map(|(gain, _)| gain).sum::<f64>();
            if gain >= 0.0 {
                break;
            }
            let end = first + load.len();
            let next = None;
            let mut new = Load {
                gain,
                first,
                end,
                next,
            };
            match scratch.loads.get_mut(begin + at) {
                Some(other) => {
                    new.gain += other.gain;
                    new.next = Some(scratch.linked.len());
                    scratch.linked.push(std::mem::replace(other, new));
                }
                None => scratch.loads.push(new),
            }
            first = end;
        }
    }
}
