//! Lagrangian lower bound at integer prices, with the reduced cost of each
//! choice.

use super::flow::{self, Flow, Offer};
use super::relaxation::{Relaxation, Stay};

/// Larger than every cost, and far from overflow.
const INFINITE: i64 = 1 << 60;

/// A lower bound, and each choice's reduced cost against it.
#[derive(Clone, Debug, PartialEq, Eq)]
pub(super) struct Bound {
    /// No assignment costs less.
    pub(super) cost: i64,
    /// The prices of the needs.
    pub(super) prices: Vec<i64>,
    /// Least excess over the bound of any assignment with this choice.
    pub(super) reduced: Vec<i64>,
    /// Least excess over the bound of any assignment that leaves this need
    /// unmet.
    pub(super) reduced_unmet: Vec<i64>,
}

/// Computes the bound: each crew's teams take the best stays, and a choice takes
/// one of them through its own. Whole numbers up to 2⁵³ are exact.
pub(super) fn compute(relaxation: &Relaxation<'_>, prices: &[i64]) -> Bound {
    let problem = relaxation.problem;
    let mut cost: i64 = prices.iter().sum();
    let mut reduced = vec![INFINITE; problem.choices.len()];
    for (crew, stays) in problem.crews.iter().zip(&relaxation.stays) {
        let loads: Vec<Loads> = stays
            .iter()
            .map(|stay| Loads::new(relaxation, stay, prices))
            .collect();
        let offers: Vec<Offer<'_>> = loads
            .iter()
            .enumerate()
            .filter(|(_, loads)| !loads.gains.is_empty())
            .map(|(stay, loads)| Offer {
                stay,
                gains: &loads.gains,
            })
            .collect();
        let flow = flow::send(stays, &offers, crew.teams as usize);
        cost += flow.gain as i64;
        let (before, after) = best_around(stays, &loads);
        for (at, stay) in stays.iter().enumerate().filter(|(_, stay)| stay.teams > 0) {
            let around = before[at] + after[at];
            loads[at].reduce(relaxation, stay, prices, around, &flow, &mut reduced);
        }
    }
    Bound {
        cost,
        prices: prices.to_vec(),
        reduced,
        reduced_unmet: problem
            .unmet
            .iter()
            .zip(prices)
            .map(|(unmet, price)| unmet - price)
            .collect(),
    }
}

/// The loads of teams at a stay.
struct Loads {
    /// Gains of the choices worth their price on each visit, the best first.
    of_visits: Vec<Vec<i64>>,
    /// The best load of each visit.
    best: Vec<i64>,
    /// Gains of the loads, the best first.
    gains: Vec<f64>,
}

impl Loads {
    fn new(relaxation: &Relaxation<'_>, stay: &Stay, prices: &[i64]) -> Loads {
        let mut loads = Loads {
            of_visits: Vec::new(),
            best: Vec::new(),
            gains: Vec::new(),
        };
        for &visit in &stay.visits {
            let choices = relaxation.choices[visit].iter();
            let gains = choices.map(|choice| gain(relaxation, prices, *choice));
            let mut gains: Vec<i64> = gains.filter(|gain| *gain < 0).collect();
            gains.sort_unstable();
            let travel = relaxation.problem.visits[visit].travel;
            let each = gains.chunks(relaxation.jobs[visit]);
            let each = each.map(|load| travel + load.iter().sum::<i64>());
            let each: Vec<i64> = each.take_while(|gain| *gain < 0).collect();
            for (at, load) in each.iter().enumerate() {
                match loads.gains.get_mut(at) {
                    Some(other) => *other += *load as f64,
                    None => loads.gains.push(*load as f64),
                }
            }
            loads.best.push(each.first().copied().unwrap_or(0));
            loads.of_visits.push(gains);
        }
        loads
    }

    /// Sets the reduced costs of a stay's choices: one team takes the choice, and the best
    /// before and after it, and the others the best of all.
    fn reduce(
        &self,
        relaxation: &Relaxation<'_>,
        stay: &Stay,
        prices: &[i64],
        around: i64,
        flow: &Flow,
        reduced: &mut [i64],
    ) {
        let all: i64 = self.best.iter().sum();
        let last = (flow.gain - flow.gain_of_others) as i64;
        for ((&visit, gains), best_here) in stay.visits.iter().zip(&self.of_visits).zip(&self.best)
        {
            // What the team gains elsewhere on that day, at most.
            let elsewhere = all - best_here;
            let travel = relaxation.problem.visits[visit].travel;
            // With a choice go the best of the others, as many as a team has
            // capacity for.
            let beside = relaxation.jobs[visit] - 1;
            let best: i64 = gains.iter().take(beside).sum();
            let next = gains.get(beside).copied().unwrap_or(0);
            let last_of_best = beside.checked_sub(1).and_then(|at| gains.get(at).copied());
            for &choice in &relaxation.choices[visit] {
                let own = gain(relaxation, prices, choice);
                let is_of_best = last_of_best.is_some_and(|last| own <= last)
                    || (own < 0 && gains.len() < beside);
                let others = if is_of_best { best - own + next } else { best };
                reduced[choice] = (travel + own + others + elsewhere + around - last).max(0);
            }
        }
    }
}

fn gain(relaxation: &Relaxation<'_>, prices: &[i64], choice: usize) -> i64 {
    let choice = relaxation.problem.choices[choice];
    choice.cost - prices[choice.need]
}

/// Returns the best that one team gains before each stay, and after it.
fn best_around(stays: &[Stay], loads: &[Loads]) -> (Vec<i64>, Vec<i64>) {
    let best = |at: usize| loads[at].gains.first().map_or(0, |gain| *gain as i64);
    let (mut before, mut after) = (vec![0; stays.len()], vec![0; stays.len()]);
    // The best path until each stay, that included, over all up to it.
    let mut until = vec![0; stays.len()];
    let mut free = 0;
    for at in 0..stays.len() {
        // Stays from which a team can be anywhere by now.
        while free < at && stays[free].free_on <= stays[at].date {
            free += 1;
        }
        if free > 0 {
            before[at] = before[at].min(until[free - 1]);
        }
        let path = before[at] + best(at);
        until[at] = path.min(if at > 0 { until[at - 1] } else { 0 });
        for &next in &stays[at].next {
            before[next] = before[next].min(path);
        }
    }
    let mut from = vec![0; stays.len() + 1];
    for at in (0..stays.len()).rev() {
        let anywhere = stays.partition_point(|stay| stay.date < stays[at].free_on);
        after[at] = from[anywhere];
        for &next in &stays[at].next {
            after[at] = after[at].min(after[next] + best(next));
        }
        from[at] = from[at + 1].min(after[at] + best(at));
    }
    (before, after)
}
