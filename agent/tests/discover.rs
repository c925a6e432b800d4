//! `discover`: what a recording and a Signal K server say, and the roles proposed for it.

#![allow(clippy::unwrap_used, reason = "helpers of tests may panic too")]

mod common;

use common::agent::command;
use common::bridge;
use futures_util::{SinkExt, StreamExt};
use serde_json::{Value, json};
use std::fmt::Write;
use std::path::Path;
use std::process::Output;
use tempfile::TempDir;
use tokio::net::TcpListener;
use tokio_tungstenite::accept_async;
use tokio_tungstenite::tungstenite::Message;

async fn discover(folder: &Path, inputs: &str, more: &[&str]) -> Output {
    let config = folder.join("agent.toml");
    std::fs::write(&config, format!("data_dir = \"state\"\n{inputs}")).unwrap();
    let mut command = command();
    command.arg("discover").arg("--config").arg(&config);
    command.args(more).output().await.unwrap()
}

fn text(bytes: &[u8]) -> String {
    String::from_utf8(bytes.to_vec()).unwrap()
}

fn sentence(body: &str) -> String {
    let sum = body.bytes().fold(0, |sum, byte| sum ^ byte);
    format!("${body}*{sum:02X}\r\n")
}

#[tokio::test]
async fn a_recording_is_listed_and_its_proposed_roles_sample_it() {
    let folder = TempDir::new().unwrap();
    let log = folder.path().join("log.nmea");
    let bytes: Vec<u8> = (0..3_600)
        .flat_map(|offset_s| {
            let mut second = bridge::second(offset_s);
            // Another compass, a converter's true heading, and the agent's own output.
            let heading = bridge::heading_deg(offset_s);
            let more = [
                format!("HNHDG,{:.1},,,,", heading - 2.0),
                format!("HCHDT,{heading:.1},T"),
                format!("IIHDG,{heading:.1},1.0,E,2.0,W"),
            ];
            second.extend(more.iter().flat_map(|body| sentence(body).into_bytes()));
            second
        })
        .collect();
    std::fs::write(&log, bytes).unwrap();
    let inputs = "[inputs.bridge]\nfile = \"log.nmea\"\n";
    let done = discover(folder.path(), inputs, &[]).await;
    assert!(done.status.success(), "{done:?}");
    let said = text(&done.stdout);
    for wanted in [
        "# bridge HCHDG  1.0/s  compass ",
        "# bridge HETHS  1.0/s  true ",
        "# bridge GPRMC  1.0/s  43.6364 -2.7984, course 4",
    ] {
        assert!(said.contains(wanted), "{wanted:?} is not in\n{said}");
    }
    assert!(
        said.contains("# bridge HCHDT is of the compass's device, and no reference\n"),
        "{said}"
    );
    let roles = said.split_once("[roles]\n").unwrap().1;
    assert!(
        roles.contains("compass = [{ input = \"bridge\", talker = \"HC\", sentence = \"HDG\" }]\n"),
        "{said}"
    );
    assert!(
        roles.contains("gyro = [{ input = \"bridge\", talker = \"HE\", sentence = \"THS\" }]\n"),
        "{said}"
    );
    // The output is a part of a configuration, as it is.
    let config = folder.path().join("agent.toml");
    std::fs::write(&config, format!("data_dir = \"state\"\n{inputs}{said}")).unwrap();
    let replayed = command()
        .arg("replay")
        .arg(&log)
        .arg("--config")
        .arg(&config)
        .output()
        .await
        .unwrap();
    assert!(replayed.status.success(), "{replayed:?}");
    let tally: Value = serde_json::from_slice(&replayed.stderr).unwrap();
    assert!(tally["windows"]["accepted"].as_u64() > Some(200), "{tally}");
}

#[tokio::test]
async fn two_compasses_on_a_bus_are_distinguished_by_name_or_address() {
    let folder = TempDir::new().unwrap();
    // Vessel heading from magnetic north, and one address claim (60928) after the first heading.
    let mut log = String::new();
    for second in 0..5 {
        writeln!(
            log,
            "(178000000{second}.100000) can0 09F11204#0010270000FF7FFD"
        )
        .unwrap();
        writeln!(
            log,
            "(178000000{second}.200000) can0 09F11209#0010280000FF7FFD"
        )
        .unwrap();
        writeln!(
            log,
            "(178000000{second}.300000) can0 18EEFF04#1243E0E7008C78C0"
        )
        .unwrap();
    }
    std::fs::write(folder.path().join("bus.log"), log).unwrap();
    let done = discover(folder.path(), "[inputs.bus]\nfile = \"bus.log\"\n", &[]).await;
    let said = text(&done.stdout);
    for (wanted, count) in [
        ("# bus N2HDG (4)", 1),
        ("# bus N2HDG (9)", 1),
        ("sentence = \"HDG\", n2k_name = \"c0788c00e7e04312\" }", 1),
        ("sentence = \"HDG\", n2k_address = 9 }", 1),
    ] {
        assert_eq!(said.matches(wanted).count(), count, "{wanted:?} in\n{said}");
    }
}

