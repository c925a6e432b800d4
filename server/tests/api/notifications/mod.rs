//! Notifications: what each person is told, and when, and how.

mod mailed;
mod needs;
mod settings;

use crate::mail::{deliver, subjects};
use crate::offers::{HOUR_S, Trade};
use crate::on_both;
use crate::support::{Answer, Person, Relay, Shore};
use binnacle_orders::dispatch::lapse;
use binnacle_planning::notifications::post;
use reqwest::Method;
use serde_json::{Value, json};

on_both!(
    an_offer_and_its_answers_reach_the_other_side,
    an_answer_that_is_late_is_told_to_both_sides,
    who_does_something_is_not_told_of_it,
    an_offer_that_is_withdrawn_is_told_without_a_reason,
    what_was_read_is_marked_and_ones_own,
);

/// The subjects of a person's notifications, the first first.
pub(crate) async fn told(person: &Person) -> Vec<String> {
    let listed = person.get("/notifications").await.good();
    let items = listed["items"].as_array().unwrap().iter().rev();
    items
        .map(|item| item["subject"].as_str().unwrap().to_owned())
        .collect()
}

/// Makes the letters that are due and sends them; the subjects of all there were.
async fn mailed(shore: &Shore, relay: &Relay) -> Vec<String> {
    post(&shore.app).await.unwrap();
    deliver(shore, relay).await;
    subjects(relay)
}

async fn say(person: &Person, settings: &Value) -> Answer {
    let request = person.request(Method::PUT, "/me/notifications");
    Answer::of(request.json(settings)).await
}

async fn an_offer_and_its_answers_reach_the_other_side(shore: Shore) {
    let relay = Relay::start().await;
    let trade = Trade::offered(&shore, 2).await;
    let [(_, rosa), (_, juan)] = &trade.firms[..] else {
        unreachable!("there are two")
    };
    let offered = "Nao: a job is offered to you at Bilbao";
    assert_eq!(told(rosa).await, [offered]);
    assert_eq!(mailed(&shore, &relay).await, [offered]);
    let letter = relay.got().remove(0);
    assert_eq!(letter.to, ["<rosa@adjusters.example>"]);
    let read = crate::mail::read(&letter);
    let text = read["text"].as_str().unwrap();
    for part in [
        "Vessel:    Nao",
        "Port:      Bilbao, berth A5",
        "Planned:   2026-11-22 08:00 UTC",
        "Operator:  ada",
        "Answer by: 2026-11-21 08:00 UTC",
        &format!("https://binnacle.example/work-orders/{}", trade.order),
        "https://binnacle.example/settings",
    ] {
        assert!(text.contains(part), "{part} is not in\n{text}");
    }

    let no = json!({ "text": "No team." });
    assert_eq!(trade.post(rosa, "/decline", &no).await.status, 204);
    let terms = json!({ "planned_at": "2026-11-22T13:00:00Z", "berth": "A7", "fee_eur": 900.5 });
    let proposal = json!({ "terms": terms, "text": "At noon." });
    trade.post(juan, "/propose", &proposal).await.good();
    let answers = [
        "Nao: rosa declines the job at Bilbao",
        "Nao: juan proposes other terms at Bilbao",
    ];
    assert_eq!(told(&trade.ada).await, answers);
    let listed = trade.ada.get("/notifications?kind=answered").await.good();
    let newest = &listed["items"][0];
    assert_eq!(newest["order_id"], trade.order.as_str());
    let said = "juan@adjusters.example: 2026-11-22 13:00 UTC, berth A7, for 900.50 euros. At noon.";
    assert!(newest["text"].as_str().unwrap().contains(said), "{newest}");

    trade.post(&trade.ada, "/accept", &json!({})).await.good();
    trade.post(juan, "/on-board", &json!({})).await.good();
    assert_eq!(
        told(juan).await,
        [offered, "Nao: your terms are accepted at Bilbao"]
    );
    let all = told(&trade.ada).await;
    assert_eq!(
        all.last().unwrap(),
        "Nao: the adjuster is on board at Bilbao"
    );
    shore.finish().await;
}

async fn an_answer_that_is_late_is_told_to_both_sides(shore: Shore) {
    let trade = Trade::offered(&shore, 1).await;
    shore.advance(HOUR_S + 1.0);
    assert_eq!(lapse(&shore.app).await.unwrap(), 1);
    let late = told(&trade.ada).await;
    assert_eq!(late, ["Nao: no answer in time from rosa at Bilbao"]);
    let theirs = told(&trade.firms[0].1).await;
    assert_eq!(theirs[1], "Nao: you have not answered in time at Bilbao");
    assert_eq!(theirs.len(), 2);
    shore.finish().await;
}

async fn who_does_something_is_not_told_of_it(shore: Shore) {
    let trade = Trade::planned(&shore, 1).await;
    let viewer = trade.ada.viewer(&shore).await;
    trade
        .post(&trade.ada, "/offer", &trade.offer())
        .await
        .good();
    let rosa = &trade.firms[0].1;
    trade.post(rosa, "/accept", &json!({})).await.good();
    let text = json!({ "text": "Is the gangway to port?" });
    trade.post(&trade.ada, "/messages", &text).await;
    // An admin stands in for the adjuster.
    trade.post(&trade.ada, "/on-board", &json!({})).await.good();
    assert_eq!(
        told(&trade.ada).await,
        ["Nao: rosa accepts the job at Bilbao"]
    );
    let others = told(&viewer).await;
    assert_eq!(
        others.last().unwrap(),
        "Nao: the adjuster is on board at Bilbao"
    );
    let theirs = told(rosa).await;
    let expected = [
        "Nao: a job is offered to you at Bilbao",
        "Nao: message from the operator at Bilbao",
    ];
    assert_eq!(theirs, expected);
    shore.finish().await;
}

async fn an_offer_that_is_withdrawn_is_told_without_a_reason(shore: Shore) {
    let trade = Trade::planned(&shore, 2).await;
    let [(_, rosa), (_, juan)] = &trade.firms[..] else {
        unreachable!("there are two")
    };
    let mut offer = trade.offer();
    offer["at_once"] = json!(true);
    trade.post(&trade.ada, "/offer", &offer).await.good();
    let yes = json!({ "text": "For 1200 euros as always." });
    trade.post(rosa, "/accept", &yes).await.good();
    let listed = juan.get("/notifications?kind=withdrawn").await.good();
    let withdrawn = &listed["items"][0];
    assert_eq!(
        withdrawn["subject"],
        "Nao: the offer is withdrawn at Bilbao"
    );
    let text = withdrawn["text"].as_str().unwrap();
    assert!(!text.contains("rosa") && !text.contains("1200"), "{text}");
    shore.finish().await;
}

async fn what_was_read_is_marked_and_ones_own(shore: Shore) {
    let trade = Trade::offered(&shore, 1).await;
    let rosa = &trade.firms[0].1;
    trade.post(rosa, "/accept", &json!({})).await.good();
    trade.post(rosa, "/on-board", &json!({})).await.good();
    let ada = &trade.ada;
    let listed = ada.get("/notifications?unread=true").await.good();
    assert_eq!(listed["unread"], 2);
    let first = listed["items"][1]["id"].as_str().unwrap();
    let path = format!("/notifications/{first}");
    let mark = |who: &Person, read: bool| {
        let request = who.request(Method::PATCH, &path);
        Answer::of(request.json(&json!({ "read": read })))
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
    let root = ada.platform_admin(&shore).await;
    assert_eq!(root.get("/notifications").await.problem(), "forbidden");
    shore.finish().await;
}
