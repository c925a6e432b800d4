//! Large neighbourhood search: needs that compete for the same teams are solved
//! again, while all others are fixed.

use super::branch_and_bound::Models;
use super::open::Open;
use super::problem::{Assignment, Problem};
use super::work_limit::WorkLimit;

/// Work of branch and bound on a neighbourhood, in nodes times choices.
const NEIGHBOURHOOD_EFFORT: usize = 60_000;
/// Needs of a neighbourhood.
const NEIGHBOURHOOD_SIZE: usize = 60;

/// Improves all neighbourhoods once.
pub(super) fn improve(
    models: &mut Models<'_>,
    open: &Open,
    known: Assignment,
    work: &mut WorkLimit,
) -> Assignment {
    let problem = models.relaxation.problem;
    let open_days = find_open_days(problem, &open.choices);
    let mut needs_by_day: Vec<Vec<usize>> = vec![Vec::new(); problem.days.len()];
    for (need, days) in open_days.iter().enumerate() {
        for day in days {
            needs_by_day[*day].push(need);
        }
    }
    let mut found = known;
    let mut done = vec![false; problem.unmet.len()];
    for seed in 0..problem.unmet.len() {
        // A need within an earlier neighbourhood is not the centre of another.
        if done[seed] || open_days[seed].len() < 2 {
            continue;
        }
        if work.is_spent() {
            break;
        }
        let near = find_neighbourhood(seed, &open_days, &needs_by_day);
        let mut free = vec![false; problem.unmet.len()];
        for (at, need) in near.into_iter().enumerate() {
            free[need] = true;
            // Neighbourhoods overlap by half.
            done[need] |= at < NEIGHBOURHOOD_SIZE / 2;
        }
        let choices = problem.choices.iter().enumerate();
        let some = Open {
            choices: choices
                .map(|(index, choice)| {
                    let is_open = open.choices[index] && free[choice.need];
                    is_open || found[choice.need] == Some(index)
                })
                .collect(),
            unmet: free
                .iter()
                .zip(&open.unmet)
                .map(|(free, open)| *free && *open)
                .collect(),
        };
        found = models
            .solve_parts(&some, &found, NEIGHBOURHOOD_EFFORT, work)
            .assignment;
    }
    found
}

/// Returns the crews' days on which each need has an open choice.
fn find_open_days(problem: &Problem, open: &[bool]) -> Vec<Vec<usize>> {
    let mut open_days: Vec<Vec<usize>> = vec![Vec::new(); problem.unmet.len()];
    for (choice, open) in problem.choices.iter().zip(open) {
        let day = problem.visits[choice.visit].day;
        if *open && !open_days[choice.need].contains(&day) {
            open_days[choice.need].push(day);
        }
    }
    open_days
}

/// Returns the needs nearest to one, itself first: those open to the same crews'
/// days, then those open to the same days as these.
fn find_neighbourhood(
    seed: usize,
    open_days: &[Vec<usize>],
    needs_by_day: &[Vec<usize>],
) -> Vec<usize> {
    let mut near = vec![seed];
    let mut at = 0;
    while at < near.len() && near.len() < NEIGHBOURHOOD_SIZE {
        for day in &open_days[near[at]] {
            for need in &needs_by_day[*day] {
                if near.len() < NEIGHBOURHOOD_SIZE && !near.contains(need) {
                    near.push(*need);
                }
            }
        }
        at += 1;
    }
    near
}
