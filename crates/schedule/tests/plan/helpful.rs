//! Remedies work: with any one of them applied, the job is planned.

use binnacle_schedule::input::read;
use binnacle_schedule::plan::{Schedule, plan};
use proptest::prelude::*;
use serde_json::{Value, json};

const NOW: &str = "2026-11-21T00:00:00Z";

fn solved(input: &Value) -> Schedule {
    plan(&read(&input.to_string()).unwrap())
}

/// True if a need is met, in time if `in_time` is set.
fn is_met(schedule: &Schedule, need: &str, in_time: bool) -> bool {
    schedule
        .jobs
        .iter()
        .any(|job| job.needs.iter().any(|met| met == need) && (!in_time || job.late_days == 0))
}

fn firm_of<'a>(input: &'a mut Value, id: &str) -> &'a mut Value {
    let firms = input["firms"].as_array_mut().unwrap();
    firms.iter_mut().find(|firm| firm["id"] == id).unwrap()
}

/// The text between two others.
fn between<'a>(text: &'a str, before: &str, after: &str) -> Option<&'a str> {
    let (_, rest) = text.split_once(before)?;
    Some(rest.split_once(after)?.0)
}

fn port_named(name: &str) -> &'static str {
    match name {
        "Rotterdam" => "NLRTM",
        "Bilbao" => "ESBIO",
        "Apia" => "WSAPW",
        other => panic!("{other}"),
    }
}

/// Replaces the ship's calls by one at a port.
fn calls_at(input: &mut Value, vessel: &str, port: &str, from: &str, to: &str) {
    let calls = input["port_calls"].as_array_mut().unwrap();
    calls.retain(|call| call["vessel"] != vessel);
    calls.push(json!({"id": "anew", "vessel": vessel, "port": port, "eta": from, "etd": to}));
}

/// Applies one change of a line.
fn apply(input: &mut Value, vessel: &str, thing: &str) {
    if thing.contains("more team") {
        let (count, firm) = (
            thing.split(' ').next().unwrap(),
            between(thing, " of ", " on ").unwrap(),
        );
        let more = if count == "one" {
            1
        } else {
            count.parse().unwrap()
        };
        let firm = firm_of(input, firm);
        firm["teams"] = json!(firm["teams"].as_u64().unwrap_or(1) + more);
    } else if let Some(firm) =
        between(thing, " accepting after all", "").map(|_| thing.split(' ').next().unwrap())
    {
        let declined = input["declined"].as_array_mut().unwrap();
        declined.retain(|one| one["firm"] != firm);
    } else if let Some(firm) = between(thing, " accepting ", ",") {
        firm_of(input, firm)["flags"] = json!([]);
    } else if let Some(licence) = between(thing, " holding licence ", ",") {
        firm_of(input, thing.split(' ').next().unwrap())["licences"] = json!([licence]);
    } else if thing.contains(" working at ") {
        let firm = firm_of(input, thing.split(' ').next().unwrap());
        firm["working_days"] = json!(["Mon", "Tue", "Wed", "Thu", "Fri", "Sat", "Sun"]);
    } else if let Some(hours) = between(thing, " at ", " h notice") {
        firm_of(input, thing.split(' ').next().unwrap())["lead_time_h"] =
            json!(hours.parse::<f64>().unwrap());
    } else if let Some(euros) = between(thing, " for ", " euros less") {
        let firm = firm_of(input, thing.split(' ').next().unwrap());
        let less = firm["fee_eur"].as_f64().unwrap() - euros.parse::<f64>().unwrap();
        firm["fee_eur"] = json!(less.max(0.0));
        for port in firm["ports"].as_array_mut().unwrap() {
            let travel = port["travel_eur"].as_f64().unwrap_or(0.0);
            port["travel_eur"] = json!((travel + less.min(0.0)).max(0.0));
        }
    } else if let Some(port) = between(thing, "a longer stay at ", " on ") {
        let day = between(thing, " on ", ",").unwrap();
        let port = port_named(port);
        // From the day before to the day after, in whatever zone.
        let at = |hours: i64| {
            let noon: chrono::DateTime<chrono::Utc> = format!("{day}T12:00:00Z").parse().unwrap();
            let at = noon + chrono::TimeDelta::hours(hours);
            at.max(NOW.parse().unwrap()).to_rfc3339()
        };
        calls_at(input, vessel, port, &at(-36), &at(36));
    } else if let Some(day) = between(thing, "an extension to ", ",") {
        for need in input["needs"].as_array_mut().unwrap() {
            if need["vessel"] == vessel {
                need["due"] = json!(day);
            }
        }
    } else if let Some(place) = between(thing, "a firm at ", " on ") {
        let port = between(place, "(", ")").unwrap();
        let firms = input["firms"].as_array_mut().unwrap();
        firms.push(json!({"id": "new", "fee_eur": 0, "ports": [{"port": port}],
                          "licences": ["MCA"], "closed": [],
                          "working_days": ["Mon", "Tue", "Wed", "Thu", "Fri", "Sat", "Sun"]}));
    } else if thing.starts_with("a call by ") || thing.starts_with("a call as soon as ") {
        let port = if let Some((_, codes)) = thing.split_once("serves: ") {
            codes.split(',').next().unwrap()
        } else {
            let place = thing.rsplit(" at ").next().unwrap();
            port_named(place.split(':').next().unwrap())
        };
        let until = match between(thing, "a call by ", " at ") {
            Some(due) => format!("{due}T23:00:00Z"),
            None => "2027-02-18T00:00:00Z".to_owned(),
        };
        calls_at(input, vessel, port, NOW, &until);
    } else {
        panic!("unknown remedy {thing:?}");
    }
}

