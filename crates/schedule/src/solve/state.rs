//! The assignment under search, and greedy starting points.
//!
//! Invariant: the teams can do what is assigned, and travel costs what their
//! routes cost; both depend on the problem alone.

use super::problem::{Assignment, Problem};
use super::routes::{self, Answer, Spell};
use super::work_limit::WorkLimit;
use std::cell::RefCell;
use std::collections::{BTreeMap, HashMap};

/// The most answers that are kept.
const MAX_KEPT: usize = 400_000;
/// Work of a step of a route's search, in looks at a choice.
const STEP: usize = 5;

/// The cost of some jobs' routes, if there are any, and whether it is exact.
pub(super) type Travel = (Option<i64>, bool);

/// Answers of the routes' search, kept by the choices of a spell.
pub(super) struct Router<'a> {
    problem: &'a Problem,
    max_travel_s: Vec<i64>,
    kept: RefCell<HashMap<Box<[usize]>, Travel>>,
    pub(super) work: RefCell<usize>,
}

impl<'a> Router<'a> {
    pub(super) fn new(problem: &'a Problem) -> Router<'a> {
        Router {
            problem,
            max_travel_s: problem.crews.iter().map(routes::max_travel_s).collect(),
            kept: RefCell::new(HashMap::new()),
            work: RefCell::new(0),
        }
    }

    /// Returns the cost of travel for some choices of one crew, none where its teams cannot
    /// do them, and whether that is exact. The choices are in ascending order.
    pub(super) fn cost(&self, choices: &[usize]) -> Travel {
        let [first, rest @ ..] = choices else {
            return (Some(0), true);
        };
        let day = self.problem.days[self.problem.day_of(*first)];
        if rest.is_empty() && self.problem.crews[day.crew].taken.is_empty() {
            let travel = self.problem.visits[self.problem.choices[*first].visit].travel;
            return ((day.teams > 0).then_some(travel), true);
        }
        if let Some(known) = self.kept.borrow().get(choices) {
            return *known;
        }
        let answer = self.routes(choices);
        *self.work.borrow_mut() += STEP * answer.steps;
        let known = (answer.routes.map(|routes| routes.cost), answer.exact);
        let mut kept = self.kept.borrow_mut();
        if kept.len() >= MAX_KEPT {
            kept.clear();
        }
        kept.insert(choices.into(), known);
        known
    }

    /// Returns the routes for some choices of one crew.
    pub(super) fn routes(&self, choices: &[usize]) -> Answer {
        let crew = self.problem.days[self.problem.day_of(choices[0])].crew;
        routes::find(&Spell::new(self.problem, crew, choices))
    }

    /// Splits a crew's choices, by date, into spells.
    pub(super) fn spells(
        &self,
        crew: usize,
        by_date: &BTreeMap<i32, Vec<usize>>,
    ) -> Vec<Vec<usize>> {
        let mut spells = Vec::new();
        let mut dates: Vec<i32> = by_date.keys().copied().collect();
        while let Some(&date) = dates.first() {
            let (first, last) = self.reach(crew, by_date, date, None);
            spells.push(choices_within(by_date, first, last));
            dates.retain(|date| *date > last);
        }
        spells
    }

    /// Returns the first and last date of the spell around a date.
    fn reach(
        &self,
        crew: usize,
        by_date: &BTreeMap<i32, Vec<usize>>,
        date: i32,
        more: Option<usize>,
    ) -> (i32, i32) {
        let travel_s = self.max_travel_s[crew];
        // Dates of two zones are 26 hours apart at most, and a day has 24.
        let reach = i32::try_from(1 + (travel_s + 26 * 3600) / (24 * 3600)).unwrap_or(i32::MAX);
        let (mut first, mut last) = (date, date);
        let mut own: Vec<usize> = by_date.get(&date).into_iter().flatten().copied().collect();
        own.extend(more);
        loop {
            let near = by_date.range(first.saturating_sub(reach)..=last.saturating_add(reach));
            let mut outside = near.filter(|(other, _)| !(first..=last).contains(*other));
            let met = outside.find(|(other, choices)| {
                let is_before = **other < first;
                choices.iter().any(|choice| {
                    own.iter().any(|own| {
                        if is_before {
                            self.matters(*choice, *own)
                        } else {
                            self.matters(*own, *choice)
                        }
                    })
                })
            });
            let Some((&other, _)) = met else {
                return (first, last);
            };
            // Days in between belong to it as well.
            let grown = (first.min(other), last.max(other));
            for (_, choices) in by_date.range(grown.0..=grown.1) {
                own.extend(
                    choices
                        .iter()
                        .filter(|choice| !own.contains(choice))
                        .copied()
                        .collect::<Vec<_>>(),
                );
            }
            (first, last) = grown;
        }
    }

    /// Returns true if a team that makes a choice at the latest may be late for another.
    fn matters(&self, first: usize, next: usize) -> bool {
        let [one, other] = [first, next].map(|choice| self.problem.choices[choice]);
        let [from, to] = [one, other].map(|choice| self.problem.visits[choice.visit]);
        let crew = self.problem.days[from.day].crew;
        let travel_s = self.problem.crews[crew].travel_s[from.place][to.place];
        one.window.to + travel_s > other.window.from
    }
}

/// Returns the choices between two dates, in ascending order.
fn choices_within(by_date: &BTreeMap<i32, Vec<usize>>, first: i32, last: i32) -> Vec<usize> {
    let mut choices: Vec<usize> = by_date
        .range(first..=last)
        .flat_map(|(_, it)| it)
        .copied()
        .collect();
    choices.sort_unstable();
    choices
}

/// An assignment under search, with the choices of each crew by date.
pub(super) struct State<'a> {
    pub(super) problem: &'a Problem,
    pub(super) router: &'a Router<'a>,
    pub(super) chosen: Assignment,
    crews: Vec<BTreeMap<i32, Vec<usize>>>,
    /// Moves since the last settled state: the need, and its choice before.
    moves: Vec<(usize, Option<usize>)>,
}

