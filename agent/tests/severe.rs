//! Severe cases and the real agent: a spoofed hour, hours of jamming, and a dead compass whose echo
//! goes on.

#![allow(clippy::unwrap_used, reason = "helpers of tests may panic too")]

mod common;

use binnacle_compass::angle::wrap_180;
use binnacle_compass::field::{FieldModel, field};
use binnacle_compass::sample::Sample;
use binnacle_compass::time::Timestamp;
use binnacle_nmea::sentence::{Position, Rmc, ThsMode, Zda};
use binnacle_nmea::time::from_unix_micros;
use binnacle_nmea::{Data, Sentence, parse, write};
use common::agent::Agent;
use common::at_end;
use common::bridge::{self, Bridge, changed, sentence};
use common::server::TestServer;
use serde_json::Value;
use std::net::SocketAddr;
use std::time::Duration;
use tokio::io::{AsyncBufReadExt, AsyncWriteExt, BufReader};
use tokio::net::{TcpListener, TcpStream, UdpSocket};
use tokio::time::{Instant, interval, timeout};

const PATIENCE: Duration = Duration::from_mins(2);
const HOUR_S: i64 = 3_600;
/// First and last second of a false track, 200 miles off.
const SPOOFED_S: std::ops::Range<i64> = 2 * HOUR_S..3 * HOUR_S;
/// Seconds of it in which the time is false as well, and by how much.
const FALSE_TIME_S: std::ops::Range<i64> = 9_000..3 * HOUR_S;
const TIME_JUMP_S: i64 = 2_400;
/// Time until a true track is trusted again, seconds.
const RECOVERY_S: i64 = 600;
const SATELLITE: &str = "satellite = [{ input = \"bridge\", talker = \"GP\", sentence = \"THS\" }]";

/// Sentences of a receiver that goes in circles elsewhere, and whose compass turns with it.
fn false_second(offset_s: i64, time_off_s: i64) -> Vec<u8> {
    let angle = offset_s as f64 / 60.0;
    let micros = (bridge::START_S + offset_s + time_off_s) * 1_000_000;
    let (date, time) = from_unix_micros(micros).unwrap();
    let rmc = Rmc {
        time: Some(time),
        date: Some(date),
        position: Some(Position {
            lat_deg_north: 40.2 + 0.01 * angle.cos(),
            lon_deg_east: -3.0 + 0.01 * angle.sin(),
        }),
        sog_kn: Some(12.0),
        cog_deg_true: Some((angle.to_degrees() + 90.0).rem_euclid(360.0)),
        ..Rmc::default()
    };
    let mut said = Vec::new();
    let data = Data::Rmc(Some(rmc));
    write(
        &Sentence {
            talker: *b"GP",
            data,
        },
        &mut said,
    );
    let turning = (angle.to_degrees() + 90.0).rem_euclid(360.0);
    said.extend(sentence(&format!("GPTHS,{turning:.1},A")));
    said
}

/// Sentences of one second with a satellite compass. In [`SPOOFED_S`] both are false, and from the
/// start of `false_time` on the time too.
fn spoofed_second(offset_s: i64, false_time: &std::ops::Range<i64>) -> Vec<u8> {
    if !SPOOFED_S.contains(&offset_s) {
        let heading = bridge::heading_deg(offset_s);
        return changed(offset_s, &[], &[format!("GPTHS,{heading:.1},A")]);
    }
    let time_off_s = if false_time.contains(&offset_s) {
        TIME_JUMP_S
    } else {
        0
    };
    [
        changed(offset_s, &["$GPRMC"], &[]),
        false_second(offset_s, time_off_s),
    ]
    .concat()
}

fn miles(lat_deg: f64, lon_deg: f64, place: Position) -> f64 {
    let north = (lat_deg - place.lat_deg_north) * 60.0;
    let east = (lon_deg - place.lon_deg_east) * 60.0 * lat_deg.to_radians().cos();
    north.hypot(east)
}

/// Waits until the server has a sample of a second or later. Returns all that it has.
async fn samples_until(server: &TestServer, wanted_s: i64) -> Vec<Sample> {
    let received = async {
        loop {
            let batches = server.decoded();
            let count = batches.len() as u64;
            let samples: Vec<Sample> = batches.into_iter().flat_map(|b| b.samples).collect();
            if samples.iter().any(|sample| error_nm(sample).0 >= wanted_s) {
                return samples;
            }
            server.has(count + 1).await;
        }
    };
    let received = timeout(PATIENCE, received).await;
    received.expect("the samples never came")
}

