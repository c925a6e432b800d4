//! The commands as a user types them.

#![allow(clippy::unwrap_used, reason = "helpers of tests may panic too")]

mod common;

use common::agent::{Agent, command};
use common::bridge::{self, Bridge};
use common::fetch;
use common::server::TestServer;
use serde_json::{Value, json};
use sqlx::sqlite::SqliteConnectOptions;
use sqlx::{Connection, SqliteConnection};
use std::fmt::Write;
use std::net::SocketAddr;
use std::path::Path;
use std::process::Stdio;
use tempfile::TempDir;
use tokio::io::{AsyncBufReadExt, AsyncWriteExt, BufReader};

fn nowhere() -> SocketAddr {
    "127.0.0.1:9".parse().unwrap()
}

fn text(bytes: &[u8]) -> String {
    String::from_utf8(bytes.to_vec()).unwrap()
}

/// A recording of so many seconds.
fn record(path: &Path, seconds: i64) {
    let bytes: Vec<u8> = (0..seconds).flat_map(bridge::second).collect();
    std::fs::write(path, bytes).unwrap();
}

#[tokio::test]
async fn a_recording_becomes_a_table_and_a_tally() {
    let folder = TempDir::new().unwrap();
    let (log, csv) = (
        folder.path().join("log.nmea"),
        folder.path().join("out.csv"),
    );
    record(&log, 7200);
    let done = command()
        .arg("replay")
        .arg(&log)
        .arg("--csv")
        .arg(&csv)
        .output()
        .await
        .unwrap();
    assert!(done.status.success(), "{done:?}");
    let table = std::fs::read_to_string(&csv).unwrap();
    let mut rows = table.lines();
    assert_eq!(
        rows.next().unwrap(),
        "time,lat,lon,compass_deg,gyro_deg,satellite_deg,sog_kn,rate_of_turn_deg_min,spread_deg,windows,\
         cog_deg,roll_deg,roll_spread_deg,temperature_c,gyro_source,satellite_source,position_reckoned"
    );
    assert_eq!(
        rows.next().unwrap(),
        // 55588 is the number of the source that any recording calls "HE THS".
        "2026-09-01T00:13:30Z,43.53103,-2.95412,41.999,45.000,,12.00,0.00,0.057,60,\
         47.00,-0.60,1.50,18.0,55588,,false"
    );
    let tally: Value = serde_json::from_slice(&done.stderr).unwrap();
    assert_eq!(tally["samples"], rows.count() + 1);
    assert_eq!(tally["sentences"]["RMC"], 7200);
    assert_eq!(tally["notes"], json!([]));
    assert!(tally["windows"]["accepted"].as_u64() > Some(600));
    assert!(tally["windows"]["settling"].as_u64() > Some(30));

    let plain = command().arg("replay").arg(&log).output().await.unwrap();
    assert_eq!(
        text(&plain.stdout),
        table,
        "without --csv it goes to standard output"
    );
}

#[tokio::test]
async fn a_recording_without_receivers_runs_by_its_own_times() {
    let folder = TempDir::new().unwrap();
    let log = folder.path().join("log.txt");
    let mut lines = String::new();
    for offset in 0..1200 {
        let said = text(&bridge::second(offset));
        for sentence in said.lines().filter(|l| !l.contains("RMC")) {
            let (minute, second) = (offset / 60, offset % 60);
            writeln!(lines, "2026-09-01T00:{minute:02}:{second:02}Z\t{sentence}").unwrap();
        }
    }
    std::fs::write(&log, lines).unwrap();
    let done = command().arg("replay").arg(&log).output().await.unwrap();
    let tally: Value = serde_json::from_slice(&done.stderr).unwrap();
    assert_eq!(tally["windows"]["no_position"], 119);
    assert_eq!(done.status.code(), Some(0));
    let said = text(&done.stderr);
    for words in ["no position in the recording (RMC, GGA, GLL)", "no samples"] {
        assert!(said.contains(words), "{said}");
    }
}

#[tokio::test]
async fn noise_is_no_recording_and_leaves_no_table() {
    let folder = TempDir::new().unwrap();
    let (log, csv) = (
        folder.path().join("noise.bin"),
        folder.path().join("out.csv"),
    );
    let noise: Vec<u8> = (0..100_000_u64)
        .map(|i| ((i * i * 31) >> 7) as u8)
        .collect();
    std::fs::write(&log, noise).unwrap();
    let done = command()
        .arg("replay")
        .arg(&log)
        .arg("--csv")
        .arg(&csv)
        .output()
        .await
        .unwrap();
    let said = text(&done.stderr);
    assert_eq!(done.status.code(), Some(2));
    assert!(
        said.contains("noise.bin") && said.lines().count() == 1,
        "{said}"
    );
    assert!(!csv.exists());
    let missing = command()
        .arg("replay")
        .arg("none.nmea")
        .output()
        .await
        .unwrap();
    assert_eq!(missing.status.code(), Some(2));
    assert!(text(&missing.stderr).contains("none.nmea"));
}

