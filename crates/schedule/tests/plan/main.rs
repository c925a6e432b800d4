//! Schedules of small fleets, worked out by hand.

#![allow(clippy::unwrap_used)] // helpers of tests

mod confirmed;
mod documented;
mod explained;
mod helpful;
mod hours;
mod watch;

use binnacle_schedule::input::read;
use binnacle_schedule::plan::{Schedule, plan};
use serde_json::{Value, json};

/// The schedule of an input as of Saturday, 21 November 2026.
pub(crate) fn schedule(mut input: Value) -> Schedule {
    input["now"] = json!("2026-11-21T00:00:00Z");
    plan(&read(&input.to_string()).unwrap())
}

/// A call in Rotterdam from midnight to midnight UTC.
pub(crate) fn call(id: &str, vessel: &str, from: &str, to: &str) -> Value {
    json!({"id": id, "vessel": vessel, "port": "NLRTM",
           "eta": format!("{from}T00:00:00Z"), "etd": format!("{to}T00:00:00Z")})
}

pub(crate) fn vessel(id: &str) -> Value {
    json!({"id": id, "flag": "NO"})
}

pub(crate) fn need(id: &str, vessel: &str, due: &str) -> Value {
    json!({"id": id, "vessel": vessel, "due": due})
}

pub(crate) fn firm(id: &str, fee_eur: u32) -> Value {
    json!({"id": id, "ports": [{"port": "NLRTM", "travel_eur": 100}], "fee_eur": fee_eur})
}

/// Vessel, firm and day of each job.
fn jobs(schedule: &Schedule) -> Vec<(String, String, String)> {
    let jobs = schedule.jobs.iter();
    jobs.map(|job| (job.vessel.clone(), job.firm.clone(), job.day.to_string()))
        .collect()
}

fn job(vessel: &str, firm: &str, day: &str) -> (String, String, String) {
    (vessel.to_owned(), firm.to_owned(), day.to_owned())
}

#[test]
fn the_cheaper_of_two_firms_goes() {
    let found = schedule(json!({
        "vessels": [vessel("v")],
        "needs": [need("n", "v", "2026-12-20")],
        "port_calls": [call("c", "v", "2026-12-01", "2026-12-02")],
        "firms": [firm("dear", 2000), firm("cheap", 1500)],
    }));
    assert_eq!(jobs(&found), [job("v", "cheap", "2026-12-01")]);
    assert!(found.proven_optimal);
    assert!((found.paid_eur - 1600.0).abs() < 1e-9);
    // 19 days early at 3 euros.
    assert!((found.cost_eur - 1657.0).abs() < 1e-9, "{}", found.cost_eur);
}

#[test]
fn a_plan_of_nothing_pays_no_less_than_nothing() {
    let found = schedule(json!({
        "vessels": [vessel("v")], "needs": [need("n", "v", "2026-12-20")],
        "port_calls": [], "firms": [],
    }));
    assert!(found.paid_eur.is_sign_positive(), "{}", found.paid_eur);
}

#[test]
fn one_team_takes_one_ship_a_day_and_the_weekend_is_free() {
    let found = schedule(json!({
        "vessels": [vessel("v"), vessel("w"), vessel("x")],
        "needs": [need("n", "v", "2026-12-20"), need("m", "w", "2026-12-20"), need("o", "x", "2026-12-20")],
        // Friday to Sunday.
        "port_calls": [call("c", "v", "2026-12-03", "2026-12-05"), call("d", "w", "2026-12-04", "2026-12-07"),
                       call("e", "x", "2026-12-05", "2026-12-07")],
        "firms": [firm("f", 1500)],
    }));
    assert_eq!(
        jobs(&found),
        [job("v", "f", "2026-12-03"), job("w", "f", "2026-12-04")]
    );
    assert_eq!(found.unscheduled[0].vessel, "x");
}

#[test]
fn two_ships_on_one_day_share_the_travel_of_a_team_that_does_two() {
    let two = json!({"id": "f", "fee_eur": 1500, "jobs_a_team_day": 2,
                     "ports": [{"port": "NLRTM", "travel_eur": 800}]});
    let found = schedule(json!({
        "vessels": [vessel("v"), vessel("w")],
        "needs": [need("n", "v", "2026-12-20"), need("m", "w", "2026-12-20")],
        "port_calls": [call("c", "v", "2026-12-01", "2026-12-05"), call("d", "w", "2026-12-02", "2026-12-04")],
        "firms": [two],
    }));
    assert_eq!(found.jobs[0].day, found.jobs[1].day);
    assert!((found.paid_eur - 3800.0).abs() < 1e-9);
    assert!((found.jobs[0].travel_eur - 400.0).abs() < 1e-9);
}