/// Returns the second of a sample, and its distance from the ship's place then, nautical miles.
fn error_nm(sample: &Sample) -> (i64, f64) {
    let offset_s = sample.time.micros() / 1_000_000 - bridge::START_S;
    let (lat, lon) = (sample.position.lat_deg(), sample.position.lon_deg());
    (offset_s, miles(lat, lon, bridge::place(offset_s)))
}

/// Asserts that the corrected heading of a status is right within its band.
fn assert_heading_within_band(status: &Value, offset_s: i64) {
    let heading = |name: &str| status["heading"][name].as_f64().unwrap();
    let there = bridge::place(offset_s);
    let there = binnacle_compass::position::Position::new(there.lat_deg_north, there.lon_deg_east);
    let time = Timestamp::from_micros((bridge::START_S + offset_s) * 1_000_000).unwrap();
    let field = field(FieldModel::Igrf14, there.unwrap(), 0.0, time).unwrap();
    let variation_deg = field.declination().degrees_east();
    let true_deg = heading("compass_deg") + heading("deviation_deg") + variation_deg;
    let error_deg = wrap_180(heading("true_deg") - true_deg).abs();
    assert!(error_deg < heading("band95_deg"), "{status}");
}

#[tokio::test]
async fn a_spoofed_hour_is_an_alert_and_the_heading_goes_on_from_the_reckoned_place() {
    let seconds = SPOOFED_S.end;
    let bridge = Bridge::playing(seconds, |offset_s| spoofed_second(offset_s, &(0..0))).await;
    let server = TestServer::start(Some(common::model()), None).await;
    let agent = Agent::new(bridge.address);
    agent.configure("[roles]", SATELLITE);
    agent.enrol(&server.url).await;
    let running = agent.run().await;
    common::status_when(&running, |status| !status["model"].is_null()).await;
    bridge.sail();
    let status = at_end(&running, seconds).await;
    let since = status["gnss_interference"]["since"].as_str();
    assert!(
        since.is_some_and(|since| since.starts_with("2026-09-01T02:00:0")),
        "{status}"
    );
    let advice = status["gnss_interference"]["advice"].as_str().unwrap();
    assert!(advice.starts_with("Navigate without GNSS"), "{advice}");
    assert_eq!(status["satellite_deg"], Value::Null, "{status}");
    let at = |name: &str| status["position"][name].as_f64().unwrap();
    let off_nm = miles(at("lat"), at("lon"), bridge::place(seconds - 1));
    assert!(off_nm < 2.0, "{off_nm}");
    assert_heading_within_band(&status, seconds - 1);
    let said = agent.call(&["status"]).await;
    let said = String::from_utf8(said.stdout).unwrap();
    assert!(
        said.contains("GNSS interference since 01 Sep 02:00 UTC"),
        "{said}"
    );
    running.kill().await;
}

#[tokio::test]
async fn of_a_spoofed_hour_with_a_false_time_no_sample_is_wrong_and_everything_comes_back() {
    let seconds = SPOOFED_S.end + 2 * HOUR_S;
    let bridge = Bridge::playing(seconds, |offset_s| spoofed_second(offset_s, &FALSE_TIME_S)).await;
    let server = TestServer::start(None, None).await;
    let agent = Agent::new(bridge.address);
    agent.configure("[roles]", SATELLITE);
    agent.enrol(&server.url).await;
    bridge.sail();
    let running = agent.run().await;
    let status = at_end(&running, seconds).await;
    assert_eq!(status["gnss_interference"], Value::Null, "{status}");
    assert_eq!(status["clock_problem"], Value::Null, "{status}");
    assert!(status["satellite_deg"].is_number(), "{status}");
    let samples = samples_until(&server, SPOOFED_S.end).await;
    running.kill().await;
    let mut reckoned = 0;
    for sample in &samples {
        let (offset_s, off_nm) = error_nm(sample);
        assert!(off_nm < 2.5, "{sample:?}");
        assert!(!FALSE_TIME_S.contains(&offset_s), "{sample:?}");
        let is_spoofed = (SPOOFED_S.start..SPOOFED_S.end + RECOVERY_S).contains(&offset_s);
        assert_eq!(sample.position_reckoned, is_spoofed, "{sample:?}");
        let heading_deg = bridge::heading_deg(offset_s);
        let satellite_off = sample
            .satellite
            .map(|heading| wrap_180(heading.degrees() - heading_deg).abs());
        assert!(satellite_off.is_none_or(|off| off < 1.0), "{sample:?}");
        assert!(!is_spoofed || sample.satellite.is_none(), "{sample:?}");
        reckoned += u32::from(is_spoofed);
    }
    assert!(
        reckoned >= 2 && samples.len() > 12,
        "{reckoned} of {}",
        samples.len()
    );
}

