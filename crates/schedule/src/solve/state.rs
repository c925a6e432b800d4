//! The assignment under search, and greedy starting points.
//!
//! Invariant: every result is feasible, and depends on the problem alone.

use super::problem::{Assignment, Problem};
use super::work_limit::WorkLimit;

/// An assignment under search, with the load of each visit and each firm's day.
pub(super) struct State<'a> {
    pub(super) problem: &'a Problem,
    pub(super) chosen: Assignment,
    pub(super) jobs: Vec<u32>,
    pub(super) sent: Vec<u32>,
    pub(super) at_visit: Vec<Vec<usize>>,
    pub(super) visits_of: Vec<Vec<usize>>,
    /// Moves since the last settled state: the need, and its choice before.
    moves: Vec<(usize, Option<usize>)>,
}

/// Improves greedily: each need in turn takes its cheapest choice, until none
/// can improve.
pub(super) fn greedy(
    problem: &Problem,
    begin: Assignment,
    order: &[Vec<usize>],
    work: &mut WorkLimit,
) -> Assignment {
    let mut state = State::new(problem, begin);
    loop {
        let mut moved = false;
        for need in 0..problem.unmet.len() {
            work.spend(order[need].len());
            moved |= state.improve_one(need, order);
        }
        state.settle();
        if !moved || work.is_spent() {
            return state.chosen;
        }
    }
}

/// Takes the first of these choices for each need for which there is a team.
pub(super) fn take_first_feasible(problem: &Problem, choices: &[usize]) -> Assignment {
    let mut state = State::new(problem, vec![None; problem.unmet.len()]);
    for &choice in choices {
        let need = problem.choices[choice].need;
        if state.chosen[need].is_none() && state.price_of(choice).is_some() {
            state.put(need, choice);
        }
    }
    state.chosen
}

impl<'a> State<'a> {
    pub(super) fn new(problem: &'a Problem, begin: Assignment) -> State<'a> {
        let mut state = State {
            problem,
            chosen: vec![None; problem.unmet.len()],
            jobs: vec![0; problem.visits.len()],
            sent: vec![0; problem.teams.len()],
            at_visit: vec![Vec::new(); problem.visits.len()],
            visits_of: problem.by_day(),
            moves: Vec::new(),
        };
        for (need, choice) in begin.into_iter().enumerate() {
            if let Some(choice) = choice {
                state.put(need, choice);
            }
        }
        state.settle();
        state
    }

    /// Returns the cost of adding a choice, travel included; `None` when no team is left.
    pub(super) fn price_of(&self, choice: usize) -> Option<i64> {
        let choice = self.problem.choices[choice];
        Some(choice.cost + self.price_of_place(choice.visit)?)
    }

    /// Returns the cost of one more place on a visit; `None` when no team is left.
    pub(super) fn price_of_place(&self, at: usize) -> Option<i64> {
        let visit = self.problem.visits[at];
        if !self.jobs[at].is_multiple_of(visit.jobs_a_team) {
            return Some(0);
        }
        let free = self.sent[visit.firm_day] < self.problem.teams[visit.firm_day];
        free.then_some(visit.travel)
    }

    /// Returns true if a visit has a team with one job there.
    pub(super) fn has_single(&self, visit: usize) -> bool {
        let others = self.jobs[visit].checked_sub(1);
        others.is_some_and(|others| others.is_multiple_of(self.problem.visits[visit].jobs_a_team))
    }

    /// Assigns a choice to a need, with or without a team for it, and returns
    /// its cost.
    pub(super) fn put(&mut self, need: usize, choice: usize) -> i64 {
        let chosen = self.problem.choices[choice];
        let visit = self.problem.visits[chosen.visit];
        let sends = self.jobs[chosen.visit].is_multiple_of(visit.jobs_a_team);
        self.jobs[chosen.visit] += 1;
        self.at_visit[chosen.visit].push(need);
        self.chosen[need] = Some(choice);
        self.moves.push((need, None));
        if sends {
            self.sent[visit.firm_day] += 1;
            return chosen.cost + visit.travel;
        }
        chosen.cost
    }

    /// Removes a need's choice, and returns the saving.
    pub(super) fn take(&mut self, need: usize) -> i64 {
        let Some(choice) = self.chosen[need].take() else {
            return self.problem.unmet[need];
        };
        self.moves.push((need, Some(choice)));
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

    /// Returns the mark for [`State::undo_to`].
    pub(super) fn mark(&self) -> usize {
        self.moves.len()
    }

    /// Undoes all moves since a mark.
    pub(super) fn undo_to(&mut self, mark: usize) {
        for (need, before) in self.moves.split_off(mark).into_iter().rev() {
            match before {
                Some(choice) => self.put(need, choice),
                None => self.take(need),
            };
        }
        self.moves.truncate(mark);
    }

    /// Forgets the moves.
    pub(super) fn settle(&mut self) {
        self.moves.clear();
    }

    /// Returns the cheapest way to meet a need now, with its cost; `None` where leaving
    /// it unmet is cheapest.
    fn best(&self, need: usize, order: &[Vec<usize>]) -> (Option<usize>, i64) {
        let mut best = (None, self.problem.unmet[need]);
        for &choice in &order[need] {
            // In order of cost: the rest is no cheaper.
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
        if let Some(before) = before {
            self.put(need, before);
        }
        false
    }
}
