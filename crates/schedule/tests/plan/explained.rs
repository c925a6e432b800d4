//! Unscheduled jobs state their reasons and remedies.

use crate::{call, firm, need, schedule, vessel};
use binnacle_schedule::plan::Unscheduled;
use serde_json::{Value, json};

fn unscheduled(change: impl FnOnce(&mut Value)) -> Unscheduled {
    let mut input = json!({
        "vessels": [vessel("v")],
        "needs": [need("n", "v", "2026-12-20")],
        "port_calls": [call("c", "v", "2026-12-01", "2026-12-02")],
        "firms": [firm("f", 1500)],
    });
    change(&mut input);
    let mut found = schedule(input);
    assert_eq!(found.unscheduled.len(), 1);
    found.unscheduled.remove(0)
}

#[test]
fn a_ship_without_calls_wants_one_in_a_port_that_is_served() {
    let found = unscheduled(|input| input["port_calls"] = json!([]));
    assert_eq!(found.because, ["no port call is known"]);
    assert_eq!(
        found.would_help,
        ["a call by 2026-12-20 at a port that a firm serves: NLRTM"]
    );
}

#[test]
fn an_overdue_job_needs_a_call_as_soon_as_possible() {
    for due in ["2026-03-20", "2026-11-21"] {
        let found = unscheduled(|input| {
            input["needs"][0]["due"] = json!(due);
            input["port_calls"] = json!([]);
        });
        assert_eq!(
            found.would_help,
            ["a call as soon as possible at a port that a firm serves: NLRTM"]
        );
    }
    let today = unscheduled(|input| {
        input["needs"][0]["due"] = json!("2026-11-21");
        input["weights"] = json!({"late_days": 0});
    });
    // No firm works on a Saturday, and after it the ship is late wherever it
    // calls.
    assert_eq!(
        today.would_help,
        ["an extension to 2026-12-01, from flag NO, where its rules allow one"]
    );
}

#[test]
fn a_port_that_no_firm_serves_wants_a_firm() {
    let found = unscheduled(|input| input["port_calls"][0]["port"] = json!("BEANR"));
    assert_eq!(found.because, ["no firm serves Antwerpen (BEANR), call c"]);
    assert_eq!(
        found.would_help,
        ["a firm at Antwerpen (BEANR) on 2026-12-01"]
    );
}

#[test]
fn a_flag_that_does_not_accept_the_firm_is_named() {
    let found = unscheduled(|input| input["firms"][0]["flags"] = json!(["PA", "MH"]));
    assert_eq!(
        found.because[0],
        "flag NO does not accept f, which serves Rotterdam"
    );
    assert_eq!(
        found.would_help,
        ["flag NO accepting f, at Rotterdam on 2026-12-01"]
    );
}

#[test]
fn a_missing_licence_is_named() {
    let found = unscheduled(|input| input["vessels"][0]["licence"] = json!("MCA"));
    assert_eq!(found.because[0], "f at Rotterdam lacks licence MCA");
}

#[test]
fn a_late_job_is_planned_and_needs_an_earlier_call_or_an_extension() {
    let found = unscheduled(|input| input["needs"][0]["due"] = json!("2026-11-30"));
    assert!(found.planned_late);
    assert_eq!(
        found.because,
        [
            "planned 1 day after the due date, 2026-11-30",
            "no port call before the due date, 2026-11-30; the first is 2026-12-01T00:00:00Z at \
             Rotterdam"
        ]
    );
    assert_eq!(
        found.would_help,
        [
            "a call by 2026-11-30 at a port that a firm serves: NLRTM",
            "an extension to 2026-12-01, from flag NO, where its rules allow one"
        ]
    );
}

#[test]
fn without_late_days_the_remedies_are_listed_instead() {
    let found = unscheduled(|input| {
        input["needs"][0]["due"] = json!("2026-11-30");
        input["weights"] = json!({"late_days": 0});
    });
    assert!(!found.planned_late);
    assert_eq!(
        found.would_help,
        [
            "a call by 2026-11-30 at Rotterdam: f could come",
            "a call by 2026-11-30 at a port that a firm serves: NLRTM",
            "an extension to 2026-12-01, from flag NO, where its rules allow one"
        ]
    );
}

#[test]
fn a_weekend_call_wants_the_firm_to_work_then() {
    let found = unscheduled(|input| {
        input["port_calls"][0]["eta"] = json!("2026-12-05T00:00:00Z");
        input["port_calls"][0]["etd"] = json!("2026-12-06T00:00:00Z");
    });
    assert_eq!(found.because[0], "f does not work on Saturday, 2026-12-05");
    assert_eq!(
        found.would_help,
        ["f working at Rotterdam on Saturday, 2026-12-05"]
    );
}

#[test]
fn a_firm_that_needs_more_notice_is_named_with_its_hours() {
    let found = unscheduled(|input| input["firms"][0]["lead_time_h"] = json!(300));
    assert_eq!(
        found.because[0],
        "f needs 300 h notice, too long for 2026-12-01"
    );
}

#[test]
fn a_stay_of_one_hour_is_too_short() {
    let found = unscheduled(|input| {
        input["port_calls"][0]["eta"] = json!("2026-12-01T09:00:00Z");
        input["port_calls"][0]["etd"] = json!("2026-12-01T10:00:00Z");
    });
    assert_eq!(
        found.because,
        ["call c leaves f too few working hours on 2026-12-01 at Rotterdam"]
    );
}

#[test]
fn a_team_that_another_ship_has_is_named_with_the_ship() {
    let found = unscheduled(|input| {
        input["vessels"].as_array_mut().unwrap().push(vessel("w"));
        let mut urgent = need("m", "w", "2026-12-20");
        urgent["urgency"] = json!("urgent");
        input["needs"].as_array_mut().unwrap().push(urgent);
        input["port_calls"].as_array_mut().unwrap().push(call(
            "d",
            "w",
            "2026-12-01",
            "2026-12-02",
        ));
    });
    assert_eq!(found.because[0], "f's teams of 2026-12-01 go to w");
    assert_eq!(
        found.would_help[0],
        "one more team of f on 2026-12-01, at Rotterdam"
    );
}

#[test]
fn a_team_that_works_elsewhere_is_not_planned_with() {
    let found = unscheduled(|input| {
        input["firms"][0]["taken"] = json!([{"day": "2026-12-01", "teams": 1}]);
    });
    assert_eq!(found.because[0], "f's teams of 2026-12-01 are booked");
    assert_eq!(
        found.would_help[0],
        "one more team of f on 2026-12-01, at Rotterdam"
    );
}

#[test]
fn a_firm_that_costs_more_than_an_unmet_need_is_named() {
    let found = unscheduled(|input| {
        let little = json!({"routine": 100, "soon": 100, "urgent": 100, "overdue": 100});
        input["weights"] = json!({"unmet_eur": little, "missed_eur": little, "late_eur_day": 0});
    });
    assert_eq!(
        found.because[0],
        "f at Rotterdam on 2026-12-01 costs more than leaving it undone"
    );
}
