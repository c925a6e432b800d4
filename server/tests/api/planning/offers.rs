//! From the plan to work orders, and back: offered, agreed, and moved for cause.

use super::agreed::Agreed;
use super::{compass_of, due_vessel, enter, first, put, solve, terms};
use crate::on_both;
use crate::support::{Person, Shore};
use serde_json::{Value, json};

on_both!(
    a_planned_job_is_offered_and_agreed_and_stays_in_the_plan,
    an_eta_moved_past_the_due_date_is_told_and_planned_anew,
    a_firm_that_said_no_is_not_planned_again,
    no_firm_is_asked_that_may_not_adjust_her,
    an_order_is_for_a_call_where_calls_at_its_port_are_known,
    a_no_holds_when_its_order_is_cancelled,
    an_order_that_is_cancelled_is_in_nobodys_way,
    an_offer_is_of_the_plan_that_was_looked_at,
    a_job_is_offered_whole_or_not_at_all,
    an_agreed_job_that_fits_nowhere_names_its_order,
);

/// A firm with terms, and its adjuster.
pub(super) async fn firm(shore: &Shore, person: &Person, name: &str) -> (String, Person) {
    let (id, adjuster) = person.adjuster(shore, name).await;
    let path = format!("/firms/{id}/terms");
    put(person, &path, &terms()).await.good();
    (id.to_string(), adjuster)
}

