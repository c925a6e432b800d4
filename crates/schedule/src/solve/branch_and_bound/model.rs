//! The mixed-integer model of a part: choices are made or not, and teams are
//! counted.

use super::cuts::Cut;
use crate::solve::relaxation::{Relaxation, Stay};
use crate::solve::state::{Router, State};
use microlp::{ComparisonOp, LinearExpr, OptimizationDirection, Variable};
use std::collections::{BTreeMap, BTreeSet};

/// The numbers of teams that the known assignment sends.
pub(super) struct Sent {
    pub(super) to_visit: Vec<u32>,
    /// By the first visit of a stay.
    to_stay: Vec<u32>,
}

impl Sent {
    pub(super) fn new(
        relaxation: &Relaxation<'_>,
        router: &Router<'_>,
        known: &[Option<usize>],
    ) -> Sent {
        let problem = relaxation.problem;
        let mut first = vec![0; problem.visits.len()];
        for stay in relaxation.stays.iter().flatten() {
            for visit in &stay.visits {
                first[*visit] = stay.visits[0];
            }
        }
        let (mut visits, mut stays) = (BTreeSet::new(), BTreeSet::new());
        for (at, spell) in State::new(router, known).spells().into_iter().enumerate() {
            let routes = router.routes(&spell).routes;
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
pub(super) struct Model<'a> {
    relaxation: &'a Relaxation<'a>,
    pub(super) program: microlp::Problem,
    pub(super) warm: Vec<(Variable, f64)>,
    /// 1 for each choice that is made.
    pub(super) made: BTreeMap<usize, Variable>,
    of_visit: BTreeMap<usize, Vec<Variable>>,
    /// Teams at each visit.
    pub(super) teams: BTreeMap<usize, Variable>,
}

impl<'a> Model<'a> {
    pub(super) fn new(relaxation: &'a Relaxation<'a>) -> Model<'a> {
        Model {
            relaxation,
            program: microlp::Problem::new(OptimizationDirection::Minimize),
            warm: Vec::new(),
            made: BTreeMap::new(),
            of_visit: BTreeMap::new(),
            teams: BTreeMap::new(),
        }
    }

    pub(super) fn add_choices(&mut self, part: &[usize], known: &[Option<usize>]) {
        let problem = self.relaxation.problem;
        let mut of_need: BTreeMap<usize, Vec<(Variable, f64)>> = BTreeMap::new();
        for &index in part {
            let choice = problem.choices[index];
            // A choice is worth its saving against leaving the need unmet.
            let worth = (choice.cost - problem.unmet[choice.need]) as f64 / CENTS;
            let x = self.program.add_binary_var(worth);
            let made = known[choice.need] == Some(index);
            self.warm.push((x, f64::from(u8::from(made))));
            self.made.insert(index, x);
            of_need.entry(choice.need).or_default().push((x, 1.0));
            self.of_visit.entry(choice.visit).or_default().push(x);
        }
        for row in of_need.into_values() {
            self.program.add_constraint(row, ComparisonOp::Le, 1.0);
        }
    }

    pub(super) fn add_teams(&mut self, sent: &Sent) {
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
                .program
                .add_integer_var(of.travel as f64 / CENTS, (0, most));
            self.warm.push((y, f64::from(sent.to_visit[visit])));
            self.teams.insert(visit, y);
            let each = self.relaxation.jobs[visit];
            add_capacity(&mut self.program, jobs, y, each);
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
            self.program.add_constraint(sent, ComparisonOp::Le, teams);
        }
    }

    /// Adds the teams that go to any of several places.
    fn add_stay(&mut self, stay: &Stay, visits: &[usize], sent: &Sent) -> Variable {
        let day = self.relaxation.problem.days[stay.day];
        let out = self
            .program
            .add_integer_var(0.0, (0, day.teams.cast_signed()));
        let first = stay.visits[0];
        self.warm.push((out, f64::from(sent.to_stay[first])));
        let mut jobs = Vec::new();
        for visit in visits {
            let there = self.teams[visit];
            self.program
                .add_constraint([(there, 1.0), (out, -1.0)], ComparisonOp::Le, 0.0);
            jobs.extend(self.of_visit[visit].iter().copied());
        }
        let each = self.relaxation.problem.crews[day.crew].jobs_a_team as usize;
        add_capacity(&mut self.program, &jobs, out, each);
        out
    }

    pub(super) fn add_cut(&mut self, cut: &Cut) {
        let problem = self.relaxation.problem;
        let mut row = LinearExpr::empty();
        match cut {
            Cut::AtMost { choices, most } => {
                for choice in choices {
                    row.add(self.made[choice], 1.0);
                }
                self.program
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
                self.program
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