#[tokio::test]
async fn while_one_receiver_is_spoofed_the_other_one_gives_the_samples_their_place_and_time() {
    let seconds = SPOOFED_S.end + 2 * HOUR_S;
    let bridge = Bridge::playing(seconds, |offset_s| {
        let second = spoofed_second(offset_s, &FALSE_TIME_S);
        let true_second = String::from_utf8(bridge::second(offset_s)).unwrap();
        let rmc = true_second
            .lines()
            .find(|line| line.contains("RMC"))
            .unwrap();
        let body = rmc[1..rmc.len() - 3].replacen("GP", "GN", 1);
        [second, sentence(&body)].concat()
    })
    .await;
    let server = TestServer::start(None, None).await;
    let agent = Agent::new(bridge.address);
    let config = std::fs::read_to_string(agent.config()).unwrap();
    let one = "position = [{ input = \"bridge\", talker = \"GP\", sentence = \"RMC\" }";
    let two = format!("{one}, {{ input = \"bridge\", talker = \"GN\", sentence = \"RMC\" }}");
    assert!(config.contains(one));
    std::fs::write(agent.config(), config.replace(one, &two)).unwrap();
    agent.enrol(&server.url).await;
    bridge.sail();
    let running = agent.run().await;
    at_end(&running, seconds).await;
    let samples = samples_until(&server, SPOOFED_S.end).await;
    running.kill().await;
    let count = |seconds: &std::ops::Range<i64>| {
        let at = samples.iter().map(|sample| error_nm(sample).0);
        at.filter(|offset_s| seconds.contains(offset_s)).count()
    };
    for sample in &samples {
        let (_, off_nm) = error_nm(sample);
        assert!(off_nm < 0.1 && !sample.position_reckoned, "{sample:?}");
    }
    assert!(count(&SPOOFED_S) >= 4 && count(&FALSE_TIME_S) >= 2);
}

/// Hours without a fix.
const JAMMED_S: std::ops::Range<i64> = 2 * HOUR_S..5 * HOUR_S;

/// Sentences of one second; a jammed receiver has its clock alone.
fn jammed_second(offset_s: i64) -> Vec<u8> {
    if !JAMMED_S.contains(&offset_s) {
        return bridge::second(offset_s);
    }
    let micros = (bridge::START_S + offset_s) * 1_000_000;
    let (date, time) = from_unix_micros(micros).unwrap();
    let mut said = changed(offset_s, &["$GPRMC"], &[]);
    for data in [
        Data::Rmc(None),
        Data::Zda(Zda {
            time: Some(time),
            date: Some(date),
        }),
    ] {
        write(
            &Sentence {
                talker: *b"GP",
                data,
            },
            &mut said,
        );
    }
    said
}

#[tokio::test]
async fn after_hours_of_jamming_the_heading_is_still_within_its_band() {
    let seconds = JAMMED_S.end;
    let bridge = Bridge::playing(seconds, jammed_second).await;
    let server = TestServer::start(Some(common::model()), None).await;
    let agent = Agent::new(bridge.address);
    agent.enrol(&server.url).await;
    let running = agent.run().await;
    common::status_when(&running, |status| !status["model"].is_null()).await;
    bridge.sail();
    let status = at_end(&running, seconds).await;
    // Silence is no interference that the agent could tell from a broken receiver.
    assert_eq!(status["gnss_interference"], Value::Null, "{status}");
    assert_heading_within_band(&status, seconds - 1);
    running.kill().await;
}

#[tokio::test]
async fn in_hours_of_jamming_nothing_is_sampled_and_everything_comes_back() {
    let seconds = JAMMED_S.end + 2 * HOUR_S;
    let bridge = Bridge::playing(seconds, jammed_second).await;
    let server = TestServer::start(None, None).await;
    let agent = Agent::new(bridge.address);
    agent.enrol(&server.url).await;
    bridge.sail();
    let running = agent.run().await;
    let status = at_end(&running, seconds).await;
    assert_eq!(status["gnss_interference"], Value::Null, "{status}");
    let samples = samples_until(&server, JAMMED_S.end + HOUR_S / 2).await;
    running.kill().await;
    for sample in &samples {
        let (offset_s, off_nm) = error_nm(sample);
        assert!(off_nm < 0.1 && !sample.position_reckoned, "{sample:?}");
        // A sample that has begun may end with the last fix's silence limit.
        let jammed = JAMMED_S.start + 15..JAMMED_S.end;
        assert!(!jammed.contains(&offset_s), "{sample:?}");
    }
    let after = samples.iter().filter(|one| error_nm(one).0 >= JAMMED_S.end);
    assert!(after.count() >= 2);
}

