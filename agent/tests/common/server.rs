//! A fake server that stores batches as the real one does, and that can be made to fail.

use axum::body::Bytes;
use axum::extract::{Path, State};
use axum::http::StatusCode;
use axum::response::{IntoResponse, Response};
use axum::routing::{get, post, put};
use axum::{Json, Router};
use binnacle_compass::time::Timestamp;
use binnacle_wire::batch::Batch;
use binnacle_wire::messages::{Downlink, EnrolRequest, ModelDownlink, Settings};
use serde_json::{Value, json};
use std::collections::BTreeMap;
use std::sync::{Arc, Mutex};
use tokio::sync::watch;
use uuid::Uuid;

pub(crate) const STREAM: Uuid = Uuid::from_u128(0x5712_ea00);
pub(crate) const CODE: &str = "K7QF-2M9X";

#[derive(Default)]
pub(crate) struct Stored {
    pub(crate) batches: BTreeMap<u64, Vec<u8>>,
    pub(crate) forks: u64,
    /// Numbers in the order in which the batches came.
    pub(crate) order: Vec<u64>,
    /// While this is set, every response is 503.
    pub(crate) down: bool,
    requests: u64,
}

#[derive(Clone)]
pub(crate) struct TestServer {
    pub(crate) url: String,
    pub(crate) stored: Arc<Mutex<Stored>>,
    /// Number of stored batches.
    pub(crate) stored_batches: watch::Sender<u64>,
    model: Option<ModelDownlink>,
    settings: Settings,
    /// Interval of failing requests.
    fail_every: Option<u64>,
}

impl TestServer {
    pub(crate) async fn start(model: Option<ModelDownlink>, fail_every: Option<u64>) -> TestServer {
        let listener = tokio::net::TcpListener::bind("127.0.0.1:0").await.unwrap();
        let server = TestServer {
            url: format!("http://{}", listener.local_addr().unwrap()),
            stored: Arc::default(),
            stored_batches: watch::Sender::new(0),
            model,
            settings: Settings {
                version: 1,
                seal_s: 3600,
                ..Settings::default()
            },
            fail_every,
        };
        let router = Router::new()
            .route("/api/v1/agents/enrol", post(enrol))
            .route(
                "/api/v1/agents/token",
                post(propose_token).put(replace_token),
            )
            .route("/api/v1/streams/{stream}/batches/{seq}", put(put_batch))
            .route("/api/v1/streams/{stream}/downlink", get(downlink))
            .with_state(server.clone());
        tokio::spawn(async move { axum::serve(listener, router).await });
        server
    }

    /// Waits for the given number of batches.
    pub(crate) async fn has(&self, batches: u64) {
        let mut stored_batches = self.stored_batches.subscribe();
        stored_batches
            .wait_for(|stored| *stored >= batches)
            .await
            .unwrap();
    }

    pub(crate) fn decoded(&self) -> Vec<Batch> {
        let stored = self.stored.lock().unwrap();
        let batches = stored.batches.values();
        batches
            .map(|bytes| binnacle_wire::decode(bytes).unwrap())
            .collect()
    }

    fn response(&self, stored: &Stored) -> Downlink {
        let contiguous = (1..).take_while(|seq| stored.batches.contains_key(seq));
        Downlink {
            contiguous_seq: contiguous.last().unwrap_or(0),
            model: self.model.clone(),
            unread: None,
            card_withdrawn: None,
            settings: Some(self.settings.clone()),
            server_time: Timestamp::parse("2026-11-21T07:00:00Z").unwrap(),
        }
    }
}

async fn enrol(Json(request): Json<EnrolRequest>) -> Response {
    if request.code != CODE {
        let problem =
            json!({"type": "/problems/not-found", "title": "No such code", "status": 404});
        return (StatusCode::NOT_FOUND, Json(problem)).into_response();
    }
    Json::<Value>(json!({
        "token": "the-token",
        "stream": STREAM,
        "vessel_name": "Txori",
        "compass_name": "Standard compass",
        "server_time": "2026-11-21T07:00:00Z",
    }))
    .into_response()
}

async fn put_batch(
    State(server): State<TestServer>,
    Path((stream, seq)): Path<(Uuid, u64)>,
    body: Bytes,
) -> Response {
    assert_eq!(stream, STREAM);
    let mut stored = server.stored.lock().unwrap();
    if stored.down {
        return (StatusCode::SERVICE_UNAVAILABLE, "down").into_response();
    }
    stored.requests += 1;
    let fails = server
        .fail_every
        .is_some_and(|every| stored.requests % every == 0);
    if fails && stored.requests % 2 == 0 {
        return (StatusCode::SERVICE_UNAVAILABLE, "busy").into_response();
    }
    if !stored.batches.contains_key(&seq) {
        stored.order.push(seq);
    }
    let known = stored.batches.entry(seq).or_insert(body.to_vec()).clone();
    if known != body {
        stored.forks += 1;
        return StatusCode::CONFLICT.into_response();
    }
    server
        .stored_batches
        .send_replace(stored.batches.len() as u64);
    if fails {
        // Stored, but the response is lost on the way.
        return (StatusCode::BAD_GATEWAY, "lost").into_response();
    }
    Json(server.response(&stored)).into_response()
}

async fn propose_token() -> Json<Value> {
    Json(json!({ "token": "the-next-token" }))
}

async fn replace_token(Json(new): Json<Value>) -> StatusCode {
    assert_eq!(new["token"], "the-next-token");
    StatusCode::NO_CONTENT
}

async fn downlink(State(server): State<TestServer>) -> Response {
    let stored = server.stored.lock().unwrap();
    if stored.down {
        return StatusCode::SERVICE_UNAVAILABLE.into_response();
    }
    Json(server.response(&stored)).into_response()
}
