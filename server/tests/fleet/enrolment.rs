//! Enrolment of agents by one-time codes.

use binnacle_fleet::alerts;
use binnacle_server_testing::on_both;
use binnacle_server_testing::{ApiResponse, Person, Ship, TestServer, enrol_with_code, sample};
use binnacle_wire::batch::StreamId;
use reqwest::Method;
use serde_json::{Value, json};

on_both!(
    a_code_works_once,
    a_code_expires,
    a_code_may_be_typed_in_any_case_with_separators,
    a_code_for_another_vessels_compass_is_refused,
    an_agent_reaches_only_its_own_streams,
    the_agents_list_reports_last_weeks_traffic,
    the_agents_list_reports_the_spool_and_a_short_budget,
    a_token_is_replaced_only_by_one_made_for_the_agent,
    a_revoked_agent_loses_access_and_its_batches_stay,
    a_duplicate_agent_raises_an_alert_until_it_is_revoked,
    the_duplicate_agent_alert_ends_after_a_week_without_evidence,
);

async fn a_code_works_once(server: TestServer) {
    let ada = server.admin("ada").await;
    let vessel = ada.create_vessel("Nao").await;
    let path = format!("/vessels/{}/agents", vessel["id"].as_str().unwrap());
    let code = ada.post(&path, &json!({})).await.good();
    let code = code["code"].as_str().unwrap();
    let enrolled = enrol_with_code(&server, code).await.good();
    assert_eq!(enrolled["vessel_name"], "Nao");
    assert_eq!(enrolled["compass_name"], "Standard compass");
    assert_eq!(enrol_with_code(&server, code).await.problem(), "gone");
    assert_eq!(
        enrol_with_code(&server, "0000-0000-0000-0000")
            .await
            .problem(),
        "not-found"
    );
    let streams = ada.get(&path).await.good();
    assert_eq!(streams["items"].as_array().unwrap().len(), 1);
    assert_eq!(streams["items"][0]["stream"], enrolled["stream"]);
    assert_eq!(streams["items"][0]["agent_version"], "1.2.3");
    server.finish().await;
}

async fn a_code_expires(server: TestServer) {
    let ada = server.admin("ada").await;
    let vessel = ada.create_vessel("Nao").await;
    let path = format!("/vessels/{}/agents", vessel["id"].as_str().unwrap());
    let made = ada.post(&path, &json!({ "valid_for_s": 60 })).await.good();
    assert_eq!(made["expires_at"], "2026-11-21T07:01:00Z");
    server.advance(60.0);
    let late = enrol_with_code(&server, made["code"].as_str().unwrap()).await;
    assert_eq!(late.problem(), "gone");
    assert!(late.text.contains("a new one"), "{late:?}");
    let usual = ada.post(&path, &json!({})).await.good();
    assert_eq!(usual["expires_at"], "2026-11-24T07:01:00Z");
    for wrong in [0, 1_209_601] {
        let refused = ada.post(&path, &json!({ "valid_for_s": wrong })).await;
        assert_eq!(refused.problem(), "invalid");
    }
    server.finish().await;
}

async fn a_code_may_be_typed_in_any_case_with_separators(server: TestServer) {
    let ada = server.admin("ada").await;
    let vessel = ada.create_vessel("Nao").await;
    let path = format!("/vessels/{}/agents", vessel["id"].as_str().unwrap());
    let made = ada.post(&path, &json!({})).await.good();
    let code = made["code"].as_str().unwrap();
    let typed = format!(" {} ", code.to_lowercase().replace('-', " "));
    assert_eq!(enrol_with_code(&server, &typed).await.status, 200);
    server.finish().await;
}

async fn a_code_for_another_vessels_compass_is_refused(server: TestServer) {
    let ada = server.admin("ada").await;
    let eve = server.admin("eve").await;
    let theirs = ada.create_vessel("Nao").await;
    let ours = eve.create_vessel("Kogge").await;
    let path = format!("/vessels/{}/agents", ours["id"].as_str().unwrap());
    let body = json!({ "compass_id": theirs["compasses"][0]["id"] });
    assert_eq!(eve.post(&path, &body).await.problem(), "not-found");
    server.finish().await;
}

