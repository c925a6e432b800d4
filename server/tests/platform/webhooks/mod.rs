//! Webhooks that deliver alerts to an operator's program.

mod slow_receivers;

use axum::http::StatusCode;
use axum::response::Redirect;
use binnacle_fleet::alerts;
use binnacle_platform::outbound::Reach;
use binnacle_platform::outbox::{self, Sent};
use binnacle_platform::webhooks::Sender;
use binnacle_server_testing::DAY_S;
use binnacle_server_testing::on_both;
use binnacle_server_testing::webhooks::{Receiver, deliver, example_accepts, json_of, make, path};
use binnacle_server_testing::{ApiResponse, Person, TestServer};
use reqwest::Method;
use serde_json::{Value, json};

on_both!(
    an_alert_is_delivered_with_a_signature,
    a_chat_gets_an_alert_in_words,
    unsubscribed_events_are_not_sent,
    messages_are_delivered_in_order_after_the_previous_one,
    a_receiver_down_for_a_day_leaves_a_dead_letter_that_can_be_resent,
    a_delivery_in_progress_is_not_claimed_by_another_server,
    a_redirect_is_a_failure_and_is_not_followed,
    nothing_is_sent_to_a_private_address,
    a_webhook_is_created_once_changed_and_removed,
    an_invalid_webhook_is_refused,
    another_operators_webhooks_are_not_found,
);

/// Raises an alert by a silent vessel, and signs the person in again.
async fn raise_alert(server: &TestServer, person: &Person) -> Person {
    server.ship(person, "Nao").await;
    server.advance(4.0 * DAY_S);
    alerts::check_silence(&server.app).await.unwrap();
    Person::sign_in(server, person.operator, &person.email).await
}

async fn an_alert_is_delivered_with_a_signature(server: TestServer) {
    let ada = server.admin("ada").await;
    let (receiver, url) = Receiver::start().await;
    let webhook = make(&ada, &url, &["alert.raised"]).await;
    let ada = raise_alert(&server, &ada).await;
    assert_eq!(deliver(&server).await, [Sent::Delivered]);

    let (signature, body) = receiver.received().remove(0);
    let message = json_of(&body);
    let alert = ada.get("/alerts").await.good()["items"][0].clone();
    assert_eq!(
        (&message["kind"], &message["alert"]),
        (&json!("alert.raised"), &alert)
    );
    let secret = webhook["secret"].as_str().unwrap();
    let now_s = server.app.clock.now().micros() / 1_000_000;
    assert!(
        example_accepts(secret, &signature, &body, now_s),
        "{signature}"
    );
    assert!(!example_accepts("bns_other", &signature, &body, now_s));
    assert!(!example_accepts(
        secret,
        &signature,
        &body.replace("raised", "closed"),
        now_s
    ));
    assert!(
        !example_accepts(secret, &signature, &body, now_s + 301),
        "it is old"
    );
    assert!(!example_accepts(secret, "v1=abc", &body, now_s));

    let listed = ada.get(&path(&webhook, "/deliveries")).await.good();
    let delivery = &listed["items"][0];
    assert_eq!(
        (&delivery["id"], &delivery["state"]),
        (&message["id"], &json!("delivered"))
    );
    assert_eq!(
        (&delivery["attempts"], &delivery["last_status"]),
        (&json!(1), &json!(200))
    );
    assert_eq!(delivery["body"], message);
    server.finish().await;
}

async fn a_chat_gets_an_alert_in_words(server: TestServer) {
    let ada = server.admin("ada").await;
    let (receiver, url) = Receiver::start().await;
    let new = json!({ "url": url, "kinds": ["alert.raised"], "format": "slack" });
    let webhook = ada.post("/webhooks", &new).await.good();
    assert_eq!(webhook["format"], "slack");
    let ada = raise_alert(&server, &ada).await;
    assert_eq!(deliver(&server).await, [Sent::Delivered]);
    let (_, body) = receiver.received().remove(0);
    let alert = ada.get("/alerts").await.good()["items"][0].clone();
    let expected = format!(
        "*Nao: {}, {}*\n{}\n<https://binnacle.example/alerts#{}|Open in Binnacle>",
        alert["severity"].as_str().unwrap(),
        "no data from the vessel",
        alert["summary"].as_str().unwrap(),
        alert["id"].as_str().unwrap(),
    );
    assert_eq!(json_of(&body), json!({ "text": expected }));

    let changed = json!({ "url": url, "kinds": ["alert.raised"], "format": "teams" });
    let request = ada.request(Method::PUT, &path(&webhook, "")).json(&changed);
    assert_eq!(ApiResponse::send(request).await.good()["format"], "teams");
    ada.post(&path(&webhook, "/test"), &json!({})).await.good();
    assert_eq!(deliver(&server).await, [Sent::Delivered]);
    let (_, body) = receiver.received().remove(1);
    assert_eq!(json_of(&body)["type"], "message");
    let unknown = json!({ "url": url, "kinds": ["alert.raised"], "format": "irc" });
    assert_eq!(ada.post("/webhooks", &unknown).await.problem(), "invalid");
    server.finish().await;
}

