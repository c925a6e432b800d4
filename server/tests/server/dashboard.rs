//! The dashboard's host, health and metrics, response headers.

use binnacle_server_testing::{ApiResponse, Engine, TestServer};
use reqwest::header::HeaderName;

#[tokio::test]
async fn every_path_outside_the_api_serves_the_dashboard() {
    let server = TestServer::start(Engine::Sqlite).await;
    for path in ["/", "/vessels/1", "/index.html"] {
        let page = ApiResponse::send(server.http.get(format!("{}{path}", server.url))).await;
        assert_eq!(page.status, 200);
        assert!(
            page.headers["content-type"]
                .to_str()
                .unwrap()
                .starts_with("text/html")
        );
        let policy = page.headers["content-security-policy"].to_str().unwrap();
        assert!(
            policy.starts_with("default-src 'none'; script-src 'self';"),
            "{policy}"
        );
        assert_eq!(page.headers["x-content-type-options"], "nosniff");
    }
    let missing = server.http.get(format!("{}/assets/none.js", server.url));
    assert_eq!(ApiResponse::send(missing).await.status, 404);
    for path in ["/api/none", "/api/v1/none", "/api/v2/vessels"] {
        let response = ApiResponse::send(server.http.get(format!("{}{path}", server.url))).await;
        assert_eq!(response.problem(), "not-found", "{path}");
    }
    server.finish().await;
}

#[tokio::test]
async fn the_health_routes_report_the_servers_state() {
    let server = TestServer::start(Engine::Sqlite).await;
    for (path, text) in [("/healthz", "ok"), ("/readyz", "ready")] {
        let response = ApiResponse::send(server.http.get(format!("{}{path}", server.url))).await;
        assert_eq!((response.status, response.text.as_str()), (200, text));
    }
    let metrics = ApiResponse::send(server.http.get(format!("{}/metrics", server.url))).await;
    assert!(
        metrics.text.contains("binnacle_http_requests_total"),
        "{metrics:?}"
    );
    server.finish().await;
}

#[tokio::test]
async fn metrics_need_the_local_machine_or_a_token() {
    let read = async |server: &TestServer, header: (&str, &str)| {
        let request = server.http.get(format!("{}/metrics", server.url));
        ApiResponse::send(request.header(header.0, header.1))
            .await
            .status
    };
    let server = TestServer::start(Engine::Sqlite).await;
    assert_eq!(read(&server, ("accept", "text/plain")).await, 200);
    // A request through an unknown proxy may come from anybody.
    for by in ["x-forwarded-for", "forwarded"] {
        assert_eq!(read(&server, (by, "127.0.0.1")).await, 401, "{by}");
    }
    server.finish().await;
    let proxied = TestServer::start_with(Engine::Sqlite, &["--proxies", "1"]).await;
    assert_eq!(read(&proxied, ("x-forwarded-for", "192.0.2.7")).await, 401);
    proxied.finish().await;

    let token = "a-token-of-the-scraper";
    let server = TestServer::start_with(Engine::Sqlite, &["--metrics-token", token]).await;
    for (sent, status) in [
        (format!("Bearer {token}"), 200),
        (format!("Bearer {token}s"), 401),
        (token.to_owned(), 401),
        (String::new(), 401),
    ] {
        let answered = read(&server, ("authorization", &sent)).await;
        assert_eq!(answered, status, "{sent}");
    }
    assert_eq!(read(&server, ("accept", "text/plain")).await, 401);
    server.finish().await;
}

#[tokio::test]
async fn responses_to_agents_have_only_necessary_headers() {
    let server = TestServer::start(Engine::Sqlite).await;
    let ada = server.admin("ada").await;
    let nao = server.ship(&ada, "Nao").await;
    let response = nao.put(1, &[]).await;
    let mut names: Vec<&str> = response.headers.keys().map(HeaderName::as_str).collect();
    names.sort_unstable();
    assert_eq!(names, ["content-length", "content-type", "date"]);
    server.finish().await;
}
