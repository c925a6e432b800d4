//! How a firm hears of its orders: live, and by webhooks of its own.

use axum::http::StatusCode;
use binnacle_orders::dispatch::lapse;
use binnacle_platform::outbox::Sent;
use binnacle_server_testing::DAY_S;
use binnacle_server_testing::HOUR_S;
use binnacle_server_testing::Shore;
use binnacle_server_testing::offers::{Trade, proposal};
use binnacle_server_testing::on_both;
use binnacle_server_testing::webhooks::{Receiver, deliver, example_says, make, path};
use reqwest::Method;
use serde_json::{Value, json};

on_both!(
    a_firms_webhook_hears_of_its_orders_signed_and_in_order,
    the_operators_webhook_hears_of_every_answer,
    a_message_that_is_not_taken_holds_up_its_own_order_only,
    a_dead_letter_of_a_firms_is_sent_again,
    a_firm_has_no_webhook_for_alerts_and_sees_only_its_own,
    a_firm_follows_its_own_orders_live,
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

async fn a_firms_webhook_hears_of_its_orders_signed_and_in_order(shore: Shore) {
    let trade = Trade::planned(&shore, 2).await;
    let [(_, rosa), (_, juan)] = &trade.firms[..] else {
        unreachable!("there are two")
    };
    let (receiver, url) = Receiver::start().await;
    let webhook = make(rosa, &url, &ALL).await;
    let mut offer = trade.offer();
    offer["at_once"] = json!(true);
    trade.post(&trade.ada, "/offer", &offer).await.good();
    trade.post(rosa, "/propose", &proposal()).await.good();
    let asked = json!({ "firm_id": trade.firms[1].0, "text": "And you?" });
    trade.post(&trade.ada, "/messages", &asked).await;
    trade.post(juan, "/accept", &json!({})).await.good();
    trade.post(juan, "/on-board", &json!({})).await.good();
    deliver(&shore).await;
    assert_eq!(
        receiver.kinds(),
        ["order.offered", "order.answered", "order.withdrawn"]
    );
    let secret = webhook["secret"].as_str().unwrap();
    for (signature, body) in receiver.got() {
        let now_s = shore.app.clock.now().micros() / 1_000_000;
        assert!(example_says(secret, &signature, &body, now_s), "{body}");
        assert!(!example_says("bns_other", &signature, &body, now_s));
    }
    let (_, last) = receiver.got().pop().unwrap();
    let last: Value = serde_json::from_str(&last).unwrap();
    assert_eq!(last["work_order"]["id"], trade.order.as_str());
    assert_eq!(last["work_order"]["state"], "cancelled");
    assert!(!last.to_string().contains("juan"), "{last}");
    shore.finish().await;
}

async fn the_operators_webhook_hears_of_every_answer(shore: Shore) {
    let trade = Trade::planned(&shore, 2).await;
    let (receiver, url) = Receiver::start().await;
    make(&trade.ada, &url, &ALL).await;
    trade
        .post(&trade.ada, "/offer", &trade.offer())
        .await
        .good();
    shore.advance(HOUR_S + 1.0);
    lapse(&shore.app).await.unwrap();
    let juan = &trade.firms[1].1;
    trade.post(juan, "/accept", &json!({})).await.good();
    trade
        .post(&trade.ada, "/cancel", &json!({ "text": "sold" }))
        .await
        .good();
    deliver(&shore).await;
    let told = [
        "order.offered",
        "order.lapsed",
        "order.offered",
        "order.answered",
        "order.cancelled",
    ];
    assert_eq!(receiver.kinds(), told);
    let (_, answered) = receiver.got()[3].clone();
    let answered: Value = serde_json::from_str(&answered).unwrap();
    assert_eq!(answered["entry"]["kind"], "accepted");
    assert_eq!(answered["entry"]["firm_id"], trade.firms[1].0.to_string());
    assert_eq!(answered["work_order"]["state"], "accepted");
    shore.finish().await;
}

async fn a_message_that_is_not_taken_holds_up_its_own_order_only(shore: Shore) {
    let mut trade = Trade::planned(&shore, 1).await;
    let rosa = trade.firms[0].1.clone();
    let (receiver, url) = Receiver::start().await;
    make(&rosa, &url, &["order.offered", "order.message"]).await;
    let ask = json!({ "firm_id": trade.firms[0].0, "text": "Which gate?" });
    let offer_and_ask = async |trade: &Trade| {
        let offered = trade.post(&trade.ada, "/offer", &trade.offer()).await;
        offered.good();
        let asked = trade.post(&trade.ada, "/messages", &ask).await;
        assert_eq!(asked.status, 204, "{asked:?}");
    };
    offer_and_ask(&trade).await;
    let first = trade.order.clone();
    let pinta = trade.ada.create_vessel("Pinta").await;
    pinta["id"].as_str().unwrap().clone_into(&mut trade.vessel);
    let path = format!("/vessels/{}/compasses", trade.vessel);
    let compasses = trade.ada.get(&path).await.good();
    let compass = compasses["items"][0]["id"].as_str().unwrap();
    compass.clone_into(&mut trade.compass);
    let new = trade.new_order();
    let made = trade.ada.post("/work-orders", &new).await.good();
    made["id"].as_str().unwrap().clone_into(&mut trade.order);
    offer_and_ask(&trade).await;

    receiver.answer(StatusCode::INTERNAL_SERVER_ERROR);
    let done = deliver(&shore).await;
    assert_eq!(done, [Sent::Failed, Sent::Delivered, Sent::Delivered]);
    let told = || {
        let got = receiver.got().into_iter().skip(1);
        let read = got.map(|(_, body)| serde_json::from_str::<Value>(&body).unwrap());
        let of = |body: Value| (body["work_order"]["id"].clone(), body["kind"].clone());
        read.map(of).collect::<Vec<_>>()
    };
    let both =
        |order: &str| ["order.offered", "order.message"].map(|kind| (json!(order), json!(kind)));
    assert_eq!(told(), both(&trade.order));
    shore.advance(13.0);
    assert_eq!(deliver(&shore).await, [Sent::Delivered; 2]);
    assert_eq!(told()[2..], both(&first));
    shore.finish().await;
}

async fn a_dead_letter_of_a_firms_is_sent_again(shore: Shore) {
    let trade = Trade::planned(&shore, 1).await;
    let rosa = trade.firms[0].1.clone();
    let (receiver, url) = Receiver::start().await;
    let webhook = make(&rosa, &url, &["order.offered"]).await;
    trade
        .post(&trade.ada, "/offer", &trade.offer())
        .await
        .good();
    receiver.answer(StatusCode::SERVICE_UNAVAILABLE);
    receiver.answer(StatusCode::SERVICE_UNAVAILABLE);
    assert_eq!(deliver(&shore).await, [Sent::Failed]);
    shore.advance(DAY_S + 1.0);
    assert_eq!(deliver(&shore).await, [Sent::Dead]);
    let rosa = binnacle_server_testing::Person::sign_in(&shore, rosa.operator, &rosa.email).await;
    let dead = rosa
        .get(&path(&webhook, "/deliveries?state=dead"))
        .await
        .good();
    let id = dead["items"][0]["id"].as_str().unwrap().to_owned();
    let again = path(&webhook, &format!("/deliveries/{id}/resend"));
    assert_eq!(rosa.post(&again, &json!({})).await.status, 202);
    assert_eq!(deliver(&shore).await, [Sent::Delivered]);
    assert_eq!(receiver.kinds().len(), 3);
    shore.finish().await;
}

async fn a_firm_has_no_webhook_for_alerts_and_sees_only_its_own(shore: Shore) {
    let trade = Trade::planned(&shore, 2).await;
    let [(_, rosa), (_, juan)] = &trade.firms[..] else {
        unreachable!("there are two")
    };
    let url = "http://127.0.0.1:9/hook";
    let new = json!({ "url": url, "kinds": ["alert.raised", "order.offered"] });
    assert_eq!(rosa.post("/webhooks", &new).await.problem(), "invalid");
    let webhook = make(rosa, url, &["order.offered"]).await;
    for other in [&trade.ada, juan] {
        assert_eq!(other.get("/webhooks").await.good()["items"], json!([]));
        let found = other.get(&path(&webhook, "")).await;
        assert_eq!(found.problem(), "not-found");
    }
    assert_eq!(rosa.get(&path(&webhook, "")).await.status, 200);
    shore.finish().await;
}

async fn a_firm_follows_its_own_orders_live(shore: Shore) {
    let trade = Trade::offered(&shore, 2).await;
    let [(_, rosa), (_, juan)] = &trade.firms[..] else {
        unreachable!("there are two")
    };
    let mut heard = Vec::new();
    for who in [rosa, juan] {
        let nil = "00000000-0000-0000-0000-000000000000";
        let request = who
            .request(Method::GET, "/events")
            .header("last-event-id", nil);
        let mut response = request.send().await.unwrap();
        if heard.is_empty() {
            // What was missed comes at once.
            let chunk = response.chunk().await.unwrap().unwrap();
            heard.push(String::from_utf8(chunk.to_vec()).unwrap());
        } else {
            // Nothing was missed: the first to come is of the offer that is made now.
            trade.post(rosa, "/decline", &json!({})).await;
            let chunk = response.chunk().await.unwrap().unwrap();
            heard.push(String::from_utf8(chunk.to_vec()).unwrap());
        }
    }
    for text in &heard {
        assert!(text.contains("work_order"), "{text}");
        assert!(text.contains(&trade.order), "{text}");
        assert_eq!(text.matches("event: vessel").count(), 1, "{text}");
    }
    shore.finish().await;
}
