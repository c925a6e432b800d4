//! The solver against two independent methods: enumeration of all assignments
//! and, where a team does one job a day, minimum-cost flow.

mod brute_force;
mod flow;

use binnacle_schedule::solve::{Choice, Problem, Visit, solve, solve_within};
use proptest::collection::vec;
use proptest::prelude::*;

/// Up to five needs, four firm-days and six visits.
fn problems(most_jobs: u32) -> impl Strategy<Value = Problem> {
    let visit = (0..4_usize, 0..900_i64, 1..=most_jobs);
    let choice = (0..5_usize, 0..6_usize, 0..2000_i64);
    (
        vec(0..3000_i64, 5),
        vec(visit, 6),
        vec(0..3_u32, 4),
        vec(choice, 0..13),
    )
        .prop_map(|(unmet, visits, teams, choices)| {
            let visits = visits
                .into_iter()
                .map(|(firm_day, travel, jobs_a_team)| Visit {
                    firm_day,
                    travel,
                    jobs_a_team,
                });
            let choices =
                choices
                    .into_iter()
                    .map(|(need, visit, cost)| Choice { need, visit, cost });
            Problem {
                unmet,
                visits: visits.collect(),
                teams,
                choices: choices.collect(),
            }
        })
}

proptest! {
    #![proptest_config(ProptestConfig { cases: 3000, failure_persistence: None, ..ProptestConfig::default() })]

    #[test]
    fn no_assignment_of_a_small_problem_is_cheaper(problem in problems(3)) {
        let solved = solve(&problem);
        prop_assert_eq!(problem.cost(&solved.assignment), Some(solved.cost));
        prop_assert_eq!(solved.cost, brute_force::least_cost(&problem));
        prop_assert_eq!(solved.bound, solved.cost);
    }

    #[test]
    fn minimum_cost_flow_finds_the_same_cost(problem in problems(1)) {
        prop_assert_eq!(solve(&problem).cost, flow::least_cost(&problem));
    }

    #[test]
    fn with_little_work_the_answer_is_feasible_and_the_bound_below_all(
        problem in problems(3),
        most_work in 0..4000_u64,
    ) {
        let solved = solve_within(&problem, most_work);
        let least = brute_force::least_cost(&problem);
        prop_assert_eq!(problem.cost(&solved.assignment), Some(solved.cost));
        prop_assert!(solved.bound <= least && least <= solved.cost);
        prop_assert_eq!(&solved, &solve_within(&problem, most_work));
        // Each of three phases ends with the step in which its part is spent.
        prop_assert!(solved.work <= most_work + 10_000, "{}", solved.work);
    }

    #[test]
    fn the_same_problem_has_the_same_answer(problem in problems(3)) {
        prop_assert_eq!(solve(&problem), solve(&problem));
    }
}

/// Four times as many ships as their teams can serve, each with ten choices.
fn crowded() -> Problem {
    let ways = (0..600_u32).flat_map(|ship| (0..10_u32).map(move |way| (ship, way)));
    Problem {
        unmet: (0..600).map(|ship| 40_000 + 7 * (ship % 90)).collect(),
        choices: ways
            .map(|(ship, way)| Choice {
                need: ship as usize,
                visit: ((ship * 7 + way * way * 13 + ship * way) % 60) as usize,
                cost: i64::from((ship * 31 + way * 17) % 3_000),
            })
            .collect(),
        visits: (0..60_u32)
            .map(|visit| Visit {
                firm_day: visit as usize / 2,
                travel: i64::from(100 * (visit % 9)),
                jobs_a_team: 1 + visit % 2,
            })
            .collect(),
        teams: (0..30).map(|day| 3 + day % 4).collect(),
    }
}

#[test]
fn a_crowded_problem_takes_no_more_work_than_it_may() {
    let problem = crowded();
    for most_work in [0, 1_000_000, 30_000_000] {
        let solved = solve_within(&problem, most_work);
        assert_eq!(problem.cost(&solved.assignment), Some(solved.cost));
        assert!(solved.bound <= solved.cost);
        // The last relaxation or search may pass the limit.
        assert!(
            solved.work <= most_work + 20_000_000,
            "{most_work}: {}",
            solved.work
        );
    }
}

#[test]
fn more_work_finds_what_little_work_does_not() {
    let problem = crowded();
    let (little, more) = (solve_within(&problem, 0), solve(&problem));
    assert!(more.cost < little.cost && more.bound > little.bound);
    assert!((more.cost - more.bound) * 100 < more.cost, "{more:?}");
}

#[test]
fn two_ships_in_one_port_share_a_teams_travel() {
    let visit = |firm_day| Visit {
        firm_day,
        travel: 500,
        jobs_a_team: 2,
    };
    let choice = |need, visit, cost| Choice { need, visit, cost };
    // Apart, each would go on its own cheaper day: 100 + 500, twice. Together,
    // 300 + 500.
    let problem = Problem {
        unmet: vec![10_000, 10_000],
        visits: vec![visit(0), visit(1)],
        teams: vec![1, 1],
        choices: vec![choice(0, 0, 100), choice(1, 0, 200), choice(1, 1, 100)],
    };
    let solved = solve(&problem);
    assert_eq!(solved.assignment, [Some(0), Some(1)]);
    assert_eq!((solved.cost, solved.bound), (800, 800));
}

/// Giving up one of them alone saves nothing: the other's team travels all the
/// same.
#[test]
fn two_needs_that_are_not_worth_their_teams_travel_are_left_unmet_together() {
    let visit = Visit {
        firm_day: 0,
        travel: 3,
        jobs_a_team: 2,
    };
    let choice = |need, cost| Choice {
        need,
        visit: 0,
        cost,
    };
    let problem = Problem {
        unmet: vec![1482, 663, 873, 258],
        visits: vec![visit],
        teams: vec![2],
        choices: vec![choice(0, 0), choice(1, 662), choice(2, 0), choice(3, 257)],
    };
    let solved = solve(&problem);
    assert_eq!(solved.assignment, [Some(0), None, Some(2), None]);
    assert_eq!((solved.cost, solved.bound), (924, 924));
}

#[test]
fn a_problem_without_needs_costs_nothing() {
    let solved = solve(&Problem::default());
    assert_eq!((solved.cost, solved.bound), (0, 0));
}
