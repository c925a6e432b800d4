//! Offers of work orders to firms: accepted, declined, lapsed, withdrawn.

mod example_client;
mod forbidden_requests;
mod generated_clients;
mod notices;
mod races;

use binnacle_orders::dispatch::lapse;
use binnacle_server_testing::HOUR_S;
use binnacle_server_testing::offers::{NEXT_DAY, OfferParties, proposal};
use binnacle_server_testing::on_both;
use binnacle_server_testing::{ApiResponse, TestServer};
use reqwest::Method;
use serde_json::{Value, json};

on_both!(
    a_firm_accepts_and_goes_on_board,
    the_next_firm_gets_the_offer_when_one_declines_or_is_silent,
    a_silent_firm_leaves_the_next_ones_time_before_the_job,
    a_past_job_is_offered_to_nobody,
    a_firm_with_a_longer_lead_time_is_skipped,
    a_firm_proposes_other_terms_and_the_operator_agrees,
    after_declined_terms_the_next_firm_gets_the_offer,
    an_unanswered_proposal_lapses,
    a_firm_gives_an_order_back,
    messages_are_visible_to_the_operator_and_one_firm,
    an_invalid_offer_is_refused_whole,
);

async fn a_firm_accepts_and_goes_on_board(server: TestServer) {
    let parties = OfferParties::offered(&server, 1).await;
    let (firm, rosa) = &parties.firms[0];
    let (_, other) = server.admin("eve").await.adjuster(&server, "other").await;
    let offered = parties.view_order().await;
    assert_eq!(offered["state"], "offered");
    assert_eq!(offered["firm_id"], Value::Null);
    assert_eq!(offered["answer_by"], "2026-11-21T08:00:00Z");
    let listed = rosa.get("/work-orders?state=offered").await.good();
    assert_eq!(listed["items"][0]["id"], parties.order.as_str());
    assert_eq!(listed["items"][0]["operator_name"], "ada");
    assert_eq!(
        rosa.get("/work-orders?state=planned").await.good()["items"],
        json!([])
    );
    assert_eq!(other.get("/work-orders").await.good()["items"], json!([]));
    assert_eq!(other.get(&parties.path("")).await.problem(), "not-found");
    let refused = parties.post(&other, "/accept", &json!({})).await;
    assert_eq!(refused.problem(), "not-found");

    let early = parties.post(rosa, "/on-board", &json!({})).await;
    assert_eq!(early.problem(), "wrong-state");
    let who = json!({ "adjuster_name": "M. Etxeberria", "adjuster_licence": "ES-CA-114" });
    let accepted = parties.post(rosa, "/accept", &who).await.good();
    assert_eq!(accepted["state"], "accepted");
    assert_eq!(accepted["firm_id"], firm.to_string());
    assert_eq!(accepted["firm"], "rosa");
    assert_eq!(accepted["adjuster_name"], "M. Etxeberria");
    assert_eq!(accepted["answer_by"], Value::Null);
    let on_board = parties.post(rosa, "/on-board", &json!({})).await.good();
    assert_eq!(on_board["state"], "on_board");
    let all = ["opened", "offered", "asked", "accepted", "on_board"];
    assert_eq!(parties.kinds(&parties.ada).await, all);
    let theirs = ["opened", "-", "asked", "accepted", "on_board"];
    assert_eq!(parties.kinds(rosa).await, theirs);
    server.finish().await;
}

