//! Every kind of bad input is refused with the JSON path of the fault.

#![allow(clippy::unwrap_used)] // helpers of tests

use binnacle_schedule::input::read;
use serde_json::{Value, json};

fn good() -> Value {
    json!({
        "now": "2026-11-21T00:00:00Z",
        "vessels": [{"id": "v1", "flag": "PA"}],
        "needs": [{"id": "n1", "vessel": "v1", "due": "2027-01-10"}],
        "port_calls": [
            {"id": "c1", "vessel": "v1", "port": "NLRTM", "eta": "2026-12-01T06:00:00Z", "etd": "2026-12-02T18:00:00Z"},
            {"id": "c2", "vessel": "v1", "port": "BEANR", "eta": "2026-12-05T06:00:00+01:00", "etd": "2026-12-06T18:00:00Z"}
        ],
        "firms": [{"id": "f1", "ports": [{"port": "NLRTM"}], "fee_eur": 1800}]
    })
}

/// The error when the value at a pointer is replaced.
fn complaint(pointer: &str, value: Value) -> String {
    let mut input = good();
    let (parent, field) = pointer.rsplit_once('/').unwrap();
    match input.pointer_mut(parent).unwrap() {
        Value::Object(object) => {
            object.insert(field.to_owned(), value);
        }
        other => other[field.parse::<usize>().unwrap()] = value,
    }
    read(&input.to_string()).unwrap_err().to_string()
}

#[test]
fn a_good_input_is_read() {
    assert!(read(&good().to_string()).is_ok());
}

#[test]
#[allow(clippy::too_many_lines, reason = "it is a table")]
fn each_fault_is_named_with_its_path() {
    let cases = [
        (
            "/now",
            json!("2026-11-21T00:00:00"),
            "now: \"2026-11-21T00:00:00\" has no time zone",
        ),
        (
            "/port_calls/1/eta",
            json!("2026-12-05 06:00"),
            "port_calls[1].eta: \"2026-12-05 06:00\" has no time zone",
        ),
        (
            "/port_calls/0/etd",
            json!("2026-11-20T00:00:00Z"),
            "port_calls[0].etd: 2026-11-20T00:00:00Z is not after eta",
        ),
        (
            "/port_calls/0/port",
            json!("NLXXX"),
            "port_calls[0].port: NLXXX is not a sea port",
        ),
        (
            "/port_calls/0/port",
            json!("Rotterdam"),
            "port_calls[0].port: \"Rotterdam\" is not a UN/LOCODE",
        ),
        (
            "/port_calls/0/vessel",
            json!("v9"),
            "port_calls[0].vessel: there is no vessel \"v9\"",
        ),
        (
            "/port_calls/1/id",
            json!("c1"),
            "port_calls[1].id: \"c1\" appears twice",
        ),
        (
            "/port_calls/1/eta",
            json!("2026-12-02T17:00:00Z"),
            "port_calls[1].eta: 2026-12-02T17:00:00Z overlaps call \"c1\"",
        ),
        (
            "/port_calls/0/eta_uncertainty_h",
            json!(-1),
            "port_calls[0].eta_uncertainty_h: -1 is not within 0 to 720",
        ),
        (
            "/port_calls/0/berth_heading_deg",
            json!(361),
            "port_calls[0].berth_heading_deg: 361 is not",
        ),
        (
            "/firms/0/fee_eur",
            json!(-1),
            "firms[0].fee_eur: -1 is not within 0 to 1000000 euros",
        ),
        (
            "/firms/0/working_days",
            json!([]),
            "firms[0].working_days: a firm that works on no day",
        ),
        (
            "/firms/0/ports",
            json!([]),
            "firms[0].ports: a firm without ports",
        ),
        (
            "/firms/0/ports/0/travel_eur",
            json!(-3),
            "firms[0].ports[0].travel_eur: -3 is not",
        ),
        (
            "/firms/0/last_hour",
            json!(8),
            "firms[0].last_hour: is not after first_hour",
        ),
        (
            "/firms/0/jobs_a_team_day",
            json!(0),
            "firms[0].jobs_a_team_day: is not within 1 to 20",
        ),
        (
            "/firms/0/mystery",
            json!(1),
            "firms[0].mystery: unknown field `mystery`",
        ),
        (
            "/vessels/0/flag",
            json!("Panama"),
            "vessels[0].flag: \"Panama\" is not a flag",
        ),
        (
            "/vessels/0/fleg",
            json!("PA"),
            "vessels[0].fleg: unknown field `fleg`",
        ),
        ("/needs/0/due", json!("10.1.2027"), "needs[0].due: "),
        (
            "/needs/0/vessel",
            json!("v9"),
            "needs[0].vessel: there is no vessel",
        ),
        (
            "/declined",
            json!([{"need": "n1", "firm": "f9"}]),
            "declined[0].firm: there is no firm \"f9\"",
        ),
        (
            "/weights",
            json!({"job_h": 0}),
            "weights.job_h: 0 is not within",
        ),
        ("/horizon_days", json!(0), "horizon_days: 0 is not within"),
        (
            "/compasses",
            json!([{"id": "k1", "vessel": "v1", "facts": {"adjusted": "2025-01-01"}}]),
            "compasses[0].facts.adjusted: unknown field",
        ),
        (
            "/compasses",
            json!([{"id": "n1", "vessel": "v1", "facts": {}}]),
            "compasses[0].id: \"n1\" appears twice",
        ),
    ];
    for (pointer, value, expected) in cases {
        let said = complaint(pointer, value);
        assert!(said.starts_with(expected), "{said}\nis not\n{expected}");
    }
}