async fn unsubscribed_events_are_not_sent(server: TestServer) {
    let ada = server.admin("ada").await;
    let eve = server.admin("eve").await;
    let (receiver, url) = Receiver::start().await;
    make(&ada, &url, &["alert.cleared"]).await;
    make(&eve, &url, &["alert.raised"]).await;
    let off = json!({ "url": url, "kinds": ["alert.raised"], "enabled": false });
    ada.post("/webhooks", &off).await.good();
    raise_alert(&server, &ada).await;
    assert_eq!(deliver(&server).await, []);
    assert_eq!(receiver.received(), []);
    server.finish().await;
}

async fn messages_are_delivered_in_order_after_the_previous_one(server: TestServer) {
    let ada = server.admin("ada").await;
    let (receiver, url) = Receiver::start().await;
    let kinds = ["alert.raised", "alert.acknowledged", "alert.cleared"];
    make(&ada, &url, &kinds).await;
    let ada = raise_alert(&server, &ada).await;
    let alert = ada.get("/alerts").await.good()["items"][0].clone();
    let at = |rest: &str| format!("/alerts/{}{rest}", alert["id"].as_str().unwrap());
    ada.post(&at("/acknowledge"), &json!({})).await.good();
    ada.post(&at("/clear"), &json!({ "reason": "Over" }))
        .await
        .good();

    receiver.respond_next(StatusCode::SERVICE_UNAVAILABLE);
    assert_eq!(deliver(&server).await, [Sent::Failed]);
    assert_eq!(deliver(&server).await, [], "before the pause is over");
    server.advance(13.0);
    assert_eq!(deliver(&server).await, [Sent::Delivered; 3]);
    let repeated = [
        "alert.raised",
        "alert.raised",
        "alert.acknowledged",
        "alert.cleared",
    ];
    assert_eq!(receiver.kinds(), repeated);
    let got = receiver.received();
    assert_eq!(got[0].1, got[1].1, "the same message, to the byte");
    assert_ne!(got[0].0, got[1].0, "signed anew");
    server.finish().await;
}

async fn a_receiver_down_for_a_day_leaves_a_dead_letter_that_can_be_resent(server: TestServer) {
    let ada = server.admin("ada").await;
    let (receiver, url) = Receiver::start().await;
    let webhook = make(&ada, &url, &["alert.raised"]).await;
    ada.post(&path(&webhook, "/test"), &json!({})).await.good();
    let (mut tries, mut last) = (0, None);
    while last != Some(Sent::Dead) {
        receiver.respond_next(StatusCode::INTERNAL_SERVER_ERROR);
        let sent = deliver(&server).await;
        last = sent.last().copied().or(last);
        tries += sent.len();
        assert!(tries < 50, "it is never given up");
        server.advance(1200.0);
    }
    assert!((25..=40).contains(&tries), "{tries} tries in a day");
    let ada = Person::sign_in(&server, ada.operator, &ada.email).await;
    assert_eq!(ada.get(&path(&webhook, "")).await.good()["dead"], 1);
    let dead = ada
        .get(&path(&webhook, "/deliveries?state=dead"))
        .await
        .good();
    let letter = dead["items"][0].clone();
    assert_eq!(letter["last_status"], 500);
    assert_eq!(letter["next_attempt_at"], Value::Null);

    receiver.respond_normally();
    let repeated = format!("/deliveries/{}/resend", letter["id"].as_str().unwrap());
    let queued = ada
        .post(&path(&webhook, &repeated), &json!({}))
        .await
        .good();
    assert_eq!(
        (&queued["state"], &queued["id"]),
        (&json!("pending"), &letter["id"])
    );
    assert_eq!(deliver(&server).await, [Sent::Delivered]);
    assert_eq!(
        receiver.received().last().unwrap().1,
        receiver.received()[0].1
    );
    let dead = ada
        .get(&path(&webhook, "/deliveries?state=dead"))
        .await
        .good();
    assert_eq!(dead["items"], json!([]));
    server.finish().await;
}

async fn a_delivery_in_progress_is_not_claimed_by_another_server(server: TestServer) {
    let ada = server.admin("ada").await;
    let (receiver, url) = Receiver::start().await;
    let webhook = make(&ada, &url, &["alert.raised"]).await;
    for _ in 0..2 {
        ada.post(&path(&webhook, "/test"), &json!({})).await.good();
    }
    let second = server.second_server().await;
    let sender = Sender::new(Reach::Anywhere).unwrap();
    let (one, other) = tokio::join!(
        outbox::step(&server.app, &sender),
        outbox::step(&second, &sender)
    );
    let sent = [one.unwrap(), other.unwrap()];
    assert!(sent.contains(&Some(Sent::Delivered)), "{sent:?}");
    deliver(&server).await;
    assert_eq!(receiver.received().len(), 2, "each once");
    second.db.close().await;
    server.finish().await;
}

