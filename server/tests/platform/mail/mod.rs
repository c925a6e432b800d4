//! Alert mail, and its recipients.

mod retries;
mod tls;

use binnacle_fleet::alerts;
use binnacle_platform::outbox::Sent;
use binnacle_server_testing::DAY_S;
use binnacle_server_testing::alerts::{set_alert_limits, ship_with_model};
use binnacle_server_testing::mail::{add, deliver, path, read, subjects, test};
use binnacle_server_testing::on_both;
use binnacle_server_testing::{ApiResponse, Relay, TestServer};
use reqwest::Method;
use serde_json::{Value, json};

on_both!(
    an_alert_letter_names_vessel_advice_and_link,
    a_letter_is_sent_when_an_alert_is_raised_gets_worse_and_ends,
    a_recipient_gets_no_letter_below_the_chosen_severity,
    names_cannot_inject_headers_and_are_unchanged,
    a_recipient_is_added_once_changed_and_removed,
    another_operators_recipients_are_not_found,
);

async fn an_alert_letter_names_vessel_advice_and_link(server: TestServer) {
    let ada = server.admin("ada").await;
    let relay = Relay::start().await;
    let bridge = add(&ada, "bridge@example.com", "warning").await;
    let nao = ship_with_model(&server, &ada).await;
    set_alert_limits(&server, &ada, &nao, json!({ "deviation_deg": 2.5 })).await;
    assert_eq!(deliver(&server, &relay).await, [Sent::Delivered]);

    let letter = relay.letters().remove(0);
    assert_eq!(letter.from, "<alerts@binnacle.example>");
    assert_eq!(letter.to, ["<bridge@example.com>"]);
    let read = read(&letter);
    assert_eq!(read["subject"], "Nao: warning, deviation over the limit");
    assert_eq!(read["from"], "Binnacle <alerts@binnacle.example>");
    assert_eq!(read["to"], "bridge@example.com");
    assert_eq!(read["date"], "Sat, 21 Nov 2026 07:00:30 +0000");
    assert_eq!(read["auto-submitted"], "auto-generated");
    let alert = ada.get("/alerts").await.good()["items"][0].clone();
    let text = read["text"].as_str().unwrap();
    let unwrapped = text.split_whitespace().collect::<Vec<_>>().join(" ");
    for part in [
        "Vessel: Nao",
        "Severity: warning",
        "Since: 2026-11-17 01:50 UTC",
        alert["summary"].as_str().unwrap(),
        alert["advice"].as_str().unwrap(),
        alert["evidence"][0].as_str().unwrap(),
        &format!("https://binnacle.example/vessels/{} ", nao.id),
        "bridge@example.com is on your company's list for alerts from warning on",
        "https://binnacle.example/mail",
    ] {
        assert!(unwrapped.contains(part), "{part} is not in\n{text}");
    }
    assert!(
        text.lines().all(|line| line.chars().count() <= 80),
        "{text}"
    );

    let listed = ada.get(&path(&bridge, "/deliveries")).await.good();
    let delivery = &listed["items"][0];
    assert_eq!(
        (&delivery["state"], &delivery["last_status"]),
        (&json!("delivered"), &json!(250))
    );
    let id = delivery["id"].as_str().unwrap();
    assert!(read["message-id"].as_str().unwrap().contains(id), "{read}");
    server.finish().await;
}

