//! Isolation of operators on every route.

use binnacle_server::routes::openapi;
use binnacle_server_testing::binnacles::{binnacle, put};
use binnacle_server_testing::on_both;
use binnacle_server_testing::port_calls::{call, path as calls_of};
use binnacle_server_testing::{ApiResponse, TestServer, sun_by_azimuth};
use reqwest::Method;
use serde_json::{Value, json};

on_both!(
    every_vessel_route_is_not_found_for_another_operator,
    every_route_needs_authentication,
    another_operators_lists_are_empty,
    a_malformed_id_is_not_found,
    an_unknown_method_of_a_path_is_refused_with_a_problem,
);

/// Returns every operation of the API document: method, path and a valid body.
fn operations() -> Vec<(Method, String, Value)> {
    let document = serde_json::to_value(openapi()).unwrap();
    let mut found = Vec::new();
    for (path, methods) in document["paths"].as_object().unwrap() {
        let Some(path) = path.strip_prefix("/api/v1") else {
            continue;
        };
        for method in methods.as_object().unwrap().keys() {
            let method = Method::from_bytes(method.to_uppercase().as_bytes()).unwrap();
            let body = match (&method, path) {
                (&Method::POST, "/vessels/{id}/compasses") => {
                    json!({ "name": "Aft", "role": "steering" })
                }
                (&Method::PUT, "/vessels/{id}/settings") => settings(),
                (&Method::PUT, "/vessels/{id}/tags") => json!({ "tags": ["tanker"] }),
                (&Method::POST, "/vessels/{id}/logbook") => lightning(),
                (&Method::POST, "/vessels/{id}/azimuths") => sun_by_azimuth(),
                (&Method::POST, "/vessels/{id}/port-calls") => call("NLRTM", 20),
                (&Method::PUT, "/vessels/{id}/compasses/{compass}/binnacle") => binnacle(),
                _ => json!({}),
            };
            found.push((method, path.to_owned(), body));
        }
    }
    assert!(found.len() > 20, "{found:?}");
    found
}

fn lightning() -> Value {
    json!({ "kind": "lightning", "from": "2026-11-20T00:00:00Z" })
}

fn settings() -> Value {
    json!({
        "agent": {
            "version": 0, "min_sog_kn": 4.0, "max_rate_of_turn_deg_min": 18.0, "settle_s": 180,
            "max_swing_deg": 2.0, "sample_s": 600, "seal_s": 21600,
        },
        "analysis": { "gyro_speed_error": "uncorrected", "reference_constant_sd_deg": 0.5 },
    })
}

async fn every_vessel_route_is_not_found_for_another_operator(server: TestServer) {
    let ada = server.admin("ada").await;
    let eve = server.admin("eve").await;
    let id = server.ship(&ada, "Nao").await.id;
    let agents = ada.get(&format!("/vessels/{id}/agents")).await.good();
    let agent = agents["items"][0]["agent_id"].as_str().unwrap();
    let compasses = ada.get(&format!("/vessels/{id}/compasses")).await.good();
    let compass = compasses["items"][0]["id"].as_str().unwrap();
    let logbook = format!("/vessels/{id}/logbook");
    let entry = ada.post(&logbook, &lightning()).await.good()["id"].clone();
    let azimuths = format!("/vessels/{id}/azimuths");
    let azimuth = ada.post(&azimuths, &sun_by_azimuth()).await.good()["id"].clone();
    let calls = calls_of(&json!({ "id": id }));
    let port_call = ada.post(&calls, &call("NLRTM", 8)).await.good()["id"].clone();
    let kept = format!("/vessels/{id}/compasses/{compass}/binnacle");
    put(&ada, &kept, &binnacle()).await.good();
    for (method, path, body) in operations() {
        if !path.contains("/vessels/{id}") {
            continue;
        }
        let path = path.replace("{id}", &id);
        let path = path.replace("{entry}", entry.as_str().unwrap());
        let path = path.replace("{azimuth}", azimuth.as_str().unwrap());
        let path = path.replace("{call}", port_call.as_str().unwrap());
        let path = path.replace("{agent}", agent);
        let path = path.replace("{compass}", compass);
        let theirs = ApiResponse::send(eve.request(method.clone(), &path).json(&body)).await;
        assert_eq!(theirs.problem(), "not-found", "{method} {path}");
        let ours = ApiResponse::send(ada.request(method.clone(), &path).json(&body)).await;
        // A file is not JSON.
        let file = path.contains("/port-calls.");
        let known = ours.status < 300
            || ours.problem() == "no-model-yet"
            || (file && ours.problem() == "invalid");
        assert!(known, "{method} {path}: {ours:?}");
    }
    server.finish().await;
}

