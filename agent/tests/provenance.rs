//! Sources that must not be believed, and the real agent.

#![allow(clippy::unwrap_used, reason = "helpers of tests may panic too")]

mod common;

use binnacle_nmea::sentence::ThsMode;
use binnacle_nmea::{Data, parse};
use common::agent::Agent;
use common::bridge::{self, Bridge, changed, sentence};
use common::server::TestServer;
use common::{at_end, status};
use futures_util::{SinkExt, StreamExt};
use serde_json::{Value, json};
use std::time::Duration;
use tokio::io::{AsyncBufReadExt, AsyncWriteExt, BufReader};
use tokio::net::{TcpListener, TcpStream};
use tokio::time::{Instant, interval, timeout};
use tokio_tungstenite::accept_async;
use tokio_tungstenite::tungstenite::Message;

const PATIENCE: Duration = Duration::from_mins(2);
const HOUR_S: i64 = 3_600;

/// Raw reading of the compass in a second.
fn compass_deg(offset_s: i64) -> f64 {
    let second = String::from_utf8(bridge::second(offset_s)).unwrap();
    let hdg = second.lines().find(|line| line.contains("HDG")).unwrap();
    let Data::Hdg(hdg) = parse(hdg.as_bytes()).unwrap().data else {
        panic!("{hdg}")
    };
    hdg.reading_deg.unwrap()
}

/// True heading that a converter makes of the compass.
fn copy_deg(offset_s: i64) -> f64 {
    (compass_deg(offset_s) + 1.2).rem_euclid(360.0)
}

fn problems(status: &Value) -> String {
    status["source_problems"].to_string()
}

#[tokio::test]
async fn the_own_compass_heard_as_a_gyro_accepts_no_window_and_is_named() {
    let seconds = 6 * HOUR_S;
    let bridge = Bridge::playing(seconds, |offset_s| {
        let copy = format!("HETHS,{:.6},A", copy_deg(offset_s));
        changed(offset_s, &["$HETHS"], &[copy])
    })
    .await;
    bridge.sail();
    let agent = Agent::new(bridge.address);
    let running = agent.run().await;
    let status = at_end(&running, seconds).await;
    let windows = &status["windows"];
    assert_eq!(windows["accepted"], Value::Null, "{windows}");
    assert!(windows["not_independent"].as_u64() > Some(600), "{windows}");
    let problems = problems(&status);
    assert!(
        problems.contains("gyro: the heading shares the compass's own noise"),
        "{problems}"
    );
    let said = agent.call(&["status"]).await;
    let said = String::from_utf8(said.stdout).unwrap();
    assert!(said.contains("SOURCES    gyro: "), "{said}");
    let (_, log) = running.terminate().await;
    assert!(log.contains("gyro: the heading shares"), "{log}");
}

#[tokio::test]
async fn the_own_compass_heard_beside_a_gyro_is_in_no_sample_and_is_named() {
    let seconds = 6 * HOUR_S;
    let bridge = Bridge::playing(seconds, |offset_s| {
        let copy = format!("GPTHS,{:.6},A", copy_deg(offset_s));
        changed(offset_s, &[], &[copy])
    })
    .await;
    let server = TestServer::start(None, None).await;
    let agent = Agent::new(bridge.address);
    agent.configure(
        "[roles]",
        "satellite = [{ input = \"bridge\", talker = \"GP\", sentence = \"THS\" }]",
    );
    agent.enrol(&server.url).await;
    bridge.sail();
    let running = agent.run().await;
    let status = at_end(&running, seconds).await;
    let problems = problems(&status);
    assert!(
        problems.contains("satellite: the heading shares"),
        "{problems}"
    );
    assert!(!problems.contains("gyro: the heading"), "{problems}");
    timeout(PATIENCE, server.has(1)).await.unwrap();
    running.terminate().await;
    let samples: Vec<_> = server
        .decoded()
        .into_iter()
        .flat_map(|b| b.samples)
        .collect();
    assert!(!samples.is_empty());
    for sample in samples {
        assert!(
            sample.gyro.is_some() && sample.satellite.is_none(),
            "{sample:?}"
        );
    }
}

