//! A confirmed job moves only for cause; a proposed one moves for a better
//! plan.

use crate::{call, firm, need, schedule, vessel};
use binnacle_schedule::input::JobState;
use binnacle_schedule::plan::ChangeKind;
use serde_json::{Value, json};

fn input(state: &str) -> Value {
    json!({
        "vessels": [vessel("v")],
        "needs": [need("n", "v", "2026-12-20")],
        "port_calls": [call("c", "v", "2026-12-01", "2026-12-04"), call("d", "v", "2026-12-14", "2026-12-16")],
        "firms": [firm("dear", 5000), firm("cheap", 1500)],
        "former": [{"needs": ["n"], "call": "c", "firm": "dear", "day": "2026-12-02", "state": state}],
    })
}

#[test]
fn a_confirmed_job_stays_though_another_firm_is_cheaper() {
    let found = schedule(input("confirmed"));
    let job = &found.jobs[0];
    assert_eq!(
        (job.firm.as_str(), job.day.to_string().as_str()),
        ("dear", "2026-12-02")
    );
    assert_eq!(job.state, JobState::Confirmed);
    assert_eq!(
        (found.changes[0].what, found.changes[0].why.as_str()),
        (ChangeKind::Kept, "confirmed")
    );
}

#[test]
fn a_proposed_job_moves_when_that_saves_more_than_moving_costs() {
    let found = schedule(input("proposed"));
    assert_eq!(found.jobs[0].firm, "cheap");
    assert_eq!(found.changes[0].what, ChangeKind::Moved);
    assert!(
        found.changes[0].why.starts_with("better by "),
        "{}",
        found.changes[0].why
    );
    let mut near = input("proposed");
    near["firms"][0]["fee_eur"] = json!(1600);
    assert_eq!(schedule(near).changes[0].what, ChangeKind::Kept);
}

#[test]
fn a_firm_that_was_asked_needs_no_further_notice() {
    let found = |state: &str| {
        let mut input = input(state);
        // Twelve days of three weeks are left: it was asked before they began.
        input["firms"][0]["lead_time_h"] = json!(21 * 24);
        input["firms"].as_array_mut().unwrap().truncate(1);
        input["port_calls"].as_array_mut().unwrap().truncate(1);
        schedule(input).changes[0].what
    };
    for state in ["offered", "confirmed"] {
        assert_eq!(found(state), ChangeKind::Kept, "{state}");
    }
    // A proposed job would have to be asked for now.
    assert_eq!(found("proposed"), ChangeKind::Dropped);
}

#[test]
fn a_call_that_is_cancelled_is_a_cause() {
    let mut input = input("confirmed");
    input["port_calls"].as_array_mut().unwrap().remove(0);
    let found = schedule(input);
    assert_eq!(found.jobs[0].call, "d");
    assert_eq!(found.changes[0].why, "call c is cancelled or over");
}

#[test]
fn a_ship_that_comes_later_than_the_confirmed_day_is_a_cause() {
    let mut input = input("confirmed");
    input["port_calls"][0]["eta"] = json!("2026-12-03T00:00:00Z");
    let found = schedule(input);
    assert_eq!(found.changes[0].what, ChangeKind::Moved);
    assert!(
        found.changes[0]
            .why
            .contains("alongside from 2026-12-03T00:00:00Z"),
        "{}",
        found.changes[0].why
    );
}

#[test]
fn a_due_date_that_moved_before_the_confirmed_day_is_a_cause() {
    let mut input = input("confirmed");
    input["needs"][0]["due"] = json!("2026-12-01");
    let found = schedule(input);
    assert_eq!(found.jobs[0].day.to_string(), "2026-12-01");
    assert_eq!(
        found.changes[0].why,
        "2026-12-02 is after the due date, 2026-12-01"
    );
}

#[test]
fn a_confirmed_job_that_became_late_stays_without_an_alternative() {
    let mut input = input("confirmed");
    input["needs"][0]["due"] = json!("2026-11-30");
    let found = schedule(input);
    assert_eq!(
        (
            found.jobs[0].day.to_string().as_str(),
            found.jobs[0].late_days
        ),
        ("2026-12-02", 2)
    );
    assert!(
        found.changes[0]
            .why
            .ends_with("and nothing better is available"),
        "{}",
        found.changes[0].why
    );
    assert!(found.unscheduled[0].planned_late);
}