pub(super) fn offer_of(plan: &Value, vessel: &Value) -> Value {
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

pub(super) fn direct(vessel: &Value, port: &str, planned_at: &str, firm: &str) -> Value {
    json!({ "vessel_id": vessel["id"], "compass_id": compass_of(vessel), "port": port,
            "planned_at": planned_at, "offer": { "firms": [firm] } })
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
    let agreed = Agreed::new(&shore).await;
    let Agreed {
        ada, nao, order, ..
    } = &agreed;
    solve(ada).await;
    // Due on the twentieth, and now she comes on the twenty-second.
    agreed
        .moves("2026-12-22T06:00:00Z", "2026-12-23T18:00:00Z")
        .await;
    enter(ada, nao, "BEANR", 17).await;
    let plan = solve(ada).await;
    assert_eq!(first(&plan), ("BEANR", "2026-12-18", "rosa"));
    let job = &plan["jobs"][0];
    let id = order.rsplit('/').next().unwrap();
    assert_eq!(
        (&job["orders"], &job["instead_of"]),
        (&json!([]), &json!([id]))
    );
    let told = alerts(ada).await;
    let summary = told[0]["summary"].as_str().unwrap();
    assert!(
        summary.contains("agreed with rosa for 2026-12-15"),
        "{summary}"
    );
    assert!(summary.contains("not long enough"), "{summary}");
    // Two orders of one compass would book her twice.
    let twice = ada.post("/schedule/offer", &offer_of(&plan, nao)).await;
    assert_eq!(twice.problem(), "wrong-state");
    assert!(twice.text.contains(id), "{twice:?}");
    let cancelled = json!({ "text": "she is late" });
    ada.post(&format!("{order}/cancel"), &cancelled)
        .await
        .good();
    let plan = solve(ada).await;
    assert_eq!(alerts(ada).await, [] as [Value; 0]);
    offer(ada, &plan, nao).await;
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
    // It is offered to the next one as it is planned, and the old order is no more.
    let next = offer(&ada, &plan, &nao).await;
    assert_eq!(ada.get(&order).await.good()["state"], "cancelled");
    assert_eq!(
        ada.get(&next).await.good()["offers"][0]["firm_name"],
        "juan"
    );
    shore.finish().await;
}

/// Rosa is the cheaper one.
async fn a_no_holds_when_its_order_is_cancelled(shore: Shore) {
    let ada = shore.admin("ada").await;
    let nao = due_vessel(&ada, "Nao").await;
    enter(&ada, &nao, "NLRTM", 14).await;
    let (juans, _) = firm(&shore, &ada, "juan").await;
    let mut dearer = terms();
    dearer["fee_eur"] = json!(4000);
    put(&ada, &format!("/firms/{juans}/terms"), &dearer)
        .await
        .good();
    let (rosas, rosa) = firm(&shore, &ada, "rosa").await;
    let plan = solve(&ada).await;
    assert_eq!(first(&plan).2, "rosa");
    let order = offer(&ada, &plan, &nao).await;
    rosa.post(&format!("{order}/decline"), &json!({})).await;
    let why = json!({ "text": "declined" });
    ada.post(&format!("{order}/cancel"), &why).await.good();
    let plan = solve(&ada).await;
    assert_eq!(first(&plan), ("NLRTM", "2026-12-15", "juan"));
    assert_eq!(plan["jobs"][0]["instead_of"], json!([]));
    // Unless she is asked anew.
    let anew = direct(&nao, "NLRTM", "2026-12-15T09:00:00Z", &rosas);
    let anew = ada.post("/work-orders", &anew).await.good();
    let anew = format!("/work-orders/{}", anew["id"].as_str().unwrap());
    rosa.post(&format!("{anew}/accept"), &json!({}))
        .await
        .good();
    let plan = solve(&ada).await;
    assert_eq!(first(&plan), ("NLRTM", "2026-12-15", "rosa"));
    assert_eq!(plan["jobs"][0]["state"], "confirmed");
    assert_eq!(alerts(&ada).await, [] as [Value; 0]);
    shore.finish().await;
}

/// The plan that was looked at still has the job in the place of an order that is cancelled.
async fn an_order_that_is_cancelled_is_in_nobodys_way(shore: Shore) {
    let ada = shore.admin("ada").await;
    let nao = due_vessel(&ada, "Nao").await;
    enter(&ada, &nao, "NLRTM", 14).await;
    let (_, rosa) = firm(&shore, &ada, "rosa").await;
    let plan = solve(&ada).await;
    let order = offer(&ada, &plan, &nao).await;
    rosa.post(&format!("{order}/decline"), &json!({})).await;
    firm(&shore, &ada, "juan").await;
    let plan = solve(&ada).await;
    let why = json!({ "text": "declined" });
    ada.post(&format!("{order}/cancel"), &why).await.good();
    offer(&ada, &plan, &nao).await;
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

async fn orders(person: &Person) -> usize {
    let list = person.get("/work-orders").await.good();
    list["items"].as_array().unwrap().len()
}

async fn a_job_is_offered_whole_or_not_at_all(shore: Shore) {
    let ada = shore.admin("ada").await;
    let nao = due_vessel(&ada, "Nao").await;
    let path = format!("/vessels/{}/compasses", nao["id"].as_str().unwrap());
    let second = json!({ "name": "Steering", "role": "steering" });
    let second = ada.post(&path, &second).await.good();
    enter(&ada, &nao, "NLRTM", 14).await;
    firm(&shore, &ada, "rosa").await;
    let plan = solve(&ada).await;
    assert_eq!(plan["jobs"][0]["compasses"].as_array().unwrap().len(), 2);
    // The job's last compass is ordered meanwhile.
    let other = &plan["jobs"][0]["compasses"][1]["compass_id"];
    assert!(*other == second["id"] || *other == compass_of(&nao).as_str());
    let order = json!({ "vessel_id": nao["id"], "compass_id": other, "port": "NLRTM",
                        "planned_at": "2026-12-15T10:00:00Z" });
    ada.post("/work-orders", &order).await.good();
    let offer = json!({ "version": plan["version"],
                        "compass_id": plan["jobs"][0]["compasses"][0]["compass_id"] });
    let refused = ada.post("/schedule/offer", &offer).await;
    assert_eq!(refused.problem(), "wrong-state");
    assert_eq!(orders(&ada).await, 1);
    shore.finish().await;
}

async fn an_agreed_job_that_fits_nowhere_names_its_order(shore: Shore) {
    let agreed = Agreed::new(&shore).await;
    let Agreed { ada, order, .. } = &agreed;
    solve(ada).await;
    // An hour alongside is not enough for anybody.
    agreed
        .moves("2026-12-22T09:00:00Z", "2026-12-22T10:00:00Z")
        .await;
    let plan = solve(ada).await;
    assert_eq!(plan["jobs"], json!([]));
    let id = order.rsplit('/').next().unwrap();
    assert_eq!(plan["unscheduled"][0]["orders"], json!([id]));
    assert_eq!(alerts(ada).await.len(), 1);
    shore.finish().await;
}

async fn no_firm_is_asked_that_may_not_adjust_her(shore: Shore) {
    let ada = shore.admin("ada").await;
    let nao = due_vessel(&ada, "Nao").await;
    let (firm_id, _) = firm(&shore, &ada, "rosa").await;
    let ask = async || {
        let order = direct(&nao, "Rotterdam (NLRTM)", "2026-12-15T08:00:00Z", &firm_id);
        ada.post("/work-orders", &order).await
    };
    let firms = format!("/firms/{firm_id}/terms");
    let mut some = terms();
    some["flags"] = json!(["PA"]);
    put(&ada, &firms, &some).await.good();
    let refused = ask().await;
    assert_eq!(refused.problem(), "wrong-state");
    assert!(
        refused.text.contains("rosa is not accepted by flag NO"),
        "{refused:?}"
    );
    some["flags"] = json!(["PA", "NO"]);
    put(&ada, &firms, &some).await.good();
    let particulars = format!("/vessels/{}/particulars", nao["id"].as_str().unwrap());
    let asked = json!({ "flag_state": "NO", "licence": "NO-7" });
    put(&ada, &particulars, &asked).await.good();
    let refused = ask().await;
    assert!(
        refused
            .text
            .contains("does not hold the licence that the vessel requires, NO-7"),
        "{refused:?}"
    );
    some["licences"] = json!(["NO-7"]);
    put(&ada, &firms, &some).await.good();
    ask().await.good();
    shore.finish().await;
}

async fn an_order_is_for_a_call_where_calls_at_its_port_are_known(shore: Shore) {
    let ada = shore.admin("ada").await;
    let nao = due_vessel(&ada, "Nao").await;
    enter(&ada, &nao, "NLRTM", 14).await;
    let (firm_id, rosa) = firm(&shore, &ada, "rosa").await;
    let order = |at: &str| direct(&nao, "NLRTM", at, &firm_id);
    let other = ada
        .post("/work-orders", &order("2026-12-18T08:00:00Z"))
        .await;
    assert_eq!(other.problem(), "invalid");
    let said = "the vessel is at Rotterdam (NLRTM) from 2026-12-14 06:00 UTC";
    assert!(other.text.contains(said), "{other:?}");
    let made = ada
        .post("/work-orders", &order("2026-12-15T08:00:00Z"))
        .await
        .good();
    let order = format!("/work-orders/{}", made["id"].as_str().unwrap());
    // Nor is another day proposed on which she is not there.
    let later = json!({ "terms": { "planned_at": "2026-12-18T08:00:00Z" } });
    let other = rosa.post(&format!("{order}/propose"), &later).await;
    assert_eq!(other.problem(), "invalid");
    let earlier = json!({ "terms": { "planned_at": "2026-12-14T08:00:00Z" } });
    rosa.post(&format!("{order}/propose"), &earlier)
        .await
        .good();
    shore.finish().await;
}