#[tokio::test]
async fn two_compasses_behind_one_talker_are_named_and_not_averaged() {
    let seconds = HOUR_S;
    let bridge = Bridge::playing(seconds, |offset_s| {
        let other = format!(
            "HCHDG,{:.2},,,0.55,E",
            (compass_deg(offset_s) + 1.5).rem_euclid(360.0)
        );
        changed(offset_s, &[], &[other])
    })
    .await;
    bridge.sail();
    let agent = Agent::new(bridge.address);
    let running = agent.run().await;
    let status = at_end(&running, seconds).await;
    let windows = &status["windows"];
    assert_eq!(windows["accepted"], Value::Null, "{windows}");
    assert!(windows["two_sensors"].as_u64() > Some(300), "{windows}");
    let problems = problems(&status);
    assert!(
        problems.contains("compass: two sensors 1.5° apart send as bridge HCHDG"),
        "{problems}"
    );
    assert_eq!(status["heading"]["compass_deg"], Value::Null);
    running.kill().await;
}

#[tokio::test]
async fn a_transponder_without_the_letter_of_its_variation_gives_the_position() {
    let seconds = 600;
    let bridge = Bridge::playing(seconds, |offset_s| {
        let second = String::from_utf8(bridge::second(offset_s)).unwrap();
        let rmc = second.lines().find(|line| line.contains("RMC")).unwrap();
        let fields: Vec<&str> = rmc[1..rmc.len() - 3].split(',').take(10).collect();
        changed(offset_s, &["$GPRMC"], &[format!("{},,A", fields.join(","))])
    })
    .await;
    bridge.sail();
    let running = Agent::new(bridge.address).run().await;
    let status = at_end(&running, seconds).await;
    let lat_deg = status["position"]["lat"].as_f64().unwrap();
    let place = bridge::place(seconds - 1);
    assert!((lat_deg - place.lat_deg_north).abs() < 1e-4, "{status}");
    running.kill().await;
}

/// A Signal K server that greets, and repeats a compass of an hour ago; then its compass is alive
/// again.
async fn serve_cached(listener: TcpListener, mut alive: tokio::sync::watch::Receiver<bool>) {
    let (stream, _) = listener.accept().await.unwrap();
    let mut server = accept_async(stream).await.unwrap();
    server.next().await.unwrap().unwrap();
    let value = |at: &str, path: &str, value: Value| {
        json!({"updates": [{"$source": "n2k.4", "timestamp": at,
            "values": [{"path": path, "value": value}]}]})
    };
    let compass = |at: &str| value(at, "navigation.headingCompass", json!(1.0));
    for message in [
        json!({"self": "vessels.urn:x", "timestamp": "2026-01-02T12:00:00Z"}),
        compass("2026-01-02T11:00:00Z"),
        value(
            "2026-01-02T12:00:00Z",
            "navigation.datetime",
            json!("2026-01-02T12:00:00Z"),
        ),
    ] {
        server
            .send(Message::text(message.to_string()))
            .await
            .unwrap();
    }
    alive.wait_for(|alive| *alive).await.unwrap();
    let mut tenths = 0;
    let mut ticks = interval(Duration::from_millis(100));
    loop {
        ticks.tick().await;
        tenths += 1;
        let at = format!(
            "2026-01-02T12:{:02}:{:02}.{}Z",
            1 + tenths / 600,
            tenths / 10 % 60,
            tenths % 10
        );
        if server
            .send(Message::text(compass(&at).to_string()))
            .await
            .is_err()
        {
            return;
        }
    }
}

