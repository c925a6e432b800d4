//! The real agent on a real Signal K server, which gets its instruments as NMEA 0183.
//!
//! From the compass's sentence alone the server makes both a magnetic and a true heading.

#![allow(clippy::unwrap_used, reason = "helpers of tests may panic too")]

mod common;

use common::agent::{Agent, Running};
use common::bridge::LEAD_DEG;
use common::server::TestServer;
use common::signalk::{COMPASS_DEG, Instruments, SignalKServer};
use serde_json::Value;
use std::time::Duration;
use tokio::io::{AsyncBufReadExt, BufReader, Lines};
use tokio::net::TcpStream;
use tokio::time::{Instant, timeout};

const PATIENCE: Duration = Duration::from_mins(1);
/// Deviation of the model that the agent has.
const DEVIATION_DEG: f64 = 2.5;
/// Time within which a silent compass ends the steering output, and what a busy machine adds.
const STEERING: Duration = Duration::from_secs(2);
const BUSY: Duration = Duration::from_secs(3);

const ALL: Instruments = Instruments {
    compass: true,
    gyro: true,
};
const COMPASS: Instruments = Instruments {
    compass: true,
    gyro: false,
};
const NONE: Instruments = Instruments {
    compass: false,
    gyro: false,
};

/// Roles that name the sources.
const NAMED: &str = r#"
compass = [{ source = "bridge.HC", sentence = "HDM", raw = true }]
gyro = [{ source = "bridge.HE", sentence = "HDT" }]
position = [{ input = "server" }]"#;
/// Roles that take any source of the server.
const ANY: &str = r#"
compass = [{ input = "server", sentence = "HDM", raw = true }]
gyro = [{ input = "server", sentence = "HDT" }]
position = [{ input = "server" }]"#;

/// Starts an agent with these roles and lines of `[output]`.
fn agent(server: &SignalKServer, roles: &str, output: &str) -> Agent {
    let agent = Agent::new(server.address);
    let config = format!(
        "data_dir = \"state\"\n{}\n[roles]{roles}\n[output]\ntcp_server = \"127.0.0.1:0\"\n\
         interval_s = 0.1\n{output}\n[page]\nlisten = \"127.0.0.1:0\"\n[uplink]\npoll_s = 1\n\
         retry_min_s = 0.02\nretry_max_s = 0.1\n",
        server.input()
    );
    std::fs::write(agent.config(), config).unwrap();
    agent
}

/// Starts an agent that has a model.
async fn steering_agent(server: &SignalKServer, roles: &str, output: &str) -> (Agent, Running) {
    let shore = TestServer::start(Some(common::model()), None).await;
    let agent = agent(server, roles, output);
    agent.enrol(&shore.url).await;
    let running = agent.run().await;
    common::status_when(&running, |status| status["model"]["version"] == 3).await;
    (agent, running)
}

/// Receiver of the steering output.
struct Autopilot(Lines<BufReader<TcpStream>>);

impl Autopilot {
    async fn connect(running: &Running) -> Autopilot {
        let stream = TcpStream::connect(running.output).await.unwrap();
        Autopilot(BufReader::new(stream).lines())
    }

    /// Returns the heading of the next THS, if it is valid.
    async fn next(&mut self) -> Option<f64> {
        loop {
            let line = self.0.next_line().await.unwrap().unwrap();
            if let Some(ths) = line.strip_prefix("$IITHS,") {
                return ths.split(',').next().unwrap().parse().ok();
            }
        }
    }

    async fn until(&mut self, wanted: impl Fn(Option<f64>) -> bool) {
        let heard = async { while !wanted(self.next().await) {} };
        timeout(PATIENCE, heard)
            .await
            .expect("the output comes to it");
    }
}

fn source<'a>(status: &'a Value, name: &str, sentence: &str) -> Option<&'a Value> {
    let sources = status["sources"].as_array()?;
    sources
        .iter()
        .find(|source| source["source"] == name && source["sentence"] == sentence)
}

