//! Live events.

use binnacle_fleet::event_kinds;
use binnacle_platform::app::App;
use binnacle_platform::db::Pools;
use binnacle_platform::events::{self, STREAMS_OF_USER};
use binnacle_platform::ids::VesselId;
use binnacle_server_testing::on_both;
use binnacle_server_testing::{ApiResponse, Engine, Person, Ship, TestServer, passage};
use futures_util::StreamExt;
use reqwest::Method;
use serde_json::json;
use std::time::Duration;
use tokio::time::timeout;

on_both!(
    a_dashboard_gets_events_of_a_batch_and_a_model,
    a_dashboard_gets_an_event_of_a_logbook_entry,
    a_reconnecting_dashboard_gets_missed_events,
    events_stay_within_an_operator,
    a_revoked_token_and_an_ended_session_get_no_more_events,
    a_stopping_server_closes_its_event_streams,
    events_are_deleted_after_a_day,
    a_user_has_no_more_event_streams_than_allowed,
);

#[tokio::test]
async fn a_lost_postgres_connection_is_restored_and_missed_events_are_sent() {
    let server = TestServer::start(Engine::Postgres).await;
    let ada = server.admin("ada").await;
    let nao = server.ship(&ada, "Nao").await;
    let mut source = EventSource::open(&ada, None).await;
    let Pools::Postgres(pool) = server.app.db.pools() else {
        unreachable!("PostgreSQL was asked for");
    };
    let broken: Vec<bool> = sqlx::query_scalar(
        "SELECT pg_terminate_backend(pid) FROM pg_stat_activity
         WHERE datname = current_database() AND query LIKE 'LISTEN%'",
    )
    .fetch_all(pool)
    .await
    .unwrap();
    assert_eq!(broken, [true]);
    let other = server.second_server().await;
    announce(&other, &nao).await;
    let (_, batch) = source.next().await.unwrap();
    assert!(batch.contains(&nao.id), "{batch}");
    other.db.close().await;
    server.finish().await;
}

#[tokio::test]
async fn a_dashboard_gets_events_of_another_server_once() {
    let server = TestServer::start(Engine::Postgres).await;
    let ada = server.admin("ada").await;
    let nao = server.ship(&ada, "Nao").await;
    let mut source = EventSource::open(&ada, None).await;
    let other = server.second_server().await;
    announce(&other, &nao).await;
    let (foreign, _) = source.next().await.unwrap();
    // This server's own event is announced as well, to the other alone.
    nao.put(1, &passage(DAY, 3)).await.good();
    let (own, _) = source.next().await.unwrap();
    announce(&other, &nao).await;
    let (last, _) = source.next().await.unwrap();
    let mut ids = [foreign, own, last];
    ids.sort_unstable();
    assert!(ids[0] != ids[1] && ids[1] != ids[2], "{ids:?}");
    other.db.close().await;
    server.finish().await;
}

/// Stores an event of a ship on a server, and announces it to the others.
async fn announce(server: &App, ship: &Ship) {
    let vessel = VesselId(ship.id.parse().unwrap());
    let mut tx = server.db.begin().await.unwrap();
    let now = server.clock.now().into();
    let event = events::insert(&mut tx, vessel, event_kinds::BATCH, now).await;
    tx.commit().await.unwrap();
    server.publish(event.unwrap());
    let announced = server.announcer.announce_pending(&server.db).await;
    announced.unwrap();
}

const DAY: &str = "2026-11-15T00:00:00Z";

/// A client of live events.
struct EventSource {
    stream: futures_util::stream::BoxStream<'static, reqwest::Result<Vec<u8>>>,
    text: String,
}

impl EventSource {
    async fn open(person: &Person, last: Option<&str>) -> EventSource {
        let mut request = person.request(Method::GET, "/events");
        if let Some(last) = last {
            request = request.header("last-event-id", last);
        }
        EventSource::send(request).await
    }

