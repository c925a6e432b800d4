//! Mail: from an alert to a person's relay.

use crate::alerts::{limit, with_model};
use crate::on_both;
use crate::support::{Answer, Letter, Person, Relay, Shore};
use binnacle_fleet::alerts;
use binnacle_planning::reports;
use binnacle_platform::config;
use binnacle_platform::mail::Mailer;
use binnacle_platform::outbox::{self, Sent};
use reqwest::Method;
use serde_json::{Value, json};
use std::process::Command;
use std::time::Duration;

on_both!(
    a_letter_says_ship_and_what_to_do_and_where_to_look,
    a_letter_comes_when_an_alert_is_raised_gets_worse_and_is_over,
    a_recipient_hears_of_nothing_less_bad_than_asked,
    names_make_no_headers_and_come_through_whole,
    a_recipient_is_added_once_changed_and_removed,
    another_operators_recipients_are_not_there,
);

pub(crate) const DAY_S: f64 = 86_400.0;
/// Long enough to talk to a relay in this process, short enough to wait for.
const PATIENCE: Duration = Duration::from_millis(1500);

/// What sends to a relay in this process.
pub(crate) fn mailer(relay: &Relay) -> Mailer {
    let config = config::Mail {
        smtp_url: Some(format!("smtp://localhost:{}?tls=none", relay.port)),
        smtp_ca: None,
        mail_from: Some("Binnacle <alerts@binnacle.example>".to_owned()),
        public_url: Some("https://binnacle.example/".to_owned()),
    };
    let mailer = Mailer::new(&config).unwrap().unwrap();
    let mailer = mailer.with_list(reports::MAILING_LIST);
    mailer.with_patience(PATIENCE)
}

pub(crate) async fn add(person: &Person, address: &str, severity: &str) -> Value {
    let new = json!({ "address": address, "severity": severity });
    person.post("/mail-recipients", &new).await.good()
}

pub(crate) fn path(recipient: &Value, rest: &str) -> String {
    format!(
        "/mail-recipients/{}{rest}",
        recipient["id"].as_str().unwrap()
    )
}

pub(crate) async fn test(person: &Person, recipient: &Value) -> Value {
    person
        .post(&path(recipient, "/test"), &json!({}))
        .await
        .good()
}

/// Sends every letter that is due now.
pub(crate) async fn deliver(shore: &Shore, relay: &Relay) -> Vec<Sent> {
    let mailer = mailer(relay);
    let mut sent = Vec::new();
    while let Some(done) = outbox::step(&shore.app, &mailer).await.unwrap() {
        sent.push(done);
    }
    sent
}

/// A letter as Python's mail parser reads it: headers by name, and `text`.
pub(crate) fn read(letter: &Letter) -> Value {
    let program = "import email, email.policy, json, sys\n\
        m = email.message_from_bytes(sys.argv[1].encode(), policy=email.policy.default)\n\
        assert not m.defects, m.defects\n\
        read = {k.lower(): str(v) for k, v in m.items()}\n\
        assert len(read) == len(m.items()), m.items()\n\
        read['text'] = m.get_content()\n\
        print(json.dumps(read))";
    let done = Command::new("python3")
        .args(["-c", program, &letter.text])
        .output()
        .unwrap();
    let problem = String::from_utf8_lossy(&done.stderr);
    assert!(done.status.success(), "{problem}\n{}", letter.text);
    serde_json::from_slice(&done.stdout).unwrap()
}

pub(crate) fn subjects(relay: &Relay) -> Vec<String> {
    let got = relay.got();
    let subjects = got.iter().map(|letter| read(letter)["subject"].take());
    subjects
        .map(|subject| subject.as_str().unwrap().to_owned())
        .collect()
}

async fn a_letter_says_ship_and_what_to_do_and_where_to_look(shore: Shore) {
    let ada = shore.admin("ada").await;
    let relay = Relay::start().await;
    let bridge = add(&ada, "bridge@example.com", "warning").await;
    let nao = with_model(&shore, &ada).await;
    limit(&shore, &ada, &nao, json!({ "deviation_deg": 2.5 })).await;
    assert_eq!(deliver(&shore, &relay).await, [Sent::Delivered]);

    let letter = relay.got().remove(0);
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
    shore.finish().await;
}

async fn a_letter_comes_when_an_alert_is_raised_gets_worse_and_is_over(shore: Shore) {
    let ada = shore.admin("ada").await;
    let relay = Relay::start().await;
    add(&ada, "bridge@example.com", "notice").await;
    let nao = with_model(&shore, &ada).await;
    // Other words, worse, less bad, as bad as before, over.
    for deviation_deg in [2.5, 2.4, 1.0, 2.5, 1.0, 45.0] {
        limit(
            &shore,
            &ada,
            &nao,
            json!({ "deviation_deg": deviation_deg }),
        )
        .await;
    }
    deliver(&shore, &relay).await;
    let expected = [
        "Nao: warning, deviation over the limit",
        "Nao: critical, deviation over the limit",
        "Nao: over, deviation over the limit",
    ];
    assert_eq!(subjects(&relay), expected);
    let got: Vec<Value> = relay.got().iter().map(read).collect();
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

    // The same cause again is another alert, and is told again.
    limit(&shore, &ada, &nao, json!({ "deviation_deg": 2.5 })).await;
    assert_eq!(deliver(&shore, &relay).await, [Sent::Delivered]);
    let alert = ada.get("/alerts?open=true").await.good()["items"][0].clone();
    let at = |rest: &str| format!("/alerts/{}{rest}", alert["id"].as_str().unwrap());
    ada.post(&at("/acknowledge"), &json!({})).await.good();
    assert_eq!(deliver(&shore, &relay).await, []);
    ada.post(&at("/clear"), &json!({ "reason": "Adjusted" }))
        .await
        .good();
    assert_eq!(deliver(&shore, &relay).await, [Sent::Delivered]);
    let last = read(&relay.got().pop().unwrap());
    assert!(
        last["text"]
            .as_str()
            .unwrap()
            .contains("Cleared by ada@example.com: Adjusted")
    );
    shore.finish().await;
}