impl<'a> State<'a> {
    /// Begins with an assignment that the teams can do.
    pub(super) fn new(router: &'a Router<'a>, begin: &[Option<usize>]) -> State<'a> {
        let problem = router.problem;
        let mut state = State {
            problem,
            router,
            chosen: vec![None; problem.unmet.len()],
            crews: vec![BTreeMap::new(); problem.crews.len()],
            moves: Vec::new(),
        };
        for choice in begin.iter().flatten() {
            state.set(problem.choices[*choice].need, Some(*choice));
        }
        state.settle();
        state
    }

    /// Returns the choices of the spell around a choice's day, that one aside.
    pub(super) fn spell_around(&self, choice: usize) -> Vec<usize> {
        let day = self.problem.days[self.problem.day_of(choice)];
        let by_date = &self.crews[day.crew];
        let (first, last) = self.router.reach(day.crew, by_date, day.date, Some(choice));
        let mut spell = choices_within(by_date, first, last);
        spell.retain(|other| *other != choice);
        spell
    }

    /// Returns the cost of adding a choice, travel included; `None` when no team can do it.
    pub(super) fn price_of(&self, choice: usize) -> Option<i64> {
        self.price_within(&self.spell_around(choice), choice, None)
    }

    /// Returns the cost of adding a choice to its spell, instead of another if that is
    /// given, without the saving of that one's own cost.
    pub(super) fn price_within(
        &self,
        spell: &[usize],
        choice: usize,
        instead_of: Option<usize>,
    ) -> Option<i64> {
        let before = self.router.cost(spell).0?;
        let mut with: Vec<usize> = spell
            .iter()
            .copied()
            .filter(|other| Some(*other) != instead_of)
            .collect();
        let at = with.partition_point(|other| *other < choice);
        with.insert(at, choice);
        Some(self.problem.choices[choice].cost + self.router.cost(&with).0? - before)
    }

    /// Assigns a choice to a need that has none, if a team can do it, and returns the cost.
    pub(super) fn put(&mut self, need: usize, choice: usize) -> Option<i64> {
        let price = self.price_of(choice)?;
        self.set(need, Some(choice));
        Some(price)
    }

    /// Removes a need's choice, and returns the saving.
    pub(super) fn take(&mut self, need: usize) -> i64 {
        let Some(choice) = self.chosen[need] else {
            return self.problem.unmet[need];
        };
        self.set(need, None);
        let own = self.problem.choices[choice].cost;
        // Where the search for routes is given up, the saving is not known.
        self.price_of(choice).unwrap_or(own)
    }

    fn set(&mut self, need: usize, choice: Option<usize>) {
        let before = std::mem::replace(&mut self.chosen[need], choice);
        self.moves.push((need, before));
        if let Some(before) = before {
            let day = self.problem.days[self.problem.day_of(before)];
            let there = self.crews[day.crew].entry(day.date).or_default();
            there.retain(|other| *other != before);
            if there.is_empty() {
                self.crews[day.crew].remove(&day.date);
            }
        }
        if let Some(choice) = choice {
            let day = self.problem.days[self.problem.day_of(choice)];
            self.crews[day.crew]
                .entry(day.date)
                .or_default()
                .push(choice);
        }
    }

    /// Returns the spells of all crews.
    pub(super) fn spells(&self) -> Vec<Vec<usize>> {
        let crews = self.crews.iter().enumerate();
        crews
            .flat_map(|(crew, by_date)| self.router.spells(crew, by_date))
            .collect()
    }

    /// Returns the cost of the assignment; `None` where the teams cannot do it.
    pub(super) fn cost(&self) -> Option<i64> {
        let own = self.problem.cost_without_travel(&self.chosen);
        let travel = self
            .spells()
            .into_iter()
            .map(|spell| self.router.cost(&spell).0);
        travel.sum::<Option<i64>>().map(|travel| own + travel)
    }

    /// Returns the mark for [`State::undo_to`].
    pub(super) fn mark(&self) -> usize {
        self.moves.len()
    }

    /// Undoes all moves since a mark.
    pub(super) fn undo_to(&mut self, mark: usize) {
        for (need, before) in self.moves.split_off(mark).into_iter().rev() {
            self.set(need, before);
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
            if choice.is_some() {
                self.set(need, choice);
            }
            return true;
        }
        if before.is_some() {
            self.set(need, before);
        }
        false
    }
}

/// Improves greedily: each need in turn takes its cheapest choice, until none
/// can improve.
pub(super) fn greedy(
    router: &Router<'_>,
    begin: &[Option<usize>],
    order: &[Vec<usize>],
    work: &mut WorkLimit,
) -> Assignment {
    let mut state = State::new(router, begin);
    loop {
        let mut moved = false;
        for (need, choices) in order.iter().enumerate() {
            if work.is_spent() {
                return state.chosen;
            }
            moved |= state.improve_one(need, order);
            work.spend(choices.len() * LOOK + router.work.take());
        }
        state.settle();
        if !moved {
            return state.chosen;
        }
    }
}

/// Work of a look at a choice with its spell.
pub(super) const LOOK: usize = 100;

/// Takes the first of these choices for each need that a team can do.
pub(super) fn take_first_feasible(router: &Router<'_>, choices: &[usize]) -> Assignment {
    let mut state = State::new(router, &vec![None; router.problem.unmet.len()]);
    for &choice in choices {
        let need = router.problem.choices[choice].need;
        if state.chosen[need].is_none() {
            state.put(need, choice);
        }
    }
    state.chosen
}
