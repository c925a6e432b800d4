//! The sandbox, in which firms and operators practise.

use binnacle_server::command::create_sandbox;
use binnacle_server_testing::{ApiResponse, TestServer, on_both, try_sign_in};
use reqwest::Method;
use serde_json::{Value, json};

on_both!(a_firm_can_practise_a_whole_job_in_a_sandbox);

async fn a_firm_can_practise_a_whole_job_in_a_sandbox(server: TestServer) {
    let made = create_sandbox(&server.app, "Practice").await.unwrap();
    server.work().await;
    let signed_in = try_sign_in(&server, &made.operator.email, &made.operator.password).await;
    signed_in.good();
    let ask = async |method: Method, path: &str, body: &Value| {
        let url = format!("{}/api/v1{path}", server.url);
        let request = server.http.request(method, url).json(body);
        ApiResponse::send(request.bearer_auth(&made.firm.token)).await
    };
    let path = format!("/work-orders/{}", made.order_id);
    let order = ask(Method::GET, &path, &json!(null)).await.good();
    assert_eq!(order["state"], "offered");
    assert_eq!(order["vessel_name"], "Sandbox (simulated)");
    let post = async |rest: &str, body: Value| {
        let done = ask(Method::POST, &format!("{path}{rest}"), &body).await;
        assert_eq!(done.status, 200, "{rest}: {done:?}");
        done.good()
    };
    post("/accept", json!({})).await;
    post("/on-board", json!({})).await;
    post("/as-found", made.as_found.clone()).await;
    post("/berth-reading", made.berth_reading.clone()).await;
    let mut order = post("/plan", json!({})).await;
    assert!(
        order["next_step"].is_object(),
        "there is something to do: {order}"
    );
    while order["next_step"].is_object() {
        let step = &order["next_step"];
        let read = json!({ "after_deg": step["expected_compass_deg"] });
        order = post(&format!("/steps/{}", step["number"]), read).await;
    }
    let word = json!({
        "adjuster_name": "M. Etxeberria", "adjuster_licence": "ES-CA-114", "firm": "Practice",
        "signature": "M. Etxeberria",
    });
    assert_eq!(post("/complete", word).await["state"], "adjusted");
    server.finish().await;
}