async fn a_letter_is_sent_when_an_alert_is_raised_gets_worse_and_ends(server: TestServer) {
    let ada = server.admin("ada").await;
    let relay = Relay::start().await;
    add(&ada, "bridge@example.com", "notice").await;
    let nao = ship_with_model(&server, &ada).await;
    // New text, worse, better, as bad as before, over.
    for deviation_deg in [2.5, 2.4, 1.0, 2.5, 1.0, 45.0] {
        set_alert_limits(
            &server,
            &ada,
            &nao,
            json!({ "deviation_deg": deviation_deg }),
        )
        .await;
    }
    deliver(&server, &relay).await;
    let expected = [
        "Nao: warning, deviation over the limit",
        "Nao: critical, deviation over the limit",
        "Nao: over, deviation over the limit",
    ];
    assert_eq!(subjects(&relay), expected);
    let got: Vec<Value> = relay.letters().iter().map(read).collect();
    assert!(
        got.iter()
            .all(|letter| letter["references"] == got[0]["references"])
    );
    assert!(
        got[2]["text"]
            .as_str()
            .unwrap()
            .contains("Cleared by Binnacle: it is over")
    );

    // The same cause later is another alert, with a letter of its own.
    set_alert_limits(&server, &ada, &nao, json!({ "deviation_deg": 2.5 })).await;
    assert_eq!(deliver(&server, &relay).await, [Sent::Delivered]);
    let alert = ada.get("/alerts?open=true").await.good()["items"][0].clone();
    let at = |rest: &str| format!("/alerts/{}{rest}", alert["id"].as_str().unwrap());
    ada.post(&at("/acknowledge"), &json!({})).await.good();
    assert_eq!(deliver(&server, &relay).await, []);
    ada.post(&at("/clear"), &json!({ "reason": "Adjusted" }))
        .await
        .good();
    assert_eq!(deliver(&server, &relay).await, [Sent::Delivered]);
    let last = read(&relay.letters().pop().unwrap());
    assert!(
        last["text"]
            .as_str()
            .unwrap()
            .contains("Cleared by ada@example.com: Adjusted")
    );
    server.finish().await;
}

async fn a_recipient_gets_no_letter_below_the_chosen_severity(server: TestServer) {
    let ada = server.admin("ada").await;
    let eve = server.admin("eve").await;
    let relay = Relay::start().await;
    add(&ada, "master@example.com", "critical").await;
    add(&eve, "eve@example.com", "notice").await;
    let nao = ship_with_model(&server, &ada).await;
    set_alert_limits(&server, &ada, &nao, json!({ "deviation_deg": 2.5 })).await;
    assert_eq!(deliver(&server, &relay).await, []);
    set_alert_limits(&server, &ada, &nao, json!({ "deviation_deg": 1.0 })).await;
    // After the critical alert the master gets one letter about the lower severity.
    set_alert_limits(&server, &ada, &nao, json!({ "deviation_deg": 2.9 })).await;
    set_alert_limits(&server, &ada, &nao, json!({ "deviation_deg": 45.0 })).await;
    assert_eq!(deliver(&server, &relay).await, [Sent::Delivered; 2]);
    let expected = [
        "Nao: critical, deviation over the limit",
        "Nao: only warning now, deviation over the limit",
    ];
    assert_eq!(subjects(&relay), expected);
    let sunk = read(&relay.letters().pop().unwrap());
    let text = sunk["text"].as_str().unwrap();
    assert!(
        text.contains("Severity: warning (critical before)"),
        "{text}"
    );
    // An alert that was critical until its end gets a letter at its end.
    set_alert_limits(&server, &ada, &nao, json!({ "deviation_deg": 1.0 })).await;
    set_alert_limits(&server, &ada, &nao, json!({ "deviation_deg": 45.0 })).await;
    deliver(&server, &relay).await;
    let expected = [
        "Nao: critical, deviation over the limit",
        "Nao: over, deviation over the limit",
    ];
    assert_eq!(subjects(&relay)[2..], expected);
    server.finish().await;
}

async fn names_cannot_inject_headers_and_are_unchanged(server: TestServer) {
    let ada = server.admin("ada").await;
    let relay = Relay::start().await;
    for ending in ["\r\n", "\u{2028}", "\u{2029}"] {
        let injected = json!({ "name": format!("Nao{ending}Bcc: eve@example.com") });
        let refused = ada.post("/vessels", &injected).await;
        assert_eq!(refused.problem(), "invalid", "{ending:?}");
    }
    let names = [
        "Ñandú Ærø 北京号".to_owned(),
        "=?utf-8?q?Bcc=3A_eve?= <eve@example.com>, \"quoted\\".to_owned(),
        "Наш корабль ".repeat(16).trim().to_owned(),
    ];
    for name in &names {
        server.ship(&ada, name).await;
    }
    add(&ada, "bridge@example.com", "notice").await;
    server.advance(4.0 * DAY_S);
    alerts::check_silence(&server.app).await.unwrap();
    assert_eq!(deliver(&server, &relay).await, [Sent::Delivered; 3]);
    let mut got: Vec<Value> = relay.letters().iter().map(read).collect();
    for name in names {
        let subject = format!("{name}: notice, no data from the vessel").replace("=?", "= ?");
        let place = got
            .iter()
            .position(|read| read["subject"] == subject.as_str());
        let read = got.remove(place.unwrap_or_else(|| panic!("{subject} is not in {got:#?}")));
        assert_eq!(read["to"], "bridge@example.com");
        assert!(read.get("bcc").is_none() && read.get("cc").is_none());
        assert!(read["text"].as_str().unwrap().contains(&name), "{read}");
    }
    for letter in relay.letters() {
        assert!(letter.text.is_ascii(), "{}", letter.text);
        assert!(letter.text.lines().all(|line| line.len() <= 998));
        assert_eq!(letter.to, ["<bridge@example.com>"]);
    }
    server.finish().await;
}

