//! The bound of a problem that is too large for the linear relaxation.
//!
//! That a need is met at most once is given a price (Lagrangian relaxation): what is left
//! falls into the days of the firms, on each of which the teams take the best loads of
//! jobs, and that is exact. Such a bound is at least the linear relaxation's with x ≤ y for
//! each job and its team (A. M. Geoffrion, "Lagrangean relaxation for integer
//! programming", Mathematical Programming Study 2, 1974, Theorem 1). Prices follow the
//! subgradient with Polyak's step (M. Held, P. Wolfe, H. P. Crowder, "Validation of
//! subgradient optimization", Mathematical Programming 6, 1974).
//!
//! What always holds: the bound is right whatever the prices are. They are rounded to
//! cents and the bound is added up from them in whole numbers, so that a bad price makes
//! the bound worse, never false.

use super::bound::Bound;
use super::problem::Problem;

/// Steps of the subgradient, at most.
const STEPS: usize = 3000;
/// The step is halved after so many without a better bound.
const PATIENCE: usize = 30;
/// Below this factor steps lead nowhere.
const SMALLEST_STEP: f64 = 1e-4;
/// Beyond every cost, and far from overflowing.
const NEVER: i64 = 1 << 60;

/// The bound by the best prices found; `known` is what an assignment costs.
pub(super) fn bound(problem: &Problem, known: i64) -> Bound {
    let layout = Layout::of(problem);
    let prices = prices(problem, &layout, known as f64);
    let whole: Vec<i64> = prices
        .iter()
        .zip(&problem.unmet)
        .map(|(price, unmet)| (price.round() as i64).clamp(0, *unmet))
        .collect();
    add_up(problem, &layout, &whole)
}

/// Which choices are on which visit, and which visits on which day.
struct Layout {
    choices: Vec<Vec<usize>>,
    visits: Vec<Vec<usize>>,
}

impl Layout {
    fn of(problem: &Problem) -> Layout {
        let choices = problem.by_visit();
        let mut visits = vec![Vec::new(); problem.teams.len()];
        for (index, visit) in problem.visits.iter().enumerate() {
            if !choices[index].is_empty() {
                visits[visit.firm_day].push(index);
            }
        }
        Layout { choices, visits }
    }
}

/// The jobs that one team does on a visit, and what it gains by them: less than nothing.
struct Load<T> {
    gain: T,
    visit: usize,
    /// How many better loads the visit has.
    place: usize,
}

/// What is worth its price on a visit, the best first.
fn worthwhile<T: Copy + PartialOrd + Default>(
    choices: &[usize],
    gain: impl Fn(usize) -> T,
) -> Vec<(T, usize)> {
    let gains = choices.iter().map(|&index| (gain(index), index));
    let mut gains: Vec<(T, usize)> = gains.filter(|(gain, _)| *gain < T::default()).collect();
    gains.sort_by(|one, other| {
        let by_gain = one.0.partial_cmp(&other.0);
        by_gain.map_or_else(
            || one.1.cmp(&other.1),
            |order| order.then(one.1.cmp(&other.1)),
        )
    });
    gains
}

/// Prices of needs, in cents, at which the bound is the best that was found.
fn prices(problem: &Problem, layout: &Layout, known: f64) -> Vec<f64> {
    let most: Vec<f64> = problem.unmet.iter().map(|unmet| *unmet as f64).collect();
    // To begin with each need pays what its cheapest choice costs alone.
    let mut at = most.clone();
    for choice in &problem.choices {
        let visit = problem.visits[choice.visit];
        let alone = (choice.cost + visit.travel) as f64;
        at[choice.need] = at[choice.need].min(alone);
    }
    let (mut best, mut best_cost) = (at.clone(), f64::NEG_INFINITY);
    let (mut factor, mut since) = (1.0, 0);
    for _ in 0..STEPS {
        let (cost, met) = taken(problem, layout, &at);
        if cost > best_cost {
            (best_cost, since) = (cost, 0);
            best.clone_from(&at);
        } else {
            since += 1;
            if since > PATIENCE {
                (factor, since) = (factor / 2.0, 0);
                at.clone_from(&best);
                if factor < SMALLEST_STEP {
                    break;
                }
                continue;
            }
        }
        let slope = |need: usize| {
            let slope = 1.0 - f64::from(met[need]);
            // A price at its end goes no further.
            if slope > 0.0 && at[need] >= most[need] {
                0.0
            } else {
                slope
            }
        };
        let slopes: Vec<f64> = (0..at.len()).map(slope).collect();
        let length: f64 = slopes.iter().map(|slope| slope * slope).sum();
        if length < 0.5 || known - best_cost < 0.5 {
            break;
        }
        let step = factor * (known - cost) / length;
        for ((price, slope), most) in at.iter_mut().zip(&slopes).zip(&most) {
            *price = (*price + step * slope).clamp(0.0, *most);
        }
    }
    best
}