fn serves(status: &Value, name: &str, sentence: &str, role: &str) -> bool {
    let source = source(status, name, sentence);
    let roles = source.and_then(|source| source["serves"].as_array());
    roles.is_some_and(|roles| roles.iter().any(|served| served == role))
}

fn near(value: &Value, deg: f64) -> bool {
    let radians = value.as_f64();
    radians.is_some_and(|radians| (radians.to_degrees() - deg).abs() < 0.02)
}

#[tokio::test(flavor = "multi_thread", worker_threads = 2)]
async fn a_true_heading_that_the_server_makes_of_the_compass_is_refused_and_a_gyro_serves() {
    let server = SignalKServer::start(COMPASS).await;
    let mut program = server.program().await;
    let agent = agent(&server, ANY, "");
    let running = agent.run().await;
    // What is computed elsewhere, and sent under the name of a plugin, is ignored.
    let status = common::status_when(&running, |status| {
        source(status, "bridge.HC", "HDT").is_some() && !status["source_problems"][0].is_null()
    });
    let status = tokio::select! {
        status = status => status,
        () = repeat(&mut program, "derived-data", "headingTrue", COMPASS_DEG) => unreachable!(),
    };
    let problems = status["source_problems"].to_string();
    let own = "gyro: server bridge.HC HDT is of the compass's own device";
    assert!(problems.contains(own), "{problems}");
    assert_eq!(source(&status, "derived-data", "HDT"), None);
    assert_eq!(status["gyro_deg"], Value::Null, "{status}");
    // The same value is refused beside a gyro, which serves.
    server.instruments.send_replace(ALL);
    let status = common::status_when(&running, |status| {
        serves(status, "bridge.HE", "HDT", "gyro") && !status["gyro_deg"].is_null()
    })
    .await;
    let gyro_deg = status["gyro_deg"].as_f64().unwrap();
    assert!(
        (gyro_deg - COMPASS_DEG - LEAD_DEG).abs() < 0.01,
        "{gyro_deg}"
    );
    assert!(!serves(&status, "bridge.HC", "HDT", "gyro"), "{status}");
    running.kill().await;
}

/// Sends a value ten times a second.
async fn repeat(program: &mut common::signalk::DeltaSender, source: &str, path: &str, deg: f64) {
    let mut ticks = tokio::time::interval(Duration::from_millis(100));
    loop {
        ticks.tick().await;
        program.send(source, path, deg).await;
    }
}

#[tokio::test(flavor = "multi_thread", worker_threads = 2)]
async fn the_output_ends_with_the_compass_though_the_server_repeats_what_the_agent_sends() {
    let server = SignalKServer::start(ALL).await;
    let output = "signalk = { input = \"server\" }";
    let (_agent, running) = steering_agent(&server, ANY, output).await;
    let mut autopilot = Autopilot::connect(&running).await;
    autopilot.until(|heading| heading.is_some()).await;
    let magnetic = server
        .when("the agent's heading is there", async |server| {
            let value = server.value("headingMagnetic", "binnacle").await;
            value.filter(|value| !value.is_null())
        })
        .await;
    assert!(near(&magnetic, COMPASS_DEG + DEVIATION_DEG), "{magnetic}");
    let deviation = server.value("magneticDeviation", "binnacle").await;
    assert!(near(&deviation.unwrap(), DEVIATION_DEG));
    // The roles would take it: it is heard, and known as the agent's own.
    let status = common::status_when(&running, |status| {
        source(status, "binnacle", "HDM").is_some() && source(status, "binnacle", "HDT").is_some()
    })
    .await;
    for sentence in ["HDM", "HDT"] {
        let own = source(&status, "binnacle", sentence).unwrap();
        assert_eq!(own["own_output"], true, "{own}");
        assert_eq!(own["serves"], serde_json::json!([]), "{own}");
    }
    assert!(serves(&status, "bridge.HC", "HDM", "compass"), "{status}");

    server.instruments.send_replace(NONE);
    autopilot.until(|heading| heading.is_none()).await;
    let passed = server.compass_sent.borrow().elapsed();
    println!(
        "withheld {:.2} s after the last reading",
        passed.as_secs_f64()
    );
    assert!(passed < STEERING + BUSY, "{passed:?}");
    server
        .when("the agent's headings are null", async |server| {
            let magnetic = server.value("headingMagnetic", "binnacle").await;
            let of_true = server.value("headingTrue", "binnacle").await;
            (magnetic == Some(Value::Null) && of_true == Some(Value::Null)).then_some(())
        })
        .await;
    // It does not come back by itself.
    let until = Instant::now() + STEERING;
    while Instant::now() < until {
        assert_eq!(autopilot.next().await, None);
    }
    running.kill().await;
}

