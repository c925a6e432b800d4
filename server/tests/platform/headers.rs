//! Headers of every response, and limits on the size and origin of requests.

use binnacle_server::routes::openapi;
use binnacle_server_testing::{ApiResponse, Engine, PASSWORD, TestServer};
use reqwest::Method;
use serde_json::json;

#[tokio::test]
async fn every_response_to_people_has_browser_security_headers() {
    let server = TestServer::start(Engine::Sqlite).await;
    for path in ["/", "/api/docs", "/api/v1/vessels", "/api/none", "/healthz"] {
        let response = ApiResponse::send(server.http.get(format!("{}{path}", server.url))).await;
        let header = |name: &str| response.headers[name].to_str().unwrap().to_owned();
        assert_eq!(header("x-content-type-options"), "nosniff", "{path}");
        assert_eq!(header("x-frame-options"), "DENY");
        assert_eq!(header("referrer-policy"), "same-origin");
        assert_eq!(header("cross-origin-opener-policy"), "same-origin");
        assert_eq!(header("cross-origin-resource-policy"), "same-origin");
        assert!(header("permissions-policy").contains("geolocation=(self)"));
        let policy = header("content-security-policy");
        for part in [
            "default-src 'none'",
            "script-src 'self';",
            "connect-src 'self'",
            "frame-ancestors 'none'",
            "base-uri 'none'",
            "form-action 'self'",
        ] {
            assert!(policy.contains(part), "{policy}");
        }
        // The tests' server has an https public URL.
        assert_eq!(header("strict-transport-security"), "max-age=31536000");
    }
    server.finish().await;
}

#[tokio::test]
async fn a_plain_http_server_sends_no_strict_transport_security() {
    let plain = ["--public-url", "http://binnacle.example"];
    let server = TestServer::start_with(Engine::Sqlite, &plain).await;
    let response = ApiResponse::send(server.http.get(format!("{}/", server.url))).await;
    assert_eq!(response.headers.get("strict-transport-security"), None);
    server.finish().await;
}

#[tokio::test]
async fn a_cross_site_request_changes_nothing_and_cannot_sign_in() {
    let server = TestServer::start(Engine::Sqlite).await;
    let ada = server.admin("ada").await;
    let vessel = json!({ "name": "Nao" });
    for (name, value) in [
        ("origin", "https://evil.example"),
        ("origin", "null"),
        ("sec-fetch-site", "cross-site"),
        ("sec-fetch-site", "same-site"),
    ] {
        // Even with the cookie and the dashboard's own header.
        let request = ada.request(Method::POST, "/vessels").json(&vessel);
        let refused = ApiResponse::send(request.header(name, value)).await;
        assert_eq!(refused.problem(), "forbidden", "{name}: {value}");
        let who = json!({ "email": "ada@example.com", "password": PASSWORD });
        let sign_in = server.http.post(format!("{}/api/v1/session", server.url));
        let refused = ApiResponse::send(sign_in.json(&who).header(name, value)).await;
        assert_eq!(refused.problem(), "forbidden", "{name}: {value}");
        assert_eq!(refused.headers.get("set-cookie"), None);
    }
    assert_eq!(ada.get("/vessels").await.good()["items"], json!([]));
    for (name, value) in [
        ("origin", server.url.as_str()),
        ("origin", "https://binnacle.example"),
        ("sec-fetch-site", "same-origin"),
    ] {
        let request = ada.request(Method::POST, "/vessels").json(&vessel);
        let made = ApiResponse::send(request.header(name, value)).await;
        assert_eq!(made.status, 201, "{name}: {value}: {made:?}");
    }
    server.finish().await;
}

#[tokio::test]
async fn an_oversized_body_is_refused_with_a_problem_on_every_json_route() {
    let server = TestServer::start(Engine::Sqlite).await;
    let ada = server.admin("ada").await;
    let nao = server.ship(&ada, "Nao").await;
    let (_, rosa) = ada.adjuster(&server, "rosa").await;
    let root = ada.platform_admin(&server).await;
    let body = json!({ "text": "x".repeat(70_000) }).to_string();
    let document = serde_json::to_value(openapi()).unwrap();
    let mut tried = 0;
    for (path, methods) in document["paths"].as_object().unwrap() {
        for (method, operation) in methods.as_object().unwrap() {
            let taken = &operation["requestBody"]["content"];
            if taken["application/json"].is_null() {
                continue;
            }
            let filled: Vec<&str> = path
                .strip_prefix("/api/v1")
                .unwrap()
                .split('/')
                .map(|part| match part {
                    "{id}" if path.contains("/vessels/") => nao.id.as_str(),
                    "{n}" => "1",
                    id if id.starts_with('{') => "019a0000-0000-7000-8000-000000000000",
                    word => word,
                })
                .collect();
            let method = Method::from_bytes(method.to_uppercase().as_bytes()).unwrap();
            let tag = operation["tags"][0].as_str().unwrap();
            let filled = filled.join("/");
            let request = match tag {
                "agents" => nao.request(method, &filled),
                "platform" => root.request(method, &filled),
                _ if filled.ends_with("/propose") => rosa.request(method, &filled),
                _ => ada.request(method, &filled),
            };
            let request = request.header("content-type", "application/json");
            let refused = ApiResponse::send(request.body(body.clone())).await;
            assert_eq!(refused.problem(), "too-large", "{path}: {refused:?}");
            assert_eq!(refused.status, 413);
            tried += 1;
        }
    }
    assert!(tried > 40, "{tried}");
    server.finish().await;
}

#[tokio::test]
async fn endless_headers_are_refused_while_others_are_served() {
    let server = TestServer::start(Engine::Sqlite).await;
    let page = format!("{}/healthz", server.url);
    let long = server.http.get(&page).header("x-long", "x".repeat(600_000));
    match long.send().await {
        Ok(response) => assert_eq!(response.status(), 431),
        // The server may close the connection before the client has sent everything.
        Err(error) => assert!(error.is_request(), "{error:?}"),
    }
    let mut many = server.http.get(&page);
    for index in 0..200 {
        many = many.header(format!("x-{index}"), "y");
    }
    assert_eq!(ApiResponse::send(many).await.status, 431);
    assert_eq!(ApiResponse::send(server.http.get(&page)).await.status, 200);
    server.finish().await;
}