#[test]
fn of_two_confirmed_jobs_for_one_team_the_more_urgent_stands() {
    let mut urgent = need("m", "w", "2026-12-20");
    urgent["urgency"] = json!("overdue");
    let former = |need: &str, call: &str| json!({"needs": [need], "call": call, "firm": "f", "day": "2026-12-02", "state": "confirmed"});
    let found = schedule(json!({
        "vessels": [vessel("v"), vessel("w")],
        "needs": [need("n", "v", "2026-12-20"), urgent],
        "port_calls": [call("c", "v", "2026-12-01", "2026-12-04"), call("d", "w", "2026-12-02", "2026-12-04")],
        "firms": [firm("f", 1500)],
        "former": [former("n", "c"), former("m", "d")],
    }));
    let day_of = |vessel: &str| {
        found
            .jobs
            .iter()
            .find(|job| job.vessel == vessel)
            .unwrap()
            .day
            .to_string()
    };
    assert_eq!(day_of("w"), "2026-12-02");
    assert_ne!(day_of("v"), "2026-12-02");
    let moved = found
        .changes
        .iter()
        .find(|change| change.what == ChangeKind::Moved)
        .unwrap();
    assert_eq!(moved.why, "f has only 1 team on 2026-12-02");
}

#[test]
fn a_refusal_sends_the_job_to_the_next_firm() {
    let mut input = input("offered");
    input["firms"][1]["fee_eur"] = json!(9000);
    assert_eq!(schedule(input.clone()).jobs[0].firm, "dear");
    input["declined"] = json!([{"need": "n", "firm": "dear"}]);
    let found = schedule(input);
    assert_eq!(found.jobs[0].firm, "cheap");
    assert_eq!(found.changes[0].why, "dear declined");
}

#[test]
fn of_two_agreed_hours_that_one_team_cannot_keep_the_first_due_stands() {
    let former = |need: &str, call: &str, from: &str| {
        json!({"needs": [need], "call": call, "firm": "f", "day": "2026-12-02", "state": "confirmed",
               "from": format!("2026-12-02T{from}:00Z")})
    };
    let mut two = firm("f", 1500);
    two["jobs_a_team_day"] = json!(2);
    let found = |second: &str| {
        schedule(json!({
            "vessels": [vessel("v"), vessel("w")],
            "needs": [need("n", "v", "2026-12-19"), need("m", "w", "2026-12-20")],
            "port_calls": [call("c", "v", "2026-12-02", "2026-12-04"), call("d", "w", "2026-12-02", "2026-12-04")],
            "firms": [two.clone()],
            "former": [former("n", "c", "08:00"), former("m", "d", second)],
        }))
    };
    let kept = found("11:30");
    assert!(
        kept.changes
            .iter()
            .all(|change| change.what == ChangeKind::Kept)
    );
    let moved = found("11:00");
    assert_eq!(moved.jobs[0].from.to_string(), "2026-12-02T08:00:00Z");
    let other = moved
        .changes
        .iter()
        .find(|change| change.needs == ["m"])
        .unwrap();
    assert_eq!(other.what, ChangeKind::Moved);
    assert_eq!(
        other.why,
        "f's teams have not the hours for it beside the other jobs agreed near 2026-12-02"
    );
}

#[test]
fn a_ship_that_is_not_there_at_the_agreed_hour_is_a_cause() {
    let mut input = input("confirmed");
    input["former"][0]["from"] = json!("2026-12-02T08:00:00Z");
    assert_eq!(schedule(input.clone()).changes[0].what, ChangeKind::Kept);
    input["port_calls"][0]["eta"] = json!("2026-12-02T09:00:00Z");
    let found = schedule(input);
    assert_eq!(found.changes[0].what, ChangeKind::Moved);
    let why = &found.changes[0].why;
    assert!(
        why.ends_with("not long enough at the hour agreed, 2026-12-02T08:00:00Z"),
        "{why}"
    );
}
