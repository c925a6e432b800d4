//! Sources that must not be believed, and the real agent.

#![allow(clippy::unwrap_used, reason = "helpers of tests may panic too")]

mod common;

use binnacle_compass::angle::wrap_180;
use binnacle_compass::field::{FieldModel, field};
use binnacle_compass::time::Timestamp;
use binnacle_nmea::sentence::{Position, Rmc, ThsMode};
use binnacle_nmea::{Data, Sentence, parse, write};
use common::agent::{Agent, Running};
use common::bridge::{self, Bridge};
use common::server::TestServer;
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

fn sentence(body: &str) -> Vec<u8> {
    let sum = body.bytes().fold(0, |sum, byte| sum ^ byte);
    format!("${body}*{sum:02X}\r\n").into_bytes()
}

/// Sentences of one second, without some and with others.
fn changed(offset_s: i64, without: &[&str], with: &[String]) -> Vec<u8> {
    let second = String::from_utf8(bridge::second(offset_s)).unwrap();
    let kept = second
        .lines()
        .filter(|line| !without.iter().any(|start| line.starts_with(start)));
    let kept = kept.flat_map(|line| format!("{line}\r\n").into_bytes());
    let more = with.iter().flat_map(|body| sentence(body));
    kept.chain(more).collect()
}

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

async fn status(running: &Running) -> Value {
    let text = common::fetch(running.page, "/api/status").await;
    serde_json::from_str(&text).unwrap()
}

