//! Notice of orders to a firm: live events, and the firm's own webhooks.

use axum::http::StatusCode;
use binnacle_orders::dispatch::lapse;
use binnacle_platform::outbox::Sent;
use binnacle_server_testing::DAY_S;
use binnacle_server_testing::HOUR_S;
use binnacle_server_testing::TestServer;
use binnacle_server_testing::offers::{OfferParties, proposal};
use binnacle_server_testing::on_both;
use binnacle_server_testing::webhooks::{Receiver, deliver, example_accepts, make, path};
use reqwest::Method;
use serde_json::{Value, json};

on_both!(
    a_firms_webhook_gets_signed_events_of_its_orders_in_order,
    the_operators_webhook_gets_every_response,
    a_failing_delivery_delays_only_its_own_order,
    a_firm_can_resend_its_dead_letter,
    a_firm_cannot_subscribe_to_alerts_and_sees_only_its_webhooks,
    a_firm_gets_live_events_of_its_orders,
);

const ALL: [&str; 11] = [
    "order.offered",
    "order.answered",
    "order.lapsed",
    "order.withdrawn",
    "order.message",
    "order.updated",
    "order.completed",
    "order.verified",
    "order.failed",
    "order.closed",
    "order.cancelled",
];

async fn a_firms_webhook_gets_signed_events_of_its_orders_in_order(server: TestServer) {
    let parties = OfferParties::planned(&server, 2).await;
    let [(_, rosa), (_, juan)] = &parties.firms[..] else {
        unreachable!("there are two")
    };
    let (receiver, url) = Receiver::start().await;
    let webhook = make(rosa, &url, &ALL).await;
    let mut offer = parties.offer();
    offer["at_once"] = json!(true);
    parties.post(&parties.ada, "/offer", &offer).await.good();
    parties.post(rosa, "/propose", &proposal()).await.good();
    let message = json!({ "firm_id": parties.firms[1].0, "text": "And you?" });
    parties.post(&parties.ada, "/messages", &message).await;
    parties.post(juan, "/accept", &json!({})).await.good();
    parties.post(juan, "/on-board", &json!({})).await.good();
    deliver(&server).await;
    assert_eq!(
        receiver.kinds(),
        ["order.offered", "order.answered", "order.withdrawn"]
    );
    let secret = webhook["secret"].as_str().unwrap();
    for (signature, body) in receiver.received() {
        let now_s = server.app.clock.now().micros() / 1_000_000;
        assert!(example_accepts(secret, &signature, &body, now_s), "{body}");
        assert!(!example_accepts("bns_other", &signature, &body, now_s));
    }
    let (_, last) = receiver.received().pop().unwrap();
    let last: Value = serde_json::from_str(&last).unwrap();
    assert_eq!(last["work_order"]["id"], parties.order.as_str());
    assert_eq!(last["work_order"]["state"], "cancelled");
    assert!(!last.to_string().contains("juan"), "{last}");
    server.finish().await;
}

async fn the_operators_webhook_gets_every_response(server: TestServer) {
    let parties = OfferParties::planned(&server, 2).await;
    let (receiver, url) = Receiver::start().await;
    make(&parties.ada, &url, &ALL).await;
    parties
        .post(&parties.ada, "/offer", &parties.offer())
        .await
        .good();
    server.advance(HOUR_S + 1.0);
    lapse(&server.app).await.unwrap();
    let juan = &parties.firms[1].1;
    parties.post(juan, "/accept", &json!({})).await.good();
    parties
        .post(&parties.ada, "/cancel", &json!({ "text": "sold" }))
        .await
        .good();
    deliver(&server).await;
    let kinds = [
        "order.offered",
        "order.lapsed",
        "order.offered",
        "order.answered",
        "order.cancelled",
    ];
    assert_eq!(receiver.kinds(), kinds);
    let (_, answered) = receiver.received()[3].clone();
    let answered: Value = serde_json::from_str(&answered).unwrap();
    assert_eq!(answered["entry"]["kind"], "accepted");
    assert_eq!(answered["entry"]["firm_id"], parties.firms[1].0.to_string());
    assert_eq!(answered["work_order"]["state"], "accepted");
    let words = &answered["words"];
    let vessel = answered["work_order"]["vessel_name"].as_str().unwrap();
    assert_eq!(words["headline"], format!("{vessel}: work order, accepted"));
    assert_eq!(words["path"], format!("/work-orders/{}", parties.order));
    let text = words["text"].as_str().unwrap();
    for part in ["compass_name", "port", "planned_at_local"] {
        let said = answered["work_order"][part].as_str().unwrap();
        assert!(text.contains(said), "{part}: {text}");
    }
    server.finish().await;
}

