//! The solver against two independent methods: enumeration of all assignments
//! and routes and, where a team does one job a day and is anywhere in time,
//! minimum-cost flow.

#![allow(clippy::unwrap_used)] // helpers of tests

mod brute_force;
mod flow;

use binnacle_schedule::solve::{
    Choice, Crew, CrewDay, Problem, Visit, Window, solve, solve_within, timetable,
};
use proptest::collection::vec;
use proptest::prelude::*;

const HOUR: i64 = 3600;

/// A crew of so many teams, whose two places are some hours apart.
fn crew(teams: u32, jobs_a_team: u32, apart_h: i64) -> Crew {
    let (near, far) = (HOUR / 2, apart_h * HOUR);
    Crew {
        teams,
        jobs_a_team,
        travel_s: vec![vec![near, far], vec![far, near]],
        taken: Vec::new(),
    }
}

/// Hours of a day from its midnight.
fn window(date: i32, from_h: i64, to_h: i64) -> Window {
    let midnight = i64::from(date) * 24 * HOUR;
    Window {
        from: midnight + from_h * HOUR,
        to: midnight + to_h * HOUR,
    }
}

/// Up to five needs of two hours, two crews with two places each, and three days.
fn problems(most_jobs: u32) -> impl Strategy<Value = Problem> {
    let crews = vec((0..3_u32, 1..=most_jobs, 0..14_i64), 2);
    let choice = (0..5_usize, 0..12_usize, 0..2000_i64, 8..16_i64, 0..8_i64);
    let travel = vec(0..900_i64, 12);
    let absent = vec(0..2_u32, 6);
    let sizes = (
        vec(0..3000_i64, 5),
        crews,
        travel,
        absent,
        vec(choice, 0..13),
    );
    sizes.prop_map(|(unmet, crews, travel, absent, choices)| Problem {
        job_s: 2 * HOUR,
        unmet,
        // Visit 6c + 2d + p is crew c, day d, place p.
        visits: travel
            .into_iter()
            .enumerate()
            .map(|(at, travel)| Visit {
                day: at / 2,
                place: at % 2,
                travel,
            })
            .collect(),
        days: (0..6)
            .map(|day| CrewDay {
                crew: day / 3,
                date: i32::try_from(day % 3).unwrap(),
                teams: crews[day / 3].0.saturating_sub(absent[day] / 2),
            })
            .collect(),
        crews: crews
            .into_iter()
            .map(|(teams, jobs, apart_h)| crew(teams, jobs, apart_h))
            .collect(),
        choices: choices
            .into_iter()
            .map(|(need, visit, cost, from_h, more_h)| Choice {
                need,
                visit,
                cost,
                window: window(
                    i32::try_from(visit / 2 % 3).unwrap(),
                    from_h,
                    from_h + 2 + more_h,
                ),
                length_s: (2 + more_h % 2) * HOUR,
            })
            .collect(),
    })
}

/// Small problems with one job a day of each team, which is anywhere in time.
fn problems_without_watches() -> impl Strategy<Value = Problem> {
    problems(1).prop_map(|mut problem| {
        for crew in &mut problem.crews {
            *crew = Crew {
                travel_s: vec![vec![0; 2]; 2],
                ..crew.clone()
            };
        }
        problem
    })
}

proptest! {
    #![proptest_config(ProptestConfig { cases: 1000, failure_persistence: None, ..ProptestConfig::default() })]

    #[test]
    fn no_assignment_of_a_small_problem_is_cheaper(problem in problems(3)) {
        let solved = solve(&problem);
        prop_assert_eq!(brute_force::cost(&problem, &solved.assignment), Some(solved.cost));
        prop_assert_eq!(solved.cost, brute_force::least_cost(&problem));
        prop_assert_eq!(solved.bound, solved.cost);
    }

    #[test]
    fn minimum_cost_flow_finds_the_same_cost(problem in problems_without_watches()) {
        prop_assert_eq!(solve(&problem).cost, flow::least_cost(&problem));
    }

    #[test]
    fn with_little_work_the_answer_is_feasible_and_the_bound_below_all(
        problem in problems(3),
        most_work in 0..40_000_u64,
    ) {
        let solved = solve_within(&problem, most_work);
        let least = brute_force::least_cost(&problem);
        prop_assert_eq!(brute_force::cost(&problem, &solved.assignment), Some(solved.cost));
        prop_assert!(solved.bound <= least && least <= solved.cost);
        prop_assert_eq!(&solved, &solve_within(&problem, most_work));
        // Each of three phases ends with the step in which its part is spent.
        prop_assert!(solved.work <= most_work + 100_000, "{}", solved.work);
    }

    #[test]
    fn every_job_has_its_hour_and_its_team(problem in problems(3)) {
        let solved = solve(&problem);
        let hours = timetable(&problem, &solved.assignment);
        for (choice, hour) in solved.assignment.iter().zip(&hours) {
            prop_assert_eq!(choice.is_some(), hour.is_some());
            let Some((choice, hour)) = choice.zip(*hour) else { continue };
            let choice = problem.choices[choice];
            let crew = problem.days[problem.visits[choice.visit].day].crew;
            prop_assert!(choice.window.from <= hour.from);
            prop_assert!(hour.from + choice.length_s <= choice.window.to);
            prop_assert!(hour.team < problem.crews[crew].teams as usize);
        }
    }
}

