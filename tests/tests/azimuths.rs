//! An azimuth from the agent's page reaches the server's list and the deviation book once,
//! whichever process is killed on the way.

#![allow(clippy::unwrap_used, reason = "these are tests, helpers included")]

use binnacle_tests::{Engine, Feed, Pace, ServerProcess, Ship, eventually};
use reqwest::StatusCode;
use serde_json::{Value, json};
use std::io::Cursor;
use std::net::SocketAddr;
use std::time::Duration;

const TIMEOUT: Duration = Duration::from_mins(1);
const AZIMUTH: &str = "01934f2a-7c00-7000-8000-0000000000a2";

async fn put(page: SocketAddr, azimuth: &Value) -> (StatusCode, Value) {
    let request = reqwest::Client::new()
        .put(format!("http://{page}/api/azimuths/{AZIMUTH}"))
        .header("x-binnacle-request", "1")
        .json(azimuth);
    let response = request.send().await.unwrap();
    let (status, text) = (response.status(), response.text().await.unwrap());
    (status, serde_json::from_str(&text).expect(&text))
}

/// Waits for an azimuth that is withdrawn or not.
async fn azimuths(server: &ServerProcess, vessel: &str, withdrawn: bool) -> Vec<Value> {
    let path = format!("/vessels/{vessel}/azimuths");
    eventually("the azimuth is on the server", TIMEOUT, async || {
        let azimuths = server.list(&path).await?;
        let mut listed = azimuths.iter();
        let there = listed.any(|azimuth| azimuth["withdrawn_at"].is_string() == withdrawn);
        Ok(if there {
            Ok(azimuths)
        } else {
            Err(format!("{azimuths:?}"))
        })
    })
    .await
    .unwrap()
}

async fn an_azimuth_from_on_board_arrives_once(engine: Engine) {
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

    let mut azimuth = json!({
        "time": "2025-11-20T10:00:00Z", "lat": 43.4, "lon": -3.1, "kind": "sun_azimuth",
        "compass_heading_deg": 92.0, "compass_bearing_deg": 150.0, "gyro_heading_deg": 94.0,
        "observer": "LW", "remark": "hazy",
    });
    let (status, shown) = put(ship.page().unwrap(), &azimuth).await;
    assert_eq!(status, StatusCode::OK);
    ship.kill_and_restart().await.unwrap();
    ship.ready().await.unwrap();
    server.kill_and_restart().await.unwrap();
    let found = azimuths(&server, &vessel, false).await;
    assert_eq!(found.len(), 1);
    assert_eq!(
        (&found[0]["id"], &found[0]["author"]),
        (&json!(AZIMUTH), &json!("agent"))
    );
    assert_eq!(found[0]["result"], shown["result"], "on board and ashore");
    let book = format!("/vessels/{vessel}/deviation-book");
    let book = server.list(&book).await.unwrap();
    assert_eq!((book.len(), &book[0]["initials"]), (1, &json!("LW")));

    azimuth["withdrawn"] = json!(true);
    assert_eq!(put(ship.page().unwrap(), &azimuth).await.0, StatusCode::OK);
    assert_eq!(azimuths(&server, &vessel, true).await.len(), 1);
    ship.kill().await.unwrap();
    server.finish().await.unwrap();
}

#[tokio::test]
async fn an_azimuth_from_on_board_arrives_once_on_sqlite() {
    an_azimuth_from_on_board_arrives_once(Engine::Sqlite).await;
}

#[tokio::test]
async fn an_azimuth_from_on_board_arrives_once_on_postgres() {
    an_azimuth_from_on_board_arrives_once(Engine::Postgres).await;
}
