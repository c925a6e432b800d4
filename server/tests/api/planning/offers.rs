//! From the plan to work orders, and back: offered, agreed, and moved for cause.

use super::{compass_of, due_vessel, enter, first, put, solve, terms};
use crate::logbook::patch;
use crate::on_both;
use crate::port_calls;
use crate::support::{Answer, Person, Shore};
use serde_json::{Value, json};

on_both!(
    a_planned_job_is_offered_and_agreed_and_stays_in_the_plan,
    an_eta_moved_past_the_due_date_is_told_and_planned_anew,
    a_firm_that_said_no_is_not_planned_again,
    no_firm_is_offered_more_ships_than_it_has_teams,
    an_offer_is_of_the_plan_that_was_looked_at,
);

/// A firm with terms, and its adjuster.
pub(super) async fn firm(shore: &Shore, person: &Person, name: &str) -> (String, Person) {
    let (id, adjuster) = person.adjuster(shore, name).await;
    let path = format!("/firms/{id}/terms");
    put(person, &path, &terms()).await.good();
    (id.to_string(), adjuster)
}

fn offer_of(plan: &Value, vessel: &Value) -> Value {
    json!({ "version": plan["version"], "compass_id": compass_of(vessel) })
}

/// Offers the vessel's job of the plan; the order's path.
pub(super) async fn offer(person: &Person, plan: &Value, vessel: &Value) -> String {
    let offered = person
        .post("/schedule/offer", &offer_of(plan, vessel))
        .await;
    assert_eq!(offered.status, 201, "{offered:?}");
    let order = offered.json()["orders"][0]["order_id"].clone();
    format!("/work-orders/{}", order.as_str().unwrap())
}

pub(super) async fn alerts(person: &Person) -> Vec<Value> {
    let list = person.get("/alerts?open=true").await.good();
    let all = list["items"].as_array().unwrap().iter();
    all.filter(|alert| alert["cause"] == "agreed_job_at_risk")
        .cloned()
        .collect()
}

async fn a_planned_job_is_offered_and_agreed_and_stays_in_the_plan(shore: Shore) {
    let ada = shore.admin("ada").await;
    let nao = due_vessel(&ada, "Nao").await;
    enter(&ada, &nao, "BEANR", 8).await;
    let (firm_id, rosa) = firm(&shore, &ada, "rosa").await;
    let plan = solve(&ada).await;
    let order = offer(&ada, &plan, &nao).await;
    let seen = ada.get(&order).await.good();
    assert_eq!(seen["state"], "offered");
    assert_eq!(seen["port"], "Antwerpen (BEANR)");
    assert_eq!(seen["offers"][0]["firm_id"], firm_id.as_str());
    assert_eq!(seen["planned_at"], plan["jobs"][0]["from"]);
    let plan = solve(&ada).await;
    assert_eq!(plan["jobs"][0]["state"], "offered");
    assert_eq!(plan["jobs"][0]["orders"][0], seen["id"]);
    let again = ada.post("/schedule/offer", &offer_of(&plan, &nao)).await;
    assert_eq!(again.problem(), "wrong-state");
    rosa.post(&format!("{order}/accept"), &json!({}))
        .await
        .good();
    // A better call comes, and the job stays where it was agreed.
    enter(&ada, &nao, "NLRTM", 15).await;
    let plan = solve(&ada).await;
    assert_eq!(plan["jobs"][0]["state"], "confirmed");
    assert_eq!(plan["jobs"][0]["port"], "BEANR");
    assert_eq!(plan["changes"][0]["what"], "kept");
    assert_eq!(alerts(&ada).await, [] as [Value; 0]);
    shore.finish().await;
}

async fn an_eta_moved_past_the_due_date_is_told_and_planned_anew(shore: Shore) {
    let ada = shore.admin("ada").await;
    let nao = due_vessel(&ada, "Nao").await;
    let call = enter(&ada, &nao, "NLRTM", 14).await;
    let (_, rosa) = firm(&shore, &ada, "rosa").await;
    let plan = solve(&ada).await;
    let order = offer(&ada, &plan, &nao).await;
    rosa.post(&format!("{order}/accept"), &json!({}))
        .await
        .good();
    solve(&ada).await;
    // Due on the twentieth, and now she comes on the twenty-second.
    let one = format!(
        "{}/{}",
        port_calls::path(&nao),
        call["id"].as_str().unwrap()
    );
    let late = json!({ "eta": "2026-12-22T06:00:00Z", "etd": "2026-12-23T18:00:00Z" });
    patch(&ada, &one, &late).await.good();
    enter(&ada, &nao, "BEANR", 17).await;
    let plan = solve(&ada).await;
    assert_eq!(first(&plan), ("BEANR", "2026-12-18", "rosa"));
    let job = &plan["jobs"][0];
    let id = order.rsplit('/').next().unwrap();
    assert_eq!(
        (&job["orders"], &job["instead_of"]),
        (&json!([]), &json!([id]))
    );
    let told = alerts(&ada).await;
    let summary = told[0]["summary"].as_str().unwrap();
    assert!(
        summary.contains("agreed with rosa for 2026-12-15"),
        "{summary}"
    );
    assert!(summary.contains("not long enough"), "{summary}");
    // Two orders of one compass would book her twice.
    let twice = ada.post("/schedule/offer", &offer_of(&plan, &nao)).await;
    assert_eq!(twice.problem(), "wrong-state");
    assert!(twice.text.contains(id), "{twice:?}");
    let cancelled = json!({ "text": "she is late" });
    ada.post(&format!("{order}/cancel"), &cancelled)
        .await
        .good();
    let plan = solve(&ada).await;
    assert_eq!(alerts(&ada).await, [] as [Value; 0]);
    offer(&ada, &plan, &nao).await;
    shore.finish().await;
}

