//! A job has its hour, and a team is in one place at a time.

use crate::{need, schedule, vessel, watch};
use binnacle_schedule::plan::Schedule;
use proptest::collection::vec;
use proptest::prelude::*;
use serde_json::{Value, json, to_value};

fn call_at(port: &str, vessel: &str, eta: &str, etd: &str) -> Value {
    json!({"id": format!("{vessel}-{port}"), "vessel": vessel, "port": port, "eta": eta, "etd": etd})
}

/// A firm that does three jobs a team's day in Rotterdam, Antwerp and Singapore.
fn firm() -> Value {
    json!({"id": "f", "fee_eur": 1500, "jobs_a_team_day": 3,
           "ports": [{"port": "NLRTM", "travel_eur": 100}, {"port": "BEANR", "travel_eur": 100},
                     {"port": "SGSIN", "travel_eur": 100}]})
}

/// The plan of ships with a call each, which is checked with a watch.
fn planned(calls: &[Value], firm: &Value, change: impl FnOnce(&mut Value)) -> Schedule {
    let ships: Vec<&str> = calls
        .iter()
        .map(|call| call["vessel"].as_str().unwrap())
        .collect();
    let mut input = json!({
        "vessels": ships.iter().map(|ship| vessel(ship)).collect::<Vec<_>>(),
        "needs": ships.iter().map(|ship| need(&format!("n-{ship}"), ship, "2027-05-01")).collect::<Vec<_>>(),
        "port_calls": calls,
        "firms": [firm],
    });
    change(&mut input);
    let found = schedule(input.clone());
    assert_eq!(
        watch::faults(&input, &to_value(&found).unwrap()),
        Vec::<String>::new()
    );
    assert!(found.proven_optimal);
    found
}

fn hours(found: &Schedule) -> Vec<(&str, String)> {
    let jobs = found.jobs.iter();
    jobs.map(|job| (job.vessel.as_str(), job.from.to_string()))
        .collect()
}

/// Ships in Rotterdam on Tuesday, 1 December, 07:30 to 11:15.
fn three_in_a_morning() -> Vec<Value> {
    let call = |ship| {
        call_at(
            "NLRTM",
            ship,
            "2026-12-01T06:30:00Z",
            "2026-12-01T10:15:00Z",
        )
    };
    ["u", "v", "w"].map(call).to_vec()
}

#[test]
fn of_three_ships_in_one_short_morning_one_team_does_one() {
    let found = planned(&three_in_a_morning(), &firm(), |_| {});
    assert_eq!(hours(&found), [("u", "2026-12-01T07:00:00Z".to_owned())]);
    assert_eq!(found.jobs[0].to.to_string(), "2026-12-01T10:00:00Z");
    assert_eq!(found.unscheduled.len(), 2);
    assert_eq!(
        found.unscheduled[0].because,
        [
            "f's teams go to u at Rotterdam from 08:00 to 11:00 on 2026-12-01, and have no 3 h with \
          the travel left: v can be served at Rotterdam from 08:00 to 11:15 on 2026-12-01 only"
        ]
    );
    assert_eq!(
        found.unscheduled[0].would_help,
        [
            "one more team of f on 2026-12-01, at Rotterdam",
            "a longer stay at Rotterdam on 2026-12-01, until 14:30, for f"
        ]
    );
}

#[test]
fn the_remedies_of_a_short_morning_are_enough() {
    let mut two = firm();
    two["teams"] = json!(2);
    assert_eq!(planned(&three_in_a_morning(), &two, |_| {}).jobs.len(), 2);
    let longer = planned(&three_in_a_morning(), &firm(), |input| {
        input["port_calls"][1]["etd"] = json!("2026-12-01T13:30:00Z");
    });
    assert_eq!(
        hours(&longer),
        [
            ("u", "2026-12-01T07:00:00Z".to_owned()),
            ("v", "2026-12-01T10:30:00Z".to_owned())
        ]
    );
}

#[test]
fn three_ships_alongside_all_day_have_hours_one_after_the_other() {
    let call = |ship| {
        call_at(
            "NLRTM",
            ship,
            "2026-12-01T00:00:00Z",
            "2026-12-02T00:00:00Z",
        )
    };
    let found = planned(&["u", "v", "w"].map(call), &firm(), |input| {
        input["firms"][0]["last_hour"] = json!(19);
    });
    let from: Vec<String> = found.jobs.iter().map(|job| job.from.to_string()).collect();
    assert_eq!(
        from,
        [
            "2026-12-01T07:00:00Z",
            "2026-12-01T10:30:00Z",
            "2026-12-01T14:00:00Z"
        ]
    );
    assert!((found.paid_eur - 4600.0).abs() < 1e-9, "{}", found.paid_eur);
}

