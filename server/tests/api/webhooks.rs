//! Webhooks: from an alert to a program of the operator's.

use crate::on_both;
use crate::support::{Answer, Person, Shore};
use axum::Router;
use axum::body::Bytes;
use axum::extract::State;
use axum::http::{HeaderMap, StatusCode};
use axum::response::{IntoResponse, Redirect, Response};
use axum::routing::post;
use binnacle_fleet::alerts;
use binnacle_platform::outbound::Reach;
use binnacle_platform::outbox::{self, Sent};
use binnacle_platform::webhooks::{SIGNATURE_HEADER, Sender};
use reqwest::Method;
use serde_json::{Value, json};
use std::collections::VecDeque;
use std::process::Command;
use std::sync::{Arc, Mutex};

on_both!(
    an_alert_reaches_the_receiver_signed,
    what_was_not_asked_for_is_not_sent,
    messages_come_in_order_and_wait_for_the_one_before,
    a_receiver_that_is_away_for_a_day_leaves_a_dead_letter_that_can_be_sent_again,
    a_delivery_under_way_is_not_taken_by_another_server,
    a_redirect_is_a_failure_and_is_not_followed,
    nothing_is_sent_to_an_address_within_the_network,
    a_webhook_is_made_once_changed_and_removed,
    a_webhook_that_makes_no_sense_is_refused,
    another_operators_webhooks_are_not_there,
);

pub(crate) const DAY_S: f64 = 86_400.0;

/// A program that takes messages; it answers as it was told to, or 200.
#[derive(Clone, Default)]
pub(crate) struct Receiver {
    got: Arc<Mutex<Vec<(String, String)>>>,
    answers: Arc<Mutex<VecDeque<Response>>>,
}

impl Receiver {
    pub(crate) async fn start() -> (Receiver, String) {
        let receiver = Receiver::default();
        let listener = tokio::net::TcpListener::bind("127.0.0.1:0").await.unwrap();
        let url = format!("http://{}/hook", listener.local_addr().unwrap());
        let router = Router::new()
            .route("/hook", post(take))
            .with_state(receiver.clone());
        tokio::spawn(async move { axum::serve(listener, router).await });
        (receiver, url)
    }

    pub(crate) fn answer(&self, answer: impl IntoResponse) {
        self.answers
            .lock()
            .unwrap()
            .push_back(answer.into_response());
    }

    /// Signatures and bodies, in the order in which they came.
    pub(crate) fn got(&self) -> Vec<(String, String)> {
        self.got.lock().unwrap().clone()
    }

    pub(crate) fn kinds(&self) -> Vec<String> {
        let got = self.got().into_iter();
        got.map(|(_, body)| json_of(&body)["kind"].as_str().unwrap().to_owned())
            .collect()
    }
}

async fn take(State(receiver): State<Receiver>, headers: HeaderMap, body: Bytes) -> Response {
    let signature = headers[SIGNATURE_HEADER].to_str().unwrap().to_owned();
    let body = String::from_utf8(body.to_vec()).unwrap();
    receiver.got.lock().unwrap().push((signature, body));
    let answer = receiver.answers.lock().unwrap().pop_front();
    answer.unwrap_or_else(|| StatusCode::OK.into_response())
}

fn json_of(text: &str) -> Value {
    serde_json::from_str(text).unwrap()
}

pub(crate) async fn make(person: &Person, url: &str, kinds: &[&str]) -> Value {
    let new = json!({ "url": url, "kinds": kinds });
    person.post("/webhooks", &new).await.good()
}

pub(crate) fn path(webhook: &Value, rest: &str) -> String {
    format!("/webhooks/{}{rest}", webhook["id"].as_str().unwrap())
}

/// Makes every delivery that is due now.
pub(crate) async fn deliver(shore: &Shore) -> Vec<Sent> {
    let sender = Sender::new(Reach::Anywhere).unwrap();
    let mut sent = Vec::new();
    while let Some(done) = outbox::step(&shore.app, &sender).await.unwrap() {
        sent.push(done);
    }
    sent
}