async fn a_failing_delivery_delays_only_its_own_order(server: TestServer) {
    let mut parties = OfferParties::planned(&server, 1).await;
    let rosa = parties.firms[0].1.clone();
    let (receiver, url) = Receiver::start().await;
    make(&rosa, &url, &["order.offered", "order.message"]).await;
    let ask = json!({ "firm_id": parties.firms[0].0, "text": "Which gate?" });
    let offer_and_ask = async |parties: &OfferParties| {
        let offered = parties.post(&parties.ada, "/offer", &parties.offer()).await;
        offered.good();
        let message = parties.post(&parties.ada, "/messages", &ask).await;
        assert_eq!(message.status, 204, "{message:?}");
    };
    offer_and_ask(&parties).await;
    let first = parties.order.clone();
    let pinta = parties.ada.create_vessel("Pinta").await;
    pinta["id"]
        .as_str()
        .unwrap()
        .clone_into(&mut parties.vessel);
    let path = format!("/vessels/{}/compasses", parties.vessel);
    let compasses = parties.ada.get(&path).await.good();
    let compass = compasses["items"][0]["id"].as_str().unwrap();
    compass.clone_into(&mut parties.compass);
    let new = parties.new_order();
    let made = parties.ada.post("/work-orders", &new).await.good();
    made["id"].as_str().unwrap().clone_into(&mut parties.order);
    offer_and_ask(&parties).await;

    receiver.respond_next(StatusCode::INTERNAL_SERVER_ERROR);
    let done = deliver(&server).await;
    assert_eq!(done, [Sent::Failed, Sent::Delivered, Sent::Delivered]);
    let delivered = || {
        let got = receiver.received().into_iter().skip(1);
        let read = got.map(|(_, body)| serde_json::from_str::<Value>(&body).unwrap());
        let of = |body: Value| (body["work_order"]["id"].clone(), body["kind"].clone());
        read.map(of).collect::<Vec<_>>()
    };
    let both =
        |order: &str| ["order.offered", "order.message"].map(|kind| (json!(order), json!(kind)));
    assert_eq!(delivered(), both(&parties.order));
    server.advance(13.0);
    assert_eq!(deliver(&server).await, [Sent::Delivered; 2]);
    assert_eq!(delivered()[2..], both(&first));
    server.finish().await;
}

async fn a_firm_can_resend_its_dead_letter(server: TestServer) {
    let parties = OfferParties::planned(&server, 1).await;
    let rosa = parties.firms[0].1.clone();
    let (receiver, url) = Receiver::start().await;
    let webhook = make(&rosa, &url, &["order.offered"]).await;
    parties
        .post(&parties.ada, "/offer", &parties.offer())
        .await
        .good();
    receiver.respond_next(StatusCode::SERVICE_UNAVAILABLE);
    receiver.respond_next(StatusCode::SERVICE_UNAVAILABLE);
    assert_eq!(deliver(&server).await, [Sent::Failed]);
    server.advance(DAY_S + 1.0);
    assert_eq!(deliver(&server).await, [Sent::Dead]);
    let rosa = binnacle_server_testing::Person::sign_in(&server, rosa.operator, &rosa.email).await;
    let dead = rosa
        .get(&path(&webhook, "/deliveries?state=dead"))
        .await
        .good();
    let id = dead["items"][0]["id"].as_str().unwrap().to_owned();
    let repeated = path(&webhook, &format!("/deliveries/{id}/resend"));
    assert_eq!(rosa.post(&repeated, &json!({})).await.status, 202);
    assert_eq!(deliver(&server).await, [Sent::Delivered]);
    assert_eq!(receiver.kinds().len(), 3);
    server.finish().await;
}

async fn a_firm_cannot_subscribe_to_alerts_and_sees_only_its_webhooks(server: TestServer) {
    let parties = OfferParties::planned(&server, 2).await;
    let [(_, rosa), (_, juan)] = &parties.firms[..] else {
        unreachable!("there are two")
    };
    let url = "http://127.0.0.1:9/hook";
    let new = json!({ "url": url, "kinds": ["alert.raised", "order.offered"] });
    assert_eq!(rosa.post("/webhooks", &new).await.problem(), "invalid");
    let webhook = make(rosa, url, &["order.offered"]).await;
    for other in [&parties.ada, juan] {
        assert_eq!(other.get("/webhooks").await.good()["items"], json!([]));
        let found = other.get(&path(&webhook, "")).await;
        assert_eq!(found.problem(), "not-found");
    }
    assert_eq!(rosa.get(&path(&webhook, "")).await.status, 200);
    server.finish().await;
}

async fn a_firm_gets_live_events_of_its_orders(server: TestServer) {
    let parties = OfferParties::offered(&server, 2).await;
    let [(_, rosa), (_, juan)] = &parties.firms[..] else {
        unreachable!("there are two")
    };
    let mut events = Vec::new();
    for who in [rosa, juan] {
        let nil = "00000000-0000-0000-0000-000000000000";
        let request = who
            .request(Method::GET, "/events")
            .header("last-event-id", nil);
        let mut response = request.send().await.unwrap();
        if events.is_empty() {
            // Missed events come at once.
            let chunk = response.chunk().await.unwrap().unwrap();
            events.push(String::from_utf8(chunk.to_vec()).unwrap());
        } else {
            // Nothing was missed: the first event is about the new offer.
            parties.post(rosa, "/decline", &json!({})).await;
            let chunk = response.chunk().await.unwrap().unwrap();
            events.push(String::from_utf8(chunk.to_vec()).unwrap());
        }
    }
    for text in &events {
        assert!(text.contains("work_order"), "{text}");
        assert!(text.contains(&parties.order), "{text}");
        assert_eq!(text.matches("event: vessel").count(), 1, "{text}");
    }
    server.finish().await;
}
