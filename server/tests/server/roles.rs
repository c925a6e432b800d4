//! Parts of the service in processes of their own, and the health check.

use binnacle_server_testing::program::{good, run};
use binnacle_server_testing::{ApiResponse, Engine, TestServer};
use reqwest::Method;
use std::net::TcpListener;

/// A route of each part, without sign-in: 401 where it is served.
const FOR_AGENTS: (Method, &str) = (Method::PUT, "/api/v1/agents/token");
const FOR_PEOPLE: (Method, &str) = (Method::GET, "/api/v1/fleet");
const DASHBOARD: (Method, &str) = (Method::GET, "/");

#[tokio::test]
async fn a_process_serves_its_role_and_its_health_alone() {
    for (role, agents, people, dashboard) in [
        ("all", 401, 401, 200),
        ("api", 404, 401, 200),
        ("ingest", 401, 404, 404),
        ("worker", 404, 404, 404),
    ] {
        let server = TestServer::start_with(Engine::Sqlite, &["--role", role]).await;
        for ((method, path), status) in [
            (FOR_AGENTS, agents),
            (FOR_PEOPLE, people),
            (DASHBOARD, dashboard),
            ((Method::GET, "/healthz"), 200),
            ((Method::GET, "/readyz"), 200),
            ((Method::GET, "/metrics"), 200),
        ] {
            let request = server.http.request(method, format!("{}{path}", server.url));
            let response = ApiResponse::send(request).await;
            assert_eq!(response.status, status, "{role}: {path}");
        }
        server.finish().await;
    }
}

#[tokio::test(flavor = "multi_thread")]
async fn a_health_check_succeeds_only_if_the_server_is_ready() {
    let folder = tempfile::tempdir().unwrap();
    let check = |url: &str| {
        let program = env!("CARGO_BIN_EXE_binnacle-server");
        run(program, folder.path(), &["health", url])
    };
    let server = TestServer::start(Engine::Sqlite).await;
    assert_eq!(good(&check(&server.url)).trim(), "ready");
    server.finish().await;
    let free = TcpListener::bind("127.0.0.1:0").unwrap();
    let nobody = format!("http://{}", free.local_addr().unwrap());
    drop(free);
    let refused = check(&nobody);
    assert_eq!(refused.status.code(), Some(1));
    let errors = String::from_utf8(refused.stderr).unwrap();
    assert!(errors.contains(&nobody), "{errors}");
}