async fn the_next_firm_gets_the_offer_when_one_declines_or_is_silent(server: TestServer) {
    let parties = OfferParties::offered(&server, 3).await;
    let [(_, rosa), (_, juan), (_, pepa)] = &parties.firms[..] else {
        unreachable!("there are three")
    };
    assert_eq!(parties.offers().await, ["open", "waiting", "waiting"]);
    assert_eq!(juan.get(&parties.path("")).await.problem(), "not-found");
    let early = parties.post(juan, "/accept", &json!({})).await;
    assert_eq!(early.problem(), "not-found");
    let no = parties
        .post(rosa, "/decline", &json!({ "text": "No team." }))
        .await;
    assert_eq!(no.status, 204, "{no:?}");
    assert_eq!(parties.offers().await, ["declined", "open", "waiting"]);
    assert_eq!(rosa.get(&parties.path("")).await.problem(), "not-found");
    let repeated = parties.post(rosa, "/accept", &json!({})).await;
    assert_eq!(repeated.problem(), "wrong-state");
    assert!(repeated.text.contains("declined"), "{repeated:?}");

    assert_eq!(lapse(&server.app).await.unwrap(), 0);
    server.advance(HOUR_S + 1.0);
    let late = parties.post(juan, "/accept", &json!({})).await;
    assert_eq!(late.problem(), "wrong-state");
    assert!(late.text.contains("lapsed"), "{late:?}");
    assert_eq!(lapse(&server.app).await.unwrap(), 1);
    assert_eq!(parties.offers().await, ["declined", "lapsed", "open"]);
    let later = parties.post(juan, "/accept", &json!({})).await;
    assert!(later.text.contains("lapsed"), "{later:?}");
    assert_eq!(
        parties.view_order().await["answer_by"],
        "2026-11-21T09:00:01Z"
    );
    server.advance(HOUR_S + 1.0);
    assert_eq!(lapse(&server.app).await.unwrap(), 1);
    assert_eq!(parties.view_order().await["state"], "declined");
    assert_eq!(pepa.get("/work-orders").await.good()["items"], json!([]));

    // It is offered again, also to the firm that did not respond.
    let repeated = json!({ "firms": [parties.firms[1].0], "text": "Please." });
    parties.post(&parties.ada, "/offer", &repeated).await.good();
    assert_eq!(parties.offers().await, ["declined", "lapsed", "open"]);
    let taken = parties.post(juan, "/accept", &json!({})).await.good();
    assert_eq!(taken["offers"].as_array().unwrap().len(), 1, "{taken}");
    server.finish().await;
}

/// Offers a job in 25 hours, with two days for each response.
async fn a_silent_firm_leaves_the_next_ones_time_before_the_job(server: TestServer) {
    let parties = OfferParties::planned(&server, 3).await;
    let mut offer = parties.offer();
    offer["answer_within_hours"] = json!(48);
    parties.post(&parties.ada, "/offer", &offer).await.good();
    assert_eq!(
        parties.view_order().await["answer_by"],
        "2026-11-21T15:20:00Z"
    );
    server.advance(8.0 * HOUR_S + 1201.0);
    assert_eq!(lapse(&server.app).await.unwrap(), 1);
    assert_eq!(parties.offers().await, ["lapsed", "open", "waiting"]);
    assert_eq!(
        parties.view_order().await["answer_by"],
        "2026-11-21T23:40:00Z"
    );
    // The operator has to answer a proposal early enough for the third firm.
    let juan = &parties.firms[1].1;
    parties.post(juan, "/propose", &proposal()).await.good();
    assert_eq!(
        parties.view_order().await["answer_by"],
        "2026-11-21T23:40:00Z"
    );
    parties.post(&parties.ada, "/decline", &json!({})).await;
    assert_eq!(parties.offers().await, ["lapsed", "declined", "open"]);
    assert_eq!(
        parties.view_order().await["answer_by"],
        "2026-11-22T08:00:00Z"
    );
    server.finish().await;
}

async fn a_past_job_is_offered_to_nobody(server: TestServer) {
    let mut parties = OfferParties::planned(&server, 2).await;
    let cancel = json!({ "text": "another time" });
    parties.post(&parties.ada, "/cancel", &cancel).await.good();
    let mut new = parties.new_order();
    new["planned_at"] = json!("2026-11-21T09:00:00Z");
    new["offer"] = parties.offer();
    let made = parties.ada.post("/work-orders", &new).await.good();
    made["id"].as_str().unwrap().clone_into(&mut parties.order);
    let [(_, rosa), (_, juan)] = &parties.firms[..] else {
        unreachable!("there are two")
    };
    parties.post(rosa, "/accept", &json!({})).await.good();
    server.advance(2.0 * HOUR_S + 1.0);
    let back = parties.post(rosa, "/decline", &json!({})).await;
    assert_eq!(back.status, 204, "{back:?}");
    assert_eq!(parties.offers().await, ["declined", "lapsed"]);
    let order = parties.view_order().await;
    assert_eq!(order["state"], "declined");
    assert_eq!(
        order["offers"][1]["text"],
        "not asked: the time of the job is past"
    );
    let refused = parties.post(juan, "/accept", &json!({})).await;
    assert!(refused.status >= 400, "{refused:?}");
    server.advance(HOUR_S);
    let late = parties.post(&parties.ada, "/offer", &parties.offer()).await;
    assert_eq!(late.problem(), "wrong-state");
    assert!(
        late.text.contains("2026-11-21 09:00 UTC, which is past"),
        "{late:?}"
    );
    server.finish().await;
}