#[test]
fn a_team_in_rotterdam_until_evening_is_not_in_singapore_in_the_morning() {
    let evening = call_at("NLRTM", "u", "2026-12-01T12:00:00Z", "2026-12-01T18:00:00Z");
    let morning = |etd: &str| call_at("SGSIN", "v", "2026-12-02T00:00:00Z", etd);
    let found = planned(
        &[evening.clone(), morning("2026-12-02T06:00:00Z")],
        &firm(),
        |_| {},
    );
    assert_eq!(found.jobs.len(), 1);
    assert_eq!(
        found.unscheduled[0].because,
        [
            "f's teams go to v at Singapore from 08:00 to 11:00 on 2026-12-02, and have no 3 h with \
          the travel left: u can be served at Rotterdam from 13:00 to 18:00 on 2026-12-01 only"
        ]
    );
    // On the third there is time: nineteen hours by air.
    let found = planned(&[evening, morning("2026-12-03T06:00:00Z")], &firm(), |_| {});
    assert_eq!(hours(&found)[1].1, "2026-12-03T00:00:00Z");
}

#[test]
fn two_ports_an_hour_apart_are_done_on_one_day() {
    let day = |port, ship| call_at(port, ship, "2026-12-01T00:00:00Z", "2026-12-02T00:00:00Z");
    let calls = [day("NLRTM", "u"), day("BEANR", "v")];
    let near = planned(&calls, &firm(), |input| {
        input["firms"][0]["travel_times"] = json!([{"from": "BEANR", "to": "NLRTM", "hours": 1}]);
    });
    let from: Vec<String> = near.jobs.iter().map(|job| job.from.to_string()).collect();
    assert_eq!(from, ["2026-12-01T07:00:00Z", "2026-12-01T11:00:00Z"]);
    assert!((near.paid_eur - 3200.0).abs() < 1e-9);
    let far = planned(&calls, &firm(), |input| {
        input["firms"][0]["travel_times"] = json!([{"from": "BEANR", "to": "NLRTM", "hours": 5}]);
    });
    assert_eq!(far.jobs.len(), 1);
}

#[test]
fn the_hour_that_clocks_lose_in_the_night_is_not_worked() {
    // Friday 18:00 to Monday 04:00 are 58 hours by the clock, and 57 by the watch.
    let calls = [
        call_at("NLRTM", "u", "2027-03-26T14:00:00Z", "2027-03-26T17:00:00Z"),
        call_at("BEANR", "v", "2027-03-29T00:00:00Z", "2027-03-29T05:00:00Z"),
    ];
    let jobs = |hours: f64| {
        let found = schedule(json!({
            "vessels": [vessel("u"), vessel("v")],
            "needs": [need("n", "u", "2027-05-01"), need("m", "v", "2027-05-01")],
            "port_calls": calls,
            "firms": [{"id": "f", "fee_eur": 1500, "first_hour": 4,
                       "ports": [{"port": "NLRTM"}, {"port": "BEANR"}],
                       "travel_times": [{"from": "NLRTM", "to": "BEANR", "hours": hours}]}],
        }));
        found
            .jobs
            .iter()
            .map(|job| job.from.to_string())
            .collect::<Vec<_>>()
    };
    assert_eq!(jobs(57.0), ["2027-03-26T14:00:00Z", "2027-03-29T02:00:00Z"]);
    assert_eq!(jobs(57.5).len(), 1);
}

#[test]
fn an_agreed_hour_holds_and_others_go_around_it() {
    let day = |ship| {
        call_at(
            "NLRTM",
            ship,
            "2026-12-01T00:00:00Z",
            "2026-12-02T00:00:00Z",
        )
    };
    let agreed = |state: &str| {
        let former = json!([{"needs": ["n-u"], "call": "u-NLRTM", "firm": "f", "day": "2026-12-01",
                             "from": "2026-12-01T09:00:00Z", "state": state}]);
        planned(&[day("u"), day("v")], &firm(), |input| {
            input["former"] = former;
            input["firms"][0]["travel_times"] =
                json!([{"from": "NLRTM", "to": "NLRTM", "hours": 0.25}]);
        })
    };
    for state in ["confirmed", "offered"] {
        let found = agreed(state);
        assert_eq!(
            hours(&found),
            [
                ("u", "2026-12-01T09:00:00Z".to_owned()),
                ("v", "2026-12-01T12:15:00Z".to_owned())
            ]
        );
    }
    // No firm knows of a proposed hour.
    assert_eq!(hours(&agreed("proposed"))[0].1, "2026-12-01T07:00:00Z");
}

