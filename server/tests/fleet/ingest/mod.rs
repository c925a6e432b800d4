//! Ingest of batches: each stored once, none lost, none altered.

mod imports;
mod short_bursts;
mod statements;

use binnacle_platform::db::Pools;
use binnacle_server_testing::on_both;
use binnacle_server_testing::{
    ApiResponse, Engine, TestServer, days_at_sea, frame, passage, true_model,
};
use binnacle_wire::batch::StreamId;
use serde_json::json;
use uuid::Uuid;

on_both!(
    a_batch_sent_twice_is_stored_once,
    other_bytes_under_the_same_number_fork_the_stream,
    batches_out_of_order_are_acknowledged_up_to_the_gap,
    a_batch_without_samples_counts_its_windows,
    a_late_batch_does_not_move_the_last_position_back,
    a_future_sample_does_not_set_the_last_position,
    a_stored_future_position_is_replaced,
    a_batch_under_a_wrong_name_is_refused_and_not_stored,
    an_acknowledged_batch_survives_a_restart,
    concurrent_batches_of_one_stream_are_all_stored,
    a_waiting_response_contains_the_new_model,
    waiting_without_a_worker_times_out,
);

const DAY: &str = "2026-11-20T00:00:00Z";

async fn a_waiting_response_contains_the_new_model(server: TestServer) {
    let ada = server.admin("ada").await;
    let nao = server.ship(&ada, "Nao").await;
    let samples = days_at_sea(&true_model(), "2026-11-10T00:00:00Z", 6.0);
    let path = format!("/streams/{}/batches/1?wait=50", nao.stream);
    let request = nao.request(reqwest::Method::PUT, &path);
    let sending = ApiResponse::send(request.body(frame(nao.stream, 1, &samples)));
    let working = async {
        while server.work().await.is_empty() {
            tokio::task::yield_now().await;
        }
    };
    let (response, ()) = tokio::join!(sending, working);
    let response = response.good();
    assert_eq!(response["contiguous_seq"], 1);
    assert_eq!(response["model"]["version"], 1, "{response}");
    server.finish().await;
}

async fn waiting_without_a_worker_times_out(server: TestServer) {
    let ada = server.admin("ada").await;
    let nao = server.ship(&ada, "Nao").await;
    let path = format!("/streams/{}/batches/1?wait=0", nao.stream);
    let request = nao.request(reqwest::Method::PUT, &path);
    let sending = ApiResponse::send(request.body(frame(nao.stream, 1, &passage(DAY, 6))));
    let response = sending.await.good();
    assert_eq!(response["contiguous_seq"], 1);
    assert!(response.get("model").is_none());
    server.finish().await;
}

async fn a_batch_sent_twice_is_stored_once(server: TestServer) {
    let ada = server.admin("ada").await;
    let nao = server.ship(&ada, "Nao").await;
    let samples = passage(DAY, 6);
    for _ in 0..2 {
        let response = nao.put(1, &samples).await.good();
        assert_eq!(response["contiguous_seq"], 1);
        assert_eq!(response["server_time"], "2026-11-21T07:00:00Z");
        assert!(response.get("model").is_none() && response.get("settings").is_none());
    }
    let streams = ada.get(&nao.path("/agents")).await.good();
    let stream = &streams["items"][0];
    assert_eq!(stream["batches"], 1);
    assert_eq!(stream["samples"], 6);
    assert_eq!(stream["tally"], json!({ "accepted": 360 }));
    assert_eq!(stream["last_upload_at"], "2026-11-21T07:00:00Z");
    server.finish().await;
}

async fn other_bytes_under_the_same_number_fork_the_stream(server: TestServer) {
    let ada = server.admin("ada").await;
    let nao = server.ship(&ada, "Nao").await;
    nao.put(1, &passage(DAY, 6)).await.good();
    let other = nao.put(1, &passage(DAY, 5)).await;
    assert_eq!(other.status, 409);
    assert_eq!(other.problem(), "stream-forked");
    let streams = ada.get(&nao.path("/agents")).await.good();
    assert_eq!(streams["items"][0]["samples"], 6);
    server.finish().await;
}

async fn batches_out_of_order_are_acknowledged_up_to_the_gap(server: TestServer) {
    let ada = server.admin("ada").await;
    let nao = server.ship(&ada, "Nao").await;
    for (seq, contiguous) in [(2, 0), (5, 0), (1, 2), (4, 2), (3, 5), (6, 6)] {
        let response = nao.put(seq, &passage(DAY, 2)).await.good();
        assert_eq!(response["contiguous_seq"], contiguous, "after batch {seq}");
    }
    server.finish().await;
}

async fn a_batch_without_samples_counts_its_windows(server: TestServer) {
    let ada = server.admin("ada").await;
    let nao = server.ship(&ada, "Nao").await;
    assert_eq!(nao.put(1, &[]).await.good()["contiguous_seq"], 1);
    assert_eq!(server.work().await, []);
    server.finish().await;
}

async fn a_late_batch_does_not_move_the_last_position_back(server: TestServer) {
    let ada = server.admin("ada").await;
    let nao = server.ship(&ada, "Nao").await;
    nao.put(2, &passage("2026-11-20T12:00:00Z", 1)).await.good();
    nao.put(1, &passage(DAY, 1)).await.good();
    let vessel = ada.get(&nao.path("")).await.good();
    assert_eq!(vessel["last_position"]["at"], "2026-11-20T12:00:00Z");
    server.finish().await;
}

