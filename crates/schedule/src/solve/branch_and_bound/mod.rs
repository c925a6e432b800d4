//! Branch and bound on the choices that the bound leaves open, as mixed-integer
//! models of independent parts.
//!
//! A model counts teams. Where its answer cannot be driven, or costs more than
//! counted, a cut is added and the part is solved again; a cut that spans parts
//! joins them.
//!
//! Invariants: the returned assignment can be done and is no worse than the
//! given one. It is called optimal only where the solver finished its proof on
//! every part, and the whole can be driven at the counted cost. Work is counted
//! in nodes and pivots, not in seconds, so that the same problem has the same
//! answer. The work of one relaxation is known only afterwards, and bounded by
//! its part's size.

mod cuts;
mod model;

use super::open::Open;
use super::problem::Assignment;
use super::relaxation::Relaxation;
use super::state::{LOOK, Router, State};
use super::work_limit::WorkLimit;
use cuts::Cut;
use microlp::{SolveOptions, TerminationReason};
use model::{Model, Sent};
use std::collections::{BTreeMap, BTreeSet};

/// The most open choices of a part for branch and bound. The relaxation of a
/// larger one takes longer than everything else, and never led to a better
/// assignment.
const LARGE_PART: usize = 5_000;
/// Work of a simplex step per choice.
const PIVOT: usize = 2;
/// The most rounds of cuts.
const ROUNDS: usize = 60;

/// The result of branch and bound.
pub(super) struct Outcome {
    pub(super) assignment: Assignment,
    /// True if no other assignment of these choices is cheaper.
    pub(super) optimal: bool,
}

/// The relaxed problem, the routes, and the cuts found so far.
pub(super) struct Models<'a> {
    pub(super) relaxation: &'a Relaxation<'a>,
    pub(super) router: &'a Router<'a>,
    cuts: BTreeSet<Cut>,
}

/// A solution of a part.
#[derive(Clone)]
struct Solved {
    made: Vec<(usize, Option<usize>)>,
    /// True if no other costs less.
    proven: bool,
    /// Its cost, with the teams that the model counts.
    cost: i64,
    /// Number of teams counted at each visit.
    teams: Vec<(usize, u32)>,
}