#[test]
fn a_ship_that_may_come_too_late_is_met_on_the_second_day() {
    let mut unsure = call("c", "v", "2026-12-01", "2026-12-03");
    unsure["eta_uncertainty_h"] = json!(24);
    let found = schedule(json!({
        "vessels": [vessel("v")],
        "needs": [need("n", "v", "2026-12-20")],
        "port_calls": [unsure],
        "firms": [firm("f", 1500)],
    }));
    assert_eq!(found.jobs[0].day.to_string(), "2026-12-02");
    assert!(found.jobs[0].chance_of_missing < 0.01);
}

#[test]
fn the_urgent_ship_has_the_only_team() {
    let mut urgent = need("m", "w", "2026-12-20");
    urgent["urgency"] = json!("urgent");
    let found = schedule(json!({
        "vessels": [vessel("v"), vessel("w")],
        "needs": [need("n", "v", "2026-12-20"), urgent],
        "port_calls": [call("c", "v", "2026-12-01", "2026-12-02"), call("d", "w", "2026-12-01", "2026-12-02")],
        "firms": [firm("f", 1500)],
    }));
    assert_eq!(jobs(&found), [job("w", "f", "2026-12-01")]);
}

#[test]
fn two_compasses_of_a_ship_are_one_job() {
    let mut both = firm("f", 1500);
    both["extra_compass_eur"] = json!(300);
    let found = schedule(json!({
        "vessels": [vessel("v")],
        "needs": [need("n1", "v", "2026-12-20"), need("n2", "v", "2027-01-20"), need("n3", "v", "2027-04-20")],
        "port_calls": [call("c", "v", "2026-12-01", "2026-12-02")],
        "firms": [both],
    }));
    assert_eq!(found.jobs[0].needs, ["n1", "n2"]);
    assert!((found.jobs[0].fee_eur - 1800.0).abs() < 1e-9);
}

#[test]
fn an_overdue_job_is_done_at_the_first_call() {
    let found = schedule(json!({
        "vessels": [vessel("v")],
        "needs": [need("n", "v", "2026-11-01")],
        "port_calls": [call("c", "v", "2026-12-01", "2026-12-02"), call("d", "v", "2026-12-08", "2026-12-09")],
        "firms": [firm("f", 1500)],
    }));
    assert_eq!(jobs(&found), [job("v", "f", "2026-12-01")]);
    assert_eq!(found.jobs[0].late_days, 30);
    assert!(found.unscheduled.is_empty());
}

#[test]
fn a_compass_without_a_record_goes_to_the_first_call_there_is() {
    let found = schedule(json!({
        "vessels": [vessel("v")],
        "compasses": [{"id": "k", "vessel": "v", "facts": {}}],
        "port_calls": [call("c", "v", "2026-12-01", "2026-12-02"), call("d", "v", "2026-12-08", "2026-12-09")],
        "firms": [firm("f", 1500)],
        "weights": {"late_days": 0},
    }));
    assert_eq!(jobs(&found), [job("v", "f", "2026-12-01")]);
    assert!(found.unscheduled.is_empty());
}

#[test]
fn a_ship_overdue_for_years_is_done_at_the_last_call_of_the_horizon() {
    let found = schedule(json!({
        "vessels": [vessel("v")],
        "needs": [need("n", "v", "2016-11-01")],
        "port_calls": [call("c", "v", "2027-05-17", "2027-05-18")],
        "firms": [firm("f", 1500)],
    }));
    assert_eq!(jobs(&found), [job("v", "f", "2027-05-17")]);
    // Only the 177 days to come count.
    assert!((found.jobs[0].weighed.late_eur - 177.0 * 500.0).abs() < 1e-9);
}

#[test]
fn a_job_that_can_only_be_late_is_planned_before_it_is_overdue() {
    let mut slow = firm("f", 1500);
    slow["lead_time_h"] = json!(96);
    let found = schedule(json!({
        "vessels": [vessel("v")],
        "needs": [need("n", "v", "2026-12-07")],
        "port_calls": [call("c", "v", "2026-12-10", "2026-12-11"), call("d", "v", "2027-03-01", "2027-03-03")],
        "firms": [slow],
    }));
    assert_eq!(jobs(&found), [job("v", "f", "2026-12-10")]);
    assert_eq!(found.jobs[0].late_days, 3);
    assert!(found.unscheduled[0].planned_late);
}

