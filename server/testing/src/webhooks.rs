//! Webhooks, and a program that receives them.

use crate::person::Person;
use crate::server::TestServer;
use axum::Router;
use axum::body::Bytes;
use axum::extract::State;
use axum::http::{HeaderMap, StatusCode};
use axum::response::{IntoResponse, Response};
use axum::routing::post;
use binnacle_platform::outbound::Reach;
use binnacle_platform::outbox::{self, Sent};
use binnacle_platform::webhooks::{SIGNATURE_HEADER, Sender};
use serde_json::{Value, json};
use std::collections::VecDeque;
use std::process::Command;
use std::sync::{Arc, Mutex};

/// A program that receives messages and responds as the test sets, or with 200.
#[derive(Clone, Default)]
pub struct Receiver {
    received: Arc<Mutex<Vec<(String, String)>>>,
    responses: Arc<Mutex<VecDeque<Response>>>,
}

impl Receiver {
    pub async fn start() -> (Receiver, String) {
        let receiver = Receiver::default();
        let listener = tokio::net::TcpListener::bind("127.0.0.1:0").await.unwrap();
        let url = format!("http://{}/hook", listener.local_addr().unwrap());
        let router = Router::new()
            .route("/hook", post(take))
            .with_state(receiver.clone());
        tokio::spawn(async move { axum::serve(listener, router).await });
        (receiver, url)
    }

    pub fn respond_next(&self, response: impl IntoResponse) {
        self.responses
            .lock()
            .unwrap()
            .push_back(response.into_response());
    }

    /// Responds with 200 again.
    pub fn respond_normally(&self) {
        self.responses.lock().unwrap().clear();
    }

    /// Returns signatures and bodies in order of arrival.
    pub fn received(&self) -> Vec<(String, String)> {
        self.received.lock().unwrap().clone()
    }

    pub fn kinds(&self) -> Vec<String> {
        let got = self.received().into_iter();
        got.map(|(_, body)| json_of(&body)["kind"].as_str().unwrap().to_owned())
            .collect()
    }
}

async fn take(State(receiver): State<Receiver>, headers: HeaderMap, body: Bytes) -> Response {
    let signature = headers[SIGNATURE_HEADER].to_str().unwrap().to_owned();
    let body = String::from_utf8(body.to_vec()).unwrap();
    receiver.received.lock().unwrap().push((signature, body));
    let response = receiver.responses.lock().unwrap().pop_front();
    response.unwrap_or_else(|| StatusCode::OK.into_response())
}

pub fn json_of(text: &str) -> Value {
    serde_json::from_str(text).unwrap()
}

pub async fn make(person: &Person, url: &str, kinds: &[&str]) -> Value {
    let new = json!({ "url": url, "kinds": kinds });
    person.post("/webhooks", &new).await.good()
}

pub fn path(webhook: &Value, rest: &str) -> String {
    format!("/webhooks/{}{rest}", webhook["id"].as_str().unwrap())
}

/// Makes every delivery that is due now.
pub async fn deliver(server: &TestServer) -> Vec<Sent> {
    let sender = Sender::new(Reach::Anywhere).unwrap();
    let mut sent = Vec::new();
    while let Some(done) = outbox::step(&server.app, &sender).await.unwrap() {
        sent.push(done);
    }
    sent
}

/// Returns true if the example in the documentation accepts a message.
pub fn example_accepts(secret: &str, signature: &str, body: &str, now_s: i64) -> bool {
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