/// A vessel falls silent: an alert is raised. The person signs in anew.
async fn raise(shore: &Shore, person: &Person) -> Person {
    shore.ship(person, "Nao").await;
    shore.advance(4.0 * DAY_S);
    alerts::check_silence(&shore.app).await.unwrap();
    Person::sign_in(shore, person.operator, &person.email).await
}

/// Whether the example in the documentation takes a message for ours.
pub(crate) fn example_says(secret: &str, signature: &str, body: &str, now_s: i64) -> bool {
    let document = include_str!("../../../docs/webhooks.md");
    let (_, example) = document.split_once("```python\n").unwrap();
    let (example, _) = example.split_once("```").unwrap();
    let ask = "import sys\n_, secret, header, body, now = sys.argv\n\
               print(is_from_binnacle(secret, header, body.encode(), now=int(now)))";
    let done = Command::new("python3")
        .args(["-c", &format!("{example}\n{ask}"), secret, signature, body])
        .arg(now_s.to_string())
        .output()
        .unwrap();
    assert!(
        done.status.success(),
        "{}",
        String::from_utf8_lossy(&done.stderr)
    );
    String::from_utf8(done.stdout).unwrap().trim() == "True"
}

async fn an_alert_reaches_the_receiver_signed(shore: Shore) {
    let ada = shore.admin("ada").await;
    let (receiver, url) = Receiver::start().await;
    let webhook = make(&ada, &url, &["alert.raised"]).await;
    let ada = raise(&shore, &ada).await;
    assert_eq!(deliver(&shore).await, [Sent::Delivered]);

    let (signature, body) = receiver.got().remove(0);
    let message = json_of(&body);
    let alert = ada.get("/alerts").await.good()["items"][0].clone();
    assert_eq!(
        (&message["kind"], &message["alert"]),
        (&json!("alert.raised"), &alert)
    );
    let secret = webhook["secret"].as_str().unwrap();
    let now_s = shore.app.clock.now().micros() / 1_000_000;
    assert!(
        example_says(secret, &signature, &body, now_s),
        "{signature}"
    );
    assert!(!example_says("bns_other", &signature, &body, now_s));
    assert!(!example_says(
        secret,
        &signature,
        &body.replace("raised", "closed"),
        now_s
    ));
    assert!(
        !example_says(secret, &signature, &body, now_s + 301),
        "it is old"
    );
    assert!(!example_says(secret, "v1=abc", &body, now_s));

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
    shore.finish().await;
}

async fn what_was_not_asked_for_is_not_sent(shore: Shore) {
    let ada = shore.admin("ada").await;
    let eve = shore.admin("eve").await;
    let (receiver, url) = Receiver::start().await;
    make(&ada, &url, &["alert.cleared"]).await;
    make(&eve, &url, &["alert.raised"]).await;
    let off = json!({ "url": url, "kinds": ["alert.raised"], "enabled": false });
    ada.post("/webhooks", &off).await.good();
    raise(&shore, &ada).await;
    assert_eq!(deliver(&shore).await, []);
    assert_eq!(receiver.got(), []);
    shore.finish().await;
}

async fn messages_come_in_order_and_wait_for_the_one_before(shore: Shore) {
    let ada = shore.admin("ada").await;
    let (receiver, url) = Receiver::start().await;
    let kinds = ["alert.raised", "alert.acknowledged", "alert.cleared"];
    make(&ada, &url, &kinds).await;
    let ada = raise(&shore, &ada).await;
    let alert = ada.get("/alerts").await.good()["items"][0].clone();
    let at = |rest: &str| format!("/alerts/{}{rest}", alert["id"].as_str().unwrap());
    ada.post(&at("/acknowledge"), &json!({})).await.good();
    ada.post(&at("/clear"), &json!({ "reason": "Over" }))
        .await
        .good();

    receiver.answer(StatusCode::SERVICE_UNAVAILABLE);
    assert_eq!(deliver(&shore).await, [Sent::Failed]);
    assert_eq!(deliver(&shore).await, [], "before the pause is over");
    shore.advance(13.0);
    assert_eq!(deliver(&shore).await, [Sent::Delivered; 3]);
    let again = [
        "alert.raised",
        "alert.raised",
        "alert.acknowledged",
        "alert.cleared",
    ];
    assert_eq!(receiver.kinds(), again);
    let got = receiver.got();
    assert_eq!(got[0].1, got[1].1, "the same message, to the byte");
    assert_ne!(got[0].0, got[1].0, "signed anew");
    shore.finish().await;
}