#[test]
fn each_fault_of_teams_and_hours_is_named() {
    let taken = |more: Value| {
        let mut taken = json!({"day": "2026-12-01"});
        taken
            .as_object_mut()
            .unwrap()
            .extend(more.as_object().unwrap().clone());
        json!([taken])
    };
    let cases = [
        (
            "teams",
            json!("two"),
            "firms[0].teams: neither a number of teams nor a list",
        ),
        (
            "teams",
            json!([{"hours": 3}]),
            "firms[0].teams: neither a number of teams nor a list",
        ),
        (
            "teams",
            json!([{"name": "a"}, {"name": "a"}]),
            "firms[0].teams: \"a\" appears twice",
        ),
        (
            "teams",
            json!([{"name": " "}]),
            "firms[0].teams: a name is empty",
        ),
        (
            "teams",
            json!([{"name": "a", "first_hour": 19}]),
            "firms[0].teams: the hours of \"a\" are not in order",
        ),
        (
            "teams",
            json!([{"name": "a", "working_days": []}]),
            "firms[0].teams: \"a\" works on no day of the week",
        ),
        (
            "teams",
            json!([{"name": "a", "ports": ["BEANR"]}]),
            "firms[0].teams: \"a\" works at BEANR, which is not among",
        ),
        (
            "teams",
            json!([{"name": "a", "ports": []}]),
            "firms[0].teams: no team works at NLRTM",
        ),
        (
            "travel_times",
            json!([{"from": "NLRTM", "to": "BEANR", "hours": 1}]),
            "firms[0].travel_times: BEANR is not among its ports",
        ),
        (
            "travel_times",
            json!([{"from": "NLRTM", "to": "NLRTM", "hours": -1}]),
            "firms[0].travel_times: -1 hours are not within",
        ),
        (
            "taken",
            taken(json!({"team": "a"})),
            "firms[0].taken: there is no team \"a\"",
        ),
        (
            "taken",
            taken(json!({"hours": {"from": "2026-12-01T09:00:00Z", "to": "2026-12-01T09:00:00Z"}})),
            "firms[0].taken: 2026-12-01T09:00:00Z is not after",
        ),
        (
            "taken",
            taken(json!({"hours": {"from": "2026-12-04T09:00:00Z", "to": "2026-12-04T10:00:00Z"}})),
            "firms[0].taken: 2026-12-04T09:00:00Z to 2026-12-04T10:00:00Z are not hours of",
        ),
    ];
    for (field, value, expected) in cases {
        let said = complaint(&format!("/firms/0/{field}"), value);
        assert!(said.starts_with(expected), "{said}\nis not\n{expected}");
    }
}

#[test]
fn each_fault_of_an_agreed_hour_is_named() {
    let cases = [
        (
            json!({"to": "2026-12-01T09:00:00Z"}),
            "former[0].to: 2026-12-01T09:00:00Z is the end of a job without a beginning",
        ),
        (
            json!({"from": "2026-12-01T09:00:00Z", "to": "2026-12-01T09:00:00Z"}),
            "former[0].to: 2026-12-01T09:00:00Z is not within 24 hours after 2026-12-01T09:00:00Z",
        ),
    ];
    for (hours, expected) in cases {
        let mut job = json!({
            "needs": ["n1"], "call": "c1", "firm": "f1", "day": "2026-12-01", "state": "offered"
        });
        job.as_object_mut()
            .unwrap()
            .extend(hours.as_object().unwrap().clone());
        let said = complaint("/former", json!([job]));
        assert!(said.starts_with(expected), "{said}");
    }
}

#[test]
fn a_call_in_the_past_is_refused() {
    let mut input = good();
    input["now"] = json!("2026-12-03T00:00:00Z");
    let said = read(&input.to_string()).unwrap_err().to_string();
    assert!(
        said.starts_with("port_calls[0].etd: 2026-12-02T18:00:00Z is in the past"),
        "{said}"
    );
}

#[test]
fn half_a_file_is_refused() {
    let text = good().to_string();
    assert!(read(&text[..text.len() / 2]).is_err());
    assert!(read(&format!("{text} more")).is_err());
    assert!(read("").is_err());
}

#[test]
fn an_input_with_more_ways_than_memory_has_room_for_is_refused_at_once() {
    let ids = |letter: &str, many: usize| -> Vec<String> {
        (0..many).map(|nth| format!("{letter}{nth}")).collect()
    };
    let input = |vessels: usize| {
        let vessels = ids("v", vessels);
        let firms = ids("f", 300);
        let each = |list: &[String], of: fn(&str) -> Value| -> Vec<Value> {
            list.iter().map(|id| of(id)).collect()
        };
        json!({
            "now": "2026-11-21T00:00:00Z",
            "vessels": each(&vessels, |id| json!({"id": id})),
            "needs": each(&vessels, |id| json!({"id": id, "vessel": id, "due": "2027-01-10"})),
            "port_calls": each(&vessels, |id| json!({
                "id": id, "vessel": id, "port": "NLRTM",
                "eta": "2026-12-01T00:00:00Z", "etd": "2027-03-30T00:00:00Z"
            })),
            "firms": each(&firms, |id| json!({"id": id, "ports": [{"port": "NLRTM"}], "fee_eur": 1})),
        })
    };
    let said = read(&input(84).to_string()).unwrap_err().to_string();
    assert!(
        said.starts_with("port_calls: 3024000 pairs of a need and a firm's day"),
        "{said}"
    );
    assert!(read(&input(83).to_string()).is_ok());
}
