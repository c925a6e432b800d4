//! The schedule: its inputs, its jobs, and its updates.

mod agreed_job;
mod at_risk;
mod concurrent;
mod fees;
mod firm_teams;
mod firm_terms;
mod hours;
mod moved_port_calls;
mod needs;
mod offers;
mod pinned_jobs;
mod plans;
mod teams;
mod withdrawn_port_calls;

use binnacle_orders::firms as all_firms;
use binnacle_planning::schedule;
use binnacle_planning::schedule::PlanSlots;
use binnacle_platform::ids::OperatorId;
use binnacle_platform::time::Time;
use binnacle_server_testing::port_calls;
use binnacle_server_testing::{ApiResponse, Person, TestServer};
use reqwest::Method;
use serde_json::{Value, json};

/// Creates a firm that works for a person's operator.
pub(crate) async fn firm(server: &TestServer, person: &Person, name: &str) -> String {
    let now = Time(server.app.clock.now());
    let mut tx = server.app.db.begin().await.unwrap();
    let id = all_firms::create(&mut tx, name, now).await.unwrap();
    all_firms::engage(&mut tx, person.operator, id, now)
        .await
        .unwrap();
    tx.commit().await.unwrap();
    id.to_string()
}

/// Returns terms of one team in Rotterdam and Antwerp, on every day but Sunday.
pub(crate) fn terms() -> Value {
    json!({
        "ports": [{ "port": "NLRTM", "travel_eur": 100 }, { "port": "BEANR", "travel_eur": 400 }],
        "fee_eur": 1800, "working_days": ["Mon", "Tue", "Wed", "Thu", "Fri", "Sat"],
    })
}

pub(crate) async fn put(person: &Person, path: &str, body: &Value) -> ApiResponse {
    ApiResponse::send(person.request(Method::PUT, path).json(body)).await
}

/// Creates a firm with terms.
pub(crate) async fn planned_firm(server: &TestServer, person: &Person, name: &str) -> String {
    let id = firm(server, person, name).await;
    put(person, &format!("/firms/{id}/terms"), &terms())
        .await
        .good();
    id
}

/// Creates a Norwegian vessel whose compass is due on 2026-12-20.
pub(crate) async fn due_vessel(person: &Person, name: &str) -> Value {
    let vessel = person.create_vessel(name).await;
    let path = format!("/vessels/{}", vessel["id"].as_str().unwrap());
    let known = json!({ "flag_state": "NO", "gross_tonnage": 24000, "trade": "bulk",
                        "deviation_record": "kept" });
    put(person, &format!("{path}/particulars"), &known)
        .await
        .good();
    let adjusted = json!({ "kind": "adjustment", "from": "2024-12-20T08:00:00Z" });
    person
        .post(&format!("{path}/logbook"), &adjusted)
        .await
        .good();
    vessel
}

/// Enters a port call of the vessel.
pub(crate) async fn enter_port_call(
    person: &Person,
    vessel: &Value,
    port: &str,
    day: u32,
) -> Value {
    let path = port_calls::path(vessel);
    person
        .post(&path, &port_calls::call(port, day))
        .await
        .good()
}

pub(crate) async fn solve(person: &Person) -> Value {
    let solved = person.post("/schedule/solve", &json!({})).await.good();
    assert_eq!(solved["outdated_since"], json!(null), "{solved}");
    solved["plan"].clone()
}

/// Advances until changes are due, and lets the worker make a schedule.
pub(crate) async fn update_schedule(server: &TestServer) -> Option<OperatorId> {
    server.advance(31.0);
    schedule::step(&server.app, &PlanSlots::default())
        .await
        .unwrap()
}

/// Returns the first job of a plan: port, day, firm.
pub(crate) fn first_job(plan: &Value) -> (&str, &str, &str) {
    let job = &plan["jobs"][0];
    let text = |field: &str| job[field].as_str().unwrap();
    (text("port"), text("day"), text("firm_name"))
}

pub(crate) fn compass_of(vessel: &Value) -> String {
    vessel["compasses"][0]["id"].as_str().unwrap().to_owned()
}
