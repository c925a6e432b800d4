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

use super::cuts::{self, Cut};
use super::open::Open;
use super::problem::Assignment;
use super::relaxation::{Relaxation, Stay};
use super::state::{Router, State};
use super::work_limit::WorkLimit;
use microlp::{
    ComparisonOp, LinearExpr, OptimizationDirection, SolveOptions, TerminationReason, Variable,
};
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
    pub(super) cuts: BTreeSet<Cut>,
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
        let sent = Sent::new(self, known);
        let mut solved: BTreeMap<(Vec<usize>, usize), Option<Solved>> = BTreeMap::new();
        let mut best: Vec<Solved> = Vec::new();
        let mut optimal = false;
        for _ in 0..ROUNDS {
            work.spend(2 * problem.choices.len());
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
                        .then(|| self.solve_part(part, &cuts, (known, &sent), nodes, work))
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
        let with = |assignment: &[Option<usize>], part: &Solved| {
            let mut with = assignment.to_vec();
            for (need, choice) in &part.made {
                with[*need] = *choice;
            }
            with
        };
        let mut best = (cost_of(known), known.to_vec());
        let all = parts
            .iter()
            .fold(known.to_vec(), |all, part| with(&all, part));
        let is_cheaper = |cost: Option<i64>, than: Option<i64>| match (cost, than) {
            (Some(cost), Some(than)) => cost < than,
            (cost, _) => cost.is_some(),
        };
        let cost = cost_of(&all);
        if cost.is_some() && !is_cheaper(best.0, cost) {
            return all;
        }
        for part in parts {
            let with = with(&best.1, part);
            let cost = cost_of(&with);
            if is_cheaper(cost, best.0) {
                best = (cost, with);
            }
        }
        best.1
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
        (known, sent): (&[Option<usize>], &Sent),
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
        let solved = model.model.solve_with(options).ok()?;
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

/// The numbers of teams that the known assignment sends.
struct Sent {
    to_visit: Vec<u32>,
    /// By the first visit of a stay.
    to_stay: Vec<u32>,
}

impl Sent {
    fn new(models: &Models<'_>, known: &[Option<usize>]) -> Sent {
        let problem = models.relaxation.problem;
        let mut first = vec![0; problem.visits.len()];
        for stay in models.relaxation.stays.iter().flatten() {
            for visit in &stay.visits {
                first[*visit] = stay.visits[0];
            }
        }
        let (mut visits, mut stays) = (BTreeSet::new(), BTreeSet::new());
        for (at, spell) in State::new(models.router, known)
            .spells()
            .into_iter()
            .enumerate()
        {
            let routes = models.router.routes(&spell).routes;
            for leg in routes.into_iter().flat_map(|routes| routes.legs) {
                let Some(choice) = leg.choice else { continue };
                let visit = problem.choices[choice].visit;
                visits.insert((visit, at, leg.team));
                stays.insert((first[visit], at, leg.team));
            }
        }
        let count = |teams: BTreeSet<(usize, usize, usize)>| {
            let mut counts = vec![0; problem.visits.len()];
            for (visit, ..) in teams {
                counts[visit] += 1;
            }
            counts
        };
        Sent {
            to_visit: count(visits),
            to_stay: count(stays),
        }
    }
}

const CENTS: f64 = 100.0;

/// A mixed-integer model of a part.
struct Model<'a> {
    relaxation: &'a Relaxation<'a>,
    model: microlp::Problem,
    warm: Vec<(Variable, f64)>,
    /// Whether each choice is made.
    made: BTreeMap<usize, Variable>,
    of_visit: BTreeMap<usize, Vec<Variable>>,
    /// Teams at each visit.
    teams: BTreeMap<usize, Variable>,
}