    async fn send(request: reqwest::RequestBuilder) -> EventSource {
        let response = request.send().await.unwrap();
        assert_eq!(response.headers()["content-type"], "text/event-stream");
        let chunks = futures_util::stream::unfold(response, |mut response| async {
            let chunk = response.chunk().await.transpose()?;
            Some((chunk.map(|bytes| bytes.to_vec()), response))
        });
        EventSource {
            stream: chunks.boxed(),
            text: String::new(),
        }
    }

    /// Reads the next event's id and data; `None` when the server has closed the stream.
    async fn next(&mut self) -> Option<(String, String)> {
        let read = timeout(Duration::from_secs(20), self.read());
        read.await.expect("an event within 20 s")
    }

    async fn read(&mut self) -> Option<(String, String)> {
        loop {
            if let Some((block, rest)) = self.text.split_once("\n\n") {
                let field = |name: &str| {
                    let line = block.lines().find_map(|line| line.strip_prefix(name));
                    line.map(|value| value.trim().to_owned())
                };
                let found = field("id:").zip(field("data:"));
                let rest = rest.to_owned();
                self.text = rest;
                if found.is_some() {
                    return found;
                }
                continue;
            }
            let bytes = self.stream.next().await?.ok()?;
            self.text.push_str(&String::from_utf8(bytes).unwrap());
        }
    }
}

async fn a_dashboard_gets_events_of_a_batch_and_a_model(server: TestServer) {
    let ada = server.admin("ada").await;
    let nao = server.ship(&ada, "Nao").await;
    let mut source = EventSource::open(&ada, None).await;
    nao.put(1, &passage(DAY, 300)).await.good();
    let (_, batch) = source.next().await.unwrap();
    assert_eq!(
        batch,
        format!("{{\"vessel_id\":\"{}\",\"kind\":\"batch\"}}", nao.id)
    );
    server.advance(10.0);
    server.work().await;
    let (_, model) = source.next().await.unwrap();
    assert!(model.contains("\"kind\":\"model\""), "{model}");
    server.finish().await;
}

async fn a_dashboard_gets_an_event_of_a_logbook_entry(server: TestServer) {
    let ada = server.admin("ada").await;
    let nao = server.ship(&ada, "Nao").await;
    let mut source = EventSource::open(&ada, None).await;
    let lightning = json!({ "kind": "lightning", "from": DAY });
    ada.post(&nao.path("/logbook"), &lightning).await.good();
    let (_, received) = source.next().await.unwrap();
    assert!(received.contains("\"kind\":\"logbook\""), "{received}");
    server.finish().await;
}

async fn a_reconnecting_dashboard_gets_missed_events(server: TestServer) {
    let ada = server.admin("ada").await;
    let nao = server.ship(&ada, "Nao").await;
    let mut source = EventSource::open(&ada, None).await;
    nao.put(1, &passage(DAY, 300)).await.good();
    let (seen, _) = source.next().await.unwrap();
    drop(source);
    server.advance(10.0);
    server.work().await;
    let mut source = EventSource::open(&ada, Some(&seen)).await;
    let (_, missed) = source.next().await.unwrap();
    assert!(missed.contains("\"kind\":\"model\""), "{missed}");
    server.finish().await;
}

async fn events_stay_within_an_operator(server: TestServer) {
    let ada = server.admin("ada").await;
    let eve = server.admin("eve").await;
    let nao = server.ship(&ada, "Nao").await;
    let kogge = server.ship(&eve, "Kogge").await;
    let mut source = EventSource::open(&eve, None).await;
    nao.put(1, &passage(DAY, 3)).await.good();
    kogge.put(1, &passage(DAY, 3)).await.good();
    let (_, first) = source.next().await.unwrap();
    assert!(first.contains(&kogge.id), "{first}");
    server.finish().await;
}

