//! Pinned jobs stay in the plan, and move only for cause.

use super::{compass_of, due_vessel, enter_port_call, first_job, planned_firm, put, solve, terms};
use binnacle_server_testing::on_both;
use binnacle_server_testing::port_calls;
use binnacle_server_testing::{ApiResponse, TestServer};
use reqwest::Method;
use serde_json::{Value, json};

on_both!(
    a_pinned_job_stays_until_it_is_unpinned,
    an_impossible_pin_is_dropped_with_its_reason,
    an_invalid_pin_is_refused,
);

fn pin(vessel: &Value, call: &Value, firm: &str, day: &str) -> Value {
    json!({ "compass_id": compass_of(vessel), "call_id": call["id"], "firm_id": firm,
            "day": day, "note": "agreed by telephone" })
}

async fn a_pinned_job_stays_until_it_is_unpinned(server: TestServer) {
    let ada = server.admin("ada").await;
    let nao = due_vessel(&ada, "Nao").await;
    enter_port_call(&ada, &nao, "NLRTM", 8).await;
    let later = enter_port_call(&ada, &nao, "BEANR", 15).await;
    let firm = planned_firm(&server, &ada, "Maas Compass").await;
    let new_pin = pin(&nao, &later, &firm, "2026-12-15");
    let kept = ada.post("/schedule/pins", &new_pin).await.good();
    assert_eq!(kept["created_by"], "ada@example.com");
    let made = solve(&ada).await;
    assert_eq!(first_job(&made), ("BEANR", "2026-12-15", "Maas Compass"));
    let job = &made["jobs"][0];
    assert_eq!(
        (&job["pinned"], &job["state"]),
        (&json!(true), &json!("proposed"))
    );
    let list = ada.get("/schedule/pins").await.good();
    assert_eq!(list["items"][0], kept);
    let path = format!("/schedule/pins/{}", compass_of(&nao));
    let eve = server.admin("eve").await;
    let theirs = ApiResponse::send(eve.request(Method::DELETE, &path)).await;
    assert_eq!(theirs.problem(), "not-found");
    assert_eq!(eve.get("/schedule/pins").await.good()["items"], json!([]));
    let gone = ApiResponse::send(ada.request(Method::DELETE, &path)).await;
    assert_eq!(gone.status, 204);
    let made = solve(&ada).await;
    assert_eq!(first_job(&made), ("NLRTM", "2026-12-09", "Maas Compass"));
    assert_eq!(made["jobs"][0]["pinned"], false);
    server.finish().await;
}

async fn an_impossible_pin_is_dropped_with_its_reason(server: TestServer) {
    let ada = server.admin("ada").await;
    let nao = due_vessel(&ada, "Nao").await;
    enter_port_call(&ada, &nao, "NLRTM", 8).await;
    let later = enter_port_call(&ada, &nao, "BEANR", 15).await;
    let firm = planned_firm(&server, &ada, "Maas Compass").await;
    let new_pin = pin(&nao, &later, &firm, "2026-12-15");
    ada.post("/schedule/pins", &new_pin).await.good();
    solve(&ada).await;
    let call = format!(
        "{}/{}",
        port_calls::path(&nao),
        later["id"].as_str().unwrap()
    );
    ada.post(&format!("{call}/withdraw"), &json!({}))
        .await
        .good();
    let made = solve(&ada).await;
    assert_eq!(first_job(&made), ("NLRTM", "2026-12-09", "Maas Compass"));
    let change = &made["changes"][0];
    assert_eq!(change["what"], "moved");
    assert!(
        change["why"].as_str().unwrap().contains("is cancelled"),
        "{change}"
    );
    assert_eq!(made["jobs"][0]["pinned"], false);
    server.finish().await;
}

async fn an_invalid_pin_is_refused(server: TestServer) {
    let ada = server.admin("ada").await;
    let eve = server.admin("eve").await;
    let nao = due_vessel(&ada, "Nao").await;
    let pinta = due_vessel(&ada, "Pinta").await;
    let call = enter_port_call(&ada, &nao, "NLRTM", 8).await;
    let others = enter_port_call(&ada, &pinta, "NLRTM", 8).await;
    let firm = planned_firm(&server, &ada, "Maas Compass").await;
    let early = ada
        .post("/schedule/pins", &pin(&nao, &call, &firm, "2026-12-07"))
        .await;
    assert_eq!(early.problem(), "invalid");
    assert!(early.text.contains("2026-12-08 to 2026-12-09"), "{early:?}");
    let day = "2026-12-08";
    for wrong in [
        pin(&nao, &others, &firm, day),
        pin(&nao, &call, nao["id"].as_str().unwrap(), day),
    ] {
        let response = ada.post("/schedule/pins", &wrong).await;
        assert_eq!(response.problem(), "not-found", "{wrong}");
    }
    // A pin to a firm without terms would give way at once.
    let mut idle = terms();
    idle["working_days"] = json!([]);
    put(&ada, &format!("/firms/{firm}/terms"), &idle)
        .await
        .good();
    let nobody = ada
        .post("/schedule/pins", &pin(&nao, &call, &firm, day))
        .await;
    assert_eq!(nobody.problem(), "invalid");
    let why = "the schedule cannot plan with Maas Compass: working_days";
    assert!(nobody.text.contains(why), "{nobody:?}");
    let theirs = eve
        .post("/schedule/pins", &pin(&nao, &call, &firm, day))
        .await;
    assert_eq!(theirs.problem(), "not-found");
    server.finish().await;
}