/// Returns the status once the ship's clock shows the last second.
async fn at_end(running: &Running, seconds: i64) -> Value {
    let (date, time) =
        binnacle_nmea::time::from_unix_micros((bridge::START_S + seconds - 1) * 1_000_000).unwrap();
    let micros = binnacle_nmea::time::unix_micros(date, time);
    let end = binnacle_compass::time::Timestamp::from_micros(micros).unwrap();
    let end = end.to_string();
    let reached = async {
        loop {
            let status = status(running).await;
            if status["ship_time"] == end.as_str() {
                return status;
            }
        }
    };
    timeout(PATIENCE, reached).await.unwrap()
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

/// A bridge in real time, to which the agent's own output returns while the compass is alive and
/// after its death. Returns the time from its last reading to the end of the output, as the
/// autopilot hears it.
async fn output_after_death(talker: &str, role: &str) -> Duration {
    let listener = TcpListener::bind("127.0.0.1:0").await.unwrap();
    let server = TestServer::start(Some(common::model()), None).await;
    let agent = Agent::new(listener.local_addr().unwrap());
    let config = std::fs::read_to_string(agent.config()).unwrap();
    let old = "compass = [{ input = \"bridge\", talker = \"HC\", sentence = \"HDG\" }]";
    std::fs::write(agent.config(), config.replace(old, role)).unwrap();
    agent.enrol(&server.url).await;
    let running = agent.run().await;
    let (mut bridge, _) = listener.accept().await.unwrap();
    let output = TcpStream::connect(running.output).await.unwrap();
    let mut lines = BufReader::new(output).lines();
    let mut ticks = interval(Duration::from_millis(100));
    let (mut valid, mut died): (u32, Option<Instant>) = (0, None);
    let start = Instant::now();
    let ended = async {
        loop {
            tokio::select! {
                _ = ticks.tick() => {
                    let rmc = "GPRMC,120000,A,4330.0,N,00300.0,W,12.0,90.0,010926,,";
                    bridge.write_all(&sentence(rmc)).await.unwrap();
                    if died.is_none() {
                        let reading = 90.0 + start.elapsed().as_secs_f64() % 2.0;
                        let hdg = format!("{talker}HDG,{reading:.1},,,,");
                        bridge.write_all(&sentence(&hdg)).await.unwrap();
                    }
                    if valid > 40 && died.is_none() {
                        died = Some(Instant::now());
                    }
                }
                line = lines.next_line() => {
                    let line = line.unwrap().unwrap() + "\r\n";
                    bridge.write_all(line.as_bytes()).await.unwrap();
                    let Ok(sentence) = parse(line.as_bytes()) else { continue };
                    let Data::Ths(ths) = sentence.data else { continue };
                    if ths.mode == ThsMode::Estimated {
                        valid += 1;
                    } else if let Some(died) = died {
                        return died.elapsed();
                    }
                }
            }
        }
    };
    let after = timeout(PATIENCE, ended).await.unwrap();
    running.kill().await;
    after
}

#[tokio::test]
async fn the_output_ends_two_seconds_after_the_compass_though_its_echo_goes_on() {
    for (talker, role) in [
        (
            "HC",
            "compass = [{ input = \"bridge\", sentence = \"HDG\" }]",
        ),
        (
            "II",
            "compass = [{ input = \"bridge\", talker = \"II\", sentence = \"HDG\" }]",
        ),
    ] {
        let after = output_after_death(talker, role).await;
        let seconds = after.as_secs_f64();
        assert!((1.8..2.5).contains(&seconds), "{talker}: {seconds}");
    }
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

/// First and last second of a false track, 200 miles off.
const SPOOFED_S: std::ops::Range<i64> = 2 * HOUR_S..3 * HOUR_S;

/// A bridge whose receiver goes in circles elsewhere for an hour.
async fn spoofed(seconds: i64) -> Bridge {
    Bridge::playing(seconds, |offset_s| {
        if !SPOOFED_S.contains(&offset_s) {
            return bridge::second(offset_s);
        }
        let angle = offset_s as f64 / 60.0;
        let (date, time) =
            binnacle_nmea::time::from_unix_micros((bridge::START_S + offset_s) * 1_000_000)
                .unwrap();
        let rmc = Rmc {
            time: Some(time),
            date: Some(date),
            position: Some(Position {
                lat_deg_north: 40.2 + 0.01 * angle.cos(),
                lon_deg_east: -3.0 + 0.01 * angle.sin(),
            }),
            sog_kn: Some(12.0),
            ..Rmc::default()
        };
        let sentence = Sentence {
            talker: *b"GP",
            data: Data::Rmc(Some(rmc)),
        };
        let mut false_fix = Vec::new();
        write(&sentence, &mut false_fix);
        [changed(offset_s, &["$GPRMC"], &[]), false_fix].concat()
    })
    .await
}

fn miles(lat_deg: f64, lon_deg: f64, place: Position) -> f64 {
    let north = (lat_deg - place.lat_deg_north) * 60.0;
    let east = (lon_deg - place.lon_deg_east) * 60.0 * lat_deg.to_radians().cos();
    north.hypot(east)
}

#[tokio::test]
async fn a_spoofed_hour_is_an_alert_and_the_heading_goes_on_from_the_reckoned_place() {
    let seconds = SPOOFED_S.end;
    let bridge = spoofed(seconds).await;
    let server = TestServer::start(Some(common::model()), None).await;
    let agent = Agent::new(bridge.address);
    agent.enrol(&server.url).await;
    let running = agent.run().await;
    let has_model = async { while status(&running).await["model"].is_null() {} };
    timeout(PATIENCE, has_model).await.unwrap();
    bridge.sail();
    let status = at_end(&running, seconds).await;
    let since = status["gnss_interference"]["since"].as_str();
    assert!(
        since.is_some_and(|since| since.starts_with("2026-09-01T02:00:0")),
        "{status}"
    );
    let at = |name: &str| status["position"][name].as_f64().unwrap();
    let off_nm = miles(at("lat"), at("lon"), bridge::place(seconds - 1));
    assert!(off_nm < 2.0, "{off_nm}");
    let heading = |name: &str| status["heading"][name].as_f64().unwrap();
    let there = bridge::place(seconds - 1);
    let there = binnacle_compass::position::Position::new(there.lat_deg_north, there.lon_deg_east);
    let time = Timestamp::parse(status["ship_time"].as_str().unwrap()).unwrap();
    let field = field(FieldModel::Igrf14, there.unwrap(), 0.0, time).unwrap();
    let variation_deg = field.declination().degrees_east();
    let true_deg = heading("compass_deg") + heading("deviation_deg") + variation_deg;
    let error_deg = wrap_180(heading("true_deg") - true_deg).abs();
    assert!(error_deg < heading("band95_deg"), "{status}");
    let said = agent.call(&["status"]).await;
    let said = String::from_utf8(said.stdout).unwrap();
    assert!(
        said.contains("GNSS interference since 01 Sep 02:00 UTC"),
        "{said}"
    );
    running.kill().await;
}

#[tokio::test]
async fn after_a_spoofed_hour_no_sample_is_wrong_and_everything_comes_back() {
    let seconds = 4 * HOUR_S;
    let bridge = spoofed(seconds).await;
    let server = TestServer::start(None, None).await;
    let agent = Agent::new(bridge.address);
    agent.enrol(&server.url).await;
    bridge.sail();
    let running = agent.run().await;
    let status = at_end(&running, seconds).await;
    assert_eq!(status["gnss_interference"], Value::Null, "{status}");
    let server_has = server.has(1);
    running.terminate().await;
    timeout(PATIENCE, server_has).await.unwrap();
    let samples: Vec<_> = server
        .decoded()
        .into_iter()
        .flat_map(|batch| batch.samples)
        .collect();
    let mut reckoned = 0;
    for sample in &samples {
        let offset_s = sample.time.micros() / 1_000_000 - bridge::START_S;
        let place = bridge::place(offset_s);
        let (lat, lon) = (sample.position.lat_deg(), sample.position.lon_deg());
        assert!(miles(lat, lon, place) < 2.5, "{sample:?}");
        assert_eq!(sample.position_reckoned, is_spoofed(offset_s), "{sample:?}");
        reckoned += u32::from(sample.position_reckoned);
    }
    assert!(
        reckoned >= 4 && samples.len() > 15,
        "{reckoned} of {}",
        samples.len()
    );
}

/// Returns whether a time lies in the false track, or in the minutes until the true one is
/// trusted again.
fn is_spoofed(offset_s: i64) -> bool {
    (SPOOFED_S.start..SPOOFED_S.end + 600).contains(&offset_s)
}