#[test]
fn no_job_is_late_for_the_sake_of_money() {
    let mut dear = firm("dear", 15_000);
    dear["ports"][0]["travel_eur"] = json!(4000);
    let input = json!({
        "vessels": [vessel("v")],
        "needs": [need("n", "v", "2026-12-01")],
        "port_calls": [call("c", "v", "2026-12-01", "2026-12-03")],
        "firms": [dear, {"id": "cheap", "ports": [{"port": "NLRTM"}], "fee_eur": 900,
                         "closed": ["2026-12-01"]}],
    });
    assert_eq!(
        jobs(&schedule(input.clone())),
        [job("v", "dear", "2026-12-01")]
    );
    // Unless the weights allow lateness.
    let mut late = input;
    late["weights"] = json!({"late_days": 1});
    assert_eq!(jobs(&schedule(late)), [job("v", "cheap", "2026-12-02")]);
}

#[test]
fn a_need_beyond_the_horizon_waits() {
    let found = schedule(json!({
        "vessels": [vessel("v")],
        "needs": [need("n", "v", "2028-01-01")],
        "port_calls": [call("c", "v", "2026-12-01", "2026-12-02")],
        "firms": [firm("f", 1500)],
    }));
    assert!(found.jobs.is_empty() && found.unscheduled.is_empty());
    assert_eq!(found.later[0].need, "n");
}

#[test]
fn a_compass_is_due_by_the_rules_that_bind_its_ship() {
    let found = schedule(json!({
        "vessels": [{"id": "v", "flag": "PA"}],
        "compasses": [{"id": "k", "vessel": "v", "facts": {"adjusted_on": "2025-12-10"}}],
        "port_calls": [call("c", "v", "2026-12-01", "2026-12-02")],
        "firms": [firm("f", 1500)],
    }));
    assert_eq!(found.jobs[0].due.to_string(), "2026-12-10");
    assert!(found.jobs[0].reason.contains("MMC-138"));
}

#[test]
fn the_same_input_gives_the_same_schedule() {
    let input = json!({
        "vessels": [vessel("v"), vessel("w")],
        "needs": [need("n", "v", "2026-12-20"), need("m", "w", "2026-12-20")],
        "port_calls": [call("c", "v", "2026-12-01", "2026-12-04"), call("d", "w", "2026-12-01", "2026-12-04")],
        "firms": [firm("f", 1500), firm("g", 1500)],
    });
    assert_eq!(schedule(input.clone()), schedule(input));
}

/// An obstacle never makes a plan look cheaper.
#[test]
fn an_obstacle_makes_no_plan_cheaper() {
    // Only late, and both by one team that has a single day for them.
    let input = json!({
        "vessels": [vessel("v"), vessel("w")],
        "needs": [need("n", "v", "2026-12-01"), need("m", "w", "2026-12-20")],
        "port_calls": [call("c", "v", "2027-02-01", "2027-02-02"), call("d", "w", "2026-12-01", "2026-12-02"),
                       call("e", "v", "2026-12-01", "2026-12-02")],
        "firms": [firm("f", 1500)],
    });
    let before = schedule(input.clone());
    assert_eq!(before.jobs.len(), 2);
    let cheaper_by = |change: &dyn Fn(&mut Value)| {
        let mut input = input.clone();
        change(&mut input);
        let after = schedule(input);
        assert_eq!(after.jobs.len(), 1);
        before.cost_eur - after.cost_eur
    };
    let no_more = cheaper_by(&|input| {
        input["declined"] = json!([{"need": "n", "firm": "f", "day": "2027-02-01"}]);
    });
    assert!(no_more <= 0.0, "{no_more}");
    let lost = cheaper_by(&|input| {
        input["port_calls"].as_array_mut().unwrap().remove(0);
    });
    assert!(lost <= 0.0, "{lost}");
}

#[test]
fn a_refusal_of_one_call_leaves_the_others() {
    let mut input = json!({
        "vessels": [vessel("v")],
        "needs": [need("n", "v", "2026-12-20")],
        "port_calls": [call("c", "v", "2026-12-01", "2026-12-02"), call("d", "v", "2026-12-08", "2026-12-09")],
        "firms": [firm("f", 1500)],
        "declined": [{"need": "n", "firm": "f", "call": "d"}],
    });
    assert_eq!(
        jobs(&schedule(input.clone())),
        [job("v", "f", "2026-12-01")]
    );
    input["declined"][0]["call"] = json!("c");
    assert_eq!(jobs(&schedule(input)), [job("v", "f", "2026-12-08")]);
}
