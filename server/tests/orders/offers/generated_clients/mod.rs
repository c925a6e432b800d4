//! A whole order by the clients that generators make from the API's document.

use crate::offers::example_client::offered;
use binnacle_orders::evidence;
use binnacle_orders::work_orders::sha256_hex;
use binnacle_server_testing::work_orders::reading;
use binnacle_server_testing::{TestServer, on_both};
use serde_json::json;
use std::path::Path;
use tokio::process::Command;

on_both!(
    a_client_by_openapi_python_client_completes_an_order,
    a_client_by_openapi_generator_completes_an_order,
);

async fn a_client_by_openapi_python_client_completes_an_order(server: TestServer) {
    complete_with(&server, "with_openapi_python_client.py").await;
    server.finish().await;
}

async fn a_client_by_openapi_generator_completes_an_order(server: TestServer) {
    complete_with(&server, "with_openapi_generator.py").await;
    server.finish().await;
}

/// Has a program with a generated client complete an order, and verifies what it downloads.
async fn complete_with(server: &TestServer, program: &str) {
    let (job, rosa) = offered(server).await;
    let token = json!({ "name": "office", "scope": "write" });
    let made = rosa.post("/tokens", &token).await.good();
    let folder = tempfile::tempdir().unwrap();
    let folder = folder.path();
    std::fs::write(folder.join("reading.json"), reading().to_string()).unwrap();
    let here = Path::new(env!("CARGO_MANIFEST_DIR"));
    let tools = here.join("../.tools");
    let clients = tools.join("api-clients");
    assert!(
        clients.join("made-from").is_file(),
        "there are no generated clients to test with: run scripts/api-clients"
    );
    let done = Command::new(tools.join("python/bin/python"))
        .arg(
            here.join("tests/orders/offers/generated_clients")
                .join(program),
        )
        .args([&server.url, made["token"].as_str().unwrap(), &job.order])
        .arg(folder)
        .env("PYTHONPATH", clients)
        .env("PYTHONDONTWRITEBYTECODE", "1")
        .output()
        .await
        .unwrap();
    let errors = String::from_utf8_lossy(&done.stderr);
    assert!(done.status.success(), "{errors}");
    let downloaded = |name: &str| std::fs::read(folder.join(name)).unwrap();
    let record_sha256 = String::from_utf8(done.stdout).unwrap();
    let record = downloaded("record.json");
    assert_eq!(sha256_hex(&record), record_sha256.trim());
    assert!(downloaded("record.pdf").starts_with(b"%PDF-"));
    let verified = evidence::verify(&downloaded("evidence.zip"), None);
    assert!(verified.problems.is_empty(), "{verified:?}");
}