#[tokio::test(flavor = "multi_thread", worker_threads = 2)]
async fn what_the_server_has_kept_or_another_source_sends_is_no_reading_of_the_compass() {
    let server = SignalKServer::start(COMPASS).await;
    server
        .when("the server has the compass", async |server| {
            server.value("headingMagnetic", "bridge.HC").await
        })
        .await;
    // The compass falls silent, and the server keeps its last reading for those who connect.
    server.instruments.send_replace(NONE);
    let sent = *server.compass_sent.borrow();
    server
        .when("the last reading is old", async |_| {
            (sent.elapsed() > STEERING).then_some(())
        })
        .await;
    let (_agent, running) = steering_agent(&server, NAMED, "").await;
    let status = common::status_when(&running, |status| {
        source(status, "bridge.HC", "HDM").is_some()
    })
    .await;
    let age_s = source(&status, "bridge.HC", "HDM").unwrap()["age_s"].as_f64();
    assert!(age_s.is_none_or(|age_s| age_s > 1.0), "{age_s:?}");
    let mut autopilot = Autopilot::connect(&running).await;
    assert_eq!(autopilot.next().await, None);

    // Another source takes the path over.
    let mut program = server.program().await;
    let other = common::status_when(&running, |status| {
        let other = source(status, "plotter", "HDM");
        other.is_some_and(|other| other["age_s"].as_f64().is_some_and(|age_s| age_s < 1.0))
    });
    let status = tokio::select! {
        status = other => status,
        () = repeat(&mut program, "plotter", "headingMagnetic", 200.0) => unreachable!(),
    };
    assert!(!serves(&status, "plotter", "HDM", "compass"), "{status}");
    for _ in 0..10 {
        assert_eq!(autopilot.next().await, None);
    }
    // The compass itself comes back.
    server.instruments.send_replace(COMPASS);
    autopilot.until(|heading| heading.is_some()).await;
    running.kill().await;
}

#[tokio::test(flavor = "multi_thread", worker_threads = 2)]
async fn a_server_with_security_gives_a_token_that_may_write_once_it_is_asked_for() {
    let server = SignalKServer::start_secure(COMPASS).await;
    let output = "signalk = { input = \"server\", label = \"steering\" }";
    let (agent, running) = steering_agent(&server, NAMED, output).await;
    assert_eq!(server.accept_request().await, "readwrite");
    let has_heading = async |server: &SignalKServer| {
        let value = server.value("headingMagnetic", "steering").await;
        value.filter(|value| near(value, COMPASS_DEG + DEVIATION_DEG))
    };
    server
        .when("the server takes the heading", has_heading)
        .await;
    running.terminate().await;
    // The token serves after a restart.
    let kept = std::fs::read_to_string(agent.spool().with_file_name("signalk-server.json"));
    assert!(kept.unwrap().contains("\"permission\":\"readwrite\""));
    let running = agent.run().await;
    let mut autopilot = Autopilot::connect(&running).await;
    autopilot.until(|heading| heading.is_some()).await;
    running.kill().await;
}
