//! Work orders from the plan: offered, agreed, and moved for cause.

use super::agreed_job::AgreedJob;
use super::{compass_of, due_vessel, enter_port_call, first_job, put, solve, terms};
use binnacle_server_testing::on_both;
use binnacle_server_testing::{Person, TestServer};
use serde_json::{Value, json};

on_both!(
    an_agreed_job_stays_in_the_plan,
    an_eta_moved_past_the_due_date_raises_an_alert_and_a_new_plan,
    a_declining_firm_is_not_planned_again,
    a_firm_not_authorised_for_the_vessel_gets_no_order,
    an_order_at_a_port_with_known_port_calls_needs_one_of_them,
    a_refusal_stands_after_its_order_is_cancelled,
    a_cancelled_order_does_not_block_a_new_one,
    an_offer_names_its_plan_version,
    a_job_of_several_compasses_is_offered_whole,
    an_agreed_job_without_a_place_names_its_order,
);

/// Creates a firm with terms, and its adjuster.
pub(super) async fn firm(server: &TestServer, person: &Person, name: &str) -> (String, Person) {
    let (id, adjuster) = person.adjuster(server, name).await;
    let path = format!("/firms/{id}/terms");
    put(person, &path, &terms()).await.good();
    (id.to_string(), adjuster)
}

pub(super) fn offer_of(plan: &Value, vessel: &Value) -> Value {
    json!({ "version": plan["version"], "compass_id": compass_of(vessel) })
}

/// Offers the vessel's job of the plan; returns the order's path.
pub(super) async fn offer(person: &Person, plan: &Value, vessel: &Value) -> String {
    let offered = person
        .post("/schedule/offer", &offer_of(plan, vessel))
        .await;
    assert_eq!(offered.status, 201, "{offered:?}");
    let order = offered.json()["orders"][0]["order_id"].clone();
    format!("/work-orders/{}", order.as_str().unwrap())
}