#[tokio::test]
async fn what_a_server_repeats_on_connect_is_no_reading_of_now() {
    let listener = TcpListener::bind("127.0.0.1:0").await.unwrap();
    let address = listener.local_addr().unwrap();
    let (alive, is_alive) = tokio::sync::watch::channel(false);
    tokio::spawn(serve_cached(listener, is_alive));
    let agent = Agent::new("127.0.0.1:9".parse().unwrap());
    let config = std::fs::read_to_string(agent.config()).unwrap();
    let config = config
        .replace(
            "tcp = \"127.0.0.1:9\"",
            &format!("signalk = \"ws://{address}/signalk/v1/stream\""),
        )
        .replace("talker = \"HC\"", "source = \"n2k.4\"")
        .replace("talker = \"GP\", sentence = \"RMC\"", "source = \"n2k.4\"");
    std::fs::write(agent.config(), config).unwrap();
    let running = agent.run().await;
    let heard = async {
        loop {
            let status = status(&running).await;
            let sources = status["sources"].as_array().cloned().unwrap_or_default();
            if sources.len() == 2 {
                return status;
            }
        }
    };
    let cached = timeout(PATIENCE, heard).await.unwrap();
    assert_eq!(cached["heading"]["compass_deg"], Value::Null, "{cached}");
    alive.send_replace(true);
    let alive_again = async { while status(&running).await["heading"]["compass_deg"].is_null() {} };
    timeout(PATIENCE, alive_again).await.unwrap();
    running.kill().await;
}

/// A compass and its repeater, which drops the deviation and latches the last heading; later a
/// compass sends in the repeater's name.
async fn latch_and_move(role: &str) {
    let listener = TcpListener::bind("127.0.0.1:0").await.unwrap();
    let server = TestServer::start(Some(common::model()), None).await;
    let agent = Agent::new(listener.local_addr().unwrap());
    let config = std::fs::read_to_string(agent.config()).unwrap();
    let old = "compass = [{ input = \"bridge\", talker = \"HC\", sentence = \"HDG\" }]";
    std::fs::write(agent.config(), config.replace(old, role)).unwrap();
    agent.enrol(&server.url).await;
    let running = agent.run().await;
    let (mut line, _) = listener.accept().await.unwrap();
    let output = TcpStream::connect(running.output).await.unwrap();
    let mut lines = BufReader::new(output).lines();
    let mut ticks = interval(Duration::from_millis(100));
    let (mut tenths, mut valid): (u32, u32) = (0, 0);
    let mut heading_deg = 90.0;
    let mut died: Option<Instant> = None;
    let returned = async {
        loop {
            let silent = died.map(|died| died.elapsed());
            tokio::select! {
                _ = ticks.tick() => {
                    tenths += 1;
                    // The silence limit is three seconds.
                    if silent.is_none_or(|silent| silent > Duration::from_secs(7)) {
                        heading_deg = 90.0 + f64::from(tenths % 7) * 0.3;
                    }
                    if died.is_none() {
                        line.write_all(&sentence(&format!("HCHDG,{heading_deg:.1},,,,"))).await.unwrap();
                    }
                    for said in [
                        format!("SDHDG,{heading_deg:.1},,,,"),
                        "GPRMC,120000,A,4330.0,N,00300.0,W,12.0,90.0,010926,,".to_owned(),
                    ] {
                        line.write_all(&sentence(&said)).await.unwrap();
                    }
                    if valid > 40 && died.is_none() {
                        died = Some(Instant::now());
                    }
                }
                heard = lines.next_line() => {
                    let heard = heard.unwrap().unwrap() + "\r\n";
                    let Ok(sentence) = parse(heard.as_bytes()) else { continue };
                    let Data::Ths(ths) = sentence.data else { continue };
                    if ths.mode != ThsMode::Estimated {
                        continue;
                    }
                    valid += 1;
                    match silent.map(|silent| silent.as_secs_f64()) {
                        Some(silent_s) if silent_s > 7.0 => return,
                        Some(silent_s) => assert!(silent_s < 2.5, "{role}: {silent_s}"),
                        None => {}
                    }
                }
            }
        }
    };
    timeout(PATIENCE, returned).await.unwrap();
    running.kill().await;
}

#[tokio::test]
async fn a_repeater_of_a_dead_compass_is_no_compass_until_it_moves_by_itself() {
    tokio::join!(
        latch_and_move(
            "compass = [{ input = \"bridge\", talker = \"HC\", sentence = \"HDG\" }, \
             { input = \"bridge\", talker = \"SD\", sentence = \"HDG\" }]",
        ),
        latch_and_move("compass = [{ input = \"bridge\", sentence = \"HDG\" }]"),
    );
}
