//! Enumerates all assignments, and for each all ways in which the teams could
//! go from job to job with a watch.

use binnacle_schedule::solve::{Choice, Problem};
use std::collections::BTreeSet;

/// The least cost of any feasible assignment.
pub(crate) fn least_cost(problem: &Problem) -> i64 {
    let mut assignment = vec![None; problem.unmet.len()];
    from(problem, 0, &mut assignment).expect("leaving all unmet is feasible")
}

fn from(problem: &Problem, need: usize, assignment: &mut Vec<Option<usize>>) -> Option<i64> {
    if need == assignment.len() {
        return cost(problem, assignment);
    }
    assignment[need] = None;
    let mut least = from(problem, need + 1, assignment);
    for (index, choice) in problem.choices.iter().enumerate() {
        if choice.need != need {
            continue;
        }
        assignment[need] = Some(index);
        least = [least, from(problem, need + 1, assignment)]
            .into_iter()
            .flatten()
            .min();
    }
    assignment[need] = None;
    least
}

/// The cost of an assignment; none where the teams cannot do it.
pub(crate) fn cost(problem: &Problem, assignment: &[Option<usize>]) -> Option<i64> {
    let mut cost = 0;
    for (choice, unmet) in assignment.iter().zip(&problem.unmet) {
        cost += choice.map_or(*unmet, |choice| problem.choices[choice].cost);
    }
    for crew in 0..problem.crews.len() {
        let made = assignment
            .iter()
            .flatten()
            .map(|choice| problem.choices[*choice]);
        let made = made.filter(|choice| crew_of(problem, choice) == crew);
        let mut left: Vec<Choice> = made.collect();
        left.sort_by_key(|choice| date_of(problem, choice));
        let mut teams = vec![Team::default(); problem.crews[crew].teams as usize];
        cost += drive(problem, crew, &left, &mut teams)?;
    }
    Some(cost)
}

#[derive(Clone, Default)]
struct Team {
    at: Option<(usize, i64)>,
    jobs: u32,
    places: BTreeSet<usize>,
    dates: BTreeSet<i32>,
}

/// The least travel of teams that still have some jobs to do, in order of the date.
fn drive(problem: &Problem, crew: usize, left: &[Choice], teams: &mut Vec<Team>) -> Option<i64> {
    let Some(first) = left.first() else {
        return Some(0);
    };
    let today = date_of(problem, first);
    let of = &problem.crews[crew];
    let mut least: Option<i64> = None;
    for (at, job) in left
        .iter()
        .enumerate()
        .filter(|(_, job)| date_of(problem, job) == today)
    {
        let visit = problem.visits[job.visit];
        for index in 0..teams.len() {
            let before = teams[index].clone();
            let is_out = before.dates.contains(&today);
            let out = teams
                .iter()
                .filter(|team| team.dates.contains(&today))
                .count();
            if !is_out && out == problem.days[visit.day].teams as usize {
                continue;
            }
            let ready = before.at.map_or(i64::MIN, |(place, ends)| {
                ends + of.travel_s[place][visit.place]
            });
            let begins = ready.max(job.window.from);
            let jobs = if is_out { before.jobs } else { 0 };
            if begins + job.length_s > job.window.to || jobs == of.jobs_a_team {
                continue;
            }
            let team = &mut teams[index];
            if !is_out {
                team.places.clear();
            }
            let comes = team.places.insert(visit.place);
            team.at = Some((visit.place, begins + job.length_s));
            team.jobs = jobs + 1;
            team.dates.insert(today);
            let mut rest = left.to_vec();
            rest.remove(at);
            let travel = if comes { visit.travel } else { 0 };
            let cost = drive(problem, crew, &rest, teams).map(|rest| rest + travel);
            least = [least, cost].into_iter().flatten().min();
            teams[index] = before;
        }
    }
    least
}

fn crew_of(problem: &Problem, choice: &Choice) -> usize {
    problem.days[problem.visits[choice.visit].day].crew
}

fn date_of(problem: &Problem, choice: &Choice) -> i32 {
    problem.days[problem.visits[choice.visit].day].date
}