async fn every_route_needs_authentication(server: TestServer) {
    let ada = server.admin("ada").await;
    let id = ada.create_vessel("Nao").await["id"]
        .as_str()
        .unwrap()
        .to_owned();
    for (method, path, body) in operations() {
        let open = [
            "/session",
            "/agents/enrol",
            "/invitations/accept",
            "/first-run",
            "/password-resets",
        ];
        let is_open = open.contains(&path.as_str()) && method == Method::POST;
        // The routes to the sign-in provider and back work without sign-in, evidence and cards are
        // checked by anyone, and the sign-in page asks whether the server is empty.
        let by_provider = path.starts_with("/session/provider");
        let by_anyone = ["/signing-keys", "/card-checks/{code}", "/first-run"];
        if is_open || by_provider || by_anyone.contains(&path.as_str()) {
            continue;
        }
        let path = path
            .replace("{id}", &id)
            .replace("{entry}", &id)
            .replace("{azimuth}", &id)
            .replace("{call}", &id)
            .replace("{agent}", &id)
            .replace("{compass}", &id)
            .replace("{stream}", &id)
            .replace("{seq}", "1");
        let url = format!("{}/api/v1{path}", server.url);
        for token in ["", "bna_wrong", "wrong", &"A".repeat(43)] {
            let request = server.http.request(method.clone(), &url).json(&body);
            let response = ApiResponse::send(request.bearer_auth(token)).await;
            assert_eq!(
                response.problem(),
                "unauthenticated",
                "{method} {path} {token}"
            );
        }
        let request = server.http.request(method.clone(), &url).json(&body);
        let response = ApiResponse::send(request.header("cookie", "binnacle_session=x")).await;
        assert_eq!(response.problem(), "unauthenticated", "{method} {path}");
    }
    server.finish().await;
}

async fn another_operators_lists_are_empty(server: TestServer) {
    let ada = server.admin("ada").await;
    let eve = server.admin("eve").await;
    ada.create_vessel("Nao").await;
    let token = json!({ "name": "ERP", "scope": "read" });
    let made = ada.post("/tokens", &token).await.good();
    assert_eq!(eve.get("/vessels").await.good()["items"], json!([]));
    assert_eq!(eve.get("/tokens").await.good()["items"], json!([]));
    let path = format!("/tokens/{}", made["id"].as_str().unwrap());
    let theirs = ApiResponse::send(eve.request(Method::DELETE, &path)).await;
    assert_eq!(theirs.problem(), "not-found");
    server.finish().await;
}

async fn a_malformed_id_is_not_found(server: TestServer) {
    let ada = server.admin("ada").await;
    for path in [
        "/vessels/1",
        "/vessels/00000000-0000-0000-0000-000000000000",
        "/nowhere",
    ] {
        assert_eq!(ada.get(path).await.problem(), "not-found", "{path}");
    }
    server.finish().await;
}

async fn an_unknown_method_of_a_path_is_refused_with_a_problem(server: TestServer) {
    let ada = server.admin("ada").await;
    for path in ["/vessels", "/agents/enrol", "/streams"] {
        let response = ApiResponse::send(ada.request(Method::PATCH, path)).await;
        assert_eq!(response.problem(), "method-not-allowed", "{path}");
    }
    server.finish().await;
}
