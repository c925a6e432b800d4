//! The hours of an assignment: when each job begins, which team does it, and
//! what room that leaves for one more.

use super::problem::{Assignment, Choice, CrewDay, Problem, Visit, Window};
use super::routes::{self, Spell};
use super::state::{Router, State};

/// The team and the beginning of a job.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub struct Appointment {
    /// The team of the crew, from 0.
    pub team: usize,
    /// Beginning, seconds since 1970.
    pub from: i64,
}

/// Returns the appointment of each need that an assignment meets; `None` for the others,
/// and for jobs that their teams cannot do together.
pub fn timetable(problem: &Problem, assignment: &[Option<usize>]) -> Vec<Option<Appointment>> {
    let router = Router::new(problem);
    let mut appointments = vec![None; problem.unmet.len()];
    for spell in State::new(&router, assignment).spells() {
        let routes = router.routes(&spell).routes;
        for leg in routes.into_iter().flat_map(|routes| routes.legs) {
            let Some(choice) = leg.choice else { continue };
            appointments[problem.choices[choice].need] = Some(Appointment {
                team: leg.team,
                from: leg.from,
            });
        }
    }
    appointments
}

/// One more job of a crew.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub struct Wanted {
    /// The crew.
    pub crew: usize,
    /// The day.
    pub date: i32,
    /// Teams at work on that day.
    pub teams: u32,
    /// The place.
    pub place: usize,
    /// Hours within which it is done.
    pub window: Window,
    /// Seconds of the job.
    pub length_s: i64,
}

/// The jobs of each crew, as a problem of its own.
pub struct Room {
    crews: Vec<(Problem, Assignment)>,
}

impl Room {
    /// Finds the room that an assignment leaves.
    pub fn new(problem: &Problem, assignment: &[Option<usize>]) -> Room {
        let own = problem.crews.iter().map(|crew| {
            let problem = Problem {
                job_s: problem.job_s,
                crews: vec![crew.clone()],
                ..Problem::default()
            };
            (problem, Vec::new())
        });
        let mut crews: Vec<(Problem, Assignment)> = own.collect();
        for choice in assignment.iter().flatten() {
            let visit = problem.visits[problem.choices[*choice].visit];
            let day = problem.days[visit.day];
            let (of, done) = &mut crews[day.crew];
            add(of, day, visit, problem.choices[*choice]);
            done.push(Some(done.len()));
        }
        Room { crews }
    }

    /// Returns the earliest end of one more job with so many teams more; `None` where they
    /// have no room for it.
    pub fn earliest_end(&self, wanted: &Wanted, more_teams: u32) -> Option<i64> {
        let (mut problem, mut done) = self.crews[wanted.crew].clone();
        for day in problem
            .days
            .iter_mut()
            .filter(|day| day.date == wanted.date)
        {
            day.teams = day.teams.saturating_add(more_teams);
        }
        problem.crews[0].teams = problem.crews[0].teams.saturating_add(more_teams);
        let day = CrewDay {
            crew: 0,
            date: wanted.date,
            teams: wanted.teams.saturating_add(more_teams),
        };
        let visit = Visit {
            day: 0,
            place: wanted.place,
            travel: 0,
        };
        let choice = Choice {
            need: 0,
            visit: 0,
            cost: 0,
            window: wanted.window,
            length_s: wanted.length_s,
        };
        add(&mut problem, day, visit, choice);
        done.push(None);
        let new = done.len() - 1;
        let router = Router::new(&problem);
        let mut spell = State::new(&router, &done).spell_around(new);
        spell.push(new);
        let routes = routes::find(&Spell::new(&problem, 0, &spell)).routes?;
        let own = routes.legs.iter().find(|leg| leg.choice == Some(new));
        own.map(|leg| leg.from + wanted.length_s)
    }

    /// Returns the choices, of the assignment's problem, that are near a day of a crew: those
    /// that may keep its teams from a job there.
    pub fn near(
        problem: &Problem,
        assignment: &[Option<usize>],
        crew: usize,
        date: i32,
    ) -> Vec<usize> {
        let days = i64::from(u8::MAX).min(1 + routes::max_travel_s(&problem.crews[crew]) / 86_400);
        let is_near = |choice: &usize| {
            let day = problem.days[problem.day_of(*choice)];
            day.crew == crew && i64::from((day.date - date).abs()) <= days
        };
        assignment
            .iter()
            .flatten()
            .copied()
            .filter(is_near)
            .collect()
    }
}

/// Adds a need with one choice, which has the hours of another.
fn add(problem: &mut Problem, day: CrewDay, visit: Visit, choice: Choice) {
    problem.days.push(CrewDay { crew: 0, ..day });
    problem.visits.push(Visit {
        day: problem.days.len() - 1,
        ..visit
    });
    problem.choices.push(Choice {
        need: problem.unmet.len(),
        visit: problem.visits.len() - 1,
        cost: 0,
        ..choice
    });
    problem.unmet.push(0);
}