async fn a_receiver_that_is_away_for_a_day_leaves_a_dead_letter_that_can_be_sent_again(
    shore: Shore,
) {
    let ada = shore.admin("ada").await;
    let (receiver, url) = Receiver::start().await;
    let webhook = make(&ada, &url, &["alert.raised"]).await;
    ada.post(&path(&webhook, "/test"), &json!({})).await.good();
    let (mut tries, mut last) = (0, None);
    while last != Some(Sent::Dead) {
        receiver.answer(StatusCode::INTERNAL_SERVER_ERROR);
        let sent = deliver(&shore).await;
        last = sent.last().copied().or(last);
        tries += sent.len();
        assert!(tries < 50, "it is never given up");
        shore.advance(1200.0);
    }
    assert!((25..=40).contains(&tries), "{tries} tries in a day");
    let ada = Person::sign_in(&shore, ada.operator, &ada.email).await;
    assert_eq!(ada.get(&path(&webhook, "")).await.good()["dead"], 1);
    let dead = ada
        .get(&path(&webhook, "/deliveries?state=dead"))
        .await
        .good();
    let letter = dead["items"][0].clone();
    assert_eq!(letter["last_status"], 500);
    assert_eq!(letter["next_attempt_at"], Value::Null);

    receiver.answers.lock().unwrap().clear();
    let again = format!("/deliveries/{}/resend", letter["id"].as_str().unwrap());
    let queued = ada.post(&path(&webhook, &again), &json!({})).await.good();
    assert_eq!(
        (&queued["state"], &queued["id"]),
        (&json!("pending"), &letter["id"])
    );
    assert_eq!(deliver(&shore).await, [Sent::Delivered]);
    assert_eq!(receiver.got().last().unwrap().1, receiver.got()[0].1);
    let dead = ada
        .get(&path(&webhook, "/deliveries?state=dead"))
        .await
        .good();
    assert_eq!(dead["items"], json!([]));
    shore.finish().await;
}

async fn a_delivery_under_way_is_not_taken_by_another_server(shore: Shore) {
    let ada = shore.admin("ada").await;
    let (receiver, url) = Receiver::start().await;
    let webhook = make(&ada, &url, &["alert.raised"]).await;
    for _ in 0..2 {
        ada.post(&path(&webhook, "/test"), &json!({})).await.good();
    }
    let second = shore.second().await;
    let sender = Sender::new(Reach::Anywhere).unwrap();
    let (one, other) = tokio::join!(
        outbox::step(&shore.app, &sender),
        outbox::step(&second, &sender)
    );
    let sent = [one.unwrap(), other.unwrap()];
    assert!(sent.contains(&Some(Sent::Delivered)), "{sent:?}");
    deliver(&shore).await;
    assert_eq!(receiver.got().len(), 2, "each once");
    second.db.close().await;
    shore.finish().await;
}

async fn a_redirect_is_a_failure_and_is_not_followed(shore: Shore) {
    let ada = shore.admin("ada").await;
    let (receiver, url) = Receiver::start().await;
    let (elsewhere, other) = Receiver::start().await;
    let webhook = make(&ada, &url, &["alert.raised"]).await;
    ada.post(&path(&webhook, "/test"), &json!({})).await.good();
    receiver.answer(Redirect::temporary(&other));
    assert_eq!(deliver(&shore).await, [Sent::Failed]);
    assert_eq!(elsewhere.got(), []);
    let listed = ada.get(&path(&webhook, "/deliveries")).await.good();
    assert_eq!(
        listed["items"][0]["last_error"],
        "responded with status 307"
    );
    shore.finish().await;
}