/// Four times as many ships as their teams can serve, each with ten choices.
fn crowded() -> Problem {
    let ways = (0..600_u32).flat_map(|ship| (0..10_u32).map(move |way| (ship, way)));
    Problem {
        job_s: 3 * HOUR,
        unmet: (0..600).map(|ship| 40_000 + 7 * (ship % 90)).collect(),
        choices: ways
            .map(|(ship, way)| {
                let visit = ((ship * 7 + way * way * 13 + ship * way) % 60) as usize;
                let from_h = i64::from(8 + (ship + way) % 5);
                let date = i32::try_from(visit / 12).unwrap();
                Choice {
                    need: ship as usize,
                    visit,
                    cost: i64::from((ship * 31 + way * 17) % 3_000),
                    window: window(date, from_h, from_h + 5),
                    length_s: 3 * HOUR,
                }
            })
            .collect(),
        visits: (0..60_u32)
            .map(|visit| Visit {
                day: visit as usize / 2,
                place: visit as usize % 2,
                travel: i64::from(100 * (visit % 9)),
            })
            .collect(),
        days: (0..30)
            .map(|day| CrewDay {
                crew: day % 6,
                date: i32::try_from(day / 6).unwrap(),
                teams: 3 + u32::try_from(day % 6).unwrap() % 4,
            })
            .collect(),
        crews: (0..6)
            .map(|at| crew(3 + at % 4, 1 + at % 2, 2 + i64::from(at)))
            .collect(),
    }
}

#[test]
fn a_crowded_problem_takes_no_more_work_than_it_may() {
    let problem = crowded();
    for most_work in [0, 1_000_000, 30_000_000] {
        let solved = solve_within(&problem, most_work);
        assert_eq!(cost_by_hours(&problem, &solved.assignment), solved.cost);
        assert!(solved.bound <= solved.cost);
        // The last relaxation or search may pass the limit.
        assert!(
            solved.work <= most_work + 20_000_000,
            "{most_work}: {}",
            solved.work
        );
    }
}

/// The cost of an assignment by the hours of its jobs: each team's day at a place
/// costs its travel.
fn cost_by_hours(problem: &Problem, assignment: &[Option<usize>]) -> i64 {
    let hours = timetable(problem, assignment);
    let mut visits = std::collections::BTreeSet::new();
    let mut cost = 0;
    for (need, choice) in assignment.iter().enumerate() {
        let Some(choice) = choice.map(|choice| problem.choices[choice]) else {
            cost += problem.unmet[need];
            continue;
        };
        cost += choice.cost;
        if visits.insert((choice.visit, hours[need].unwrap().team)) {
            cost += problem.visits[choice.visit].travel;
        }
    }
    cost
}

#[test]
fn more_work_finds_what_little_work_does_not() {
    let problem = crowded();
    let (little, more) = (
        solve_within(&problem, 0),
        solve_within(&problem, 300_000_000),
    );
    assert!(more.cost < little.cost && more.bound > little.bound);
    assert!(
        (more.cost - more.bound) * 20 < more.cost,
        "{} {}",
        more.cost,
        more.bound
    );
}

/// One crew of so many teams, which does two jobs of three hours a day, and one visit on
/// each of some days.
fn one_crew(teams: u32, travel: i64, days: i32) -> Problem {
    Problem {
        job_s: 3 * HOUR,
        crews: vec![crew(teams, 2, 1)],
        days: (0..days)
            .map(|date| CrewDay {
                crew: 0,
                date,
                teams,
            })
            .collect(),
        visits: (0..days as usize)
            .map(|day| Visit {
                day,
                place: 0,
                travel,
            })
            .collect(),
        ..Problem::default()
    }
}

fn all_day(need: usize, visit: usize, cost: i64) -> Choice {
    Choice {
        need,
        visit,
        cost,
        window: window(i32::try_from(visit).unwrap(), 8, 18),
        length_s: 3 * HOUR,
    }
}

#[test]
fn two_ships_in_one_port_share_a_teams_travel() {
    // Apart, each would go on its own cheaper day: 100 + 500, twice. Together,
    // 300 + 500.
    let problem = Problem {
        unmet: vec![10_000, 10_000],
        choices: vec![all_day(0, 0, 100), all_day(1, 0, 200), all_day(1, 1, 100)],
        ..one_crew(1, 500, 2)
    };
    let solved = solve(&problem);
    assert_eq!(solved.assignment, [Some(0), Some(1)]);
    assert_eq!((solved.cost, solved.bound), (800, 800));
}

/// Giving up one of them alone saves nothing: the other's team travels all the
/// same.
#[test]
fn two_needs_that_are_not_worth_their_teams_travel_are_left_unmet_together() {
    let problem = Problem {
        unmet: vec![1482, 663, 873, 258],
        choices: vec![
            all_day(0, 0, 0),
            all_day(1, 0, 662),
            all_day(2, 0, 0),
            all_day(3, 0, 257),
        ],
        ..one_crew(2, 3, 1)
    };
    let solved = solve(&problem);
    assert_eq!(solved.assignment, [Some(0), None, Some(2), None]);
    assert_eq!((solved.cost, solved.bound), (924, 924));
}

#[test]
fn two_ships_in_one_short_window_need_two_teams_and_travel_twice() {
    let in_window = |need| Choice {
        window: window(0, 8, 13),
        ..all_day(need, 0, 100)
    };
    let problem = |teams| Problem {
        unmet: vec![10_000, 10_000],
        choices: vec![in_window(0), in_window(1)],
        ..one_crew(teams, 500, 1)
    };
    let solved = solve(&problem(2));
    assert_eq!((solved.cost, solved.bound), (1_200, 1_200));
    let solved = solve(&problem(1));
    assert_eq!((solved.cost, solved.bound), (10_600, 10_600));
}

#[test]
fn a_problem_without_needs_costs_nothing() {
    let solved = solve(&Problem::default());
    assert_eq!((solved.cost, solved.bound), (0, 0));
}