async fn a_recipient_hears_of_nothing_less_bad_than_asked(shore: Shore) {
    let ada = shore.admin("ada").await;
    let eve = shore.admin("eve").await;
    let relay = Relay::start().await;
    add(&ada, "master@example.com", "critical").await;
    add(&eve, "eve@example.com", "notice").await;
    let nao = with_model(&shore, &ada).await;
    limit(&shore, &ada, &nao, json!({ "deviation_deg": 2.5 })).await;
    assert_eq!(deliver(&shore, &relay).await, []);
    limit(&shore, &ada, &nao, json!({ "deviation_deg": 1.0 })).await;
    // Told of the worst, the master is told once that it is not so bad any more.
    limit(&shore, &ada, &nao, json!({ "deviation_deg": 2.9 })).await;
    limit(&shore, &ada, &nao, json!({ "deviation_deg": 45.0 })).await;
    assert_eq!(deliver(&shore, &relay).await, [Sent::Delivered; 2]);
    let expected = [
        "Nao: critical, deviation over the limit",
        "Nao: only warning now, deviation over the limit",
    ];
    assert_eq!(subjects(&relay), expected);
    let sunk = read(&relay.got().pop().unwrap());
    let text = sunk["text"].as_str().unwrap();
    assert!(
        text.contains("Severity: warning (critical before)"),
        "{text}"
    );
    // What is as bad as asked until it is over is told to be over.
    limit(&shore, &ada, &nao, json!({ "deviation_deg": 1.0 })).await;
    limit(&shore, &ada, &nao, json!({ "deviation_deg": 45.0 })).await;
    deliver(&shore, &relay).await;
    let expected = [
        "Nao: critical, deviation over the limit",
        "Nao: over, deviation over the limit",
    ];
    assert_eq!(subjects(&relay)[2..], expected);
    shore.finish().await;
}

async fn names_make_no_headers_and_come_through_whole(shore: Shore) {
    let ada = shore.admin("ada").await;
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
        shore.ship(&ada, name).await;
    }
    add(&ada, "bridge@example.com", "notice").await;
    shore.advance(4.0 * DAY_S);
    alerts::check_silence(&shore.app).await.unwrap();
    assert_eq!(deliver(&shore, &relay).await, [Sent::Delivered; 3]);
    let mut got: Vec<Value> = relay.got().iter().map(read).collect();
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
    for letter in relay.got() {
        assert!(letter.text.is_ascii(), "{}", letter.text);
        assert!(letter.text.lines().all(|line| line.len() <= 998));
        assert_eq!(letter.to, ["<bridge@example.com>"]);
    }
    shore.finish().await;
}

async fn a_recipient_is_added_once_changed_and_removed(shore: Shore) {
    let ada = shore.admin("ada").await;
    let new = json!({ "address": "Bridge@Example.com" });
    let twice = || {
        let request = ada.request(Method::POST, "/mail-recipients").json(&new);
        Answer::of(request.header("idempotency-key", "one"))
    };
    let made = twice().await.good();
    assert_eq!(twice().await.good(), made);
    assert_eq!(
        (&made["address"], &made["severity"]),
        (&json!("Bridge@example.com"), &json!("warning"))
    );
    let again = ada.post("/mail-recipients", &new).await;
    assert_eq!(again.problem(), "invalid");
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
    let wanted = json!({ "severity": "critical" });
    let request = ada.request(Method::PUT, &path(&made, "")).json(&wanted);
    let changed = Answer::of(request).await.good();
    assert_eq!(changed["severity"], "critical");
    let viewer = ada.viewer(&shore).await;
    assert_eq!(viewer.get("/mail-recipients").await.status, 200);
    for (method, rest) in [(Method::DELETE, ""), (Method::POST, "/test")] {
        let refused = Answer::of(viewer.request(method, &path(&made, rest))).await;
        assert_eq!(refused.problem(), "forbidden");
    }
    let removed = Answer::of(ada.request(Method::DELETE, &path(&made, ""))).await;
    assert_eq!(removed.status, 204);
    assert_eq!(ada.get(&path(&made, "")).await.problem(), "not-found");
    shore.finish().await;
}

async fn another_operators_recipients_are_not_there(shore: Shore) {
    let ada = shore.admin("ada").await;
    let eve = shore.admin("eve").await;
    let bridge = add(&ada, "bridge@example.com", "warning").await;
    let letter = test(&ada, &bridge).await;
    let resend = format!("/deliveries/{}/resend", letter["id"].as_str().unwrap());
    let wanted = json!({ "severity": "notice" });
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
            .json(&wanted);
        let answer = Answer::of(request).await;
        assert_eq!(answer.problem(), "not-found", "{method} {rest}");
    }
    // A webhook's path finds no recipient, nor the other way round.
    let webhook = format!("/webhooks/{}", bridge["id"].as_str().unwrap());
    let removed = Answer::of(ada.request(Method::DELETE, &webhook)).await;
    assert_eq!(removed.problem(), "not-found");
    assert_eq!(eve.get("/mail-recipients").await.good()["items"], json!([]));
    shore.finish().await;
}