async fn an_agent_reaches_only_its_own_streams(server: TestServer) {
    let ada = server.admin("ada").await;
    let nao = server.ship(&ada, "Nao").await;
    let kogge = server.ship(&ada, "Kogge").await;
    let stolen = binnacle_server_testing::frame(kogge.stream, 1, &[]);
    let path = format!("/streams/{}/batches/1", kogge.stream);
    let put = ApiResponse::send(nao.request(Method::PUT, &path).body(stolen)).await;
    assert_eq!(put.problem(), "not-found");
    let path = format!("/streams/{}/downlink", kogge.stream);
    let fleet_read = ApiResponse::send(nao.request(Method::GET, &path)).await;
    assert_eq!(fleet_read.problem(), "not-found");
    // It does not open the fleet API either.
    let vessels = ApiResponse::send(nao.request(Method::GET, "/vessels")).await;
    assert_eq!(vessels.problem(), "unauthenticated");

    let opened = ApiResponse::send(nao.request(Method::POST, "/streams")).await;
    assert_eq!(opened.status, 201);
    let stream = opened.json()["stream"].as_str().unwrap().to_owned();
    let second = binnacle_wire::batch::StreamId(stream.parse().unwrap());
    let now = server.app.clock.now();
    let batch = binnacle_server_testing::frame(second, 1, &[sample(now, 90.0)]);
    let path = format!("/streams/{stream}/batches/1");
    let put = ApiResponse::send(nao.request(Method::PUT, &path).body(batch)).await;
    assert_eq!(put.good()["contiguous_seq"], 1);
    server.finish().await;
}

async fn the_agents_list_reports_last_weeks_traffic(server: TestServer) {
    let ada = server.admin("ada").await;
    let nao = server.ship(&ada, "Nao").await;
    let path = format!("/vessels/{}/agents", nao.id);
    let last_week =
        async |who: &Person| who.get(&path).await.good()["items"][0]["last_week"].clone();
    let nothing = json!({ "batches": 0, "octets": 0, "longest_wait_s": null });
    assert_eq!(last_week(&ada).await, nothing);
    let mut bytes = 0;
    for (seq, waited_s) in [(1, 60.0), (2, 7200.0), (3, 600.0)] {
        let taken = server.app.clock.now().plus_seconds(-waited_s);
        let batch = binnacle_server_testing::frame(nao.stream, seq, &[sample(taken, 90.0)]);
        bytes += batch.len();
        nao.put_bytes(seq, batch).await.good();
    }
    let week = json!({ "batches": 3, "octets": bytes, "longest_wait_s": 7200 });
    assert_eq!(last_week(&ada).await, week);
    server.advance(8.0 * 86_400.0);
    let ada = Person::sign_in(&server, ada.operator, &ada.email).await;
    assert_eq!(last_week(&ada).await, nothing);
    server.finish().await;
}

async fn the_agents_list_reports_the_spool_and_a_short_budget(server: TestServer) {
    let ada = server.admin("ada").await;
    let nao = server.ship(&ada, "Nao").await;
    let path = nao.path("/agents");
    let status_on_board = async || ada.get(&path).await.good()["items"][0]["aboard"].clone();
    assert_eq!(status_on_board().await, Value::Null);
    let send = async |seq: u64, status_query: &str| {
        let taken = [sample(server.app.clock.now(), 90.0)];
        let batch = binnacle_server_testing::frame(nao.stream, seq, &taken);
        let path = format!("/streams/{}/batches/{seq}{status_query}", nao.stream);
        let put = nao.request(Method::PUT, &path).body(batch);
        ApiResponse::send(put).await.good();
    };
    send(1, "").await;
    assert_eq!(status_on_board().await, Value::Null, "it was not said");
    let now = || server.app.clock.now().to_string();
    send(2, "?waits=12&budget=-40").await;
    let short = json!({ "batches_waiting": 12, "budget_left_percent": -40, "at": now() });
    assert_eq!(status_on_board().await, short);
    server.advance(3600.0);
    send(3, "?wait=1").await;
    let well = json!({ "batches_waiting": 0, "budget_left_percent": null, "at": now() });
    assert_eq!(status_on_board().await, well);
    server.finish().await;
}

async fn a_token_is_replaced_only_by_one_made_for_the_agent(server: TestServer) {
    let ada = server.admin("ada").await;
    let mut nao = server.ship(&ada, "Nao").await;
    let other = server.ship(&ada, "Arrano").await;
    let made = ApiResponse::send(nao.request(Method::POST, "/agents/token")).await;
    let new = made.good()["token"].as_str().unwrap().to_owned();
    let old = std::mem::replace(&mut nao.token, new.clone());
    let path = format!("/streams/{}/downlink", nao.stream);
    let early = ApiResponse::send(nao.request(Method::GET, &path)).await;
    assert_eq!(early.status, 401, "it is not in place yet");
    nao.token = old;
    for wrong in [&other.token, "short", ""] {
        let request = nao.request(Method::PUT, "/agents/token");
        let refused = ApiResponse::send(request.json(&json!({ "token": wrong }))).await;
        assert_eq!(refused.status, 422, "{wrong}");
    }
    let request = nao.request(Method::PUT, "/agents/token");
    let replaced = ApiResponse::send(request.json(&json!({ "token": new }))).await;
    assert_eq!(replaced.status, 204);
    let late = ApiResponse::send(nao.request(Method::GET, &path)).await;
    assert_eq!(late.status, 401, "the old one is not known any more");
    nao.token = new;
    assert_eq!(nao.downlink("").await["contiguous_seq"], 0);
    server.finish().await;
}