/// A line between bridge and agent on which the agent's own output comes back.
enum Line {
    Tcp(TcpStream),
    /// Datagrams to this address: the output goes there too.
    Udp(UdpSocket, SocketAddr),
}

impl Line {
    async fn send(&mut self, sentence: &[u8]) {
        match self {
            Line::Tcp(bridge) => bridge.write_all(sentence).await.unwrap(),
            Line::Udp(socket, agent) => {
                socket.send_to(sentence, *agent).await.unwrap();
            }
        }
    }

    /// Returns a sentence of the output to the agent. With datagrams the output itself does.
    async fn echo(&mut self, sentence: &[u8]) {
        if matches!(self, Line::Tcp(_)) {
            self.send(sentence).await;
        }
    }
}

/// A bridge in real time, to which the agent's own output returns while the compass is alive and
/// after its death. Returns the time from its last reading to the end of the output, as the
/// autopilot hears it.
async fn output_after_death(talker: &str, role: &str, is_udp: bool) -> Duration {
    let listener = TcpListener::bind("127.0.0.1:0").await.unwrap();
    let server = TestServer::start(Some(common::model()), None).await;
    let agent = Agent::new(listener.local_addr().unwrap());
    let mut config = std::fs::read_to_string(agent.config()).unwrap();
    let old = "compass = [{ input = \"bridge\", talker = \"HC\", sentence = \"HDG\" }]";
    config = config.replace(old, role);
    // A port that is free for the agent.
    let input = std::net::UdpSocket::bind("127.0.0.1:0")
        .unwrap()
        .local_addr()
        .unwrap();
    if is_udp {
        let tcp = format!("tcp = \"{}\"", listener.local_addr().unwrap());
        config = config.replace(&tcp, &format!("udp = \"{input}\""));
        config = config.replace("[output]", &format!("[output]\nudp = \"{input}\""));
    }
    std::fs::write(agent.config(), config).unwrap();
    agent.enrol(&server.url).await;
    let running = agent.run().await;
    let mut line = if is_udp {
        Line::Udp(UdpSocket::bind("127.0.0.1:0").await.unwrap(), input)
    } else {
        Line::Tcp(listener.accept().await.unwrap().0)
    };
    let output = TcpStream::connect(running.output).await.unwrap();
    let mut lines = BufReader::new(output).lines();
    let mut ticks = interval(Duration::from_millis(100));
    let (mut valid, mut died): (u32, Option<Instant>) = (0, None);
    let start = Instant::now();
    let ended = async {
        loop {
            tokio::select! {
                _ = ticks.tick() => {
                    line.send(&sentence("GPRMC,120000,A,4330.0,N,00300.0,W,12.0,90.0,010926,,")).await;
                    if died.is_none() {
                        let reading = 90.0 + start.elapsed().as_secs_f64() % 2.0;
                        line.send(&sentence(&format!("{talker}HDG,{reading:.1},,,,"))).await;
                    }
                    if valid > 40 && died.is_none() {
                        died = Some(Instant::now());
                    }
                }
                heard = lines.next_line() => {
                    let heard = heard.unwrap().unwrap() + "\r\n";
                    line.echo(heard.as_bytes()).await;
                    let Ok(sentence) = parse(heard.as_bytes()) else { continue };
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

const ANY_COMPASS: &str = "compass = [{ input = \"bridge\", sentence = \"HDG\" }]";
/// A compass with the talker of the agent's own output.
const II_COMPASS: &str = "compass = [{ input = \"bridge\", talker = \"II\", sentence = \"HDG\" }]";

#[tokio::test]
async fn the_output_ends_two_seconds_after_the_compass_though_its_echo_goes_on_over_tcp() {
    for (talker, role) in [("HC", ANY_COMPASS), ("II", II_COMPASS)] {
        let seconds = output_after_death(talker, role, false).await.as_secs_f64();
        assert!((1.8..2.5).contains(&seconds), "{talker}: {seconds}");
    }
}

#[tokio::test]
async fn the_output_ends_two_seconds_after_the_compass_though_its_echo_goes_on_over_udp() {
    for (talker, role) in [("HC", ANY_COMPASS), ("II", II_COMPASS)] {
        let seconds = output_after_death(talker, role, true).await.as_secs_f64();
        assert!((1.8..2.5).contains(&seconds), "{talker}: {seconds}");
    }
}