/// A server that greets, repeats what it has cached, and goes on with live values.
async fn signal_k(listener: TcpListener) {
    let (stream, _) = listener.accept().await.unwrap();
    let mut server = accept_async(stream).await.unwrap();
    server.next().await.unwrap().unwrap();
    let update = |source: &str, at: &str, path: &str, value: Value| {
        json!({"context": "vessels.self", "updates": [{"$source": source, "timestamp": at,
            "values": [{"path": path, "value": value}]}]})
    };
    for message in [
        json!({"name": "server", "version": "2.0.0", "self": "vessels.urn:x",
            "timestamp": "2026-01-02T12:00:00Z"}),
        update(
            "old.HC",
            "2026-01-02T09:00:00Z",
            "navigation.headingCompass",
            json!(1.0),
        ),
        update(
            "n2k.4",
            "2026-01-02T12:00:00Z",
            "navigation.headingMagnetic",
            json!(1.5),
        ),
        update(
            "n2k.4",
            "2026-01-02T12:00:00Z",
            "navigation.headingTrue",
            json!(1.4),
        ),
        update(
            "n2k.9",
            "2026-01-02T12:00:00Z",
            "navigation.headingTrue",
            json!(1.4),
        ),
    ] {
        server
            .send(Message::text(message.to_string()))
            .await
            .unwrap();
    }
    // The server stays.
    while server.next().await.is_some() {}
}

#[tokio::test]
async fn a_signal_k_servers_sources_are_distinguished_by_name_and_age() {
    let folder = TempDir::new().unwrap();
    let listener = TcpListener::bind("127.0.0.1:0").await.unwrap();
    let address = listener.local_addr().unwrap();
    tokio::spawn(signal_k(listener));
    let inputs = format!("[inputs.sk]\nsignalk = \"ws://{address}/signalk/v1/stream\"\n");
    let done = discover(folder.path(), &inputs, &["--seconds", "1", "--json"]).await;
    let found: Value = serde_json::from_slice(&done.stdout).unwrap();
    let source = |name: &str, sentence: &str| {
        let sources = found["sources"].as_array().unwrap();
        let found = sources
            .iter()
            .find(|source| source["source"] == name && source["sentence"] == sentence);
        found
            .unwrap_or_else(|| panic!("{name} is not in {sources:?}"))
            .clone()
    };
    assert_eq!(source("old.HC", "HDG")["age_s"], Value::Null);
    let age_s = source("n2k.4", "HDM")["age_s"].as_f64();
    assert!(age_s.is_some_and(|age_s| age_s < 1.0), "{age_s:?}");
    assert_eq!(source("n2k.9", "HDT")["last"], "true 080.2°");
    let roles = found["roles"].as_str().unwrap();
    let mut expected = "[roles]\n".to_owned();
    for line in [
        "# only if no deviation is applied to this heading:",
        "# compass = [{ input = \"sk\", source = \"n2k.4\", sentence = \"HDM\", raw = true }]",
        "# sk n2k.4 HDT is of the compass's device, and no reference",
        "# if sk n2k.9 HDT is a gyro compass, move it to gyro",
        "satellite = [{ input = \"sk\", source = \"n2k.9\", sentence = \"HDT\" }]",
    ] {
        writeln!(expected, "{line}").unwrap();
    }
    assert_eq!(roles, expected);
}

#[tokio::test]
async fn an_input_that_cannot_be_opened_is_named() {
    let folder = TempDir::new().unwrap();
    let inputs = "[inputs.line]\nserial = { path = \"/dev/binnacle-none\" }\n";
    let done = discover(folder.path(), inputs, &["--seconds", "1"]).await;
    let said = text(&done.stdout);
    assert!(said.contains("# nothing\n# PROBLEM line: "), "{said}");
}