/// Gives Juan a lead time of a day, and Pepa one of five hours.
async fn a_firm_with_a_longer_lead_time_is_skipped(server: TestServer) {
    let parties = OfferParties::planned(&server, 3).await;
    for (firm, hours) in [(&parties.firms[1].0, 24), (&parties.firms[2].0, 5)] {
        let terms = json!({ "fee_eur": 1800, "working_days": ["Sun"], "lead_time_h": hours });
        let path = format!("/firms/{firm}/terms");
        let put = parties.ada.request(Method::PUT, &path).json(&terms);
        ApiResponse::send(put).await.good();
    }
    let mut offer = parties.offer();
    offer["answer_within_hours"] = json!(48);
    parties.post(&parties.ada, "/offer", &offer).await.good();
    // Half of the hour that is left before Juan's lead time.
    assert_eq!(
        parties.view_order().await["answer_by"],
        "2026-11-21T07:30:00Z"
    );
    server.advance(2.0 * HOUR_S);
    assert_eq!(lapse(&server.app).await.unwrap(), 1);
    assert_eq!(parties.offers().await, ["lapsed", "lapsed", "open"]);
    let passed = &parties.view_order().await["offers"][1];
    assert_eq!(passed["text"], "not asked: it requires 24 h notice");
    server.finish().await;
}

async fn a_firm_proposes_other_terms_and_the_operator_agrees(server: TestServer) {
    let parties = OfferParties::offered(&server, 2).await;
    let (_, rosa) = &parties.firms[0];
    let proposed = parties.post(rosa, "/propose", &proposal()).await.good();
    assert_eq!(proposed["state"], "proposed");
    let seen = parties.view_order().await;
    assert_eq!(seen["offers"][0]["terms"], proposal()["terms"]);
    assert_eq!(seen["planned_at"], "2026-11-22T08:00:00Z");
    assert_eq!(seen["planned_until"], "2026-11-22T11:00:00Z");
    let own = parties.post(rosa, "/accept", &json!({})).await;
    assert_eq!(own.problem(), "wrong-state");
    let agreed = parties
        .post(&parties.ada, "/accept", &json!({}))
        .await
        .good();
    assert_eq!(agreed["state"], "accepted");
    assert_eq!(agreed["planned_at"], NEXT_DAY);
    assert_eq!(agreed["planned_until"], "2026-11-22T17:00:00Z");
    assert_eq!(agreed["berth"], "A7", "{agreed}");
    assert_eq!(agreed["firm"], "rosa");
    let repeated = parties.post(&parties.ada, "/accept", &json!({})).await;
    assert_eq!(repeated.problem(), "wrong-state");
    server.finish().await;
}

async fn after_declined_terms_the_next_firm_gets_the_offer(server: TestServer) {
    let parties = OfferParties::offered(&server, 2).await;
    parties
        .post(&parties.firms[0].1, "/propose", &proposal())
        .await
        .good();
    let no = parties
        .post(&parties.ada, "/decline", &json!({ "text": "Too late." }))
        .await;
    assert_eq!(no.status, 204, "{no:?}");
    assert_eq!(parties.offers().await, ["declined", "open"]);
    let past = json!({ "terms": { "planned_at": "2026-11-20T00:00:00Z" } });
    let refused = parties.post(&parties.firms[1].1, "/propose", &past).await;
    assert_eq!(refused.problem(), "invalid");
    let paid = json!({ "terms": { "planned_at": NEXT_DAY, "fee_eur": -1.0 } });
    let refused = parties.post(&parties.firms[1].1, "/propose", &paid).await;
    assert_eq!(refused.problem(), "invalid");
    assert_eq!(parties.offers().await, ["declined", "open"]);
    server.finish().await;
}

async fn an_unanswered_proposal_lapses(server: TestServer) {
    let parties = OfferParties::offered(&server, 1).await;
    server.advance(HOUR_S / 2.0);
    parties
        .post(&parties.firms[0].1, "/propose", &proposal())
        .await
        .good();
    server.advance(HOUR_S / 2.0 + 1.0);
    // The operator has an hour to respond.
    assert_eq!(lapse(&server.app).await.unwrap(), 0);
    server.advance(HOUR_S / 2.0);
    let late = parties.post(&parties.ada, "/accept", &json!({})).await;
    assert_eq!(late.problem(), "wrong-state");
    assert_eq!(lapse(&server.app).await.unwrap(), 1);
    assert_eq!(parties.offers().await, ["lapsed"]);
    assert_eq!(parties.view_order().await["state"], "declined");
    server.finish().await;
}

