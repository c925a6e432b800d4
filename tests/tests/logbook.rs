//! An officer's report from the agent's page reaches the server's logbook once,
//! whichever process is killed on the way.

#![allow(clippy::unwrap_used, reason = "these are tests, helpers included")]

use binnacle_tests::{Engine, Feed, Pace, ServerProcess, Ship, eventually};
use reqwest::StatusCode;
use serde_json::{Value, json};
use std::io::Cursor;
use std::net::SocketAddr;
use std::time::Duration;

const TIMEOUT: Duration = Duration::from_mins(1);
const REPORT: &str = "01934f2a-7c00-7000-8000-0000000000b1";

async fn put(page: SocketAddr, report: &Value) -> StatusCode {
    let request = reqwest::Client::new()
        .put(format!("http://{page}/api/reports/{REPORT}"))
        .header("x-binnacle-request", "1")
        .json(report);
    request.send().await.unwrap().status()
}

/// Waits for a logbook entry with this end, or an open one.
async fn logbook(server: &ServerProcess, vessel: &str, to: &Value) -> Vec<Value> {
    let path = format!("/vessels/{vessel}/logbook");
    eventually("the report is in the logbook", TIMEOUT, async || {
        let entries = server.list(&path).await?;
        let there = entries.iter().any(|entry| entry["to"] == *to);
        Ok(if there {
            Ok(entries)
        } else {
            Err(format!("{entries:?}"))
        })
    })
    .await
    .unwrap()
}

async fn an_officers_report_arrives_once(engine: Engine) {
    let folder = tempfile::tempdir().unwrap();
    let mut server = ServerProcess::start(engine, folder.path()).await.unwrap();
    let (vessel, code) = server.create_vessel("Nao").await.unwrap();
    let feed = Feed::start(Cursor::new(Vec::new()), Pace::Live)
        .await
        .unwrap();
    let mut ship = Ship::new("nao", folder.path(), feed.address()).unwrap();
    ship.enrol(&server.url, &code).await.unwrap();
    ship.start().unwrap();
    ship.ready().await.unwrap();

    let mut report = json!({
        "reporter": "Li", "kind": "magnetic_cargo", "from": "2026-11-20T06:00:00Z",
        "cargo": "scrap", "hatch": "2", "port": "Bilbao", "note": "shredded",
    });
    assert_eq!(put(ship.page().unwrap(), &report).await, StatusCode::OK);
    ship.kill_and_restart().await.unwrap();
    ship.ready().await.unwrap();
    server.kill_and_restart().await.unwrap();
    let entries = logbook(&server, &vessel, &json!(null)).await;
    assert_eq!(entries.len(), 1);
    assert_eq!(entries[0]["id"], REPORT);
    assert_eq!(entries[0]["author"], "agent");
    for (name, value) in report.as_object().unwrap() {
        let name = if name == "reporter" {
            "created_by"
        } else {
            name
        };
        assert_eq!(entries[0][name], *value, "{name}");
    }

    report["to"] = json!("2026-11-20T18:00:00Z");
    assert_eq!(put(ship.page().unwrap(), &report).await, StatusCode::OK);
    let entries = logbook(&server, &vessel, &report["to"]).await;
    assert_eq!((entries.len(), &entries[0]["revision"]), (1, &json!(2)));
    ship.kill().await.unwrap();
    server.finish().await.unwrap();
}

#[tokio::test]
async fn an_officers_report_arrives_once_on_sqlite() {
    an_officers_report_arrives_once(Engine::Sqlite).await;
}

#[tokio::test]
async fn an_officers_report_arrives_once_on_postgres() {
    an_officers_report_arrives_once(Engine::Postgres).await;
}