/// What all days cost at some prices, and how often each need is met by them.
fn taken(problem: &Problem, layout: &Layout, prices: &[f64]) -> (f64, Vec<u32>) {
    let mut cost: f64 = prices.iter().sum();
    let mut met = vec![0; prices.len()];
    for (day, visits) in layout.visits.iter().enumerate() {
        let mut loads: Vec<Load<f64>> = Vec::new();
        let mut of_visit: Vec<(usize, Vec<(f64, usize)>)> = Vec::new();
        for &index in visits {
            let visit = problem.visits[index];
            let gains = worthwhile(&layout.choices[index], |choice| {
                let choice = problem.choices[choice];
                choice.cost as f64 - prices[choice.need]
            });
            for (place, load) in gains.chunks(visit.jobs_a_team as usize).enumerate() {
                let gain = visit.travel as f64 + load.iter().map(|(gain, _)| gain).sum::<f64>();
                if gain >= 0.0 {
                    break;
                }
                let visit = of_visit.len();
                loads.push(Load { gain, visit, place });
            }
            of_visit.push((visit.jobs_a_team as usize, gains));
        }
        loads.sort_by(|one, other| {
            let by_gain = one.gain.total_cmp(&other.gain);
            by_gain.then((one.visit, one.place).cmp(&(other.visit, other.place)))
        });
        for load in loads.iter().take(problem.teams[day] as usize) {
            cost += load.gain;
            let (jobs, gains) = &of_visit[load.visit];
            let done = gains.iter().skip(load.place * jobs).take(*jobs);
            for (_, choice) in done {
                met[problem.choices[*choice].need] += 1;
            }
        }
    }
    (cost, met)
}

/// The bound at whole prices, and what each choice costs beyond it: it takes the place of
/// the last load that the day's teams take.
fn add_up(problem: &Problem, layout: &Layout, prices: &[i64]) -> Bound {
    let mut cost: i64 = prices.iter().sum();
    let mut reduced = vec![0; problem.choices.len()];
    let mut worth = vec![0; problem.visits.len()];
    for (day, visits) in layout.visits.iter().enumerate() {
        let teams = problem.teams[day] as usize;
        let gain = |choice: usize| {
            let choice = problem.choices[choice];
            choice.cost - prices[choice.need]
        };
        let gains: Vec<Vec<(i64, usize)>> = visits
            .iter()
            .map(|index| worthwhile(&layout.choices[*index], gain))
            .collect();
        let mut loads: Vec<i64> = Vec::new();
        for (&index, gains) in visits.iter().zip(&gains) {
            let visit = problem.visits[index];
            let each = gains.chunks(visit.jobs_a_team as usize);
            let each =
                each.map(|load| visit.travel + load.iter().map(|(gain, _)| gain).sum::<i64>());
            loads.extend(each.take_while(|gain| *gain < 0));
        }
        loads.sort_unstable();
        cost += loads.iter().take(teams).sum::<i64>();
        let last = match teams {
            0 => -NEVER,
            teams => loads.get(teams - 1).copied().unwrap_or(0),
        };
        for (&index, gains) in visits.iter().zip(&gains) {
            let visit = problem.visits[index];
            worth[index] = (visit.travel - last) / i64::from(visit.jobs_a_team);
            let beside = visit.jobs_a_team as usize - 1;
            for &choice in &layout.choices[index] {
                let others = gains.iter().filter(|(_, other)| *other != choice);
                let others: i64 = others.take(beside).map(|(gain, _)| gain).sum();
                let load = visit.travel + gain(choice) + others;
                reduced[choice] = (load - last).max(0);
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

#[cfg(test)]
mod tests {
    use super::*;
    use crate::solve::problem::made_up::problems;
    use crate::solve::solve;
    use proptest::prelude::*;

    proptest! {
        #![proptest_config(ProptestConfig { cases: 2000, failure_persistence: None, ..ProptestConfig::default() })]

        // The solver is held to every assignment there is by a test of its own.
        #[test]
        fn no_best_assignment_costs_less_nor_has_a_choice_beyond_the_gap(problem in problems()) {
            let best = solve(&problem);
            let found = bound(&problem, best.cost);
            prop_assert!(found.cost <= best.cost, "{} {}", found.cost, best.cost);
            for choice in best.assignment.iter().flatten() {
                prop_assert!(found.reduced[*choice] <= best.cost - found.cost);
            }
        }
    }
}