async fn a_firm_that_said_no_is_not_planned_again(shore: Shore) {
    let ada = shore.admin("ada").await;
    let nao = due_vessel(&ada, "Nao").await;
    enter(&ada, &nao, "NLRTM", 14).await;
    let (_, rosa) = firm(&shore, &ada, "rosa").await;
    let plan = solve(&ada).await;
    let order = offer(&ada, &plan, &nao).await;
    // What a firm has declined it sees no more.
    let declined = rosa.post(&format!("{order}/decline"), &json!({})).await;
    assert!(declined.status < 300, "{declined:?}");
    let plan = solve(&ada).await;
    assert_eq!(plan["jobs"], json!([]));
    let because = plan["unscheduled"][0]["because"].to_string();
    assert!(because.contains("rosa declined"), "{because}");
    firm(&shore, &ada, "juan").await;
    let plan = solve(&ada).await;
    assert_eq!(first(&plan).2, "juan");
    let id = order.rsplit('/').next().unwrap();
    assert_eq!(plan["jobs"][0]["instead_of"], json!([id]));
    shore.finish().await;
}

async fn no_firm_is_offered_more_ships_than_it_has_teams(shore: Shore) {
    let ada = shore.admin("ada").await;
    let (nao, pinta) = (
        due_vessel(&ada, "Nao").await,
        due_vessel(&ada, "Pinta").await,
    );
    for vessel in [&nao, &pinta] {
        enter(&ada, vessel, "NLRTM", 14).await;
    }
    let (firm_id, _) = firm(&shore, &ada, "rosa").await;
    let mut two = terms();
    two["teams"] = json!(2);
    let path = format!("/firms/{firm_id}/terms");
    put(&ada, &path, &two).await.good();
    let plan = solve(&ada).await;
    let days: Vec<&Value> = plan["jobs"]
        .as_array()
        .unwrap()
        .iter()
        .map(|job| &job["day"])
        .collect();
    assert_eq!(days, ["2026-12-15", "2026-12-15"]);
    // One of the teams is lost while both are offered at once.
    put(&ada, &path, &terms()).await.good();
    let (one, other) = (offer_of(&plan, &nao), offer_of(&plan, &pinta));
    let (one, other): (Answer, Answer) = tokio::join!(
        ada.post("/schedule/offer", &one),
        ada.post("/schedule/offer", &other)
    );
    let mut statuses = [one.status, other.status];
    statuses.sort_unstable();
    assert_eq!(statuses, [201, 409], "{one:?} {other:?}");
    shore.finish().await;
}

async fn an_offer_is_of_the_plan_that_was_looked_at(shore: Shore) {
    let ada = shore.admin("ada").await;
    let eve = shore.admin("eve").await;
    let nao = due_vessel(&ada, "Nao").await;
    firm(&shore, &ada, "rosa").await;
    let wrong = json!({ "version": 1, "compass_id": compass_of(&nao) });
    let none = ada.post("/schedule/offer", &wrong).await;
    assert_eq!(none.problem(), "not-found");
    let plan = solve(&ada).await;
    let unplanned = ada.post("/schedule/offer", &offer_of(&plan, &nao)).await;
    assert_eq!(unplanned.problem(), "not-found");
    enter(&ada, &nao, "NLRTM", 14).await;
    solve(&ada).await;
    let old = ada.post("/schedule/offer", &offer_of(&plan, &nao)).await;
    assert!(old.text.contains("the plan is of version 2 now"), "{old:?}");
    let theirs = eve.post("/schedule/offer", &offer_of(&plan, &nao)).await;
    assert_eq!(theirs.problem(), "not-found");
    let viewer = ada.viewer(&shore).await;
    let seen = viewer.post("/schedule/offer", &offer_of(&plan, &nao)).await;
    assert_eq!(seen.problem(), "forbidden");
    shore.finish().await;
}
