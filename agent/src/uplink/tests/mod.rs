//! The uplink against a fake server on a real socket.

mod alerts;
mod azimuths;
mod batches;
mod budget;
mod connection;
mod downlink;
mod reports;
mod token;

use super::*;
use crate::config::{Profile, UploadPlan};
use crate::spool::{BudgetAccount, Seal};
use axum::body::Bytes;
use axum::extract::{Path, Query, State};
use axum::http::StatusCode;
use axum::response::{IntoResponse, Response};
use axum::routing::{get, post, put};
use axum::{Json, Router};
use binnacle_compass::angle::{CompassHeading, TrueHeading};
use binnacle_compass::position::Position;
use binnacle_compass::sample::Sample;
use binnacle_wire::batch::StreamId;
use binnacle_wire::messages::{BoardAzimuth, CardWithdrawn, Downlink, LogbookReport, Settings};
use rand::SeedableRng;
use serde_json::{Value, json};
use std::collections::{BTreeMap, HashMap, VecDeque};
use std::sync::Mutex;
use tempfile::TempDir;
use uuid::Uuid;

/// Requests that the server received, and its responses before it behaves well.
#[derive(Default)]
struct Fake {
    batches: BTreeMap<(Uuid, u64), Vec<u8>>,
    streams: u128,
    queries: Vec<HashMap<String, String>>,
    responses: VecDeque<Response>,
    settings: Option<Settings>,
    withdrawn: Option<CardWithdrawn>,
    /// A model that no agent can read.
    unreadable: Option<Value>,
    requests: u32,
    polls: u32,
    reports: Vec<(Uuid, LogbookReport)>,
    report_responses: VecDeque<Response>,
    azimuths: Vec<(Uuid, BoardAzimuth)>,
    azimuth_responses: VecDeque<Response>,
    /// Numbers of the stored batches, in order; 0 for a report.
    order: Vec<u64>,
}

impl Fake {
    /// A server with settings of its own.
    fn with_settings(settings: &Settings) -> Fake {
        Fake {
            settings: Some(settings.clone()),
            ..Fake::default()
        }
    }
}

type Shared = Arc<Mutex<Fake>>;

fn time() -> Timestamp {
    Timestamp::parse("2026-11-21T07:00:00Z").unwrap()
}

fn problem(status: StatusCode, kind: &str) -> Response {
    let body =
        json!({"type": format!("https://x/problems/{kind}"), "title": kind, "detail": "why"});
    (status, Json(body)).into_response()
}

async fn put_batch(
    State(fake): State<Shared>,
    Path((stream, seq)): Path<(Uuid, u64)>,
    Query(query): Query<HashMap<String, String>>,
    body: Bytes,
) -> Response {
    let mut fake = fake.lock().unwrap();
    fake.requests += 1;
    fake.queries.push(query.clone());
    if let Some(response) = fake.responses.pop_front() {
        return response;
    }
    let known = fake
        .batches
        .entry((stream, seq))
        .or_insert(body.to_vec())
        .clone();
    if known != body {
        return problem(StatusCode::CONFLICT, "stream-forked");
    }
    fake.order.push(seq);
    respond_in_form(&fake, stream, &query)
}

async fn put_report(
    State(fake): State<Shared>,
    Path(id): Path<Uuid>,
    Json(report): Json<LogbookReport>,
) -> Response {
    let mut fake = fake.lock().unwrap();
    let revision = report.revision;
    fake.reports.push((id, report));
    fake.order.push(0);
    if let Some(response) = fake.report_responses.pop_front() {
        return response;
    }
    Json(json!({ "revision": revision, "withdrawn": false })).into_response()
}

async fn put_azimuth(
    State(fake): State<Shared>,
    Path(id): Path<Uuid>,
    Json(azimuth): Json<BoardAzimuth>,
) -> Response {
    let mut fake = fake.lock().unwrap();
    let withdrawn = azimuth.withdrawn;
    fake.azimuths.push((id, azimuth));
    if let Some(response) = fake.azimuth_responses.pop_front() {
        return response;
    }
    Json(json!({ "withdrawn": withdrawn })).into_response()
}

async fn get_downlink(
    State(fake): State<Shared>,
    Path(stream): Path<Uuid>,
    Query(query): Query<HashMap<String, String>>,
) -> Response {
    let mut fake = fake.lock().unwrap();
    fake.polls += 1;
    respond_in_form(&fake, stream, &query)
}

/// Responds in the requested form; an unreadable model is JSON, as of an old server.
fn respond_in_form(fake: &Fake, stream: Uuid, query: &HashMap<String, String>) -> Response {
    let sent = downlink(fake, stream);
    if fake.unreadable.is_some() || query["form"] != "1" {
        return Json(sent).into_response();
    }
    let sent = serde_json::from_value(sent).unwrap();
    let bytes = binnacle_wire::downlink::encode(&sent).unwrap();
    bytes.into_response()
}

async fn open_stream(State(fake): State<Shared>) -> Response {
    let mut fake = fake.lock().unwrap();
    fake.streams += 1;
    let stream = Uuid::from_u128(1000 + fake.streams);
    (StatusCode::CREATED, Json(json!({"stream": stream}))).into_response()
}

fn downlink(fake: &Fake, stream: Uuid) -> Value {
    let contiguous_seq = (1..).take_while(|seq| fake.batches.contains_key(&(stream, *seq)));
    let downlink = Downlink {
        contiguous_seq: contiguous_seq.last().unwrap_or(0),
        model: None,
        unread: None,
        card_withdrawn: fake.withdrawn.clone(),
        settings: fake.settings.clone(),
        server_time: time(),
    };
    let mut sent = serde_json::to_value(downlink).unwrap();
    if let Some(model) = &fake.unreadable {
        sent["model"] = model.clone();
    }
    sent
}