pub(super) fn order_for_firm(vessel: &Value, port: &str, planned_at: &str, firm: &str) -> Value {
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

async fn an_agreed_job_stays_in_the_plan(server: TestServer) {
    let ada = server.admin("ada").await;
    let nao = due_vessel(&ada, "Nao").await;
    enter_port_call(&ada, &nao, "BEANR", 8).await;
    let (firm_id, rosa) = firm(&server, &ada, "rosa").await;
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
    let repeated = ada.post("/schedule/offer", &offer_of(&plan, &nao)).await;
    assert_eq!(repeated.problem(), "wrong-state");
    rosa.post(&format!("{order}/accept"), &json!({}))
        .await
        .good();
    // A better port call appears, and the job stays as agreed.
    enter_port_call(&ada, &nao, "NLRTM", 15).await;
    let plan = solve(&ada).await;
    assert_eq!(plan["jobs"][0]["state"], "confirmed");
    assert_eq!(plan["jobs"][0]["port"], "BEANR");
    assert_eq!(plan["changes"][0]["what"], "kept");
    assert_eq!(alerts(&ada).await, [] as [Value; 0]);
    server.finish().await;
}

async fn an_eta_moved_past_the_due_date_raises_an_alert_and_a_new_plan(server: TestServer) {
    let agreed = AgreedJob::new(&server).await;
    let AgreedJob {
        ada, nao, order, ..
    } = &agreed;
    solve(ada).await;
    // Due on the twentieth, and the vessel now arrives on the twenty-second.
    agreed
        .move_port_call("2026-12-22T06:00:00Z", "2026-12-23T18:00:00Z")
        .await;
    enter_port_call(ada, nao, "BEANR", 17).await;
    let plan = solve(ada).await;
    assert_eq!(first_job(&plan), ("BEANR", "2026-12-18", "rosa"));
    let job = &plan["jobs"][0];
    let id = order.rsplit('/').next().unwrap();
    assert_eq!(
        (&job["orders"], &job["instead_of"]),
        (&json!([]), &json!([id]))
    );
    let raised = alerts(ada).await;
    let summary = raised[0]["summary"].as_str().unwrap();
    assert!(
        summary.contains("agreed with rosa for 2026-12-15"),
        "{summary}"
    );
    assert!(summary.contains("not long enough"), "{summary}");
    // Two orders for one compass would book it twice.
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
    server.finish().await;
}

async fn a_declining_firm_is_not_planned_again(server: TestServer) {
    let ada = server.admin("ada").await;
    let nao = due_vessel(&ada, "Nao").await;
    enter_port_call(&ada, &nao, "NLRTM", 14).await;
    let (_, rosa) = firm(&server, &ada, "rosa").await;
    let plan = solve(&ada).await;
    let order = offer(&ada, &plan, &nao).await;
    // A firm does not see a declined order.
    let declined = rosa.post(&format!("{order}/decline"), &json!({})).await;
    assert!(declined.status < 300, "{declined:?}");
    let plan = solve(&ada).await;
    assert_eq!(plan["jobs"], json!([]));
    let because = plan["unscheduled"][0]["because"].to_string();
    assert!(because.contains("rosa declined"), "{because}");
    firm(&server, &ada, "juan").await;
    let plan = solve(&ada).await;
    assert_eq!(first_job(&plan).2, "juan");
    let id = order.rsplit('/').next().unwrap();
    assert_eq!(plan["jobs"][0]["instead_of"], json!([id]));
    // It is offered to the next firm as planned, and the old order is cancelled.
    let next = offer(&ada, &plan, &nao).await;
    assert_eq!(ada.get(&order).await.good()["state"], "cancelled");
    assert_eq!(
        ada.get(&next).await.good()["offers"][0]["firm_name"],
        "juan"
    );
    server.finish().await;
}

/// Makes Rosa the cheaper firm.
async fn a_refusal_stands_after_its_order_is_cancelled(server: TestServer) {
    let ada = server.admin("ada").await;
    let nao = due_vessel(&ada, "Nao").await;
    enter_port_call(&ada, &nao, "NLRTM", 14).await;
    let (juans, _) = firm(&server, &ada, "juan").await;
    let mut dearer = terms();
    dearer["fee_eur"] = json!(4000);
    put(&ada, &format!("/firms/{juans}/terms"), &dearer)
        .await
        .good();
    let (rosas, rosa) = firm(&server, &ada, "rosa").await;
    let plan = solve(&ada).await;
    assert_eq!(first_job(&plan).2, "rosa");
    let order = offer(&ada, &plan, &nao).await;
    rosa.post(&format!("{order}/decline"), &json!({})).await;
    let why = json!({ "text": "declined" });
    ada.post(&format!("{order}/cancel"), &why).await.good();
    let plan = solve(&ada).await;
    assert_eq!(first_job(&plan), ("NLRTM", "2026-12-15", "juan"));
    assert_eq!(plan["jobs"][0]["instead_of"], json!([]));
    // Unless the firm gets a new offer.
    let anew = order_for_firm(&nao, "NLRTM", "2026-12-15T09:00:00Z", &rosas);
    let anew = ada.post("/work-orders", &anew).await.good();
    let anew = format!("/work-orders/{}", anew["id"].as_str().unwrap());
    rosa.post(&format!("{anew}/accept"), &json!({}))
        .await
        .good();
    let plan = solve(&ada).await;
    assert_eq!(first_job(&plan), ("NLRTM", "2026-12-15", "rosa"));
    assert_eq!(plan["jobs"][0]["state"], "confirmed");
    assert_eq!(alerts(&ada).await, [] as [Value; 0]);
    server.finish().await;
}

/// Offers from a plan that still has the job of a cancelled order.
async fn a_cancelled_order_does_not_block_a_new_one(server: TestServer) {
    let ada = server.admin("ada").await;
    let nao = due_vessel(&ada, "Nao").await;
    enter_port_call(&ada, &nao, "NLRTM", 14).await;
    let (_, rosa) = firm(&server, &ada, "rosa").await;
    let plan = solve(&ada).await;
    let order = offer(&ada, &plan, &nao).await;
    rosa.post(&format!("{order}/decline"), &json!({})).await;
    firm(&server, &ada, "juan").await;
    let plan = solve(&ada).await;
    let why = json!({ "text": "declined" });
    ada.post(&format!("{order}/cancel"), &why).await.good();
    offer(&ada, &plan, &nao).await;
    server.finish().await;
}

async fn an_offer_names_its_plan_version(server: TestServer) {
    let ada = server.admin("ada").await;
    let eve = server.admin("eve").await;
    let nao = due_vessel(&ada, "Nao").await;
    firm(&server, &ada, "rosa").await;
    let wrong = json!({ "version": 1, "compass_id": compass_of(&nao) });
    let none = ada.post("/schedule/offer", &wrong).await;
    assert_eq!(none.problem(), "not-found");
    let plan = solve(&ada).await;
    let unplanned = ada.post("/schedule/offer", &offer_of(&plan, &nao)).await;
    assert_eq!(unplanned.problem(), "not-found");
    enter_port_call(&ada, &nao, "NLRTM", 14).await;
    solve(&ada).await;
    let old = ada.post("/schedule/offer", &offer_of(&plan, &nao)).await;
    assert!(
        old.text.contains("the current plan has version 2"),
        "{old:?}"
    );
    let theirs = eve.post("/schedule/offer", &offer_of(&plan, &nao)).await;
    assert_eq!(theirs.problem(), "not-found");
    let viewer = ada.viewer(&server).await;
    let seen = viewer.post("/schedule/offer", &offer_of(&plan, &nao)).await;
    assert_eq!(seen.problem(), "forbidden");
    server.finish().await;
}

async fn orders(person: &Person) -> usize {
    let list = person.get("/work-orders").await.good();
    list["items"].as_array().unwrap().len()
}

async fn a_job_of_several_compasses_is_offered_whole(server: TestServer) {
    let ada = server.admin("ada").await;
    let nao = due_vessel(&ada, "Nao").await;
    let path = format!("/vessels/{}/compasses", nao["id"].as_str().unwrap());
    let second = json!({ "name": "Steering", "role": "steering" });
    let second = ada.post(&path, &second).await.good();
    enter_port_call(&ada, &nao, "NLRTM", 14).await;
    firm(&server, &ada, "rosa").await;
    let plan = solve(&ada).await;
    assert_eq!(plan["jobs"][0]["compasses"].as_array().unwrap().len(), 2);
    // The job's last compass gets an order meanwhile.
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
    server.finish().await;
}

async fn an_agreed_job_without_a_place_names_its_order(server: TestServer) {
    let agreed = AgreedJob::new(&server).await;
    let AgreedJob { ada, order, .. } = &agreed;
    solve(ada).await;
    // An hour alongside is not enough for any firm.
    agreed
        .move_port_call("2026-12-22T09:00:00Z", "2026-12-22T10:00:00Z")
        .await;
    let plan = solve(ada).await;
    assert_eq!(plan["jobs"], json!([]));
    let id = order.rsplit('/').next().unwrap();
    assert_eq!(plan["unscheduled"][0]["orders"], json!([id]));
    assert_eq!(alerts(ada).await.len(), 1);
    server.finish().await;
}

async fn a_firm_not_authorised_for_the_vessel_gets_no_order(server: TestServer) {
    let ada = server.admin("ada").await;
    let nao = due_vessel(&ada, "Nao").await;
    let (firm_id, _) = firm(&server, &ada, "rosa").await;
    let ask = async || {
        let order = order_for_firm(&nao, "Rotterdam (NLRTM)", "2026-12-15T08:00:00Z", &firm_id);
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
    let requirements = json!({ "flag_state": "NO", "licence": "NO-7" });
    put(&ada, &particulars, &requirements).await.good();
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
    server.finish().await;
}

async fn an_order_at_a_port_with_known_port_calls_needs_one_of_them(server: TestServer) {
    let ada = server.admin("ada").await;
    let nao = due_vessel(&ada, "Nao").await;
    enter_port_call(&ada, &nao, "NLRTM", 14).await;
    let (firm_id, rosa) = firm(&server, &ada, "rosa").await;
    let order = |at: &str| order_for_firm(&nao, "NLRTM", at, &firm_id);
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
    // A day on which the vessel is away cannot be proposed either.
    let later = json!({ "terms": { "planned_at": "2026-12-18T08:00:00Z" } });
    let other = rosa.post(&format!("{order}/propose"), &later).await;
    assert_eq!(other.problem(), "invalid");
    let earlier = json!({ "terms": { "planned_at": "2026-12-14T08:00:00Z" } });
    rosa.post(&format!("{order}/propose"), &earlier)
        .await
        .good();
    server.finish().await;
}
