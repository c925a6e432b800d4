//! The whole agent between a vessel and a server, over real sockets.

#![allow(clippy::unwrap_used, reason = "helpers of tests may panic too")]

mod common;

use binnacle_compass::angle::wrap_180;
use binnacle_compass::sample::SourceId;
use binnacle_compass::time::Timestamp;
use binnacle_nmea::sentence::ThsMode;
use binnacle_nmea::{Data, parse};
use common::agent::Agent;
use common::bridge::{self, AIR_C, Bridge, DRIFT_DEG, LEAD_DEG, LIST_DEG, ROLL_DEG};
use common::server::{STREAM, TestServer};
use serde_json::Value;
use sqlx::sqlite::SqliteConnectOptions;
use sqlx::{Connection, SqliteConnection};
use std::collections::BTreeSet;
use std::time::Duration;
use tokio::io::{AsyncBufReadExt, BufReader};
use tokio::net::TcpStream;
use tokio::time::timeout;

const PATIENCE: Duration = Duration::from_mins(2);

#[tokio::test]
async fn a_voyage_reaches_the_server_and_comes_back_as_a_heading() {
    let seconds = 12 * 3600;
    let bridge = Bridge::new(seconds).await;
    let server = TestServer::start(Some(common::model()), None).await;
    let agent = Agent::new(bridge.address);
    agent.enrol(&server.url).await;
    let running = agent.run().await;
    loop {
        // Not before the server's settings are in effect.
        let status = common::fetch(running.page, "/api/status").await;
        let status: Value = serde_json::from_str(&status).unwrap();
        if status["link"]["state"] == "up" {
            break;
        }
    }
    bridge.sail();
    timeout(PATIENCE, server.has(10)).await.unwrap();

    // While the bridge talks, the heading is corrected; when it falls silent, not valid.
    let stream = TcpStream::connect(running.output).await.unwrap();
    let mut lines = BufReader::new(stream).lines();
    let mut quality = String::new();
    let not_valid = timeout(PATIENCE, async {
        let mut last_hdg = None;
        loop {
            let line = lines.next_line().await.unwrap().unwrap();
            if line.starts_with("$PBINQ") {
                quality = line;
                continue;
            }
            match parse(line.as_bytes()).unwrap().data {
                Data::Hdg(hdg) => last_hdg = Some(hdg),
                Data::Ths(ths) if ths.mode == ThsMode::NotValid => return ths,
                Data::Ths(ths) => {
                    assert_eq!(ths.mode, ThsMode::Estimated);
                    let hdg = last_hdg.unwrap();
                    assert_eq!(hdg.deviation_deg_east, Some(2.5));
                    let sum = hdg.reading_deg.unwrap() + 2.5 + hdg.variation_deg_east.unwrap();
                    assert!(wrap_180(sum - ths.heading_deg_true.unwrap()).abs() < 0.11);
                }
                other => panic!("{other:?}"),
            }
        }
    });
    assert_eq!(not_valid.await.unwrap().heading_deg_true, None);
    assert!(quality.starts_with("$PBINQ,A,3,2."), "{quality}");
    assert!(quality.contains(",0.20*"), "{quality}");

    let (code, log) = running.terminate().await;
    assert_eq!(code, Some(0), "{log}");
    assert!(!log.contains("the-token"), "{log}");

    let mut windows = 0;
    for batch in server.decoded() {
        for sample in batch.samples {
            let lead = wrap_180(sample.gyro.unwrap().degrees() - sample.compass.degrees());
            assert!((lead - LEAD_DEG).abs() < 0.2, "{sample:?}");
            let offset = sample.time.micros() / 1_000_000 - bridge::START_S;
            let heading = bridge::heading_deg(offset);
            assert!(wrap_180(sample.gyro.unwrap().degrees() - heading).abs() < 0.06);
            let drift = sample.cog.unwrap().degrees() - heading;
            assert!((wrap_180(drift) - DRIFT_DEG).abs() < 0.51, "{sample:?}");
            assert_eq!(sample.roll_deg, Some(LIST_DEG));
            assert_eq!(sample.roll_spread_deg, Some(ROLL_DEG));
            assert_eq!(sample.temperature_c, Some(AIR_C));
            let source = SourceId::from_name("bridge HE THS");
            assert_eq!(sample.gyro_source, Some(source));
            assert_eq!(sample.satellite_source, None);
            windows += u64::from(sample.windows);
        }
    }
    // Ten hours at least, less three minutes after each turn.
    assert!(windows > 10 * (360 - 20) - 60, "{windows}");
}

#[tokio::test]
async fn killed_again_and_again_it_sends_every_sealed_sample_once() {
    let bridge = Bridge::new(10 * 24 * 3600).await;
    bridge.sail();
    let server = TestServer::start(None, Some(5)).await;
    let agent = Agent::new(bridge.address);
    agent.enrol(&server.url).await;
    for round in 1..=5 {
        let running = agent.run().await;
        let wanted = *server.stored_batches.borrow() + 3 * round;
        timeout(PATIENCE, server.has(wanted)).await.unwrap();
        running.kill().await;
    }
    let running = agent.run().await;
    let status = timeout(PATIENCE, async {
        loop {
            // The last batches are on their way, or waiting for the next try.
            let done = agent.call(&["status", "--json"]).await;
            let status: Value = serde_json::from_slice(&done.stdout).unwrap();
            let spool = &status["spool"];
            if spool["waiting_batches"] == 0 && spool["acknowledged_batches"].as_u64() > Some(45) {
                return status;
            }
        }
    });
    let status = status.await.unwrap();
    assert_eq!(status["running"], true);
    assert_eq!(status["link"]["state"], "up");
    running.kill().await;

    let options = SqliteConnectOptions::new()
        .filename(agent.spool())
        .read_only(true);
    let mut spool = SqliteConnection::connect_with(&options).await.unwrap();
    let acknowledged: Vec<(String, i64, i64)> =
        sqlx::query_as("SELECT stream, seq, samples FROM acknowledged ORDER BY seq")
            .fetch_all(&mut spool)
            .await
            .unwrap();
    let batches = server.decoded();
    for ((stream, seq, samples), number) in acknowledged.iter().zip(1..) {
        assert_eq!((stream, *seq), (&STREAM.to_string(), number));
        let sent = &batches[usize::try_from(*seq).unwrap() - 1];
        assert_eq!(sent.samples.len(), usize::try_from(*samples).unwrap());
    }
    assert_eq!(
        server.stored.lock().unwrap().forks,
        0,
        "a batch was changed after it was sent"
    );
    let times: Vec<Timestamp> = batches
        .iter()
        .flat_map(|b| &b.samples)
        .map(|s| s.time)
        .collect();
    let distinct: BTreeSet<Timestamp> = times.iter().copied().collect();
    assert_eq!(times.len(), distinct.len(), "a sample was sent twice");
}
