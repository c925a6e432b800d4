//! Lagrangian lower bound at integer prices, with the reduced cost of each
//! choice.

use super::problem::Problem;

/// Larger than every cost, and far from overflow.
const INFINITE: i64 = 1 << 60;

/// A lower bound, and each choice's reduced cost against it.
#[derive(Clone, Debug, PartialEq, Eq)]
pub(super) struct Bound {
    /// No assignment costs less.
    pub(super) cost: i64,
    /// Least excess over the bound of any assignment with this choice.
    pub(super) reduced: Vec<i64>,
    /// Value of one more job on each visit at these prices; it guides the
    /// search and proves nothing.
    pub(super) worth: Vec<i64>,
    /// Least excess over the bound of any assignment that leaves this need
    /// unmet.
    pub(super) reduced_unmet: Vec<i64>,
}

/// Computes the bound: each day's teams take the best loads, and a choice
/// replaces the last of them.
pub(super) fn compute(problem: &Problem, prices: &[i64]) -> Bound {
    let mut cost: i64 = prices.iter().sum();
    let mut reduced = vec![0; problem.choices.len()];
    let mut worth = vec![0; problem.visits.len()];
    let choices = problem.by_visit();
    let gain = |choice: usize| problem.choices[choice].cost - prices[problem.choices[choice].need];
    for (day, visits) in problem.by_day().into_iter().enumerate() {
        let teams = problem.teams[day] as usize;
        let gains: Vec<Vec<i64>> = visits
            .iter()
            .map(|index| worthwhile(&choices[*index], gain))
            .collect();
        let mut loads: Vec<i64> = Vec::new();
        for (&index, gains) in visits.iter().zip(&gains) {
            let visit = problem.visits[index];
            let each = gains.chunks(visit.jobs_a_team as usize);
            let each = each.map(|load| visit.travel + load.iter().sum::<i64>());
            loads.extend(each.take_while(|gain| *gain < 0));
        }
        loads.sort_unstable();
        cost += loads.iter().take(teams).sum::<i64>();
        let last = match teams {
            0 => -INFINITE,
            teams => loads.get(teams - 1).copied().unwrap_or(0),
        };
        for (&index, gains) in visits.iter().zip(&gains) {
            let visit = problem.visits[index];
            worth[index] = (visit.travel - last) / i64::from(visit.jobs_a_team);
            // With a choice go the best of the others, as many as a team has
            // capacity for.
            let beside = visit.jobs_a_team as usize - 1;
            let best: i64 = gains.iter().take(beside).sum();
            let next = gains.get(beside).copied().unwrap_or(0);
            let last_of_best = beside.checked_sub(1).and_then(|at| gains.get(at).copied());
            for &choice in &choices[index] {
                let own = gain(choice);
                let is_of_best = last_of_best.is_some_and(|last| own <= last)
                    || (own < 0 && gains.len() < beside);
                let others = if is_of_best { best - own + next } else { best };
                reduced[choice] = (visit.travel + own + others - last).max(0);
            }
        }
    }
    Bound {
        cost,
        reduced,
        worth,
        reduced_unmet: problem
            .unmet
            .iter()
            .zip(prices)
            .map(|(unmet, price)| unmet - price)
            .collect(),
    }
}

/// Gains of the choices worth their price on a visit, the best first.
fn worthwhile(choices: &[usize], gain: impl Fn(usize) -> i64) -> Vec<i64> {
    let mut gains: Vec<i64> = choices
        .iter()
        .map(|choice| gain(*choice))
        .filter(|gain| *gain < 0)
        .collect();
    gains.sort_unstable();
    gains
}
