//! Jobs at fixed hours and the teams that do them.

#![allow(clippy::unwrap_used)] // helpers of tests

use binnacle_schedule::bookings::{Booking, assign_teams};
use binnacle_schedule::input::Firm;
use binnacle_schedule::time::Instant;
use proptest::collection::vec;
use proptest::prelude::*;
use serde_json::{Value, json};

fn firm(teams: &Value) -> Firm {
    let firm = json!({
        "id": "f", "fee_eur": 1500, "jobs_a_team_day": 3, "teams": teams,
        "ports": [{"port": "NLRTM"}, {"port": "BEANR"}, {"port": "DEHAM"}],
        "travel_times": [{"from": "NLRTM", "to": "BEANR", "hours": 1.0}],
    });
    serde_json::from_value(firm).unwrap()
}

/// A job from an hour of 15 December to another.
fn booking(place: &str, from_h: f64, to_h: f64) -> Booking {
    let midnight = Instant::parse("2026-12-15T00:00:00Z").unwrap();
    Booking {
        day: "2026-12-15".parse().unwrap(),
        from: midnight.plus_hours(from_h),
        to: midnight.plus_hours(to_h),
        place: place.to_owned(),
        team: None,
    }
}

#[test]
fn one_team_does_one_job_after_the_other_with_its_way() {
    let one = firm(&json!(1));
    let after = |place, from_h| {
        let jobs = [booking("NLRTM", 8.0, 11.0), booking(place, from_h, 16.0)];
        assign_teams(&one, &jobs).is_some()
    };
    // Half an hour between berths, an hour to Antwerp by the firm's table.
    assert!(!after("NLRTM", 11.25) && after("NLRTM", 11.5));
    assert!(!after("BEANR", 11.75) && after("BEANR", 12.0));
    // Hamburg is too far by any way, and so is a place that nobody knows.
    assert!(!after("DEHAM", 13.0) && !after("somewhere", 15.0));
    // What overlaps is never done by one team.
    assert!(!after("NLRTM", 8.0));
}

#[test]
fn two_teams_do_two_jobs_at_a_time() {
    let jobs = [booking("NLRTM", 8.0, 11.0), booking("BEANR", 8.0, 11.0)];
    let teams = assign_teams(&firm(&json!(2)), &jobs).unwrap();
    assert_ne!(teams[0], teams[1]);
    assert_eq!(assign_teams(&firm(&json!(0)), &jobs[..1]), None);
}

#[test]
fn a_team_does_no_more_jobs_a_day_than_it_may() {
    let hours = [8.0, 9.0, 10.0, 11.0];
    let mut jobs = hours.map(|from_h| booking("NLRTM", from_h, from_h + 0.5));
    assert!(assign_teams(&firm(&json!(1)), &jobs[..3]).is_some());
    assert_eq!(assign_teams(&firm(&json!(1)), &jobs), None);
    jobs[3].day = "2026-12-16".parse().unwrap();
    assert!(assign_teams(&firm(&json!(1)), &jobs).is_some());
}

#[test]
fn a_named_team_keeps_its_own_jobs() {
    let two = firm(&json!([{"name": "Jansen"}, {"name": "Peeters"}]));
    let mut jobs = [booking("NLRTM", 8.0, 11.0), booking("NLRTM", 9.0, 12.0)];
    jobs[1].team = Some("Jansen".to_owned());
    assert_eq!(assign_teams(&two, &jobs), Some(vec![1, 0]));
    jobs[0].team = Some("Jansen".to_owned());
    assert_eq!(assign_teams(&two, &jobs), None);
    jobs[0].team = Some("nobody".to_owned());
    assert_eq!(assign_teams(&two, &jobs), None);
}

/// Returns whether any way to give each job a team works.
fn any_way_works(firm: &Firm, jobs: &[Booking], teams: usize) -> bool {
    let ways = teams.pow(u32::try_from(jobs.len()).unwrap());
    (0..ways).any(|way| {
        let team_of = |at: usize| way / teams.pow(u32::try_from(at).unwrap()) % teams;
        let of = |team| {
            let own = (0..jobs.len()).filter(move |at| team_of(*at) == team);
            own.map(|at| jobs[at].clone()).collect::<Vec<_>>()
        };
        let one = Firm {
            teams: 1.into(),
            ..firm.clone()
        };
        (0..teams).all(|team| assign_teams(&one, &of(team)).is_some())
    })
}

proptest! {
    #![proptest_config(ProptestConfig::with_cases(300))]

    #[test]
    fn teams_are_found_whenever_there_are_any(
        jobs in vec((0..3_usize, 0..12_u32, 1..4_u32), 0..6),
        teams in 1..4_usize,
    ) {
        let jobs: Vec<Booking> = jobs
            .into_iter()
            .map(|(place, from_h, long_h)| {
                let (from_h, long_h) = (f64::from(from_h), f64::from(long_h));
                booking(["NLRTM", "BEANR", "DEHAM"][place], from_h, from_h + long_h)
            })
            .collect();
        let firm = firm(&json!(teams));
        let found = assign_teams(&firm, &jobs);
        prop_assert_eq!(found.is_some(), any_way_works(&firm, &jobs, teams));
    }
}
