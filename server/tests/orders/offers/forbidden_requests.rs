//! Requests that an order's state forbids, for the operator and for the firm.

use binnacle_server_testing::offers::{OfferParties, proposal};
use binnacle_server_testing::on_both;
use binnacle_server_testing::{ApiResponse, Person, TestServer};
use reqwest::Method;
use serde_json::{Value, json};

on_both!(
    a_request_forbidden_in_a_state_is_refused_and_writes_nothing,
    a_firm_cannot_act_for_the_operator,
    a_read_token_cannot_respond_to_an_offer,
);

const STATES: [&str; 7] = [
    "planned",
    "offered",
    "proposed",
    "declined",
    "accepted",
    "on_board",
    "cancelled",
];

/// Allowed requests of each side by state; everything else is refused. Requests at the
/// berth have tests of their own.
const OPERATOR: [(&str, &[&str]); 9] = [
    ("/offer", &["planned", "declined"]),
    ("/accept", &["proposed"]),
    ("/decline", &["proposed"]),
    ("/on-board", &["planned", "accepted"]),
    (
        "/messages",
        &["offered", "proposed", "accepted", "on_board"],
    ),
    (
        "/cancel",
        &[
            "planned", "offered", "proposed", "declined", "accepted", "on_board",
        ],
    ),
    ("/close", &[]),
    ("/complete", &[]),
    ("/signatures", &[]),
];
const FIRM: [(&str, &[&str]); 9] = [
    ("/accept", &["offered"]),
    ("/decline", &["offered", "proposed", "accepted"]),
    ("/propose", &["offered", "proposed"]),
    ("/on-board", &["accepted"]),
    (
        "/messages",
        &["offered", "proposed", "accepted", "on_board"],
    ),
    (
        "/remarks",
        &["offered", "proposed", "accepted", "on_board", "cancelled"],
    ),
    ("/plan", &[]),
    ("/complete", &[]),
    ("/signatures", &[]),
];

/// Brings an order, offered to one firm, to a state.
async fn bring_to(parties: &mut OfferParties, state: &str) {
    let mut new = parties.new_order();
    if state != "planned" {
        new["offer"] = parties.offer();
    }
    let made = parties.ada.post("/work-orders", &new).await.good();
    made["id"].as_str().unwrap().clone_into(&mut parties.order);
    let rosa = &parties.firms[0].1;
    let ways: &[(&str, Value)] = match state {
        "planned" | "offered" => &[],
        "proposed" => &[("/propose", proposal())],
        "declined" => &[("/decline", json!({}))],
        "accepted" => &[("/accept", json!({}))],
        "on_board" => &[("/accept", json!({})), ("/on-board", json!({}))],
        "cancelled" => {
            parties.post(rosa, "/accept", &json!({})).await.good();
            parties
                .post(&parties.ada, "/cancel", &json!({ "text": "x" }))
                .await
                .good();
            &[]
        }
        _ => unreachable!("{state} is none of them"),
    };
    for (rest, body) in ways {
        let done = parties.post(rosa, rest, body).await;
        assert!(done.status < 300, "{rest}: {done:?}");
    }
    assert_eq!(parties.view_order().await["state"], state);
}

fn body(parties: &OfferParties, rest: &str) -> Value {
    match rest {
        "/offer" => parties.offer(),
        "/propose" => proposal(),
        "/messages" | "/cancel" | "/close" | "/remarks" => json!({ "text": "x" }),
        "/complete" => json!({
            "adjuster_name": "M", "adjuster_licence": "1", "firm": "N", "signature": "M",
        }),
        "/signatures" => json!({ "public_key": "0".repeat(64), "signature": "0".repeat(128) }),
        _ => json!({}),
    }
}

async fn a_request_forbidden_in_a_state_is_refused_and_writes_nothing(server: TestServer) {
    let mut parties = OfferParties::planned(&server, 1).await;
    let cancel = json!({ "text": "x" });
    parties.post(&parties.ada, "/cancel", &cancel).await.good();
    for state in STATES {
        for (side, table) in [(0, OPERATOR), (1, FIRM)] {
            bring_to(&mut parties, state).await;
            let who = [&parties.ada, &parties.firms[0].1][side].clone();
            // An allowed request comes last, on an order of its own.
            for (rest, allowed) in table
                .iter()
                .filter(|(_, allowed)| !allowed.contains(&state))
            {
                let seq = parties.view_order().await["last_seq"].clone();
                let refused = parties.post(&who, rest, &body(&parties, rest)).await;
                let known = ["wrong-state", "not-found"].contains(&refused.problem().as_str());
                assert!(known, "{state} {side} {rest} {allowed:?}: {refused:?}");
                assert_eq!(
                    parties.view_order().await["last_seq"],
                    seq,
                    "{state} {rest}"
                );
            }
            cancel_if_open(&parties, state).await;
            for (rest, _) in table.iter().filter(|(_, allowed)| allowed.contains(&state)) {
                bring_to(&mut parties, state).await;
                let done = parties.post(&who, rest, &body(&parties, rest)).await;
                assert!(done.status < 300, "{state} {side} {rest}: {done:?}");
                cancel_if_open(&parties, "").await;
            }
        }
    }
    server.finish().await;
}

/// Cancels the order, because a compass has only one under way.
async fn cancel_if_open(parties: &OfferParties, state: &str) {
    if state != "cancelled" && parties.view_order().await["state"] != "cancelled" {
        let cancel = json!({ "text": "x" });
        parties.post(&parties.ada, "/cancel", &cancel).await.good();
    }
}

async fn a_firm_cannot_act_for_the_operator(server: TestServer) {
    let parties = OfferParties::offered(&server, 1).await;
    let rosa = &parties.firms[0].1;
    for rest in ["/offer", "/cancel", "/close"] {
        let refused = parties.post(rosa, rest, &body(&parties, rest)).await;
        assert_eq!(refused.problem(), "forbidden", "{rest}");
    }
    let made = rosa.post("/work-orders", &parties.new_order()).await;
    assert_eq!(made.problem(), "forbidden");
    let proposed = parties.post(&parties.ada, "/propose", &proposal()).await;
    assert_eq!(proposed.problem(), "forbidden");
    let viewer: Person = parties.ada.viewer(&server).await;
    let refused = parties.post(&viewer, "/accept", &json!({})).await;
    assert_eq!(refused.problem(), "forbidden");
    assert_eq!(parties.kinds(&parties.ada).await.len(), 3);
    server.finish().await;
}

async fn a_read_token_cannot_respond_to_an_offer(server: TestServer) {
    let parties = OfferParties::offered(&server, 1).await;
    let rosa = &parties.firms[0].1;
    let token = |scope: &str| json!({ "name": "ERP", "scope": scope });
    let read = rosa.post("/tokens", &token("read")).await.good()["token"].clone();
    let write = rosa.post("/tokens", &token("write")).await.good()["token"].clone();
    let request = |token: &Value, method: Method, rest: &str| {
        let url = format!("{}/api/v1{}", server.url, parties.path(rest));
        let request = server.http.request(method, url);
        ApiResponse::send(request.bearer_auth(token.as_str().unwrap()))
    };
    assert_eq!(
        request(&read, Method::GET, "").await.good()["state"],
        "offered"
    );
    let refused = request(&read, Method::POST, "/accept").await;
    assert_eq!(refused.problem(), "forbidden");
    let accepted = request(&write, Method::POST, "/accept").await;
    assert_eq!(accepted.good()["state"], "accepted");
    server.finish().await;
}