async fn a_future_sample_does_not_set_the_last_position(server: TestServer) {
    let ada = server.admin("ada").await;
    let nao = server.ship(&ada, "Nao").await;
    let at = async || ada.get(&nao.path("")).await.good()["last_position"]["at"].clone();
    let mut samples = passage(DAY, 1);
    // The server's clock is at 07:00 on the 21st.
    samples.extend(passage("2026-11-22T07:01:00Z", 1));
    nao.put(1, &samples).await.good();
    assert_eq!(at().await, DAY);
    nao.put(2, &passage("2029-07-06T00:00:00Z", 2)).await.good();
    assert_eq!(at().await, DAY);
    nao.put(3, &passage("2026-11-22T07:00:00Z", 1)).await.good();
    assert_eq!(at().await, "2026-11-22T07:00:00Z");
    let streams = ada.get(&nao.path("/agents")).await.good();
    assert_eq!(streams["items"][0]["samples"], 5);
    server.finish().await;
}

async fn a_stored_future_position_is_replaced(server: TestServer) {
    let ada = server.admin("ada").await;
    let nao = server.ship(&ada, "Nao").await;
    nao.put(1, &passage(DAY, 1)).await.good();
    // As an earlier version left it: the year 2046.
    server
        .run_sql("UPDATE vessels SET last_sample_at = 2414448000000000")
        .await;
    nao.put(2, &passage("2026-11-20T12:00:00Z", 1)).await.good();
    let vessel = ada.get(&nao.path("")).await.good();
    assert_eq!(vessel["last_position"]["at"], "2026-11-20T12:00:00Z");
    server.finish().await;
}

async fn a_batch_under_a_wrong_name_is_refused_and_not_stored(server: TestServer) {
    let ada = server.admin("ada").await;
    let nao = server.ship(&ada, "Nao").await;
    let good = frame(nao.stream, 1, &passage(DAY, 6));
    let numbered = |seq| frame(nao.stream, seq, &passage(DAY, 1));
    let mut flipped = good.clone();
    flipped[40] ^= 0x10;
    let cases = [
        (1, b"noise".to_vec(), "bad-request"),
        (1, Vec::new(), "bad-request"),
        (1, flipped, "bad-request"),
        (1, good[..good.len() - 1].to_vec(), "bad-request"),
        (2, good, "invalid"),
        (1, frame(StreamId(Uuid::now_v7()), 1, &[]), "invalid"),
        (1, vec![0; 262_145], "too-large"),
        (1 << 53, numbered(1 << 53), "bad-request"),
        (i64::MAX as u64, numbered(i64::MAX as u64), "bad-request"),
        (u64::MAX, numbered(u64::MAX), "bad-request"),
    ];
    for (seq, bytes, problem) in cases {
        let response = nao.put_bytes(seq, bytes).await;
        assert_eq!(response.problem(), problem, "{response:?}");
    }
    for seq in ["0", "-1", "x", "99999999999999999999"] {
        let path = format!("/streams/{}/batches/{seq}", nao.stream);
        let body = frame(nao.stream, 1, &[]);
        let request = nao.request(reqwest::Method::PUT, &path).body(body);
        assert!([404, 422].contains(&request.send().await.unwrap().status().as_u16()));
    }
    assert_eq!(nao.downlink("").await["contiguous_seq"], 0);
    let streams = ada.get(&nao.path("/agents")).await.good();
    assert_eq!(streams["items"][0]["batches"], 0);
    let highest = (1 << 53) - 1;
    nao.put(highest, &passage(DAY, 1)).await.good();
    server.finish().await;
}

async fn an_acknowledged_batch_survives_a_restart(server: TestServer) {
    let ada = server.admin("ada").await;
    let mut nao = server.ship(&ada, "Nao").await;
    nao.put(1, &passage(DAY, 40)).await.good();
    let server = server.restart().await;
    let ada = ada.reconnect(&server);
    nao.reconnect(&server);
    assert_eq!(nao.downlink("").await["contiguous_seq"], 1);
    // Its job was stored with the batch.
    server.advance(5.0);
    assert_eq!(server.work().await.len(), 1);
    let listed = ada.get(&nao.path("/samples")).await.good();
    assert_eq!(listed["items"].as_array().unwrap().len(), 40);
    server.finish().await;
}

async fn concurrent_batches_of_one_stream_are_all_stored(server: TestServer) {
    let ada = server.admin("ada").await;
    let nao = server.ship(&ada, "Nao").await;
    let samples = passage(DAY, 2);
    let puts = (1..=20).map(|seq| nao.put(seq, &samples));
    for response in futures_util::future::join_all(puts).await {
        response.good();
    }
    assert_eq!(nao.downlink("").await["contiguous_seq"], 20);
    let streams = ada.get(&nao.path("/agents")).await.good();
    assert_eq!(streams["items"][0]["batches"], 20);
    assert_eq!(streams["items"][0]["tally"], json!({ "accepted": 2400 }));
    server.finish().await;
}

/// SQLite rolls a transaction back itself when the disk is full.
#[tokio::test]
async fn batches_are_accepted_again_after_a_full_disk() {
    let server = TestServer::start(Engine::Sqlite).await;
    let ada = server.admin("ada").await;
    let nao = server.ship(&ada, "Nao").await;
    let Pools::Sqlite { writer, .. } = server.app.db.pools() else {
        unreachable!("it was started on SQLite");
    };
    // Not below its present size.
    let limit = sqlx::query("PRAGMA max_page_count = 1");
    limit.execute(writer).await.unwrap();
    let mut seq = 1;
    while nao.put(seq, &passage(DAY, 500)).await.status == 200 {
        seq += 1;
        assert!(seq < 100, "it never gets full");
    }
    let limit = sqlx::query("PRAGMA max_page_count = 1000000");
    limit.execute(writer).await.unwrap();
    let response = nao.put(seq, &passage(DAY, 500)).await.good();
    assert_eq!(response["contiguous_seq"], seq);
    server.finish().await;
}
