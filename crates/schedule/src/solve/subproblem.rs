//! The subproblem of the Lagrangian relaxation: the loads of each firm's teams
//! at given prices. The price steps solve it thousands of times.

use super::problem::Problem;

/// A solution of the subproblem, and its total cost.
pub(super) struct Solution {
    pub(super) cost: f64,
    pub(super) choices: Vec<usize>,
}

/// The choices by visit, contiguous in memory, and the visits by day.
pub(super) struct Subproblem<'a> {
    problem: &'a Problem,
    seats: Vec<Seat>,
    /// Range of each visit's seats.
    of_visit: Vec<(usize, usize)>,
    visits: Vec<Vec<usize>>,
}

struct Seat {
    need: usize,
    cost: f64,
    choice: usize,
}

/// The jobs of one team on a visit, with their total gain, which is negative.
struct Load {
    gain: f64,
    first: usize,
    end: usize,
}

impl<'a> Subproblem<'a> {
    pub(super) fn new(problem: &'a Problem) -> Subproblem<'a> {
        let mut days = Subproblem {
            problem,
            seats: Vec::with_capacity(problem.choices.len()),
            of_visit: Vec::with_capacity(problem.visits.len()),
            visits: vec![Vec::new(); problem.teams.len()],
        };
        for (index, choices) in problem.by_visit().into_iter().enumerate() {
            let first = days.seats.len();
            days.seats.extend(choices.into_iter().map(|choice| Seat {
                need: problem.choices[choice].need,
                cost: problem.choices[choice].cost as f64,
                choice,
            }));
            days.of_visit.push((first, days.seats.len()));
            let day = problem.visits[index].firm_day;
            if days.seats.len() > first && problem.teams[day] > 0 {
                days.visits[day].push(index);
            }
        }
        days
    }

    pub(super) fn solve(&self, prices: &[f64]) -> Solution {
        let mut solution = Solution {
            cost: prices.iter().sum(),
            choices: Vec::new(),
        };
        let (mut loads, mut kept) = (Vec::new(), Vec::new());
        for (visits, teams) in self.visits.iter().zip(&self.problem.teams) {
            let teams = *teams as usize;
            loads.clear();
            kept.clear();
            for &visit in visits {
                self.loads(visit, teams, prices, &mut loads, &mut kept);
            }
            loads.sort_by(|one: &Load, other: &Load| {
                let by_gain = one.gain.total_cmp(&other.gain);
                by_gain.then(one.first.cmp(&other.first))
            });
            for load in loads.iter().take(teams) {
                solution.cost += load.gain;
                let done = kept[load.first..load.end].iter();
                solution
                    .choices
                    .extend(done.map(|(_, seat)| self.seats[*seat].choice));
            }
        }
        solution
    }

    /// Adds the profitable loads of a visit, the best first, as many as there
    /// are teams.
    fn loads(
        &self,
        index: usize,
        teams: usize,
        prices: &[f64],
        loads: &mut Vec<Load>,
        kept: &mut Vec<(f64, usize)>,
    ) {
        let visit = self.problem.visits[index];
        let jobs = visit.jobs_a_team as usize;
        let begin = kept.len();
        let (first, end) = self.of_visit[index];
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
        if kept.len() - begin > most {
            kept[begin..].select_nth_unstable_by(most - 1, by_gain);
            kept.truncate(begin + most);
        }
        kept[begin..].sort_unstable_by(by_gain);
        let mut first = begin;
        for load in kept[begin..].chunks(jobs) {
            let gain = visit.travel as f64 + load.iter().map(|(gain, _)| gain).sum::<f64>();
            if gain >= 0.0 {
                break;
            }
            let end = first + load.len();
            loads.push(Load { gain, first, end });
            first = end;
        }
    }
}