#[test]
fn an_agreed_job_takes_as_long_as_agreed() {
    let day = |ship| {
        call_at(
            "NLRTM",
            ship,
            "2026-12-01T00:00:00Z",
            "2026-12-02T00:00:00Z",
        )
    };
    let second = |to: &str| {
        let former = json!([{"needs": ["n-u"], "call": "u-NLRTM", "firm": "f", "day": "2026-12-01",
                             "from": "2026-12-01T07:00:00Z", "to": to, "state": "confirmed"}]);
        let found = planned(&[day("u"), day("v")], &firm(), |input| {
            input["former"] = former;
        });
        assert_eq!(found.jobs[0].to.to_string(), to);
        found.jobs[1].from.to_string()
    };
    assert_eq!(second("2026-12-01T12:00:00Z"), "2026-12-01T12:30:00Z");
    assert_eq!(second("2026-12-01T08:00:00Z"), "2026-12-01T08:30:00Z");
}

#[test]
fn hours_that_are_taken_are_left_free() {
    let day = call_at("NLRTM", "u", "2026-12-01T00:00:00Z", "2026-12-02T00:00:00Z");
    let taken = |from: &str, to: &str, port: Value| {
        let taken = json!([{"day": "2026-12-01", "hours": {"from": from, "to": to, "port": port}}]);
        planned(std::slice::from_ref(&day), &firm(), |input| {
            input["firms"][0]["taken"] = taken;
        })
    };
    let here = taken(
        "2026-12-01T07:00:00Z",
        "2026-12-01T10:00:00Z",
        json!("NLRTM"),
    );
    assert_eq!(here.jobs[0].from.to_string(), "2026-12-01T10:30:00Z");
    let most = taken("2026-12-01T09:00:00Z", "2026-12-01T16:00:00Z", Value::Null);
    assert!(
        most.unscheduled[0].because[0].contains("hours that leave no 3 h"),
        "{most:?}"
    );
}

#[test]
fn a_job_booked_elsewhere_is_one_of_the_days_jobs() {
    let day = call_at("NLRTM", "u", "2026-12-01T00:00:00Z", "2026-12-01T20:00:00Z");
    let with_jobs = |jobs: u32, port: Value| {
        let hours = json!({"from": "2026-12-01T07:00:00Z", "to": "2026-12-01T08:00:00Z",
                           "port": port});
        planned(std::slice::from_ref(&day), &firm(), |input| {
            input["firms"][0]["taken"] = json!([{"day": "2026-12-01", "hours": hours}]);
            input["firms"][0]["jobs_a_team_day"] = json!(jobs);
        })
    };
    let full = with_jobs(1, json!("NLRTM"));
    assert_eq!(
        full.unscheduled[0].because,
        ["f's teams of 2026-12-01 are booked"]
    );
    assert_eq!(with_jobs(2, json!("NLRTM")).jobs.len(), 1);
    assert_eq!(with_jobs(1, Value::Null).jobs.len(), 1);
}

#[test]
fn more_jobs_than_a_team_may_do_are_booked_and_other_days_are_planned() {
    let days = call_at("NLRTM", "u", "2026-12-01T00:00:00Z", "2026-12-03T00:00:00Z");
    let found = planned(&[days], &firm(), |input| {
        let hours = |from: &str, to: &str| json!({"day": "2026-12-01", "hours": {"from": from, "to": to, "port": "NLRTM"}});
        input["firms"][0]["jobs_a_team_day"] = json!(1);
        input["firms"][0]["taken"] = json!([
            hours("2026-12-01T07:00:00Z", "2026-12-01T08:00:00Z"),
            hours("2026-12-01T09:00:00Z", "2026-12-01T10:00:00Z"),
        ]);
    });
    assert_eq!(found.jobs[0].from.to_string(), "2026-12-02T07:00:00Z");
}

#[test]
fn a_team_with_a_name_has_its_own_hours_licence_and_ports() {
    let mut named = firm();
    named["teams"] = json!([
        {"name": "Jansen", "first_hour": 13, "last_hour": 17, "ports": ["NLRTM"]},
        {"name": "Peeters", "licences": ["MCA"]},
    ]);
    let day = |port, ship| call_at(port, ship, "2026-12-01T00:00:00Z", "2026-12-02T00:00:00Z");
    let calls = [day("NLRTM", "u"), day("NLRTM", "v"), day("NLRTM", "w")];
    let found = planned(&calls, &named, |input| {
        input["vessels"][2]["licence"] = json!("MCA");
        input["firms"][0]["jobs_a_team_day"] = json!(2);
    });
    assert_eq!(found.jobs.len(), 3);
    let of = |ship: &str| found.jobs.iter().find(|job| job.vessel == ship).unwrap();
    assert_eq!(of("w").team, "Peeters");
    let late = found.jobs.iter().find(|job| job.team == "Jansen").unwrap();
    assert_eq!(late.from.to_string(), "2026-12-01T12:00:00Z");
}