struct Rig {
    fake: Shared,
    spool: Spool,
    link: watch::Receiver<LinkStatus>,
    settings: watch::Receiver<Settings>,
    withdrawn: watch::Receiver<Option<CardWithdrawn>>,
    sealed: Arc<Notify>,
    urgent: Arc<Notify>,
    ship_time: watch::Sender<Option<Timestamp>>,
    shutdown: CancellationToken,
    _directory: TempDir,
}

impl Drop for Rig {
    fn drop(&mut self) {
        self.shutdown.cancel();
    }
}

const STREAM: Uuid = Uuid::from_u128(7);

/// An enrolled agent's spool with `batches` sealed, and a server to send to.
async fn rig(batches: i64, fake: Fake) -> Rig {
    rig_with(batches, fake, &Profile::Standard.plan(None), None).await
}

/// Like [`rig`], with a budget and its balance.
async fn rig_with(
    batches: i64,
    fake: Fake,
    plan: &UploadPlan,
    account: Option<BudgetAccount>,
) -> Rig {
    rustls::crypto::ring::default_provider()
        .install_default()
        .ok();
    let fake = Arc::new(Mutex::new(fake));
    let router = Router::new()
        .route("/api/v1/streams/{stream}/batches/{seq}", put(put_batch))
        .route("/api/v1/streams/{stream}/downlink", get(get_downlink))
        .route("/api/v1/streams", post(open_stream))
        .route("/api/v1/agents/logbook/{id}", put(put_report))
        .route("/api/v1/agents/azimuths/{id}", put(put_azimuth))
        .with_state(fake.clone());
    let listener = tokio::net::TcpListener::bind("127.0.0.1:0").await.unwrap();
    let server = format!("http://{}", listener.local_addr().unwrap());
    tokio::spawn(async move { axum::serve(listener, router).await });

    let directory = TempDir::new().unwrap();
    let spool = Spool::open(directory.path()).await.unwrap();
    let identity = identity(server);
    spool.enrol(&identity).await.unwrap();
    for number in 0..batches {
        seal(&spool, number).await;
    }
    let (link_tx, link) = watch::channel(LinkStatus::default());
    let (settings_tx, settings) = watch::channel(Settings::default());
    let (withdrawn_tx, withdrawn) = watch::channel(None);
    let ship_time = watch::Sender::new(Some(time()));
    let sealed = Arc::new(Notify::new());
    let urgent = Arc::new(Notify::new());
    let uplink = Uplink {
        spool: spool.clone(),
        token: Some(identity.token.clone()),
        refused_token: None,
        client: ServerClient::new(None, &plan.connection_policy()).unwrap(),
        backoff: Backoff::new(Duration::from_millis(10), Duration::from_millis(40)),
        poll: Duration::from_hours(1),
        budget: Budget::new(plan, account, Instant::now()),
        ship_time: ship_time.subscribe(),
        publisher: Publisher {
            model: watch::channel(None).0,
            withdrawn: withdrawn_tx,
            settings: settings_tx,
            link: link_tx,
        },
        keeps_connection: plan.keeps_connection(),
        exchange_open: false,
        report_pauses: ReportPauses::default(),
        sealed: sealed.clone(),
        urgent: urgent.clone(),
        rng: StdRng::seed_from_u64(1),
    };
    let shutdown = CancellationToken::new();
    tokio::spawn(uplink.run(shutdown.clone()));
    Rig {
        fake,
        spool,
        link,
        settings,
        withdrawn,
        sealed,
        urgent,
        ship_time,
        shutdown,
        _directory: directory,
    }
}

fn identity(server: String) -> Identity {
    Identity {
        server,
        token: "t".to_owned(),
        other_token: None,
        stream: StreamId(STREAM),
        vessel_name: "Txori".to_owned(),
        compass_name: "Standard compass".to_owned(),
    }
}

/// Other settings than the built-in ones.
fn other_settings() -> Settings {
    Settings {
        version: 3,
        min_sog_kn: 7.0,
        ..Settings::default()
    }
}

async fn seal(spool: &Spool, number: i64) {
    let sample = Sample {
        gyro: TrueHeading::new(98.0),
        sog_kn: Some(12.0),
        rate_of_turn_deg_min: Some(0.0),
        spread_deg: Some(0.1),
        windows: 60,
        ..Sample::new(
            time().plus_seconds(number as f64 * 600.0),
            Position::new(43.0, -3.0).unwrap(),
            CompassHeading::new(100.0).unwrap(),
        )
    };
    spool
        .store(&[sample], &BTreeMap::new(), Seal::All)
        .await
        .unwrap();
}

impl Rig {
    /// Waits until nothing is left to send.
    async fn all_sent(&mut self) {
        loop {
            if self.spool.next_batch().await.unwrap().is_none()
                && self.link.borrow().state == LinkState::Up
            {
                return;
            }
            let changed = self.link.changed();
            timeout(Duration::from_secs(20), changed)
                .await
                .expect("the link says nothing new")
                .unwrap();
        }
    }

    fn seqs(&self, stream: Uuid) -> Vec<u64> {
        let fake = self.fake.lock().unwrap();
        let keys = fake.batches.keys();
        keys.filter(|(s, _)| *s == stream)
            .map(|(_, seq)| *seq)
            .collect()
    }
}