async fn revoke(person: &Person, ship: &Ship) -> ApiResponse {
    let streams = person.get(&ship.path("/agents")).await.good();
    let agent = streams["items"][0]["agent_id"].as_str().unwrap();
    let path = ship.path(&format!("/agents/{agent}"));
    ApiResponse::send(person.request(Method::DELETE, &path)).await
}

async fn a_revoked_agent_loses_access_and_its_batches_stay(server: TestServer) {
    let ada = server.admin("ada").await;
    let nao = server.ship(&ada, "Nao").await;
    let now = server.app.clock.now();
    nao.put(1, &[sample(now, 90.0)]).await.good();
    for _ in 0..2 {
        assert_eq!(revoke(&ada, &nao).await.status, 204);
    }
    let refused = nao.put(2, &[sample(now, 91.0)]).await;
    assert_eq!(refused.problem(), "unauthenticated");
    let streams = ada.get(&nao.path("/agents")).await.good();
    let stream = &streams["items"][0];
    assert_eq!(stream["revoked_at"], "2026-11-21T07:00:00Z");
    assert_eq!(stream["batches"], 1);
    server.finish().await;
}

/// Opens another stream of the same agent.
async fn another_stream(ship: &Ship) -> StreamId {
    let opened = ApiResponse::send(ship.request(Method::POST, "/streams")).await;
    StreamId(opened.json()["stream"].as_str().unwrap().parse().unwrap())
}

async fn put_batch(ship: &Ship, stream: StreamId, seq: u64) {
    let path = format!("/streams/{stream}/batches/{seq}");
    let frame = binnacle_server_testing::frame(stream, seq, &[]);
    let put = ship.request(Method::PUT, &path).body(frame);
    ApiResponse::send(put).await.good();
}

async fn duplicate_agent_alerts(person: &Person) -> Vec<Value> {
    let listed = person.get("/alerts").await.good();
    let mut alerts = listed["items"].as_array().unwrap().clone();
    alerts.retain(|alert| alert["cause"] == "cloned_agent");
    alerts
}

async fn a_duplicate_agent_raises_an_alert_until_it_is_revoked(server: TestServer) {
    let ada = server.admin("ada").await;
    let nao = server.ship(&ada, "Nao").await;
    put_batch(&nao, nao.stream, 1).await;
    let second = another_stream(&nao).await;
    // So far it may be the same computer, which did not use the new stream.
    put_batch(&nao, nao.stream, 2).await;
    put_batch(&nao, second, 1).await;
    // The same batch again proves nothing.
    put_batch(&nao, nao.stream, 2).await;
    assert_eq!(duplicate_agent_alerts(&ada).await, Vec::<Value>::new());
    for seq in 3..6 {
        put_batch(&nao, nao.stream, seq).await;
        put_batch(&nao, second, seq).await;
        let found = duplicate_agent_alerts(&ada).await;
        assert_eq!(found.len(), 1);
        assert_eq!(
            (&found[0]["state"], &found[0]["severity"]),
            (&json!("raised"), &json!("warning"))
        );
        let last = found[0]["evidence"][1].as_str().unwrap();
        assert!(last.starts_with(&format!("Batch {seq} arrived")), "{last}");
    }
    server.work().await;
    assert_eq!(duplicate_agent_alerts(&ada).await[0]["state"], "raised");
    revoke(&ada, &nao).await;
    assert_eq!(duplicate_agent_alerts(&ada).await[0]["state"], "cleared");
    server.finish().await;
}

async fn the_duplicate_agent_alert_ends_after_a_week_without_evidence(server: TestServer) {
    let ada = server.admin("ada").await;
    let nao = server.ship(&ada, "Nao").await;
    let second = another_stream(&nao).await;
    put_batch(&nao, second, 1).await;
    put_batch(&nao, nao.stream, 1).await;
    for (days, state) in [(6.0, "raised"), (1.1, "cleared")] {
        server.advance(days * 86_400.0);
        alerts::check_timed(&server.app).await.unwrap();
        let ada = Person::sign_in(&server, ada.operator, &ada.email).await;
        assert_eq!(duplicate_agent_alerts(&ada).await[0]["state"], state);
    }
    server.finish().await;
}