async fn nothing_is_sent_to_an_address_within_the_network(shore: Shore) {
    let ada = shore.admin("ada").await;
    let (receiver, url) = Receiver::start().await;
    // As if it had been made while that was allowed, or its name meant another place.
    let by_name = url.replace("http://127.0.0.1", "https://localhost");
    for url in [url, by_name] {
        let webhook = make(&ada, &url, &["alert.raised"]).await;
        ada.post(&path(&webhook, "/test"), &json!({})).await.good();
        let sender = Sender::new(Reach::Public).unwrap();
        let sent = outbox::step(&shore.app, &sender).await.unwrap();
        assert_eq!(sent, Some(Sent::Failed));
        let listed = ada.get(&path(&webhook, "/deliveries")).await.good();
        let problem = listed["items"][0]["last_error"]
            .as_str()
            .unwrap()
            .to_owned();
        let refused = problem.contains("not https") || problem.contains("public internet");
        assert!(refused, "{problem}");
    }
    assert_eq!(receiver.got(), []);
    shore.finish().await;
}

async fn a_webhook_is_made_once_changed_and_removed(shore: Shore) {
    let ada = shore.admin("ada").await;
    // A blank comes along when an address is copied.
    let new =
        json!({ "url": " https://example.com/a\n", "kinds": ["alert.raised", "alert.raised"] });
    let twice = || {
        let request = ada.request(Method::POST, "/webhooks").json(&new);
        Answer::of(request.header("idempotency-key", "one"))
    };
    let made = twice().await.good();
    assert_eq!(twice().await.good(), made);
    assert!(made["secret"].as_str().unwrap().starts_with("bns_"));
    assert_eq!(made["kinds"], json!(["alert.raised"]));
    let listed = ada.get("/webhooks").await.good();
    assert_eq!(listed["items"].as_array().unwrap().len(), 1);
    assert_eq!(listed["items"][0].get("secret"), None);

    let wanted =
        json!({ "url": "https://example.com/b", "kinds": ["alert.cleared"], "enabled": false });
    let request = ada.request(Method::PUT, &path(&made, "")).json(&wanted);
    let changed = Answer::of(request).await.good();
    assert_eq!(
        (&changed["url"], &changed["enabled"]),
        (&wanted["url"], &json!(false))
    );
    let viewer = ada.viewer(&shore).await;
    let refused = Answer::of(viewer.request(Method::DELETE, &path(&made, ""))).await;
    assert_eq!(refused.problem(), "forbidden");
    let removed = Answer::of(ada.request(Method::DELETE, &path(&made, ""))).await;
    assert_eq!(removed.status, 204);
    assert_eq!(ada.get(&path(&made, "")).await.problem(), "not-found");
    shore.finish().await;
}

async fn a_webhook_that_makes_no_sense_is_refused(shore: Shore) {
    let ada = shore.admin("ada").await;
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
        let answer = ada
            .post("/webhooks", &json!({ "url": url, "kinds": kinds }))
            .await;
        assert_eq!(answer.problem(), "invalid", "{url} {kinds}");
    }
    shore.finish().await;
}

async fn another_operators_webhooks_are_not_there(shore: Shore) {
    let ada = shore.admin("ada").await;
    let eve = shore.admin("eve").await;
    let webhook = make(&ada, "https://example.com/", &["alert.raised"]).await;
    let test = ada.post(&path(&webhook, "/test"), &json!({})).await.good();
    let resend = format!("/deliveries/{}/resend", test["id"].as_str().unwrap());
    let wanted = json!({ "url": "https://example.com/", "kinds": ["alert.raised"] });
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
            .json(&wanted);
        assert_eq!(
            Answer::of(request).await.problem(),
            "not-found",
            "{method} {rest}"
        );
    }
    assert_eq!(eve.get("/webhooks").await.good()["items"], json!([]));
    shore.finish().await;
}