prop_compose! {
    fn a_call(vessel: &'static str)(
        port in prop::sample::select(vec!["NLRTM", "ESBIO", "WSAPW"]),
        begins_h in 0_i64..400,
        lasts_h in prop_oneof![1_i64..12, 12_i64..90],
    ) -> Value {
        let now: chrono::DateTime<chrono::Utc> = NOW.parse().unwrap();
        let at = |hours| (now + chrono::TimeDelta::hours(hours)).to_rfc3339();
        json!({"id": format!("{vessel}-call"), "vessel": vessel, "port": port,
               "eta": at(begins_h - 30), "etd": at(begins_h - 30 + lasts_h.max(31 - begins_h))})
    }
}

prop_compose! {
    fn a_firm(id: &'static str)(
        ports in prop::sample::subsequence(vec!["NLRTM", "ESBIO", "WSAPW"], 1..=2),
        fee in prop_oneof![9 => Just(1500), 1 => Just(90_000)],
        is_for_panama in prop::bool::weighted(0.25),
        is_licensed in prop::bool::weighted(0.7),
        teams in 0_u32..3,
        lead in prop_oneof![Just(0), Just(48), Just(400)],
        weekend in any::<bool>(),
        last_hour in prop_oneof![Just(18.0), Just(12.5)],
    ) -> Value {
        let ports: Vec<Value> = ports.into_iter()
            .map(|port| json!({"port": port, "travel_eur": 100})).collect();
        let days = if weekend { json!(["Sat", "Sun"]) } else { json!(["Mon", "Tue", "Wed", "Thu", "Fri"]) };
        json!({"id": id, "ports": ports, "fee_eur": fee, "teams": teams, "lead_time_h": lead,
               "flags": if is_for_panama { json!(["PA"]) } else { json!([]) },
               "licences": if is_licensed { json!(["MCA"]) } else { json!([]) },
               "working_days": days, "last_hour": last_hour})
    }
}

prop_compose! {
    fn a_fleet()(
        calls in (prop::option::weighted(0.9, a_call("v")), prop::option::weighted(0.9, a_call("w"))),
        firms in prop_oneof![
            a_firm("f").prop_map(|firm| vec![firm]),
            (a_firm("f"), a_firm("g")).prop_map(|(one, other)| vec![one, other]),
        ],
        dues in (-20_i64..40, -20_i64..40),
        licence in any::<bool>(),
        has_declined in prop::bool::weighted(0.2),
        cap in prop::option::weighted(0.4, 0_u32..5),
    ) -> Value {
        let now: chrono::DateTime<chrono::Utc> = NOW.parse().unwrap();
        let day = |days| (now + chrono::TimeDelta::days(days)).date_naive().to_string();
        let vessel = |id: &str| if licence {
            json!({"id": id, "flag": "NO", "licence": "MCA"})
        } else {
            json!({"id": id, "flag": "NO"})
        };
        let calls: Vec<Value> = [calls.0, calls.1].into_iter().flatten().collect();
        let declined = if has_declined { json!([{"need": "v-need", "firm": "f"}]) } else { json!([]) };
        let weights = cap.map_or(json!({}), |days| json!({"late_days": days}));
        json!({
            "now": NOW, "vessels": [vessel("v"), vessel("w")], "port_calls": calls,
            "needs": [{"id": "v-need", "vessel": "v", "due": day(dues.0)},
                      {"id": "w-need", "vessel": "w", "due": day(dues.1)}],
            "firms": firms, "declined": declined, "weights": weights,
        })
    }
}

proptest! {
    #![proptest_config(ProptestConfig::with_cases(400))]

    #[test]
    fn every_remedy_is_enough_and_there_is_always_one(fleet in a_fleet()) {
        let found = solved(&fleet);
        for open in &found.unscheduled {
            prop_assert!(!open.would_help.is_empty(), "{open:?}");
            for line in &open.would_help {
                if line.starts_with("another firm") {
                    continue;
                }
                let mut helped = fleet.clone();
                for thing in line.split(" and ") {
                    apply(&mut helped, &open.vessel, thing);
                }
                let then = solved(&helped);
                // A way that opens for one ship may open for another, which
                // takes it.
                let is_done = is_met(&then, &open.needs[0], open.planned_late)
                    || then.jobs.len() > found.jobs.len();
                prop_assert!(is_done, "{line:?} of {open:?} leaves {:?}", then.unscheduled);
            }
        }
    }
}
