//! Notifications to people: in the dashboard and by mail.

mod due_dates;
mod mail;
mod settings;

use binnacle_orders::dispatch::lapse;
use binnacle_planning::notifications::send_due;
use binnacle_server_testing::HOUR_S;
use binnacle_server_testing::mail::{deliver, subjects};
use binnacle_server_testing::offers::OfferParties;
use binnacle_server_testing::on_both;
use binnacle_server_testing::{ApiResponse, Person, Relay, TestServer};
use reqwest::Method;
use serde_json::{Value, json};

on_both!(
    an_offer_and_its_responses_notify_the_other_side,
    a_lapsed_offer_notifies_both_sides,
    a_person_is_not_notified_of_their_own_action,
    a_withdrawn_offer_is_notified_without_a_reason,
    reading_marks_only_ones_own_notifications,
    a_list_of_an_unknown_kind_is_refused,
);

/// Returns the subjects of a person's notifications, oldest first.
pub(crate) async fn subjects_of(person: &Person) -> Vec<String> {
    let listed = person.get("/notifications").await.good();
    let items = listed["items"].as_array().unwrap().iter().rev();
    items
        .map(|item| item["subject"].as_str().unwrap().to_owned())
        .collect()
}

/// Makes and sends the letters that are due; returns the subjects of all letters so far.
async fn sent_subjects(server: &TestServer, relay: &Relay) -> Vec<String> {
    send_due(&server.app).await.unwrap();
    deliver(server, relay).await;
    subjects(relay)
}

async fn put_settings(person: &Person, settings: &Value) -> ApiResponse {
    let request = person.request(Method::PUT, "/me/notifications");
    ApiResponse::send(request.json(settings)).await
}

async fn an_offer_and_its_responses_notify_the_other_side(server: TestServer) {
    let relay = Relay::start().await;
    let parties = OfferParties::offered(&server, 2).await;
    let [(_, rosa), (_, juan)] = &parties.firms[..] else {
        unreachable!("there are two")
    };
    let offered = "Nao: a job is offered to you at Bilbao";
    assert_eq!(subjects_of(rosa).await, [offered]);
    assert_eq!(sent_subjects(&server, &relay).await, [offered]);
    let letter = relay.letters().remove(0);
    assert_eq!(letter.to, ["<rosa@adjusters.example>"]);
    let read = binnacle_server_testing::mail::read(&letter);
    let text = read["text"].as_str().unwrap();
    for part in [
        "Vessel:    Nao",
        "Port:      Bilbao, berth A5",
        "Planned:   2026-11-22 09:00 to 12:00, port's time (UTC+01:00)",
        "Operator:  ada",
        "Answer by: 2026-11-21 08:00 UTC",
        &format!("https://binnacle.example/work-orders/{}", parties.order),
        "https://binnacle.example/settings",
    ] {
        assert!(text.contains(part), "{part} is not in\n{text}");
    }

    let no = json!({ "text": "No team." });
    assert_eq!(parties.post(rosa, "/decline", &no).await.status, 204);
    let terms = json!({ "planned_at": "2026-11-22T13:00:00Z", "berth": "A7", "fee_eur": 900.5 });
    let proposal = json!({ "terms": terms, "text": "At noon." });
    parties.post(juan, "/propose", &proposal).await.good();
    let responses = [
        "Nao: rosa declines the job at Bilbao",
        "Nao: juan proposes other terms at Bilbao",
    ];
    assert_eq!(subjects_of(&parties.ada).await, responses);
    let listed = parties.ada.get("/notifications?kind=answered").await.good();
    let newest = &listed["items"][0];
    assert_eq!(newest["order_id"], parties.order.as_str());
    let terms_text = "juan@adjusters.example: 2026-11-22 14:00 to 17:00, port's time (UTC+01:00), berth A7, for \
         900.50 euros. At noon.";
    assert!(
        newest["text"].as_str().unwrap().contains(terms_text),
        "{newest}"
    );

    parties
        .post(&parties.ada, "/accept", &json!({}))
        .await
        .good();
    parties.post(juan, "/on-board", &json!({})).await.good();
    assert_eq!(
        subjects_of(juan).await,
        [offered, "Nao: your terms are accepted at Bilbao"]
    );
    let all = subjects_of(&parties.ada).await;
    assert_eq!(
        all.last().unwrap(),
        "Nao: the adjuster is on board at Bilbao"
    );
    server.finish().await;
}

async fn a_lapsed_offer_notifies_both_sides(server: TestServer) {
    let parties = OfferParties::offered(&server, 1).await;
    server.advance(HOUR_S + 1.0);
    assert_eq!(lapse(&server.app).await.unwrap(), 1);
    let late = subjects_of(&parties.ada).await;
    assert_eq!(late, ["Nao: no answer in time from rosa at Bilbao"]);
    let theirs = subjects_of(&parties.firms[0].1).await;
    assert_eq!(theirs[1], "Nao: you have not answered in time at Bilbao");
    assert_eq!(theirs.len(), 2);
    server.finish().await;
}

