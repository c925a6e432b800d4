//! The cheapest routes, by dynamic programming over the days of a spell.
//!
//! Within a day one team after the other takes a sequence of stops. Of teams
//! that are alike the one with the earlier first stop in the list comes first,
//! so that no two are tried the other way round.

use super::spell::{Day, Load, Spell, Stop, Team};
use super::{Answer, Leg, Routes};

/// The most stops of a day that are searched.
const MAX_STOPS: usize = 64;

/// The places of all teams at the end of a day.
#[derive(Clone)]
struct State {
    teams: Vec<Team>,
    cost: i64,
    legs: Vec<Leg>,
}

/// Finds the cheapest routes within a number of steps. Routes that cost no more
/// than `least` are the cheapest.
pub(super) fn find(spell: &Spell<'_>, least: i64, max_steps: usize) -> Answer {
    let mut steps = 0;
    let mut states = vec![State {
        teams: vec![Team::FREE; spell.crew.teams as usize],
        cost: 0,
        legs: Vec::new(),
    }];
    let mut exact = spell.days.iter().all(|day| day.stops.len() <= MAX_STOPS);
    if !exact {
        states.clear();
    }
    for (at, day) in spell.days.iter().enumerate() {
        let mut next = Vec::new();
        for state in &states {
            let mut today = Today {
                spell,
                day,
                next_day: at + 1,
                before: &state.teams,
                teams: state.teams.clone(),
                first: vec![usize::MAX; state.teams.len()],
                cost: state.cost,
                legs: state.legs.clone(),
                found: &mut next,
                steps,
                max_steps,
                least: (at + 1 == spell.days.len()).then_some(least),
            };
            today.send(
                0,
                0,
                if day.stops.len() == MAX_STOPS {
                    u64::MAX
                } else {
                    (1 << day.stops.len()) - 1
                },
            );
            steps = today.steps;
        }
        exact &= steps <= max_steps;
        states = next;
    }
    let best = states.into_iter().min_by_key(|state| state.cost);
    let routes = best.map(|state| Routes {
        cost: state.cost,
        legs: state.legs,
    });
    let exact = exact || routes.as_ref().is_some_and(|routes| routes.cost <= least);
    Answer {
        routes,
        exact,
        steps,
    }
}

/// One day, under search.
struct Today<'a> {
    spell: &'a Spell<'a>,
    day: &'a Day,
    next_day: usize,
    /// The teams in the morning.
    before: &'a [Team],
    teams: Vec<Team>,
    /// The first stop in the list that each team takes.
    first: Vec<usize>,
    cost: i64,
    legs: Vec<Leg>,
    found: &'a mut Vec<State>,
    steps: usize,
    max_steps: usize,
    /// A cost that no routes are below, on the last day.
    least: Option<i64>,
}

impl Today<'_> {
    fn is_over(&self) -> bool {
        let least = self.least.unwrap_or(i64::MIN);
        self.steps > self.max_steps || self.found.iter().any(|state| state.cost <= least)
    }

    /// Sends a team and those after it to the stops that are left.
    fn send(&mut self, team: usize, out: usize, left: u64) {
        self.steps += 1;
        if left == 0 {
            self.finish();
            return;
        }
        if team == self.teams.len() || out == self.day.teams || self.is_over() {
            return;
        }
        let free = (self.teams.len() - team).min(self.day.teams - out);
        let jobs = stops(left)
            .filter(|stop| self.day.stops[*stop].choice.is_some())
            .count();
        if jobs > free * self.spell.crew.jobs_a_team as usize {
            return;
        }
        self.drive(team, out, left, Load::default(), &mut Vec::new());
        // A team that stays in is like the last of those alike.
        self.send_next(team, out, left);
    }

    /// Goes on with the next team that may go out.
    fn send_next(&mut self, team: usize, out: usize, left: u64) {
        let mut next = team + 1;
        if self.first[team] == usize::MAX {
            while next < self.teams.len() && self.before[next] == self.before[team] {
                next += 1;
            }
        }
        self.send(next, out, left);
    }

    /// Gives a team one more stop, in every way.
    fn drive(&mut self, team: usize, out: usize, left: u64, load: Load, places: &mut Vec<usize>) {
        let alike = team > 0 && self.before[team - 1] == self.before[team];
        let after = if alike {
            Some(self.first[team - 1])
        } else {
            None
        };
        for stop in stops(left) {
            // The team before has the earlier stop.
            if after.is_some_and(|after| stop < after) {
                continue;
            }
            self.steps += 1;
            if self.is_over() {
                return;
            }
            let to: Stop = self.day.stops[stop];
            let Some(load) = load.with(&to, self.spell.crew.jobs_a_team) else {
                continue;
            };
            let before = self.teams[team];
            let Some(begin) = self.spell.begin(before, &to) else {
                continue;
            };
            let comes = to
                .place
                .filter(|place| to.choice.is_some() && !places.contains(place));
            let cost = if comes.is_some() { to.travel } else { 0 };
            let first = self.first[team];
            places.extend(comes);
            self.cost += cost;
            self.teams[team] = Spell::after(before, &to, begin);
            self.first[team] = first.min(stop);
            self.legs.push(Leg {
                team,
                choice: to.choice,
                from: begin,
            });
            let left = left & !(1 << stop);
            self.drive(team, out, left, load, places);
            self.send_next(team, out + 1, left);
            self.legs.pop();
            self.first[team] = first;
            self.teams[team] = before;
            self.cost -= cost;
            if comes.is_some() {
                places.pop();
            }
        }
    }

    /// Keeps the end of a day, unless another is no worse in anything.
    fn finish(&mut self) {
        let mut teams = self.teams.clone();
        self.spell.free_by(&mut teams, self.next_day);
        let sorted = |teams: &[Team]| {
            let mut sorted = teams.to_vec();
            sorted.sort_unstable();
            sorted
        };
        let new = sorted(&teams);
        let is_no_worse = |cost: i64, one: &[Team], than: i64, other: &[Team]| {
            cost <= than
                && one.iter().zip(other).all(|(one, other)| {
                    *one == Team::FREE || one.place == other.place && one.ready <= other.ready
                })
        };
        for state in self.found.iter() {
            if is_no_worse(state.cost, &sorted(&state.teams), self.cost, &new) {
                return;
            }
        }
        self.found
            .retain(|state| !is_no_worse(self.cost, &new, state.cost, &sorted(&state.teams)));
        self.found.push(State {
            teams,
            cost: self.cost,
            legs: self.legs.clone(),
        });
    }
}

/// Returns the stops of a set, in order.
fn stops(mut set: u64) -> impl Iterator<Item = usize> {
    std::iter::from_fn(move || {
        let stop = set.trailing_zeros();
        (set != 0).then(|| {
            set &= set - 1;
            stop as usize
        })
    })
}
