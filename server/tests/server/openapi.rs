//! The OpenAPI document.

use binnacle_server::routes::openapi;
use binnacle_server_testing::{ApiResponse, Engine, TestServer};
use serde_json::Value;

#[test]
fn the_committed_document_is_current() {
    let committed = include_str!("../../openapi.json");
    let current = openapi().to_pretty_json().unwrap();
    assert!(
        committed.trim_end() == current.trim_end(),
        "run `cargo run -p binnacle-server -- openapi > server/openapi.json`, then `npm run schema` in web"
    );
}

#[test]
fn every_response_is_described_and_every_error_is_a_problem() {
    let document = serde_json::to_value(openapi()).unwrap();
    for (path, operations) in document["paths"].as_object().unwrap() {
        for (method, operation) in operations.as_object().unwrap() {
            for (status, response) in operation["responses"].as_object().unwrap() {
                let place = format!("{method} {path} {status}");
                assert!(response["description"].is_string(), "{place}");
                let problem = response["content"].get("application/problem+json");
                // The readiness check responds with text.
                let is_error = status.starts_with(['4', '5']) && path != "/readyz";
                assert_eq!(problem.is_some(), is_error, "{place}");
            }
        }
    }
}

#[tokio::test]
async fn the_document_and_its_page_need_no_sign_in() {
    let server = TestServer::start(Engine::Sqlite).await;
    let document =
        ApiResponse::send(server.http.get(format!("{}/api/openapi.json", server.url))).await;
    assert_eq!(document.good()["openapi"], "3.1.0");
    let page = ApiResponse::send(server.http.get(format!("{}/api/docs", server.url))).await;
    let paths: Value = document.json()["paths"].take();
    for path in paths.as_object().unwrap().keys() {
        assert!(
            page.text.contains(path.as_str()),
            "{path} is not on the page"
        );
    }
    assert!(!page.text.contains("<script"), "the page needs no script");
    server.finish().await;
}
