//! A checker that walks each team through a plan with a watch.
//!
//! It knows the input's and the output's JSON alone, and shares no code with the
//! planner: times are read by chrono, and distances, hours and zones are its own.

use chrono::{DateTime, NaiveDate, NaiveTime, TimeDelta, Utc};
use serde_json::Value;
use std::collections::BTreeMap;

/// Zone (hours ahead of UTC in December) and position of a port of the tests.
fn port(code: &str) -> (i64, f64, f64) {
    match code {
        "NLRTM" => (1, 51.92, 4.5),
        "BEANR" => (1, 51.23, 4.42),
        "DEHAM" => (1, 53.53, 9.97),
        "SGSIN" => (8, 1.28, 103.85),
        other => panic!("{other}"),
    }
}

/// Hours between two ports: the firm's own, or by the quicker of road and air.
fn travel_h(firm: &Value, from: &str, to: &str) -> f64 {
    let own = firm["travel_times"]
        .as_array()
        .into_iter()
        .flatten()
        .find(|time| {
            let ends = (time["from"].as_str().unwrap(), time["to"].as_str().unwrap());
            ends == (from, to) || ends == (to, from)
        });
    if let Some(own) = own {
        return own["hours"].as_f64().unwrap();
    }
    if from == to {
        return 0.5;
    }
    let ((_, lat, lon), (_, lat2, lon2)) = (port(from), port(to));
    let (a, b) = (lat.to_radians(), lat2.to_radians());
    let cos = a.sin() * b.sin() + a.cos() * b.cos() * (lon2 - lon).to_radians().cos();
    let km = cos.clamp(-1.0, 1.0).acos() * 6371.0;
    // Positions are rounded: a few kilometres are forgiven.
    (0.5 + km * 1.3 / 60.0).min(5.0 + km / 750.0) - 0.1
}

fn at(value: &Value) -> DateTime<Utc> {
    value.as_str().unwrap().parse().unwrap()
}

/// The instant of an hour of a day at a port.
fn local(day: NaiveDate, hour: f64, code: &str) -> DateTime<Utc> {
    let minutes = (hour * 60.0) as i64 - 60 * port(code).0;
    day.and_time(NaiveTime::MIN).and_utc() + TimeDelta::minutes(minutes)
}

fn by_id<'a>(list: &'a Value, id: &Value) -> &'a Value {
    list.as_array()
        .unwrap()
        .iter()
        .find(|one| one["id"] == *id)
        .unwrap()
}

/// The faults of a plan.
pub(crate) fn faults(input: &Value, plan: &Value) -> Vec<String> {
    let mut faults = Vec::new();
    let mut routes: BTreeMap<(&str, &str), Vec<&Value>> = BTreeMap::new();
    let mut met = Vec::new();
    for job in plan["jobs"].as_array().unwrap() {
        let wrong = job_faults(input, job);
        faults.extend(wrong.into_iter().map(|what| format!("{what}: {job}")));
        for need in job["needs"].as_array().unwrap() {
            if met.contains(&need) {
                faults.push(format!("met twice: {need}"));
            }
            met.push(need);
        }
        let [firm, team] = ["firm", "team"].map(|name| job[name].as_str().unwrap());
        routes.entry((firm, team)).or_default().push(job);
    }
    for ((firm, team), mut jobs) in routes {
        let firm = by_id(&input["firms"], &Value::String(firm.to_owned()));
        jobs.sort_by_key(|job| at(&job["from"]));
        for pair in jobs.windows(2) {
            let ports = [pair[0], pair[1]].map(|job| job["port"].as_str().unwrap());
            let gap = at(&pair[1]["from"]) - at(&pair[0]["to"]);
            if (gap.num_seconds() as f64) < travel_h(firm, ports[0], ports[1]) * 3600.0 {
                faults.push(format!(
                    "team {team} in two places: {} {}",
                    pair[0], pair[1]
                ));
            }
        }
        let most = firm["jobs_a_team_day"].as_u64().unwrap_or(1) as usize;
        for job in &jobs {
            if jobs
                .iter()
                .filter(|other| other["day"] == job["day"])
                .count()
                > most
            {
                faults.push(format!("team {team} has too many jobs: {job}"));
            }
        }
    }
    faults
}

/// The faults of one job by itself.
fn job_faults(input: &Value, job: &Value) -> Vec<&'static str> {
    let (from, to) = (at(&job["from"]), at(&job["to"]));
    let call = by_id(&input["port_calls"], &job["call"]);
    let firm = by_id(&input["firms"], &job["firm"]);
    let (code, name) = (job["port"].as_str().unwrap(), job["team"].as_str().unwrap());
    let day: NaiveDate = job["day"].as_str().unwrap().parse().unwrap();
    let teams = firm["teams"].as_array();
    let team = teams.and_then(|teams| teams.iter().find(|team| team["name"] == name));
    let is_known = match teams {
        Some(_) => team.is_some(),
        None => (1..=firm["teams"].as_u64().unwrap_or(1)).contains(&name.parse().unwrap()),
    };
    let own = |field: &str| team.map_or(&firm[field], |team| &team[field]);
    let hour = |field, usual| {
        let own = own(field).as_f64().or(firm[field].as_f64());
        own.unwrap_or(usual)
    };
    let mut former = input["former"].as_array().into_iter().flatten();
    let agreed = former.find(|former| {
        let is_it = former["needs"] == job["needs"] && former["from"] == job["from"];
        is_it && former["state"] != "proposed"
    });
    let agreed_to = agreed.filter(|agreed| !agreed["to"].is_null());
    let hours = (hour("first_hour", 8.0), hour("last_hour", 18.0));
    let work = (local(day, hours.0, code), local(day, hours.1, code));
    let ports = own("ports")
        .as_array()
        .or(firm["ports"].as_array())
        .unwrap();
    let asked = &by_id(&input["vessels"], &job["vessel"])["licence"];
    let held = own("licences").as_array().or(firm["licences"].as_array());
    let job_s = input["weights"]["job_h"].as_f64().unwrap_or(3.0) * 3600.0;
    let checks = [
        ("unknown team", is_known),
        (
            "length",
            match agreed_to {
                Some(agreed) => to == at(&agreed["to"]),
                None => ((to - from).num_seconds() as f64 - job_s).abs() < 0.5,
            },
        ),
        (
            "not alongside",
            at(&call["eta"]) <= from && to <= at(&call["etd"]),
        ),
        (
            "other call",
            call["vessel"] == job["vessel"] && call["port"] == job["port"],
        ),
        (
            "not at work",
            agreed.is_some() || work.0 <= from && to <= work.1,
        ),
        (
            "not served",
            ports.iter().any(|it| it == code || it["port"] == code),
        ),
        (
            "no licence",
            asked.is_null() || held.is_some_and(|held| held.contains(asked)),
        ),
    ];
    let wrong = checks.into_iter().filter(|(_, is_right)| !is_right);
    wrong.map(|(what, _)| what).collect()
}