async fn a_firm_gives_an_order_back(server: TestServer) {
    let parties = OfferParties::offered(&server, 2).await;
    let [(_, rosa), (_, juan)] = &parties.firms[..] else {
        unreachable!("there are two")
    };
    let who = json!({ "adjuster_name": "M. Etxeberria" });
    parties.post(rosa, "/accept", &who).await.good();
    let back = parties
        .post(rosa, "/decline", &json!({ "text": "Ill." }))
        .await;
    assert_eq!(back.status, 204, "{back:?}");
    let order = parties.view_order().await;
    assert_eq!(order["state"], "offered");
    for field in ["firm", "firm_id", "adjuster_name"] {
        assert_eq!(order[field], Value::Null, "{field}");
    }
    parties.post(juan, "/accept", &json!({})).await.good();
    parties.post(juan, "/on-board", &json!({})).await.good();
    let late = parties.post(juan, "/decline", &json!({})).await;
    assert_eq!(late.problem(), "wrong-state");
    server.finish().await;
}

async fn messages_are_visible_to_the_operator_and_one_firm(server: TestServer) {
    let parties = OfferParties::planned(&server, 2).await;
    let [(rosas, rosa), (_, juan)] = &parties.firms[..] else {
        unreachable!("there are two")
    };
    let mut offer = parties.offer();
    offer["at_once"] = json!(true);
    let nobody = parties
        .post(&parties.ada, "/messages", &json!({ "text": "?" }))
        .await;
    assert_eq!(nobody.problem(), "wrong-state");
    parties.post(&parties.ada, "/offer", &offer).await.good();
    let which = parties
        .post(&parties.ada, "/messages", &json!({ "text": "?" }))
        .await;
    assert_eq!(which.problem(), "invalid");
    let message = json!({ "text": "Is the gangway to port?\nOr to starboard?" });
    let sent = parties.post(rosa, "/messages", &message).await;
    assert_eq!(sent.status, 204, "{sent:?}");
    let response = json!({ "firm_id": rosas, "text": "To port." });
    let sent = parties.post(&parties.ada, "/messages", &response).await;
    assert_eq!(sent.status, 204, "{sent:?}");
    for (who, expected) in [(&parties.ada, 2), (rosa, 2), (juan, 0)] {
        let read = who.get(&parties.path("/messages")).await.good();
        let items = read["items"].as_array().unwrap();
        assert_eq!(items.len(), expected);
        if let [first, second] = &items[..] {
            assert_eq!(
                (&first["text"], &first["from_firm"]),
                (&message["text"], &json!(true))
            );
            assert_eq!(
                (&second["text"], &second["from_firm"]),
                (&json!("To port."), &json!(false))
            );
        }
    }
    let kinds = parties.kinds(juan).await;
    assert_eq!(kinds, ["opened", "-", "-", "asked", "-", "-"]);
    let blank = parties
        .post(rosa, "/messages", &json!({ "text": " " }))
        .await;
    assert_eq!(blank.problem(), "invalid");
    server.finish().await;
}

async fn an_invalid_offer_is_refused_whole(server: TestServer) {
    let parties = OfferParties::planned(&server, 1).await;
    let eve = server.admin("eve").await;
    let (strange, _) = eve.adjuster(&server, "other").await;
    let rosas = parties.firms[0].0;
    for bad in [
        json!({ "firms": [] }),
        json!({ "firms": [rosas, rosas] }),
        json!({ "firms": [strange] }),
        json!({ "firms": [rosas], "answer_within_hours": 0 }),
        json!({ "firms": [rosas], "answer_within_hours": 721 }),
        json!({ "firms": [rosas], "by": "pigeon" }),
    ] {
        let refused = parties.post(&parties.ada, "/offer", &bad).await;
        assert_eq!(refused.problem(), "invalid", "{bad}");
    }
    assert_eq!(parties.kinds(&parties.ada).await, ["opened"]);
    // An order with an invalid offer is not created.
    parties
        .post(&parties.ada, "/cancel", &json!({ "text": "no" }))
        .await
        .good();
    let mut new = parties.new_order();
    new["offer"] = json!({ "firms": [strange] });
    let refused = parties.ada.post("/work-orders", &new).await;
    assert_eq!(refused.problem(), "invalid");
    let orders = parties.ada.get("/work-orders").await.good();
    assert_eq!(orders["items"].as_array().unwrap().len(), 1);
    new["offer"] = json!({ "firms": [rosas] });
    let request = || parties.ada.request(Method::POST, "/work-orders").json(&new);
    let made = ApiResponse::send(request().header("Idempotency-Key", "1"))
        .await
        .good();
    assert_eq!(made["state"], "offered");
    let repeated = ApiResponse::send(request().header("Idempotency-Key", "1"))
        .await
        .good();
    assert_eq!(made["id"], repeated["id"]);
    server.finish().await;
}
