//! Fees of a job: offered from the schedule, proposed by the firm, agreed.

use super::offers::{firm, offer};
use super::{due_vessel, enter_port_call, put, solve, terms};
use binnacle_server_testing::on_both;
use binnacle_server_testing::patch;
use binnacle_server_testing::port_calls;
use binnacle_server_testing::webhooks::{Receiver, deliver, make};
use binnacle_server_testing::{Person, TestServer};
use serde_json::{Value, json};

on_both!(
    an_offer_has_the_fee_of_the_schedule,
    a_firm_proposes_another_fee_alone_and_the_operator_agrees,
    a_declined_fee_does_not_change_the_next_firms_fee,
    a_fee_alone_does_not_settle_the_moved_port_call,
    responding_for_another_firm_is_refused,
);

/// Offers a ship's job to one firm of two; returns the order's path.
async fn offered_job(server: &TestServer) -> (Person, Value, Person, String) {
    let ada = server.admin("ada").await;
    let nao = due_vessel(&ada, "Nao").await;
    enter_port_call(&ada, &nao, "NLRTM", 14).await;
    let (_, rosa) = firm(server, &ada, "rosa").await;
    let plan = solve(&ada).await;
    let order = offer(&ada, &plan, &nao).await;
    (ada, nao, rosa, order)
}

async fn propose(who: &Person, order: &str, terms: &Value) -> Value {
    let path = format!("{order}/propose");
    who.post(&path, &json!({ "terms": terms })).await.good()
}

async fn accept(who: &Person, order: &str) -> Value {
    who.post(&format!("{order}/accept"), &json!({}))
        .await
        .good()
}

async fn an_offer_has_the_fee_of_the_schedule(server: TestServer) {
    let ada = server.admin("ada").await;
    let nao = due_vessel(&ada, "Nao").await;
    let path = format!("/vessels/{}/compasses", nao["id"].as_str().unwrap());
    let second = json!({ "name": "Steering", "role": "steering" });
    ada.post(&path, &second).await.good();
    enter_port_call(&ada, &nao, "NLRTM", 14).await;
    let (id, rosa) = firm(&server, &ada, "rosa").await;
    let mut dearer = terms();
    dearer["extra_compass_eur"] = json!(400.5);
    put(&ada, &format!("/firms/{id}/terms"), &dearer)
        .await
        .good();
    let plan = solve(&ada).await;
    let job = &plan["jobs"][0];
    assert_eq!(job["fee_eur"], 2200.5, "{job}");
    let new = json!({ "version": plan["version"],
                      "compass_id": job["compasses"][0]["compass_id"] });
    let offered = ada.post("/schedule/offer", &new).await.json();
    let mut fees = Vec::new();
    for order in offered["orders"].as_array().unwrap() {
        let path = format!("/work-orders/{}", order["order_id"].as_str().unwrap());
        let seen = rosa.get(&path).await.good();
        assert_eq!(seen["fee_eur"], Value::Null, "nothing is agreed on yet");
        fees.push(seen["offers"][0]["fee_eur"].as_f64().unwrap());
        // A firm that accepts gets this fee.
        let taken = accept(&rosa, &path).await;
        assert_eq!(taken["fee_eur"], seen["offers"][0]["fee_eur"]);
        let log = ada.get(&format!("{path}/entries")).await.good();
        let entry = log["items"].as_array().unwrap().last().unwrap();
        assert_eq!(entry["entry"]["kind"], "accepted");
        assert_eq!(entry["entry"]["content"]["fee_eur"], taken["fee_eur"]);
    }
    assert_eq!(fees, [1800.0, 400.5]);
    // An order offered by hand has the fee for one compass.
    let pinta = due_vessel(&ada, "Pinta").await;
    let by_hand = json!({ "vessel_id": pinta["id"], "compass_id": super::compass_of(&pinta),
                          "port": "BEANR", "planned_at": "2026-12-01T08:00:00Z",
                          "offer": { "firms": [id] } });
    let made = ada.post("/work-orders", &by_hand).await.good();
    assert_eq!(made["offers"][0]["fee_eur"], 1800.0, "{made}");
    server.finish().await;
}

async fn a_firm_proposes_another_fee_alone_and_the_operator_agrees(server: TestServer) {
    let (ada, _, rosa, order) = offered_job(&server).await;
    let (receiver, url) = Receiver::start().await;
    make(&ada, &url, &["order.answered"]).await;
    let before = ada.get(&order).await.good();
    let nothing = json!({ "terms": {}, "text": "Hm." });
    let refused = rosa.post(&format!("{order}/propose"), &nothing).await;
    assert_eq!(refused.problem(), "invalid");
    for fee in [-1.0, 1e7] {
        let wrong = json!({ "terms": { "fee_eur": fee } });
        let refused = rosa.post(&format!("{order}/propose"), &wrong).await;
        assert_eq!(refused.problem(), "invalid", "{fee}");
    }
    let proposed = propose(&rosa, &order, &json!({ "fee_eur": 2100 })).await;
    assert_eq!(proposed["state"], "proposed");
    let seen = ada.get(&order).await.good();
    assert_eq!(seen["offers"][0]["fee_eur"], 1800.0);
    let new_terms = json!({ "planned_at": before["planned_at"],
                            "planned_until": before["planned_until"], "fee_eur": 2100.0 });
    assert_eq!(seen["offers"][0]["terms"], new_terms);
    let notifications = ada.get("/notifications?kind=answered").await.good();
    assert!(
        notifications.to_string().contains("for 2100.00 euros"),
        "{notifications}"
    );
    let agreed = accept(&ada, &order).await;
    assert_eq!(agreed["state"], "accepted");
    for (field, is) in [
        ("fee_eur", &json!(2100.0)),
        ("planned_at", &before["planned_at"]),
        ("berth", &before["berth"]),
        ("firm", &json!("rosa")),
    ] {
        assert_eq!(&agreed[field], is, "{field}");
    }
    deliver(&server).await;
    let bodies: Vec<Value> = receiver
        .received()
        .iter()
        .map(|(_, body)| serde_json::from_str(body).unwrap())
        .collect();
    assert_eq!(bodies[0]["entry"]["terms"], new_terms);
    assert_eq!(bodies[1]["entry"]["kind"], "proposal_accepted");
    assert_eq!(bodies[1]["entry"]["terms"]["fee_eur"], 2100.0);
    server.finish().await;
}