async fn a_recipient_is_added_once_changed_and_removed(server: TestServer) {
    let ada = server.admin("ada").await;
    let new = json!({ "address": "Bridge@Example.com" });
    let twice = || {
        let request = ada.request(Method::POST, "/mail-recipients").json(&new);
        ApiResponse::send(request.header("idempotency-key", "one"))
    };
    let made = twice().await.good();
    assert_eq!(twice().await.good(), made);
    assert_eq!(
        (&made["address"], &made["severity"]),
        (&json!("Bridge@example.com"), &json!("warning"))
    );
    let repeated = ada.post("/mail-recipients", &new).await;
    assert_eq!(repeated.problem(), "invalid");
    let listed = ada.get("/mail-recipients").await.good();
    assert_eq!(
        (&listed["items"], &listed["sending"]),
        (&json!([made]), &json!(true))
    );
    for bad in [
        json!({ "address": "nobody" }),
        json!({ "address": "a@example.com\r\nBcc: b@example.com" }),
        json!({ "address": "a@example.com", "severity": "dire" }),
    ] {
        assert_eq!(
            ada.post("/mail-recipients", &bad).await.problem(),
            "invalid"
        );
    }
    let change = json!({ "severity": "critical" });
    let request = ada.request(Method::PUT, &path(&made, "")).json(&change);
    let changed = ApiResponse::send(request).await.good();
    assert_eq!(changed["severity"], "critical");
    let viewer = ada.viewer(&server).await;
    assert_eq!(viewer.get("/mail-recipients").await.status, 200);
    for (method, rest) in [(Method::DELETE, ""), (Method::POST, "/test")] {
        let refused = ApiResponse::send(viewer.request(method, &path(&made, rest))).await;
        assert_eq!(refused.problem(), "forbidden");
    }
    let removed = ApiResponse::send(ada.request(Method::DELETE, &path(&made, ""))).await;
    assert_eq!(removed.status, 204);
    assert_eq!(ada.get(&path(&made, "")).await.problem(), "not-found");
    server.finish().await;
}

async fn another_operators_recipients_are_not_found(server: TestServer) {
    let ada = server.admin("ada").await;
    let eve = server.admin("eve").await;
    let bridge = add(&ada, "bridge@example.com", "warning").await;
    let letter = test(&ada, &bridge).await;
    let resend = format!("/deliveries/{}/resend", letter["id"].as_str().unwrap());
    let change = json!({ "severity": "notice" });
    for (method, rest) in [
        (Method::GET, ""),
        (Method::PUT, ""),
        (Method::DELETE, ""),
        (Method::POST, "/test"),
        (Method::GET, "/deliveries"),
        (Method::POST, &resend),
    ] {
        let request = eve
            .request(method.clone(), &path(&bridge, rest))
            .json(&change);
        let response = ApiResponse::send(request).await;
        assert_eq!(response.problem(), "not-found", "{method} {rest}");
    }
    // A webhook's path does not find a recipient.
    let webhook = format!("/webhooks/{}", bridge["id"].as_str().unwrap());
    let removed = ApiResponse::send(ada.request(Method::DELETE, &webhook)).await;
    assert_eq!(removed.problem(), "not-found");
    assert_eq!(eve.get("/mail-recipients").await.good()["items"], json!([]));
    server.finish().await;
}
