//! A simulated vessel that sends over TCP, a fake server, and the real agent.

#![allow(dead_code, reason = "each test program uses its part")]

pub(crate) mod agent;
pub(crate) mod bridge;
pub(crate) mod server;
pub(crate) mod signalk;

use binnacle_compass::model::{Model, Parameters, ReferenceGrade};
use binnacle_compass::time::Timestamp;
use binnacle_wire::messages::ModelDownlink;
use uuid::Uuid;

/// A model that adds 2.5° everywhere.
pub(crate) fn model() -> ModelDownlink {
    let mut covariance = [[0.0; 8]; 8];
    covariance[7][7] = 0.04;
    ModelDownlink {
        id: Uuid::from_u128(9),
        version: 3,
        data_until: Timestamp::parse("2026-08-30T00:00:00Z").unwrap(),
        replaces: None,
        model: Model {
            parameters_over_lambda: Parameters {
                bx_nt: 0.0,
                chi13: 0.0,
                by_nt: 0.0,
                chi23: 0.0,
                chi11_minus_chi22: 0.0,
                chi12: 0.0,
                chi21: 0.0,
            },
            constant_deg: 2.5,
            covariance: Some(covariance),
            identifiable: None,
            rms_deg: None,
            samples_used: 1,
            samples_rejected: 0,
            quality: None,
            reference_grade: ReferenceGrade::Heading,
            mean_h_nt: None,
            needles: None,
        },
    }
}

/// Presses a button of the page.
pub(crate) async fn post(address: std::net::SocketAddr, path: &str, body: &str) {
    let request = reqwest::Client::new()
        .post(format!("http://{address}{path}"))
        .header("content-type", "application/json")
        .header("x-binnacle-request", "1")
        .body(body.to_owned());
    let response = request.send().await.unwrap();
    assert!(response.status().is_success(), "{response:?}");
}

/// Waits for a status.
pub(crate) async fn status_when(
    running: &agent::Running,
    wanted: impl Fn(&serde_json::Value) -> bool,
) -> serde_json::Value {
    let seen = tokio::time::timeout(std::time::Duration::from_mins(2), async {
        loop {
            let status = fetch(running.page, "/api/status").await;
            let status: serde_json::Value = serde_json::from_str(&status).unwrap();
            if wanted(&status) {
                return status;
            }
        }
    });
    seen.await.expect("the status never came to it")
}

/// Fetches a page as text.
pub(crate) async fn fetch(address: std::net::SocketAddr, path: &str) -> String {
    rustls::crypto::ring::default_provider()
        .install_default()
        .ok();
    let response = reqwest::get(format!("http://{address}{path}")).await;
    response.unwrap().text().await.unwrap()
}

/// Fetches the status.
pub(crate) async fn status(running: &agent::Running) -> serde_json::Value {
    let text = fetch(running.page, "/api/status").await;
    serde_json::from_str(&text).unwrap()
}

/// Returns the status once the ship's clock shows the last second.
pub(crate) async fn at_end(running: &agent::Running, seconds: i64) -> serde_json::Value {
    let end = Timestamp::from_micros((bridge::START_S + seconds - 1) * 1_000_000);
    let end = end.unwrap().to_string();
    status_when(running, |status| status["ship_time"] == end.as_str()).await
}