async fn a_revoked_token_and_an_ended_session_get_no_more_events(server: TestServer) {
    let ada = server.admin("ada").await;
    let grace = ada.viewer(&server).await;
    let nao = server.ship(&ada, "Nao").await;
    let token = json!({ "name": "ERP", "scope": "read" });
    let made = ada.post("/tokens", &token).await.good();
    let url = format!("{}/api/v1/events", server.url);
    let request = server.http.get(url);
    let mut by_token =
        EventSource::send(request.bearer_auth(made["token"].as_str().unwrap())).await;
    let mut by_session = EventSource::open(&grace, None).await;
    let mut kept = EventSource::open(&ada, None).await;
    nao.put(1, &passage(DAY, 3)).await.good();
    for source in [&mut by_token, &mut by_session, &mut kept] {
        assert!(source.next().await.is_some());
    }
    let path = format!("/tokens/{}", made["id"].as_str().unwrap());
    for ended in [
        ada.request(Method::DELETE, &path),
        grace.request(Method::DELETE, "/session"),
    ] {
        assert_eq!(ApiResponse::send(ended).await.status, 204);
    }
    nao.put(2, &passage("2026-11-16T00:00:00Z", 3)).await.good();
    assert!(kept.next().await.is_some());
    assert_eq!(by_token.next().await, None);
    assert_eq!(by_session.next().await, None);
    server.finish().await;
}

async fn a_user_has_no_more_event_streams_than_allowed(server: TestServer) {
    let ada = server.admin("ada").await;
    let mut open = Vec::new();
    for _ in 0..STREAMS_OF_USER {
        open.push(EventSource::open(&ada, None).await);
    }
    let further = async || ApiResponse::send(ada.request(Method::GET, "/events")).await;
    assert_eq!(further().await.problem(), "too-many-streams");
    // Another user has streams of their own.
    let grace = ada.viewer(&server).await;
    drop(EventSource::open(&grace, None).await);
    // Once one is closed there is room again: the server notices when it next sends something.
    drop(open.pop());
    let nao = server.ship(&ada, "Nao").await;
    let reopened = async {
        for seq in 1.. {
            nao.put(seq, &passage(DAY, 3)).await.good();
            let request = ada.request(Method::GET, "/events");
            if request.send().await.unwrap().status() == 200 {
                break;
            }
        }
    };
    let reopened = timeout(Duration::from_secs(20), reopened).await;
    reopened.expect("room for a stream within 20 s");
    server.finish().await;
}

async fn a_stopping_server_closes_its_event_streams(server: TestServer) {
    let ada = server.admin("ada").await;
    let mut source = EventSource::open(&ada, None).await;
    server.app.stopping.cancel();
    assert_eq!(source.next().await, None);
    server.finish().await;
}

async fn count_events(server: &TestServer) -> (i64,) {
    let sql = "SELECT COUNT(*) FROM events";
    match server.app.db.pools() {
        Pools::Sqlite { readers, .. } => sqlx::query_as(sql).fetch_one(readers).await,
        Pools::Postgres(pool) => sqlx::query_as(sql).fetch_one(pool).await,
    }
    .unwrap()
}

async fn events_are_deleted_after_a_day(server: TestServer) {
    let ada = server.admin("ada").await;
    let nao = server.ship(&ada, "Nao").await;
    let mut source = EventSource::open(&ada, None).await;
    nao.put(1, &passage(DAY, 3)).await.good();
    nao.put(2, &passage(DAY, 3)).await.good();
    let (seen, _) = source.next().await.unwrap();
    server.advance(86_401.0);
    events::prune(&server.app.db, server.app.clock.now().into())
        .await
        .unwrap();
    nao.put(3, &passage(DAY, 3)).await.good();
    // The session has expired.
    let ada = Person::sign_in(&server, ada.operator, &ada.email).await;
    let mut source = EventSource::open(&ada, Some(&seen)).await;
    let (third, _) = source.next().await.unwrap();
    // If the second event were still there, it would come first.
    let (listed,) = count_events(&server).await;
    assert_eq!(listed, 1, "after {third}");
    server.finish().await;
}