async fn a_declined_fee_does_not_change_the_next_firms_fee(server: TestServer) {
    let ada = server.admin("ada").await;
    let nao = due_vessel(&ada, "Nao").await;
    enter_port_call(&ada, &nao, "NLRTM", 14).await;
    let (_, rosa) = firm(&server, &ada, "rosa").await;
    let (second, juan) = firm(&server, &ada, "juan").await;
    let mut dearer = terms();
    dearer["fee_eur"] = json!(1950);
    put(&ada, &format!("/firms/{second}/terms"), &dearer)
        .await
        .good();
    let plan = solve(&ada).await;
    let new = json!({ "version": plan["version"], "compass_id": super::compass_of(&nao),
                      "then": [second] });
    let offered = ada.post("/schedule/offer", &new).await.json();
    let order = format!(
        "/work-orders/{}",
        offered["orders"][0]["order_id"].as_str().unwrap()
    );
    propose(&rosa, &order, &json!({ "fee_eur": 2500 })).await;
    let no = ada.post(&format!("{order}/decline"), &json!({})).await;
    assert_eq!(no.status, 204, "{no:?}");
    let seen = juan.get(&order).await.good();
    assert_eq!(seen["offers"][0]["fee_eur"], 1950.0);
    assert!(!seen.to_string().contains("2500"), "{seen}");
    // A firm that proposes only another time keeps the offered fee.
    let later = json!({ "planned_at": "2026-12-15T10:00:00Z" });
    propose(&juan, &order, &later).await;
    let agreed = accept(&ada, &order).await;
    assert_eq!(agreed["fee_eur"], 1950.0);
    assert_eq!(agreed["planned_at"], "2026-12-15T10:00:00Z");
    server.finish().await;
}

async fn a_fee_alone_does_not_settle_the_moved_port_call(server: TestServer) {
    let (ada, nao, rosa, order) = offered_job(&server).await;
    let calls = ada.get(&port_calls::path(&nao)).await.good();
    let call = calls["items"][0]["id"].as_str().unwrap();
    let call = format!("{}/{call}", port_calls::path(&nao));
    let late = json!({ "eta": "2026-12-17T06:00:00Z", "etd": "2026-12-18T18:00:00Z" });
    patch(&ada, &call, &late).await.good();
    propose(&rosa, &order, &json!({ "fee_eur": 2100 })).await;
    let agreed = accept(&ada, &order).await;
    assert_eq!(
        agreed["call_fit"], "needs_new_day",
        "nobody agreed on another day"
    );
    assert_eq!(agreed["fee_eur"], 2100.0);
    // Another time does not change the fee.
    let later = json!({ "terms": { "planned_at": "2026-12-17T08:00:00Z" } });
    ada.post(&format!("{order}/retime"), &later).await.good();
    let moved = accept(&rosa, &format!("{order}/retime")).await;
    assert_eq!(moved["call_fit"], Value::Null);
    assert_eq!(moved["fee_eur"], 2100.0);
    server.finish().await;
}

async fn responding_for_another_firm_is_refused(server: TestServer) {
    let (ada, _, rosa, order) = offered_job(&server).await;
    let (other, _) = firm(&server, &ada, "juan").await;
    let theirs = json!({ "firm_id": other });
    let message = json!({ "firm_id": other, "text": "Hello." });
    let bodies = [
        ("accept", &theirs),
        ("decline", &theirs),
        ("messages", &message),
    ];
    for (rest, body) in bodies {
        let refused = rosa.post(&format!("{order}/{rest}"), body).await;
        assert_eq!(refused.problem(), "invalid", "{rest}");
        assert!(refused.text.contains("is not your firm"), "{refused:?}");
    }
    assert_eq!(ada.get(&order).await.good()["state"], "offered");
    accept(&rosa, &order).await;
    let later = json!({ "terms": { "planned_at": "2026-12-15T10:00:00Z" } });
    ada.post(&format!("{order}/retime"), &later).await.good();
    for (who, rest) in [
        (&rosa, "retime/accept"),
        (&rosa, "retime/decline"),
        (&ada, "retime/decline"),
    ] {
        let refused = who.post(&format!("{order}/{rest}"), &theirs).await;
        assert_eq!(refused.problem(), "invalid", "{rest}");
    }
    server.finish().await;
}
