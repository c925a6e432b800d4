//! A good assignment by greedy insertion and local search.
//!
//! What always holds: what is found is feasible, never worse than what the search
//! began with, and the same for the same problem.

use super::problem::{Assignment, Problem};

/// An assignment under change, with what each visit and each firm's day carries.
struct State<'a> {
    problem: &'a Problem,
    chosen: Assignment,
    jobs: Vec<u32>,
    sent: Vec<u32>,
    at_visit: Vec<Vec<usize>>,
    visits_of: Vec<Vec<usize>>,
}

/// Improves an assignment until no move of one need, and no move of one that makes
/// another one give way, makes it cheaper.
pub(super) fn improve(problem: &Problem, begin: Assignment, order: &[Vec<usize>]) -> Assignment {
    let mut state = State::new(problem, begin);
    let mut queue: Vec<usize> = (0..problem.unmet.len()).collect();
    // Each round walks over all needs; costs fall with every move, so that it ends.
    loop {
        let mut moved = false;
        for need in queue.drain(..) {
            moved |= state.improve_one(need, order);
        }
        if !moved {
            return state.chosen;
        }
        queue.extend(0..problem.unmet.len());
    }
}

impl<'a> State<'a> {
    fn new(problem: &'a Problem, begin: Assignment) -> State<'a> {
        let mut visits_of = vec![Vec::new(); problem.teams.len()];
        for (index, visit) in problem.visits.iter().enumerate() {
            visits_of[visit.firm_day].push(index);
        }
        let mut state = State {
            problem,
            chosen: vec![None; problem.unmet.len()],
            jobs: vec![0; problem.visits.len()],
            sent: vec![0; problem.teams.len()],
            at_visit: vec![Vec::new(); problem.visits.len()],
            visits_of,
        };
        for (need, choice) in begin.into_iter().enumerate() {
            if let Some(choice) = choice {
                state.put(need, choice);
            }
        }
        state
    }

    /// What it costs to add a choice, travel included; none when no team is left.
    fn price_of(&self, choice: usize) -> Option<i64> {
        let choice = self.problem.choices[choice];
        let visit = self.problem.visits[choice.visit];
        if !self.jobs[choice.visit].is_multiple_of(visit.jobs_a_team) {
            return Some(choice.cost);
        }
        let free = self.sent[visit.firm_day] < self.problem.teams[visit.firm_day];
        free.then_some(choice.cost + visit.travel)
    }

    fn put(&mut self, need: usize, choice: usize) {
        let at = self.problem.choices[choice].visit;
        let visit = self.problem.visits[at];
        if self.jobs[at].is_multiple_of(visit.jobs_a_team) {
            self.sent[visit.firm_day] += 1;
        }
        self.jobs[at] += 1;
        self.at_visit[at].push(need);
        self.chosen[need] = Some(choice);
    }

    /// Takes a need's choice back; gives what that saves.
    fn take(&mut self, need: usize) -> i64 {
        let Some(choice) = self.chosen[need].take() else {
            return self.problem.unmet[need];
        };
        let choice = self.problem.choices[choice];
        let visit = self.problem.visits[choice.visit];
        self.jobs[choice.visit] -= 1;
        self.at_visit[choice.visit].retain(|other| *other != need);
        if self.jobs[choice.visit].is_multiple_of(visit.jobs_a_team) {
            self.sent[visit.firm_day] -= 1;
            return choice.cost + visit.travel;
        }
        choice.cost
    }

    /// The cheapest way to meet a need now, `None` where leaving it unmet is.
    fn best(&self, need: usize, order: &[Vec<usize>]) -> (Option<usize>, i64) {
        let mut best = (None, self.problem.unmet[need]);
        for &choice in &order[need] {
            // In order of cost: what follows is no cheaper.
            if self.problem.choices[choice].cost >= best.1 {
                break;
            }
            match self.price_of(choice) {
                Some(price) if price < best.1 => best = (Some(choice), price),
                _ => {}
            }
        }
        best
    }

    fn improve_one(&mut self, need: usize, order: &[Vec<usize>]) -> bool {
        let before = self.chosen[need];
        let saved = self.take(need);
        let (choice, price) = self.best(need, order);
        if price < saved {
            if let Some(choice) = choice {
                self.put(need, choice);
            }
            return true;
        }
        // One other need gives way, and takes what is best for it then.
        for &choice in &order[need] {
            let wanted = self.problem.choices[choice];
            if wanted.cost >= saved {
                break;
            }
            if self.price_of(choice).is_some() {
                continue;
            }
            let firm_day = self.problem.visits[wanted.visit].firm_day;
            let others: Vec<usize> = self.visits_of[firm_day]
                .iter()
                .flat_map(|visit| self.at_visit[*visit].iter().copied())
                .collect();
            for other in others {
                let Some(had) = self.chosen[other] else {
                    continue;
                };
                let freed = self.take(other);
                if let Some(price) = self.price_of(choice) {
                    self.put(need, choice);
                    let (instead, instead_price) = self.best(other, order);
                    if price + instead_price < saved + freed {
                        if let Some(instead) = instead {
                            self.put(other, instead);
                        }
                        return true;
                    }
                    self.take(need);
                }
                self.put(other, had);
            }
        }
        if let Some(before) = before {
            self.put(need, before);
        }
        false
    }
}