async fn a_redirect_is_a_failure_and_is_not_followed(server: TestServer) {
    let ada = server.admin("ada").await;
    let (receiver, url) = Receiver::start().await;
    let (elsewhere, other) = Receiver::start().await;
    let webhook = make(&ada, &url, &["alert.raised"]).await;
    ada.post(&path(&webhook, "/test"), &json!({})).await.good();
    receiver.respond_next(Redirect::temporary(&other));
    assert_eq!(deliver(&server).await, [Sent::Failed]);
    assert_eq!(elsewhere.received(), []);
    let listed = ada.get(&path(&webhook, "/deliveries")).await.good();
    assert_eq!(
        listed["items"][0]["last_error"],
        "responded with status 307"
    );
    server.finish().await;
}

async fn nothing_is_sent_to_a_private_address(server: TestServer) {
    let ada = server.admin("ada").await;
    let (receiver, url) = Receiver::start().await;
    // Such a webhook may be older than the rule, or its name may resolve differently now.
    let by_name = url.replace("http://127.0.0.1", "https://localhost");
    for url in [url, by_name] {
        let webhook = make(&ada, &url, &["alert.raised"]).await;
        ada.post(&path(&webhook, "/test"), &json!({})).await.good();
        let sender = Sender::new(Reach::Public).unwrap();
        let sent = outbox::step(&server.app, &sender).await.unwrap();
        assert_eq!(sent, Some(Sent::Failed));
        let listed = ada.get(&path(&webhook, "/deliveries")).await.good();
        let problem = listed["items"][0]["last_error"]
            .as_str()
            .unwrap()
            .to_owned();
        let refused = problem.contains("not https") || problem.contains("public internet");
        assert!(refused, "{problem}");
    }
    assert_eq!(receiver.received(), []);
    server.finish().await;
}

async fn a_webhook_is_created_once_changed_and_removed(server: TestServer) {
    let ada = server.admin("ada").await;
    // A copied address may bring blanks along.
    let new =
        json!({ "url": " https://example.com/a\n", "kinds": ["alert.raised", "alert.raised"] });
    let twice = || {
        let request = ada.request(Method::POST, "/webhooks").json(&new);
        ApiResponse::send(request.header("idempotency-key", "one"))
    };
    let made = twice().await.good();
    assert_eq!(twice().await.good(), made);
    assert!(made["secret"].as_str().unwrap().starts_with("bns_"));
    assert_eq!(made["kinds"], json!(["alert.raised"]));
    let listed = ada.get("/webhooks").await.good();
    assert_eq!(listed["items"].as_array().unwrap().len(), 1);
    assert_eq!(listed["items"][0].get("secret"), None);

    let change =
        json!({ "url": "https://example.com/b", "kinds": ["alert.cleared"], "enabled": false });
    let request = ada.request(Method::PUT, &path(&made, "")).json(&change);
    let changed = ApiResponse::send(request).await.good();
    assert_eq!(
        (&changed["url"], &changed["enabled"]),
        (&change["url"], &json!(false))
    );
    let viewer = ada.viewer(&server).await;
    let refused = ApiResponse::send(viewer.request(Method::DELETE, &path(&made, ""))).await;
    assert_eq!(refused.problem(), "forbidden");
    let removed = ApiResponse::send(ada.request(Method::DELETE, &path(&made, ""))).await;
    assert_eq!(removed.status, 204);
    assert_eq!(ada.get(&path(&made, "")).await.problem(), "not-found");
    server.finish().await;
}

async fn an_invalid_webhook_is_refused(server: TestServer) {
    let ada = server.admin("ada").await;
    for (url, kinds) in [
        ("ftp://example.com/", json!(["alert.raised"])),
        ("not a url", json!(["alert.raised"])),
        ("https://exam\tple.com/", json!(["alert.raised"])),
        ("https://example.com/a b", json!(["alert.raised"])),
        ("https://example.com/\u{202e}", json!(["alert.raised"])),
        ("https://example.com/", json!([])),
        ("https://example.com/", json!(["test"])),
        ("https://example.com/", json!(["alert.exploded"])),
    ] {
        let response = ada
            .post("/webhooks", &json!({ "url": url, "kinds": kinds }))
            .await;
        assert_eq!(response.problem(), "invalid", "{url} {kinds}");
    }
    server.finish().await;
}

async fn another_operators_webhooks_are_not_found(server: TestServer) {
    let ada = server.admin("ada").await;
    let eve = server.admin("eve").await;
    let webhook = make(&ada, "https://example.com/", &["alert.raised"]).await;
    let test = ada.post(&path(&webhook, "/test"), &json!({})).await.good();
    let resend = format!("/deliveries/{}/resend", test["id"].as_str().unwrap());
    let change = json!({ "url": "https://example.com/", "kinds": ["alert.raised"] });
    for (method, rest) in [
        (Method::GET, ""),
        (Method::PUT, ""),
        (Method::DELETE, ""),
        (Method::POST, "/test"),
        (Method::GET, "/deliveries"),
        (Method::POST, &resend),
    ] {
        let request = eve
            .request(method.clone(), &path(&webhook, rest))
            .json(&change);
        assert_eq!(
            ApiResponse::send(request).await.problem(),
            "not-found",
            "{method} {rest}"
        );
    }
    assert_eq!(eve.get("/webhooks").await.good()["items"], json!([]));
    server.finish().await;
}