impl<'a> Models<'a> {
    pub(super) fn new(relaxation: &'a Relaxation<'a>, router: &'a Router<'a>) -> Models<'a> {
        Models {
            relaxation,
            router,
            cuts: BTreeSet::new(),
        }
    }

    /// Finds the cheapest assignment within `open`, for each part of choices that
    /// share no need, no crew's day and no cut. A part of many choices may take
    /// fewer nodes, and one that is too large none: `effort` is nodes times choices.
    pub(super) fn solve_parts(
        &mut self,
        open: &Open,
        known: &[Option<usize>],
        effort: usize,
        work: &mut WorkLimit,
    ) -> Outcome {
        let problem = self.relaxation.problem;
        let sent = Sent::new(self.relaxation, self.router, known);
        let mut solved: BTreeMap<(Vec<usize>, usize), Option<Solved>> = BTreeMap::new();
        let mut best: Vec<Solved> = Vec::new();
        let mut optimal = false;
        for _ in 0..ROUNDS {
            work.spend(2 * problem.choices.len() + LOOK * known.len());
            let mut trial = known.to_vec();
            let mut teams = sent.to_visit.clone();
            let (mut proven, mut counted, mut of_parts) = (true, 0, vec![false; known.len()]);
            best.clear();
            for part in self.parts(&open.choices) {
                for index in &part {
                    of_parts[problem.choices[*index].need] = true;
                }
                // A part is settled if each need has one choice, which is made, and
                // none may stay unmet.
                let is_settled = |index: &usize| {
                    let need = problem.choices[*index].need;
                    known[need] == Some(*index) && !open.unmet[need]
                };
                if part.iter().all(is_settled) {
                    counted += self.cost_alone(&part);
                    continue;
                }
                let cuts = self.cuts_within(&part);
                let key = (part, cuts.len());
                if !solved.contains_key(&key) {
                    let part = &key.0;
                    let nodes = (effort / part.len().max(1)).max(1) as u64;
                    let found = (part.len() <= LARGE_PART && !work.is_spent())
                        .then(|| self.solve_part(part, &cuts, known, &sent, nodes, work))
                        .flatten();
                    solved.insert(key.clone(), found);
                }
                let Some(found) = &solved[&key] else {
                    proven = false;
                    continue;
                };
                proven &= found.proven;
                counted += found.cost;
                for (need, choice) in &found.made {
                    trial[*need] = *choice;
                }
                for (visit, sent) in &found.teams {
                    teams[*visit] = *sent;
                }
                best.push(found.clone());
            }
            let without_parts = of_parts.iter().zip(&problem.unmet);
            counted += without_parts
                .map(|(is, unmet)| if *is { 0 } else { *unmet })
                .sum::<i64>();
            let state = State::new(self.router, &trial);
            let cuts = state.spells().into_iter().filter_map(|spell| {
                cuts::find(problem, self.router, &open.choices, &spell, &teams)
            });
            let cuts: Vec<Cut> = cuts.collect();
            work.spend(self.router.work.take());
            if cuts.is_empty() {
                optimal = proven && state.cost().is_some_and(|cost| cost <= counted);
                break;
            }
            let before = self.cuts.len();
            self.cuts.extend(cuts);
            if self.cuts.len() == before || work.is_spent() {
                break;
            }
        }
        let assignment = self.take_what_is_cheaper(known, &best);
        Outcome {
            assignment,
            optimal,
        }
    }

    /// Returns the cost of some choices as if there were no others.
    fn cost_alone(&self, choices: &[usize]) -> i64 {
        let problem = self.relaxation.problem;
        let mut of_crews: BTreeMap<usize, Vec<usize>> = BTreeMap::new();
        for choice in choices {
            let crew = problem.days[problem.day_of(*choice)].crew;
            of_crews.entry(crew).or_default().push(*choice);
        }
        let own: i64 = choices
            .iter()
            .map(|choice| problem.choices[*choice].cost)
            .sum();
        let travel = of_crews
            .values()
            .map(|choices| match self.router.cost(choices) {
                (Some(cost), true) => cost,
                // Not known exactly: nothing is proven with it.
                _ => 0,
            });
        own + travel.sum::<i64>()
    }

    /// Takes all parts' solutions, or each that is cheaper with the rest as it is.
    fn take_what_is_cheaper(&self, known: &[Option<usize>], parts: &[Solved]) -> Assignment {
        let cost_of = |assignment: &[Option<usize>]| State::new(self.router, assignment).cost();
        let is_no_dearer =
            |assignment: &[Option<usize>]| match (cost_of(assignment), cost_of(known)) {
                (Some(cost), Some(known)) => cost <= known,
                (cost, _) => cost.is_some(),
            };
        let mut all = known.to_vec();
        for (need, choice) in parts.iter().flat_map(|part| &part.made) {
            all[*need] = *choice;
        }
        if is_no_dearer(&all) {
            return all;
        }
        let mut state = State::new(self.router, known);
        for part in parts {
            let mark = state.mark();
            let saved: i64 = part.made.iter().map(|(need, _)| state.take(*need)).sum();
            let each = part.made.iter().map(|(need, choice)| match choice {
                Some(choice) => state.put(*need, *choice),
                None => Some(state.problem.unmet[*need]),
            });
            if each.sum::<Option<i64>>().is_none_or(|cost| cost >= saved) {
                state.undo_to(mark);
            }
            state.settle();
        }
        if is_no_dearer(&state.chosen) {
            return state.chosen;
        }
        known.to_vec()
    }

    /// Returns the cuts whose choices are all in a part.
    fn cuts_within(&self, part: &[usize]) -> Vec<Cut> {
        let is_in = |choice: &usize| part.binary_search(choice).is_ok();
        let within = self.cuts.iter().filter_map(|cut| match cut {
            // Choices that are not open are not made.
            Cut::AtMost { choices, most } => {
                let choices: Vec<usize> = choices.iter().copied().filter(is_in).collect();
                (choices.len() > *most).then_some(Cut::AtMost {
                    choices,
                    most: *most,
                })
            }
            Cut::Travel { choices, .. } => choices.iter().all(is_in).then(|| cut.clone()),
        });
        within.collect()
    }

    /// Splits the open choices into independent parts.
    fn parts(&self, open: &[bool]) -> Vec<Vec<usize>> {
        let problem = self.relaxation.problem;
        let needs = problem.unmet.len();
        let mut leader: Vec<usize> = (0..needs + problem.days.len()).collect();
        for (index, choice) in problem.choices.iter().enumerate() {
            if open[index] {
                join(&mut leader, choice.need, needs + problem.day_of(index));
            }
        }
        for cut in &self.cuts {
            let choices = cut.choices().iter();
            let choices: Vec<usize> = choices.copied().filter(|choice| open[*choice]).collect();
            for pair in choices.windows(2) {
                let days = [pair[0], pair[1]].map(|choice| needs + problem.day_of(choice));
                join(&mut leader, days[0], days[1]);
            }
        }
        let mut parts: BTreeMap<usize, Vec<usize>> = BTreeMap::new();
        for (index, choice) in problem.choices.iter().enumerate() {
            if open[index] {
                parts
                    .entry(find(&mut leader, choice.need))
                    .or_default()
                    .push(index);
            }
        }
        parts.into_values().collect()
    }

    /// Solves one part: its best choices and whether they are proven optimal;
    /// `None` without a solution.
    fn solve_part(
        &self,
        part: &[usize],
        cuts: &[Cut],
        known: &[Option<usize>],
        sent: &Sent,
        nodes: u64,
        work: &mut WorkLimit,
    ) -> Option<Solved> {
        let problem = self.relaxation.problem;
        let mut model = Model::new(self.relaxation);
        model.add_choices(part, known);
        model.add_teams(sent);
        for cut in cuts {
            model.add_cut(cut);
        }
        let mut options = SolveOptions::default();
        options.node_limit = Some(nodes);
        options.warm_start = Some(model.warm);
        let solved = model.program.solve_with(options).ok()?;
        let pivots = usize::try_from(solved.stats().lp_iterations).unwrap_or(usize::MAX);
        work.spend(pivots.saturating_mul(PIVOT * part.len()));
        let solved = solved.into_solution().ok()?;
        let proven = solved.termination_reason() == TerminationReason::ProvenOptimal;
        let mut found: BTreeMap<usize, Option<usize>> = BTreeMap::new();
        for (index, x) in &model.made {
            let made = found.entry(problem.choices[*index].need).or_default();
            if solved.var_value(*x) > 0.5 {
                *made = Some(*index);
            }
        }
        let teams = model.teams.iter().map(|(visit, y)| {
            let sent = solved.var_value(*y).round().max(0.0) as u32;
            (*visit, sent)
        });
        let teams: Vec<(usize, u32)> = teams.collect();
        let own = found.iter().map(|(need, choice)| match choice {
            Some(choice) => problem.choices[*choice].cost,
            None => problem.unmet[*need],
        });
        let travel = teams
            .iter()
            .map(|(visit, sent)| i64::from(*sent) * problem.visits[*visit].travel);
        Some(Solved {
            proven,
            cost: own.sum::<i64>() + travel.sum::<i64>(),
            made: found.into_iter().collect(),
            teams,
        })
    }
}

fn join(leader: &mut [usize], one: usize, other: usize) {
    let (one, other) = (find(leader, one), find(leader, other));
    leader[one.max(other)] = one.min(other);
}

fn find(leader: &mut [usize], mut of: usize) -> usize {
    while leader[of] != of {
        leader[of] = leader[leader[of]];
        of = leader[of];
    }
    of
}
