//! The relaxed problem, whose least cost is a lower bound: teams are followed
//! from day to day, and not from job to job.
//!
//! A stay is a crew's day at one place, or at several that can be reached from
//! each other on that day. There a team does as many jobs as there is time for
//! between the first beginning and the last end of any. It can go on to a later
//! stay if the first job that could end at the one leaves time for the last that
//! could begin at the other. Two jobs of one stay that a team cannot do one
//! after the other are not known here: routes only cost more.

use super::problem::{Problem, Window};
use super::routes::max_travel_s;

const NEVER: Window = Window {
    from: i64::MAX,
    to: i64::MIN,
};

/// The stays of all crews, and their capacities.
pub(super) struct Relaxation<'a> {
    pub(super) problem: &'a Problem,
    /// The choices of each visit.
    pub(super) choices: Vec<Vec<usize>>,
    /// The most jobs of a team on each visit.
    pub(super) jobs: Vec<usize>,
    /// The stays of each crew, by date.
    pub(super) stays: Vec<Vec<Stay>>,
}

/// A crew's day at places that a team may combine.
#[derive(Clone, Debug)]
pub(super) struct Stay {
    /// Index of the crew's day.
    pub(super) day: usize,
    pub(super) date: i32,
    /// Number of teams at work.
    pub(super) teams: usize,
    /// The visits, in order.
    pub(super) visits: Vec<usize>,
    /// Later stays of the crew to which a team can go on, up to `free_on`.
    pub(super) next: Vec<usize>,
    /// The date from which on it can go anywhere.
    pub(super) free_on: i32,
}

impl<'a> Relaxation<'a> {
    pub(super) fn new(problem: &'a Problem) -> Relaxation<'a> {
        let choices = problem.by_visit();
        let hours: Vec<Window> = choices
            .iter()
            .map(|choices| {
                let windows = choices.iter().map(|choice| problem.choices[*choice].window);
                windows.fold(NEVER, |one, other| Window {
                    from: one.from.min(other.from),
                    to: one.to.max(other.to),
                })
            })
            .collect();
        let jobs = problem.visits.iter().zip(&hours).map(|(visit, hours)| {
            let crew = &problem.crews[problem.days[visit.day].crew];
            let between_s = crew.travel_s[visit.place][visit.place];
            let each_s = (problem.job_s + between_s).max(1);
            let in_time = hours
                .to
                .saturating_sub(hours.from)
                .saturating_add(between_s)
                / each_s;
            usize::try_from(in_time)
                .unwrap_or(0)
                .clamp(1, crew.jobs_a_team as usize)
        });
        let jobs = jobs.collect();
        let mut stays: Vec<Vec<Stay>> = vec![Vec::new(); problem.crews.len()];
        for (day, visits) in problem.by_day().into_iter().enumerate() {
            let of = problem.days[day];
            let groups = group(problem, &hours, visits).into_iter();
            stays[of.crew].extend(groups.map(|visits| Stay {
                day,
                date: of.date,
                teams: of.teams as usize,
                visits,
                next: Vec::new(),
                free_on: of.date,
            }));
        }
        for (crew, stays) in stays.iter_mut().enumerate() {
            stays.sort_by_key(|stay| (stay.date, stay.visits[0]));
            link(problem, &hours, crew, stays);
        }
        Relaxation {
            problem,
            choices,
            jobs,
            stays,
        }
    }
}

/// Finds the stays to which a team can go on from each.
fn link(problem: &Problem, hours: &[Window], crew: usize, stays: &mut [Stay]) {
    let travel_s = max_travel_s(&problem.crews[crew]);
    // Days of two zones are 26 hours apart at most.
    let days = i32::try_from(2 + (travel_s + 26 * 3600) / (24 * 3600)).unwrap_or(i32::MAX);
    for at in 0..stays.len() {
        let free_on = stays[at].date.saturating_add(days);
        let later = stays[at + 1..].iter().enumerate();
        let near = later.take_while(|(_, stay)| stay.date < free_on);
        let can_go_on = |to: &Stay| {
            let mut ways = stays[at].visits.iter();
            stays[at].date < to.date
                && ways.any(|from| {
                    to.visits
                        .iter()
                        .any(|to| follows(problem, hours, *from, *to))
                })
        };
        let next = near
            .filter(|(_, stay)| can_go_on(stay))
            .map(|(more, _)| at + 1 + more);
        let next = next.collect();
        stays[at].next = next;
        stays[at].free_on = free_on;
    }
}

/// Returns true if a team may do a job of one visit after one of another.
fn follows(problem: &Problem, hours: &[Window], first: usize, next: usize) -> bool {
    let visits = [first, next].map(|visit| problem.visits[visit]);
    let crew = &problem.crews[problem.days[visits[0].day].crew];
    let travel_s = crew.travel_s[visits[0].place][visits[1].place];
    hours[first]
        .from
        .saturating_add(2 * problem.job_s + travel_s)
        <= hours[next].to
}

/// Groups the visits of a day such that no team goes from one group to another.
fn group(problem: &Problem, hours: &[Window], visits: Vec<usize>) -> Vec<Vec<usize>> {
    let mut groups: Vec<Vec<usize>> = Vec::new();
    for visit in visits {
        let day = problem.days[problem.visits[visit].day];
        let meets = |group: &Vec<usize>| {
            problem.crews[day.crew].jobs_a_team > 1
                && group.iter().any(|other| {
                    follows(problem, hours, *other, visit) || follows(problem, hours, visit, *other)
                })
        };
        let (near, far): (Vec<_>, Vec<_>) = groups.into_iter().partition(meets);
        let mut joined: Vec<usize> = near.into_iter().flatten().collect();
        joined.push(visit);
        joined.sort_unstable();
        groups = far;
        groups.push(joined);
    }
    groups
}