#[tokio::test]
async fn a_wrong_configuration_is_one_line_and_exit_code_2() {
    let agent = Agent::new(nowhere());
    let good = std::fs::read_to_string(agent.config()).unwrap();
    std::fs::write(
        agent.config(),
        good.replace("stale_s = 3", "stale_s = \"3\""),
    )
    .unwrap();
    for arguments in [&["run"][..], &["status"], &["hold", "off"]] {
        let done = agent.call(arguments).await;
        let said = text(&done.stderr);
        assert_eq!(done.status.code(), Some(2), "{said}");
        assert!(said.contains("agent.toml:21: stale_s: "), "{said}");
        assert_eq!(said.lines().count(), 1, "{said}");
    }
}

#[tokio::test]
async fn asking_for_the_status_makes_no_data_directory() {
    let agent = Agent::new(nowhere());
    let done = agent.call(&["status"]).await;
    let said = text(&done.stderr);
    assert_eq!(done.status.code(), Some(2), "{said}");
    assert!(
        said.contains("state: there is no such data directory"),
        "{said}"
    );
    assert!(!agent.spool().parent().unwrap().exists());
}

#[tokio::test]
async fn a_wrong_code_is_refused_and_nothing_is_kept() {
    let server = TestServer::start(None, None).await;
    let agent = Agent::new(nowhere());
    let done = agent
        .call(&["enrol", "--server", &server.url, "--code", "WRONG"])
        .await;
    assert_eq!(done.status.code(), Some(2), "{done:?}");
    assert!(text(&done.stderr).contains("No such code"));
    let status = agent.call(&["status"]).await;
    assert!(text(&status.stdout).contains("not enrolled"));
    agent.enrol(&server.url).await;
    let status = agent.call(&["status"]).await;
    assert!(text(&status.stdout).contains("Txori, Standard compass"));
}

#[tokio::test]
async fn a_code_is_not_sent_unencrypted_to_another_computer() {
    let agent = Agent::new(nowhere());
    let server = "http://192.0.2.1:8080";
    let done = agent
        .call(&["enrol", "--server", server, "--code", "CODE"])
        .await;
    let said = text(&done.stderr);
    assert_eq!(done.status.code(), Some(2), "{said}");
    assert!(
        said.contains("http to 192.0.2.1 would send the token unencrypted: use https"),
        "{said}"
    );
    assert!(!agent.spool().exists());
}

#[tokio::test]
async fn a_hold_reaches_the_running_agent_and_outlasts_it() {
    let bridge = Bridge::new(0).await;
    let agent = Agent::new(bridge.address);
    let running = agent.run().await;
    let done = agent.call(&["hold", "magnetic-cargo"]).await;
    assert_eq!(text(&done.stdout), "on hold: magnetic-cargo\n");
    let shown = common::fetch(running.page, "/api/status").await;
    let shown: Value = serde_json::from_str(&shown).unwrap();
    assert_eq!(shown["running"], true);
    assert!(
        common::fetch(running.page, "/")
            .await
            .contains("Magnetic cargo")
    );
    running.kill().await;
    let status = agent.call(&["status", "--json"]).await;
    let status: Value = serde_json::from_slice(&status.stdout).unwrap();
    assert_eq!(
        (&status["running"], &status["hold"]),
        (&false.into(), &"magnetic-cargo".into())
    );
    agent.call(&["hold", "off"]).await;
    let status = agent.call(&["status"]).await;
    assert!(!text(&status.stdout).contains("hold"));
}

#[tokio::test]
async fn the_status_is_live_without_a_page_and_says_when_nobody_responds() {
    let agent = Agent::new(nowhere());
    let config = std::fs::read_to_string(agent.config()).unwrap();
    let without = config.replace("[page]\nlisten = \"127.0.0.1:0\"\n", "");
    assert_ne!(config, without);
    std::fs::write(agent.config(), without).unwrap();
    let mut run = command();
    run.arg("run").arg("--config").arg(agent.config());
    let mut process = run.stderr(Stdio::piped()).spawn().unwrap();
    let mut log = BufReader::new(process.stderr.take().unwrap()).lines();
    while !log.next_line().await.unwrap().unwrap().contains(" ready ") {}

    let status = agent.call(&["status", "--json"]).await;
    let status: Value = serde_json::from_slice(&status.stdout).unwrap();
    assert_eq!(status["running"], true);
    assert!(status["age_s"].as_f64() < Some(60.0), "{status}");
    assert_eq!(status["inputs"][0]["name"], "bridge");

    // The socket is gone, the agent is not.
    let socket = agent.spool().with_file_name("status.sock");
    std::fs::remove_file(socket).unwrap();
    let said = text(&agent.call(&["status"]).await.stdout);
    assert!(said.contains("running, but does not respond"), "{said}");
    process.kill().await.unwrap();
    let said = text(&agent.call(&["status"]).await.stdout);
    assert!(said.contains(" not running\n"), "{said}");
}