async fn a_person_is_not_notified_of_their_own_action(server: TestServer) {
    let parties = OfferParties::planned(&server, 1).await;
    let viewer = parties.ada.viewer(&server).await;
    parties
        .post(&parties.ada, "/offer", &parties.offer())
        .await
        .good();
    let rosa = &parties.firms[0].1;
    parties.post(rosa, "/accept", &json!({})).await.good();
    let text = json!({ "text": "Is the gangway to port?" });
    parties.post(&parties.ada, "/messages", &text).await;
    // An admin acts for the adjuster.
    parties
        .post(&parties.ada, "/on-board", &json!({}))
        .await
        .good();
    assert_eq!(
        subjects_of(&parties.ada).await,
        ["Nao: rosa accepts the job at Bilbao"]
    );
    let others = subjects_of(&viewer).await;
    assert_eq!(
        others.last().unwrap(),
        "Nao: the adjuster is on board at Bilbao"
    );
    let theirs = subjects_of(rosa).await;
    let expected = [
        "Nao: a job is offered to you at Bilbao",
        "Nao: message from the operator at Bilbao",
    ];
    assert_eq!(theirs, expected);
    server.finish().await;
}

async fn a_withdrawn_offer_is_notified_without_a_reason(server: TestServer) {
    let parties = OfferParties::planned(&server, 2).await;
    let [(_, rosa), (_, juan)] = &parties.firms[..] else {
        unreachable!("there are two")
    };
    let mut offer = parties.offer();
    offer["at_once"] = json!(true);
    parties.post(&parties.ada, "/offer", &offer).await.good();
    let yes = json!({ "text": "For 1200 euros as always." });
    parties.post(rosa, "/accept", &yes).await.good();
    let listed = juan.get("/notifications?kind=withdrawn").await.good();
    let withdrawn = &listed["items"][0];
    assert_eq!(
        withdrawn["subject"],
        "Nao: the offer is withdrawn at Bilbao"
    );
    let text = withdrawn["text"].as_str().unwrap();
    assert!(!text.contains("rosa") && !text.contains("1200"), "{text}");
    server.finish().await;
}

async fn reading_marks_only_ones_own_notifications(server: TestServer) {
    let parties = OfferParties::offered(&server, 1).await;
    let rosa = &parties.firms[0].1;
    parties.post(rosa, "/accept", &json!({})).await.good();
    parties.post(rosa, "/on-board", &json!({})).await.good();
    let ada = &parties.ada;
    let listed = ada.get("/notifications?unread=true").await.good();
    assert_eq!(listed["unread"], 2);
    let first = listed["items"][1]["id"].as_str().unwrap();
    let path = format!("/notifications/{first}");
    let mark = |who: &Person, read: bool| {
        let request = who.request(Method::PATCH, &path);
        ApiResponse::send(request.json(&json!({ "read": read })))
    };
    assert_eq!(mark(rosa, true).await.problem(), "not-found");
    assert_eq!(mark(ada, true).await.status, 204);
    let left = ada.get("/notifications?unread=true").await.good();
    assert_eq!(left["items"].as_array().unwrap().len(), 1);
    assert_ne!(left["items"][0]["id"], first);
    let read = ada.get("/notifications?unread=false").await.good();
    assert_eq!(read["items"][0]["read_at"], "2026-11-21T07:00:00Z");
    assert_eq!(mark(ada, false).await.status, 204);
    let until = json!({ "until": first });
    assert_eq!(ada.post("/notifications/read", &until).await.status, 204);
    assert_eq!(ada.get("/notifications").await.good()["unread"], 1);
    assert_eq!(
        ada.post("/notifications/read", &json!({})).await.status,
        204
    );
    assert_eq!(ada.get("/notifications").await.good()["unread"], 0);
    let page = ada.get("/notifications?limit=1").await.good();
    let next = format!(
        "/notifications?limit=1&after={}",
        page["next"].as_str().unwrap()
    );
    assert_eq!(ada.get(&next).await.good()["items"][0]["id"], first);
    let root = ada.platform_admin(&server).await;
    assert_eq!(root.get("/notifications").await.problem(), "forbidden");
    server.finish().await;
}

async fn a_list_of_an_unknown_kind_is_refused(server: TestServer) {
    let ada = server.admin("ada").await;
    let refused = ada.get("/notifications?kind=gossip").await;
    assert_eq!(refused.problem(), "bad-request");
    server.finish().await;
}
