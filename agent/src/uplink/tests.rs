//! The uplink against a made-up shore on a real socket.

use super::*;
use crate::spool::{ReportStanding, Seal};
use axum::body::Bytes;
use axum::extract::{Path, Query, State};
use axum::http::StatusCode;
use axum::response::{IntoResponse, Response};
use axum::routing::{get, post, put};
use axum::{Json, Router};
use binnacle_magnetics::angle::{CompassHeading, TrueHeading};
use binnacle_magnetics::position::Position;
use binnacle_magnetics::sample::Sample;
use binnacle_wire::alert::{ShipAlert, ShipAlertState};
use binnacle_wire::batch::StreamId;
use binnacle_wire::messages::{CardWithdrawn, LogbookReport};
use rand::SeedableRng;
use serde_json::{Value, json};
use std::collections::{BTreeMap, HashMap, VecDeque};
use std::sync::Mutex;
use tempfile::TempDir;
use uuid::Uuid;

/// What the shore was sent, and what it is to answer before it behaves well.
#[derive(Default)]
struct Fake {
    batches: BTreeMap<(Uuid, u64), Vec<u8>>,
    streams: u128,
    queries: Vec<HashMap<String, String>>,
    answers: VecDeque<Response>,
    settings: Option<Settings>,
    withdrawn: Option<CardWithdrawn>,
    /// A model as no agent knows it.
    unreadable: Option<Value>,
    requests: u32,
    reports: Vec<(Uuid, LogbookReport)>,
    report_answers: VecDeque<Response>,
    /// The batches that were kept, in order; 0 for a report.
    order: Vec<u64>,
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
    fake.queries.push(query);
    if let Some(answer) = fake.answers.pop_front() {
        return answer;
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
    Json(downlink(&fake, stream)).into_response()
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
    if let Some(answer) = fake.report_answers.pop_front() {
        return answer;
    }
    Json(json!({ "revision": revision, "withdrawn": false })).into_response()
}

async fn get_downlink(State(fake): State<Shared>, Path(stream): Path<Uuid>) -> Json<Value> {
    Json(downlink(&fake.lock().unwrap(), stream))
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
    shutdown: CancellationToken,
    _directory: TempDir,
}

impl Drop for Rig {
    fn drop(&mut self) {
        self.shutdown.cancel();
    }
}

const STREAM: Uuid = Uuid::from_u128(7);

/// An enrolled agent's spool with `batches` sealed, and a shore to send to.
async fn rig(batches: i64, fake: Fake) -> Rig {
    rustls::crypto::ring::default_provider()
        .install_default()
        .ok();
    let fake = Arc::new(Mutex::new(fake));
    let router = Router::new()
        .route("/api/v1/streams/{stream}/batches/{seq}", put(put_batch))
        .route("/api/v1/streams/{stream}/downlink", get(get_downlink))
        .route("/api/v1/streams", post(open_stream))
        .route("/api/v1/agents/logbook/{id}", put(put_report))
        .with_state(fake.clone());
    let listener = tokio::net::TcpListener::bind("127.0.0.1:0").await.unwrap();
    let server = format!("http://{}", listener.local_addr().unwrap());
    tokio::spawn(async move { axum::serve(listener, router).await });

    let directory = TempDir::new().unwrap();
    let spool = Spool::open(directory.path()).await.unwrap();
    let identity = Identity {
        server,
        token: "t".to_owned(),
        stream: StreamId(STREAM),
        vessel_name: "Txori".to_owned(),
        compass_name: "Standard compass".to_owned(),
    };
    spool.enrol(&identity).await.unwrap();
    for number in 0..batches {
        seal(&spool, number).await;
    }
    let (link_tx, link) = watch::channel(LinkStatus::default());
    let (settings_tx, settings) = watch::channel(Settings::default());
    let (withdrawn_tx, withdrawn) = watch::channel(None);
    let sealed = Arc::new(Notify::new());
    let urgent = Arc::new(Notify::new());
    let uplink = Uplink {
        spool: spool.clone(),
        token: Some(identity.token.clone()),
        shore: Shore::new(None).unwrap(),
        backoff: Backoff::new(Duration::from_millis(10), Duration::from_millis(40)),
        poll: Duration::from_hours(1),
        tell: Tell {
            model: watch::channel(None).0,
            withdrawn: withdrawn_tx,
            settings: settings_tx,
            link: link_tx,
        },
        no_reports_before: None,
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
        shutdown,
        _directory: directory,
    }
}

async fn seal(spool: &Spool, number: i64) {
    let sample = Sample {
        time: time().plus_seconds(number as f64 * 600.0),
        position: Position::new(43.0, -3.0).unwrap(),
        compass: CompassHeading::new(100.0).unwrap(),
        gyro: TrueHeading::new(98.0),
        satellite: None,
        sog_kn: Some(12.0),
        rate_of_turn_deg_min: Some(0.0),
        spread_deg: Some(0.1),
        windows: 60,
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

#[tokio::test]
async fn every_batch_is_sent_and_then_forgotten() {
    let mut rig = rig(3, Fake::default()).await;
    rig.all_sent().await;
    assert_eq!(rig.seqs(STREAM), [1, 2, 3]);
    seal(&rig.spool, 3).await;
    rig.sealed.notify_one();
    rig.link.mark_unchanged();
    rig.all_sent().await;
    let standing = rig.spool.standing().await.unwrap();
    assert_eq!(
        (standing.acknowledged_samples, standing.contiguous_seq),
        (4, 4)
    );
    assert_eq!(standing.waiting_batches, 0);
    assert_eq!(rig.link.borrow().last_contact, Some(time()));
}

#[tokio::test]
async fn no_failure_of_the_link_loses_a_batch() {
    let login = "<html>Welcome to Harbour Wi-Fi</html>";
    let answers = [
        (StatusCode::OK, login).into_response(),
        (StatusCode::FOUND, [("location", "http://portal/")]).into_response(),
        (StatusCode::FORBIDDEN, login).into_response(),
        (StatusCode::OK, "{\"contiguous_seq\":").into_response(),
        (StatusCode::BAD_GATEWAY, "nginx").into_response(),
        problem(StatusCode::SERVICE_UNAVAILABLE, "busy"),
    ];
    let fake = Fake {
        answers: answers.into(),
        ..Fake::default()
    };
    let mut rig = rig(2, fake).await;
    rig.all_sent().await;
    assert_eq!(rig.seqs(STREAM), [1, 2]);
    assert_eq!(rig.fake.lock().unwrap().requests, 6 + 2);
    assert_eq!(rig.spool.standing().await.unwrap().acknowledged_batches, 2);
}

#[tokio::test]
async fn the_shore_is_given_the_time_it_asks_for() {
    let busy = (
        StatusCode::TOO_MANY_REQUESTS,
        [("retry-after", "1")],
        "slow down",
    );
    let fake = Fake {
        answers: [busy.into_response()].into(),
        ..Fake::default()
    };
    let before = Instant::now();
    let mut rig = rig(1, fake).await;
    rig.all_sent().await;
    assert!(before.elapsed() >= Duration::from_secs(1));
}

#[tokio::test]
async fn a_forked_stream_is_left_for_a_new_one() {
    let mut fake = Fake::default();
    fake.batches.insert((STREAM, 1), b"other bytes".to_vec());
    let mut rig = rig(2, fake).await;
    rig.all_sent().await;
    let new = Uuid::from_u128(1001);
    assert_eq!(rig.seqs(new), [1, 2]);
    let fake = rig.fake.lock().unwrap();
    for seq in [1, 2] {
        let batch = binnacle_wire::decode(&fake.batches[&(new, seq)]).unwrap();
        assert_eq!(
            (batch.stream.0, batch.seq, batch.samples.len()),
            (new, seq, 1)
        );
    }
}

#[tokio::test]
async fn a_shore_that_lost_its_batches_gets_a_new_stream() {
    let mut rig = rig(3, Fake::default()).await;
    rig.all_sent().await;
    rig.fake.lock().unwrap().batches.clear();
    seal(&rig.spool, 3).await;
    seal(&rig.spool, 4).await;
    rig.link.mark_unchanged();
    rig.sealed.notify_one();
    rig.all_sent().await;
    assert_eq!(rig.seqs(STREAM), [4]);
    assert_eq!(rig.seqs(Uuid::from_u128(1001)), [1]);
}

#[tokio::test]
async fn a_refused_batch_is_kept_aside_and_does_not_block_the_next() {
    let fake = Fake {
        answers: [problem(StatusCode::UNPROCESSABLE_ENTITY, "undecodable")].into(),
        ..Fake::default()
    };
    let mut rig = rig(2, fake).await;
    rig.all_sent().await;
    assert_eq!(rig.seqs(STREAM), [2]);
    let standing = rig.spool.standing().await.unwrap();
    assert_eq!((standing.parked_batches, standing.contiguous_seq), (1, 0));
    assert_eq!(
        standing.parked_because.as_deref(),
        Some("422 undecodable: why")
    );
}

#[tokio::test]
async fn a_token_that_is_not_known_keeps_the_data_and_says_so() {
    let fake = Fake {
        answers: [
            problem(StatusCode::UNAUTHORIZED, "unauthorized"),
            problem(StatusCode::NOT_FOUND, "not-found"),
        ]
        .into(),
        ..Fake::default()
    };
    let mut rig = rig(1, fake).await;
    rig.link
        .wait_for(|link| link.state == LinkState::Refused)
        .await
        .unwrap();
    rig.all_sent().await;
    assert_eq!(rig.seqs(STREAM), [1]);
}

#[tokio::test]
async fn a_card_is_withdrawn_at_once_and_given_back() {
    let withdrawn = CardWithdrawn {
        since: time(),
        reason: "adjustment".to_owned(),
    };
    let fake = Fake {
        withdrawn: Some(withdrawn.clone()),
        ..Fake::default()
    };
    let mut rig = rig(1, fake).await;
    rig.all_sent().await;
    assert_eq!(*rig.withdrawn.borrow_and_update(), Some(withdrawn));
    rig.fake.lock().unwrap().withdrawn = None;
    seal(&rig.spool, 1).await;
    rig.sealed.notify_one();
    rig.withdrawn.wait_for(Option::is_none).await.unwrap();
    assert_eq!(rig.spool.card_withdrawn().await.unwrap(), None);
}

#[tokio::test]
async fn settings_are_in_effect_and_kept_and_then_asked_for_by_version() {
    let settings = Settings {
        version: 3,
        min_sog_kn: 7.0,
        ..Settings::default()
    };
    let fake = Fake {
        settings: Some(settings.clone()),
        ..Fake::default()
    };
    let mut rig = rig(2, fake).await;
    rig.all_sent().await;
    assert_eq!(*rig.settings.borrow(), settings);
    assert_eq!(rig.spool.settings().await.unwrap(), settings);
    let fake = rig.fake.lock().unwrap();
    let asked: Vec<&str> = fake
        .queries
        .iter()
        .map(|q| q["settings"].as_str())
        .collect();
    assert_eq!(asked, ["0", "3"]);
}

#[tokio::test]
async fn an_agent_enrolled_for_another_compass_drops_what_the_first_was_told() {
    let settings = Settings {
        version: 3,
        ..Settings::default()
    };
    let fake = Fake {
        settings: Some(settings.clone()),
        ..Fake::default()
    };
    let mut rig = rig(1, fake).await;
    rig.all_sent().await;
    assert_eq!(*rig.settings.borrow_and_update(), settings);
    rig.fake.lock().unwrap().settings = None;
    let first = rig.spool.identity().await.unwrap().unwrap();
    let second = Identity {
        token: "another".to_owned(),
        compass_name: "Steering compass".to_owned(),
        ..first
    };
    rig.spool.enrol(&second).await.unwrap();
    rig.sealed.notify_one();
    let in_effect = rig.settings.wait_for(|settings| settings.version == 0);
    let in_time = timeout(Duration::from_secs(20), in_effect).await;
    assert!(in_time.is_ok(), "the old settings are still in effect");
}

impl Rig {
    /// Writes a report as the page does.
    async fn report(&self, number: u128) {
        let report = serde_json::from_value(json!({
            "kind": "lightning", "from": "2026-11-21T06:00:00Z",
        }));
        let (id, reporter) = (Uuid::from_u128(number), "Li".to_owned());
        self.spool
            .keep_report(id, report.unwrap(), reporter, false, time())
            .await
            .unwrap();
        self.sealed.notify_one();
    }

    /// Waits until no report waits.
    async fn reports_settled(&self) {
        let settled = async {
            while self.spool.next_report().await.unwrap().is_some() {
                tokio::task::yield_now().await;
            }
        };
        let patience = timeout(Duration::from_secs(20), settled);
        patience.await.expect("the reports are sent");
    }

    async fn standings(&self) -> Vec<ReportStanding> {
        let reports = self.spool.reports().await.unwrap();
        reports.iter().map(|report| report.standing).collect()
    }
}

#[tokio::test]
async fn a_report_is_sent_until_it_is_answered() {
    let lost = || StatusCode::BAD_GATEWAY.into_response();
    let busy = problem(StatusCode::SERVICE_UNAVAILABLE, "busy");
    let fake = Fake {
        report_answers: VecDeque::from([lost(), busy]),
        ..Fake::default()
    };
    let mut rig = rig(1, fake).await;
    rig.report(1).await;
    rig.reports_settled().await;
    rig.all_sent().await;
    assert_eq!(rig.standings().await, [ReportStanding::Ashore]);
    let sent = &rig.fake.lock().unwrap().reports;
    assert_eq!(sent.len(), 3);
    assert!(sent.iter().all(|report| *report == sent[0]), "{sent:?}");
}

#[tokio::test]
async fn a_report_that_is_refused_is_kept_with_the_reason_and_the_next_one_goes() {
    let refused = problem(StatusCode::UNPROCESSABLE_ENTITY, "invalid");
    let fake = Fake {
        report_answers: VecDeque::from([refused]),
        ..Fake::default()
    };
    let rig = rig(0, fake).await;
    rig.report(1).await;
    rig.reports_settled().await;
    rig.report(2).await;
    rig.reports_settled().await;
    let (ashore, refused) = (ReportStanding::Ashore, ReportStanding::Refused);
    assert_eq!(rig.standings().await, [ashore, refused]);
    let reports = rig.spool.reports().await.unwrap();
    assert_eq!(reports[1].problem.as_deref(), Some("422 invalid: why"));
}

#[tokio::test]
async fn a_shore_that_knows_no_reports_gets_its_batches_all_the_same() {
    let unknown = problem(StatusCode::NOT_FOUND, "not-found");
    let fake = Fake {
        report_answers: VecDeque::from([unknown]),
        ..Fake::default()
    };
    let mut rig = rig(0, fake).await;
    rig.report(1).await;
    seal(&rig.spool, 0).await;
    rig.sealed.notify_one();
    rig.all_sent().await;
    assert_eq!(rig.seqs(STREAM), [1]);
    assert_eq!(rig.standings().await, [ReportStanding::Waiting]);
}

#[tokio::test]
async fn a_model_that_cannot_be_read_leaves_the_one_on_board_unless_the_ship_was_altered() {
    let altered = CardWithdrawn {
        since: time(),
        reason: "lightning_or_shock".to_owned(),
    };
    for (replaces, withdrawn) in [(None, None), (Some(altered.clone()), Some(altered))] {
        let fake = Fake {
            unreadable: Some(json!({ "version": 9, "replaces": replaces, "model": "?" })),
            ..Fake::default()
        };
        let mut rig = rig(1, fake).await;
        rig.all_sent().await;
        assert_eq!(rig.spool.card_withdrawn().await.unwrap(), withdrawn);
        assert_eq!(*rig.withdrawn.borrow(), withdrawn);
    }
}

/// Seals a sample with an alert, as when compass and gyro have parted.
async fn seal_evidence(spool: &Spool, number: i64) {
    let at = time().plus_seconds(number as f64 * 600.0);
    let alert = ShipAlert {
        id: Uuid::from_u128(0xa1),
        revision: u32::try_from(number).unwrap() + 1,
        state: ShipAlertState::Open,
        since: time(),
        at,
        gyro_departure_deg: Some(28.4),
        satellite_departure_deg: None,
        limit_deg: 3.9,
        model_version: 1,
    };
    let sealed = spool
        .store_evidence(&[], &BTreeMap::new(), &[alert], None)
        .await;
    assert_eq!(sealed.unwrap().1, 1);
}

/// A shore that asks to be left alone for an hour, and an agent that obeys.
async fn waiting_rig(batches: i64) -> Rig {
    let busy = (
        StatusCode::TOO_MANY_REQUESTS,
        [("retry-after", "3600")],
        "slow down",
    );
    let fake = Fake {
        answers: [busy.into_response()].into(),
        ..Fake::default()
    };
    let mut rig = rig(batches, fake).await;
    let down = rig.link.wait_for(|link| link.state == LinkState::Down);
    down.await.unwrap();
    rig
}

#[tokio::test]
async fn evidence_goes_before_the_backlog_and_the_reports_and_once() {
    let mut rig = waiting_rig(3).await;
    rig.report(1).await;
    seal_evidence(&rig.spool, 1).await;
    seal(&rig.spool, 7).await;
    seal_evidence(&rig.spool, 2).await;
    rig.urgent.notify_one();
    rig.all_sent().await;
    let order = rig.fake.lock().unwrap().order.clone();
    assert_eq!(order[..2], [6, 4], "the newest alert first");
    assert_eq!(
        order[2..],
        [0, 1, 2, 3, 5],
        "a report, then the oldest first"
    );
    let standing = rig.spool.standing().await.unwrap();
    assert_eq!(
        (standing.acknowledged_batches, standing.contiguous_seq),
        (6, 6)
    );
}

#[tokio::test]
async fn an_alert_cuts_a_long_pause_short() {
    let mut rig = waiting_rig(1).await;
    seal_evidence(&rig.spool, 1).await;
    rig.urgent.notify_one();
    rig.all_sent().await;
    assert_eq!(rig.seqs(STREAM), [1, 2]);
}