impl<'a> Model<'a> {
    fn new(relaxation: &'a Relaxation<'a>) -> Model<'a> {
        Model {
            relaxation,
            model: microlp::Problem::new(OptimizationDirection::Minimize),
            warm: Vec::new(),
            made: BTreeMap::new(),
            of_visit: BTreeMap::new(),
            teams: BTreeMap::new(),
        }
    }

    fn add_choices(&mut self, part: &[usize], known: &[Option<usize>]) {
        let problem = self.relaxation.problem;
        let mut of_need: BTreeMap<usize, Vec<(Variable, f64)>> = BTreeMap::new();
        for &index in part {
            let choice = problem.choices[index];
            // A choice is worth its saving against leaving the need unmet.
            let worth = (choice.cost - problem.unmet[choice.need]) as f64 / CENTS;
            let x = self.model.add_binary_var(worth);
            let made = known[choice.need] == Some(index);
            self.warm.push((x, f64::from(u8::from(made))));
            self.made.insert(index, x);
            of_need.entry(choice.need).or_default().push((x, 1.0));
            self.of_visit.entry(choice.visit).or_default().push(x);
        }
        for row in of_need.into_values() {
            self.model.add_constraint(row, ComparisonOp::Le, 1.0);
        }
    }

    fn add_teams(&mut self, sent: &Sent) {
        let problem = self.relaxation.problem;
        let mut of_day: BTreeMap<usize, LinearExpr> = BTreeMap::new();
        let visits: Vec<usize> = self.of_visit.keys().copied().collect();
        for visit in visits {
            let of = problem.visits[visit];
            let jobs = &self.of_visit[&visit];
            let most = problem.days[of.day]
                .teams
                .min(jobs.len() as u32)
                .cast_signed();
            let y = self
                .model
                .add_integer_var(of.travel as f64 / CENTS, (0, most));
            self.warm.push((y, f64::from(sent.to_visit[visit])));
            self.teams.insert(visit, y);
            let each = self.relaxation.jobs[visit];
            add_capacity(&mut self.model, jobs, y, each);
        }
        for stay in self.relaxation.stays.iter().flatten() {
            let here = stay
                .visits
                .iter()
                .copied()
                .filter(|visit| self.teams.contains_key(visit));
            let here: Vec<usize> = here.collect();
            let out = match here[..] {
                [] => continue,
                [only] => self.teams[&only],
                [..] => self.add_stay(stay, &here, sent),
            };
            of_day
                .entry(stay.day)
                .or_insert_with(LinearExpr::empty)
                .add(out, 1.0);
        }
        for (day, sent) in of_day {
            let teams = f64::from(problem.days[day].teams);
            self.model.add_constraint(sent, ComparisonOp::Le, teams);
        }
    }

    /// Adds the teams that go to any of several places.
    fn add_stay(&mut self, stay: &Stay, visits: &[usize], sent: &Sent) -> Variable {
        let day = self.relaxation.problem.days[stay.day];
        let out = self
            .model
            .add_integer_var(0.0, (0, day.teams.cast_signed()));
        let first = stay.visits[0];
        self.warm.push((out, f64::from(sent.to_stay[first])));
        let mut jobs = Vec::new();
        for visit in visits {
            let there = self.teams[visit];
            self.model
                .add_constraint([(there, 1.0), (out, -1.0)], ComparisonOp::Le, 0.0);
            jobs.extend(self.of_visit[visit].iter().copied());
        }
        let each = self.relaxation.problem.crews[day.crew].jobs_a_team as usize;
        add_capacity(&mut self.model, &jobs, out, each);
        out
    }

    fn add_cut(&mut self, cut: &Cut) {
        let problem = self.relaxation.problem;
        let mut row = LinearExpr::empty();
        match cut {
            Cut::AtMost { choices, most } => {
                for choice in choices {
                    row.add(self.made[choice], 1.0);
                }
                self.model
                    .add_constraint(row, ComparisonOp::Le, *most as f64);
            }
            Cut::Travel { choices, least } => {
                let least = *least as f64 / CENTS;
                let visits = choices.iter().map(|choice| problem.choices[*choice].visit);
                for visit in visits.collect::<BTreeSet<usize>>() {
                    row.add(
                        self.teams[&visit],
                        problem.visits[visit].travel as f64 / CENTS,
                    );
                }
                for choice in choices {
                    row.add(self.made[choice], -least);
                }
                let all_but_one = (choices.len() - 1) as f64;
                self.model
                    .add_constraint(row, ComparisonOp::Ge, -least * all_but_one);
            }
        }
    }
}

/// Limits jobs to a number for each team.
fn add_capacity(model: &mut microlp::Problem, jobs: &[Variable], teams: Variable, each: usize) {
    let mut capacity = LinearExpr::empty();
    capacity.add(teams, -(each as f64));
    for &x in jobs {
        capacity.add(x, 1.0);
        if each > 1 {
            model.add_constraint([(x, 1.0), (teams, -1.0)], ComparisonOp::Le, 0.0);
        }
    }
    model.add_constraint(capacity, ComparisonOp::Le, 0.0);
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