#[tokio::test]
async fn a_pin_guards_the_page_and_changes_are_recorded() {
    let agent = Agent::new(nowhere());
    let mut hash = command();
    let hash = hash.arg("page-pin").stdin(Stdio::piped());
    let mut hash = hash.stdout(Stdio::piped()).spawn().unwrap();
    let mut typing = hash.stdin.take().unwrap();
    typing.write_all(b"271828\n").await.unwrap();
    drop(typing);
    let line = text(&hash.wait_with_output().await.unwrap().stdout);
    agent.configure("[page]", line.trim());

    let running = agent.run().await;
    let hold = async |pin: &str| {
        let request = reqwest::Client::new()
            .post(format!("http://{}/api/hold", running.page))
            .header("x-binnacle-request", "1")
            .header("x-binnacle-pin", pin)
            .json(&json!({ "hold": "berthed" }));
        request.send().await.unwrap().status().as_u16()
    };
    fetch(running.page, "/").await;
    assert_eq!(hold("314159").await, 401);
    assert_eq!(hold("271828").await, 200);
    agent.call(&["hold", "off"]).await;
    let said = text(&agent.call(&["actions"]).await.stdout);
    let lines: Vec<&str> = said
        .lines()
        .map(|line| line.split_once(" UTC  ").unwrap().1)
        .collect();
    let wanted = [
        "127.0.0.1  PIN: wrong",
        "127.0.0.1  hold: berthed: done",
        "command line  hold ended: done",
    ];
    assert_eq!(lines, wanted, "{said}");
}

#[tokio::test]
async fn what_has_settled_is_kept_when_the_agent_is_stopped() {
    let bridge = Bridge::new(600).await;
    bridge.sail();
    let agent = Agent::new(bridge.address);
    let running = agent.run().await;
    loop {
        let status = common::fetch(running.page, "/api/status").await;
        let status: Value = serde_json::from_str(&status).unwrap();
        if status["ship_time"] == "2026-09-01T00:09:59Z" {
            break;
        }
    }
    let (code, log) = running.terminate().await;
    assert_eq!(code, Some(0), "{log}");
    let status = agent.call(&["status", "--json"]).await;
    let status: Value = serde_json::from_slice(&status.stdout).unwrap();
    assert_eq!(status["spool"]["pending_samples"], 1);
}

#[tokio::test]
async fn what_was_said_in_each_second_can_be_exported_and_bad_questions_are_refused() {
    let bridge = Bridge::new(400).await;
    let agent = Agent::new(bridge.address);
    let early = agent.call(&["export"]).await;
    assert_eq!(early.status.code(), Some(2), "{early:?}");
    bridge.sail();
    let running = agent.run().await;
    while !fetch(running.page, "/api/status")
        .await
        .contains("00:06:39")
    {
        tokio::task::yield_now().await;
    }
    // Two blocks are on the disk, the rest is there after the end.
    let done = agent.call(&["export"]).await;
    assert_eq!(text(&done.stdout).lines().count(), 1 + 336, "{done:?}");
    running.terminate().await;
    let span = [
        "--from",
        "2026-09-01T00:06:30Z",
        "--until",
        "2026-09-01T01:00:00Z",
    ];
    let done = agent.call(&[&["export"], &span[..]].concat()).await;
    let table = text(&done.stdout);
    assert_eq!(table.lines().count(), 1 + 10, "{table}");
    assert_eq!(
        table.lines().nth(1),
        Some("2026-09-01T00:06:30Z,43.5147766,-2.9781547,41.44,44.53,,12.00,0.0,-2.10")
    );
    let wrong = agent.call(&["export", "--from", "yesterday"]).await;
    assert_eq!(wrong.status.code(), Some(2));
    assert!(
        text(&wrong.stderr).contains("--from: \"yesterday\""),
        "{wrong:?}"
    );
}

#[tokio::test]
async fn a_token_is_replaced_on_board_when_the_server_has_replaced_it() {
    let server = TestServer::start(None, None).await;
    let agent = Agent::new(nowhere());
    let early = agent.call(&["rotate-token"]).await;
    assert_eq!(early.status.code(), Some(2), "{early:?}");
    agent.enrol(&server.url).await;
    let done = agent.call(&["rotate-token"]).await;
    assert!(done.status.success(), "{done:?}");
    assert!(!text(&done.stdout).contains("the-next-token"));
    let spool = SqliteConnectOptions::new().filename(agent.spool());
    let mut spool = SqliteConnection::connect_with(&spool).await.unwrap();
    let identity: String = sqlx::query_scalar("SELECT value FROM state WHERE name = 'identity'")
        .fetch_one(&mut spool)
        .await
        .unwrap();
    let identity: Value = serde_json::from_str(&identity).unwrap();
    assert_eq!(identity["token"], "the-next-token");
}
