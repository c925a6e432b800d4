//! A shore that keeps batches as the real one does, and can be told to fail.

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
pub(crate) struct Kept {
    pub(crate) batches: BTreeMap<u64, Vec<u8>>,
    pub(crate) forks: u64,
    /// Numbers in the order in which they came.
    pub(crate) order: Vec<u64>,
    /// While this is set, nothing is answered but 503.
    pub(crate) down: bool,
    requests: u64,
}

#[derive(Clone)]
pub(crate) struct Shore {
    pub(crate) url: String,
    pub(crate) kept: Arc<Mutex<Kept>>,
    /// Rises with each batch that is kept.
    pub(crate) news: watch::Sender<u64>,
    model: Option<ModelDownlink>,
    settings: Settings,
    /// Every so many requests, one fails.
    fail_every: Option<u64>,
}

impl Shore {
    pub(crate) async fn start(model: Option<ModelDownlink>, fail_every: Option<u64>) -> Shore {
        let listener = tokio::net::TcpListener::bind("127.0.0.1:0").await.unwrap();
        let shore = Shore {
            url: format!("http://{}", listener.local_addr().unwrap()),
            kept: Arc::default(),
            news: watch::Sender::new(0),
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
            .with_state(shore.clone());
        tokio::spawn(async move { axum::serve(listener, router).await });
        shore
    }

    /// Waits until so many batches are here.
    pub(crate) async fn has(&self, batches: u64) {
        let mut news = self.news.subscribe();
        news.wait_for(|kept| *kept >= batches).await.unwrap();
    }

    pub(crate) fn decoded(&self) -> Vec<Batch> {
        let kept = self.kept.lock().unwrap();
        let batches = kept.batches.values();
        batches
            .map(|bytes| binnacle_wire::decode(bytes).unwrap())
            .collect()
    }

    fn answer(&self, kept: &Kept) -> Downlink {
        let contiguous = (1..).take_while(|seq| kept.batches.contains_key(seq));
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
    State(shore): State<Shore>,
    Path((stream, seq)): Path<(Uuid, u64)>,
    body: Bytes,
) -> Response {
    assert_eq!(stream, STREAM);
    let mut kept = shore.kept.lock().unwrap();
    if kept.down {
        return (StatusCode::SERVICE_UNAVAILABLE, "down").into_response();
    }
    kept.requests += 1;
    let fails = shore
        .fail_every
        .is_some_and(|every| kept.requests % every == 0);
    if fails && kept.requests % 2 == 0 {
        return (StatusCode::SERVICE_UNAVAILABLE, "busy").into_response();
    }
    if !kept.batches.contains_key(&seq) {
        kept.order.push(seq);
    }
    let known = kept.batches.entry(seq).or_insert(body.to_vec()).clone();
    if known != body {
        kept.forks += 1;
        return StatusCode::CONFLICT.into_response();
    }
    shore.news.send_replace(kept.batches.len() as u64);
    if fails {
        // Kept, but the answer is lost on the way.
        return (StatusCode::BAD_GATEWAY, "lost").into_response();
    }
    Json(shore.answer(&kept)).into_response()
}

async fn propose_token() -> Json<Value> {
    Json(json!({ "token": "the-next-token" }))
}

async fn replace_token(Json(new): Json<Value>) -> StatusCode {
    assert_eq!(new["token"], "the-next-token");
    StatusCode::NO_CONTENT
}

async fn downlink(State(shore): State<Shore>) -> Response {
    let kept = shore.kept.lock().unwrap();
    if kept.down {
        return StatusCode::SERVICE_UNAVAILABLE.into_response();
    }
    Json(shore.answer(&kept)).into_response()
}