#[test]
fn a_team_works_on_its_own_days() {
    let mut named = firm();
    named["teams"] = json!([{"name": "Jansen", "working_days": ["Tue", "Sat"]}]);
    let call = |eta, etd| [call_at("NLRTM", "u", eta, etd)];
    // From Thursday to Sunday, where the firm works to Friday.
    let weekend = call("2026-12-03T00:00:00Z", "2026-12-07T00:00:00Z");
    let found = planned(&weekend, &named, |_| {});
    assert_eq!(found.jobs[0].day.to_string(), "2026-12-05");
    let monday = call("2026-11-30T00:00:00Z", "2026-11-30T20:00:00Z");
    let found = planned(&monday, &named, |_| {});
    assert_eq!(
        found.unscheduled[0].because,
        ["f does not work on Monday, 2026-11-30"]
    );
}

#[test]
fn the_watch_finds_a_team_in_two_places_and_a_ship_that_has_left() {
    let day = |ship| {
        call_at(
            "NLRTM",
            ship,
            "2026-12-01T00:00:00Z",
            "2026-12-02T00:00:00Z",
        )
    };
    let input = json!({
        "vessels": [vessel("u"), vessel("v")],
        "needs": [need("n-u", "u", "2027-05-01"), need("n-v", "v", "2027-05-01")],
        "port_calls": [day("u"), day("v")],
        "firms": [firm()],
    });
    let good = to_value(schedule(input.clone())).unwrap();
    let faults = |from: &str, to: &str| {
        let mut plan = good.clone();
        (plan["jobs"][1]["from"], plan["jobs"][1]["to"]) = (json!(from), json!(to));
        watch::faults(&input, &plan)
    };
    let early = faults("2026-12-01T10:15:00Z", "2026-12-01T13:15:00Z");
    assert!(early[0].starts_with("team 1 in two places"), "{early:?}");
    let night = faults("2026-12-02T10:00:00Z", "2026-12-02T13:00:00Z");
    assert!(night[0].starts_with("not alongside"), "{night:?}");
}

/// Two firms in four ports, with up to six ships alongside for hours or days.
fn inputs() -> impl Strategy<Value = Value> {
    let ports = ["NLRTM", "BEANR", "DEHAM", "SGSIN"];
    let call = (0..6_u32, 0..4_usize, 0..96_i64, 3..40_i64);
    let firm = (1..3_u32, 1..4_u32, 0..900_u32, 1..4_usize);
    (vec(call, 1..9), vec(firm, 2)).prop_map(move |(calls, firms)| {
        let ships = || (0..6).map(|ship| format!("v{ship}"));
        let at = |hour: i64| {
            let begin: chrono::DateTime<chrono::Utc> = "2026-11-30T06:00:00Z".parse().unwrap();
            (begin + chrono::TimeDelta::hours(hour)).to_rfc3339()
        };
        // A ship's calls follow each other.
        let mut free = [0; 6];
        let mut listed = Vec::new();
        for (index, (ship, port, wait, stay)) in calls.into_iter().enumerate() {
            let eta = free[ship as usize] + wait;
            free[ship as usize] = eta + stay;
            listed.push(json!({"id": format!("c{index}"), "vessel": format!("v{ship}"),
                               "port": ports[port], "eta": at(eta), "etd": at(eta + stay)}));
        }
        let firms = firms.into_iter().enumerate().map(|(index, (teams, jobs, travel, many))| {
            let served = ports.iter().cycle().skip(index).take(many + 1);
            let served: Vec<Value> =
                served.map(|port| json!({"port": port, "travel_eur": travel})).collect();
            json!({"id": format!("f{index}"), "ports": served, "teams": teams,
                   "jobs_a_team_day": jobs, "fee_eur": 1500 + 100 * index})
        });
        json!({
            "vessels": ships().map(|ship| vessel(&ship)).collect::<Vec<_>>(),
            "needs": ships().map(|ship| need(&format!("n-{ship}"), &ship, "2026-12-20")).collect::<Vec<_>>(),
            "port_calls": listed, "firms": firms.collect::<Vec<_>>(),
        })
    })
}

proptest! {
    #![proptest_config(ProptestConfig { cases: 500, failure_persistence: None, ..ProptestConfig::default() })]

    #[test]
    fn someone_with_a_watch_can_do_every_plan(input in inputs()) {
        let found = schedule(input.clone());
        let faults = watch::faults(&input, &to_value(&found).unwrap());
        prop_assert!(faults.is_empty(), "{faults:#?}");
        prop_assert!(found.proven_optimal);
    }
}
