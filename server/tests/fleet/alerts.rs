//! Alerts from an analysis or a silent agent.

use binnacle_compass::angle::TrueHeading;
use binnacle_fleet::alerts;
use binnacle_server_testing::DAY_S;
use binnacle_server_testing::alerts::{set_alert_limits, ship_with_model};
use binnacle_server_testing::on_both;
use binnacle_server_testing::{ApiResponse, Person, TestServer, passage};
use reqwest::Method;
use serde_json::{Value, json};

on_both!(
    an_alert_follows_the_vessels_limits_and_is_updated_in_place,
    an_alert_is_acknowledged_once_with_a_note,
    a_worse_alert_needs_another_acknowledgement,
    a_cleared_alert_is_raised_again_only_when_it_gets_worse,
    a_silent_agent_raises_an_alert_until_it_sends_again,
    two_servers_checking_at_once_raise_one_alert,
    diverging_references_raise_a_reference_fault_alert,
    the_list_filters_and_pages,
    another_operators_alerts_are_not_found,
    an_adjustment_withdraws_the_old_card_at_once,
    without_a_model_a_cleared_alert_is_not_reported_as_over,
);

const DAY: &str = "2026-11-15T00:00:00Z";
const A_WHILE_S: f64 = 10.0;

pub(crate) async fn list(person: &Person, query: &str) -> Vec<Value> {
    let listed = person.get(&format!("/alerts{query}")).await.good();
    listed["items"].as_array().unwrap().clone()
}

pub(crate) fn path(alert: &Value, rest: &str) -> String {
    format!("/alerts/{}{rest}", alert["id"].as_str().unwrap())
}

async fn an_alert_follows_the_vessels_limits_and_is_updated_in_place(server: TestServer) {
    let ada = server.admin("ada").await;
    let nao = ship_with_model(&server, &ada).await;
    assert_eq!(list(&ada, "").await, Vec::<Value>::new());

    set_alert_limits(&server, &ada, &nao, json!({ "deviation_deg": 2.5 })).await;
    let raised = list(&ada, "").await;
    assert_eq!(raised.len(), 1, "{raised:?}");
    let alert = &raised[0];
    assert_eq!(alert["cause"], "deviation_over_limit");
    assert_eq!(
        (&alert["state"], &alert["vessel_name"]),
        (&json!("raised"), &json!("Nao"))
    );
    assert!(
        alert["summary"]
            .as_str()
            .unwrap()
            .contains("over the limit of 2.5°"),
        "{alert}"
    );
    assert!(!alert["advice"].as_str().unwrap().is_empty());
    assert!(!alert["evidence"].as_array().unwrap().is_empty());
    let vessel = ada.get(&nao.path("")).await.good();
    assert_eq!(vessel["open_alerts"], 1);
    assert_eq!(vessel["worst_alert"], alert["severity"]);
    let at_a_glance = ada.get("/fleet").await.good()["vessels"][0]["alert"].clone();
    assert_eq!(at_a_glance["id"], alert["id"]);

    set_alert_limits(&server, &ada, &nao, json!({ "deviation_deg": 1.0 })).await;
    let updated = list(&ada, "").await;
    assert_eq!(updated.len(), 1);
    assert_eq!(
        (&updated[0]["id"], &updated[0]["severity"]),
        (&alert["id"], &json!("critical"))
    );
    assert_eq!(updated[0]["since"], alert["since"]);

    set_alert_limits(&server, &ada, &nao, json!({ "deviation_deg": 45.0 })).await;
    let cleared = ada.get(&path(alert, "")).await.good();
    assert_eq!(
        (&cleared["state"], &cleared["cleared_by"]),
        (&json!("cleared"), &Value::Null)
    );
    assert_eq!(
        ada.get("/vessels").await.good()["items"][0]["worst_alert"],
        Value::Null
    );
    // Other limits do not make another model.
    let versions = ada.get(&nao.path("/models")).await.good();
    assert_eq!(versions["items"].as_array().unwrap().len(), 1);
    server.finish().await;
}

async fn an_alert_is_acknowledged_once_with_a_note(server: TestServer) {
    let ada = server.admin("ada").await;
    let nao = ship_with_model(&server, &ada).await;
    set_alert_limits(&server, &ada, &nao, json!({ "deviation_deg": 2.5 })).await;
    let alert = list(&ada, "").await.remove(0);
    let viewer = ada.viewer(&server).await;
    let refused = viewer.post(&path(&alert, "/acknowledge"), &json!({})).await;
    assert_eq!(refused.problem(), "forbidden");

    let note = json!({ "note": "Azimuth taken" });
    let known = ada.post(&path(&alert, "/acknowledge"), &note).await.good();
    assert_eq!(
        (&known["state"], &known["acknowledged_by"]),
        (&json!("acknowledged"), &json!("ada@example.com"))
    );
    assert_eq!(known["acknowledgement_note"], "Azimuth taken");
    server.advance(60.0);
    let repeated = ada
        .post(&path(&alert, "/acknowledge"), &json!({}))
        .await
        .good();
    assert_eq!(repeated, known);
    let vessel = ada.get(&nao.path("")).await.good();
    assert_eq!(
        (&vessel["open_alerts"], &vessel["worst_alert"]),
        (&json!(0), &known["severity"])
    );

    let reason = json!({ "reason": "Adjusted" });
    ada.post(&path(&alert, "/clear"), &reason).await.good();
    let gone = ada.post(&path(&alert, "/acknowledge"), &json!({})).await;
    assert_eq!(gone.problem(), "gone");
    let empty = ada
        .post(&path(&alert, "/clear"), &json!({ "reason": " " }))
        .await;
    assert_eq!(empty.problem(), "invalid");
    server.finish().await;
}

async fn a_worse_alert_needs_another_acknowledgement(server: TestServer) {
    let ada = server.admin("ada").await;
    let nao = ship_with_model(&server, &ada).await;
    set_alert_limits(&server, &ada, &nao, json!({ "deviation_deg": 2.5 })).await;
    let alert = list(&ada, "").await.remove(0);
    assert_eq!(alert["severity"], "warning");
    // Without a body, because the note is optional.
    let request = ada.request(Method::POST, &path(&alert, "/acknowledge"));
    let known = ApiResponse::send(request).await.good();
    assert_eq!(known["acknowledgement_note"], Value::Null);
    set_alert_limits(&server, &ada, &nao, json!({ "deviation_deg": 1.0 })).await;
    let worse = ada.get(&path(&alert, "")).await.good();
    assert_eq!(
        (&worse["severity"], &worse["state"]),
        (&json!("critical"), &json!("raised"))
    );
    assert_eq!(worse["acknowledged_by"], Value::Null);
    server.finish().await;
}

async fn a_cleared_alert_is_raised_again_only_when_it_gets_worse(server: TestServer) {
    let ada = server.admin("ada").await;
    let nao = ship_with_model(&server, &ada).await;
    set_alert_limits(&server, &ada, &nao, json!({ "deviation_deg": 2.5 })).await;
    let alert = list(&ada, "").await.remove(0);
    let reason = json!({ "reason": "Known; she is sold" });
    let cleared = ada.post(&path(&alert, "/clear"), &reason).await.good();
    assert_eq!(cleared["clearing_reason"], "Known; she is sold");
    set_alert_limits(&server, &ada, &nao, json!({ "deviation_deg": 2.4 })).await;
    assert_eq!(list(&ada, "?open=true").await, Vec::<Value>::new());

    set_alert_limits(&server, &ada, &nao, json!({ "deviation_deg": 1.0 })).await;
    let open = list(&ada, "?open=true").await;
    assert_eq!(open.len(), 1);
    assert_ne!(open[0]["id"], alert["id"]);
    assert_eq!(
        ada.get(&path(&alert, "")).await.good()["cleared_by"],
        "ada@example.com"
    );
    // After its cause was gone, it is raised like any other.
    ada.post(&path(&open[0], "/clear"), &reason).await.good();
    set_alert_limits(&server, &ada, &nao, json!({ "deviation_deg": 45.0 })).await;
    set_alert_limits(&server, &ada, &nao, json!({ "deviation_deg": 1.0 })).await;
    assert_eq!(list(&ada, "?open=true").await.len(), 1);
    assert_eq!(list(&ada, "").await.len(), 3);
    server.finish().await;
}

async fn a_silent_agent_raises_an_alert_until_it_sends_again(server: TestServer) {
    let ada = server.admin("ada").await;
    let nao = server.ship(&ada, "Nao").await;
    nao.put(1, &passage(DAY, 3)).await.good();
    server.advance(2.9 * DAY_S);
    alerts::check_silence(&server.app).await.unwrap();
    // The idle session has expired.
    let ada = Person::sign_in(&server, ada.operator, &ada.email).await;
    assert_eq!(list(&ada, "").await, Vec::<Value>::new());
    server.advance(0.2 * DAY_S);
    for _ in 0..2 {
        alerts::check_silence(&server.app).await.unwrap();
    }
    let ada = Person::sign_in(&server, ada.operator, &ada.email).await;
    let raised = list(&ada, "").await;
    assert_eq!(raised.len(), 1);
    assert_eq!(
        (&raised[0]["cause"], &raised[0]["severity"]),
        (&json!("silent_agent"), &json!("notice"))
    );
    // An analysis does not clear it.
    server.work().await;
    assert_eq!(list(&ada, "?open=true").await.len(), 1);
    nao.put(2, &passage(DAY, 3)).await.good();
    alerts::check_silence(&server.app).await.unwrap();
    assert_eq!(list(&ada, "?open=true").await, Vec::<Value>::new());
    assert_eq!(list(&ada, "?state=cleared").await.len(), 1);
    server.finish().await;
}

async fn two_servers_checking_at_once_raise_one_alert(server: TestServer) {
    let ada = server.admin("ada").await;
    server.ship(&ada, "Nao").await;
    let second = server.second_server().await;
    server.advance(4.0 * DAY_S);
    let (one, other) = tokio::join!(
        alerts::check_silence(&server.app),
        alerts::check_silence(&second)
    );
    one.unwrap();
    other.unwrap();
    let ada = Person::sign_in(&server, ada.operator, &ada.email).await;
    assert_eq!(list(&ada, "").await.len(), 1);
    second.db.close().await;
    server.finish().await;
}

async fn diverging_references_raise_a_reference_fault_alert(server: TestServer) {
    let ada = server.admin("ada").await;
    let nao = server.ship(&ada, "Nao").await;
    let mut samples = passage(DAY, 400);
    for (index, sample) in samples.iter_mut().enumerate() {
        sample.satellite = sample.gyro;
        // The gyro drifts further and further.
        let wrong_deg = (index as f64 - 370.0).max(0.0);
        sample.gyro = sample
            .gyro
            .and_then(|gyro| TrueHeading::new(gyro.degrees() + wrong_deg));
    }
    set_alert_limits(
        &server,
        &ada,
        &nao,
        json!({ "deviation_deg": 45.0, "band95_deg": 45.0 }),
    )
    .await;
    nao.put(1, &samples).await.good();
    server.advance(A_WHILE_S);
    server.work().await;
    let raised = list(&ada, "").await;
    let causes: Vec<&Value> = raised.iter().map(|alert| &alert["cause"]).collect();
    assert_eq!(causes, ["reference_fault"], "{raised:?}");
    assert!(
        raised[0]["advice"]
            .as_str()
            .unwrap()
            .contains("compass itself is not suspected")
    );
    server.finish().await;
}

async fn the_list_filters_and_pages(server: TestServer) {
    let ada = server.admin("ada").await;
    let nao = ship_with_model(&server, &ada).await;
    let other = server.ship(&ada, "Santa Clara").await;
    set_alert_limits(&server, &ada, &nao, json!({ "deviation_deg": 1.0 })).await;
    server.advance(4.0 * DAY_S);
    alerts::check_silence(&server.app).await.unwrap();
    let ada = Person::sign_in(&server, ada.operator, &ada.email).await;
    assert_eq!(list(&ada, "").await.len(), 3);
    assert_eq!(list(&ada, "?severity=warning").await.len(), 1);
    assert_eq!(list(&ada, &format!("?vessel={}", other.id)).await.len(), 1);
    assert_eq!(list(&ada, "?state=acknowledged").await.len(), 0);
    assert_eq!(list(&ada, "?open=false").await.len(), 0);
    let first = ada.get("/alerts?limit=2").await.good();
    let rest = format!("?limit=2&after={}", first["next"].as_str().unwrap());
    let rest = list(&ada, &rest).await;
    assert_eq!(rest.len(), 1);
    // The newest come first.
    assert_eq!(rest[0]["cause"], "deviation_over_limit");
    assert_eq!(ada.get("/alerts?state=odd").await.problem(), "bad-request");
    server.finish().await;
}

async fn another_operators_alerts_are_not_found(server: TestServer) {
    let ada = server.admin("ada").await;
    let eve = server.admin("eve").await;
    server.ship(&ada, "Nao").await;
    server.advance(4.0 * DAY_S);
    alerts::check_silence(&server.app).await.unwrap();
    let ada = Person::sign_in(&server, ada.operator, &ada.email).await;
    let eve = Person::sign_in(&server, eve.operator, &eve.email).await;
    let alert = list(&ada, "").await.remove(0);
    assert_eq!(list(&eve, "").await, Vec::<Value>::new());
    assert_eq!(eve.get(&path(&alert, "")).await.problem(), "not-found");
    let reason = json!({ "reason": "Mischief" });
    for (rest, body) in [("/acknowledge", json!({})), ("/clear", reason)] {
        assert_eq!(
            eve.post(&path(&alert, rest), &body).await.problem(),
            "not-found"
        );
    }
    assert_eq!(ada.get(&path(&alert, "")).await.good()["state"], "raised");
    server.finish().await;
}

async fn without_a_model_a_cleared_alert_is_not_reported_as_over(server: TestServer) {
    let ada = server.admin("ada").await;
    let nao = ship_with_model(&server, &ada).await;
    set_alert_limits(&server, &ada, &nao, json!({ "deviation_deg": 2.5 })).await;
    let open = list(&ada, "?open=true").await.remove(0);
    assert_eq!(open["cause"], "deviation_over_limit");

    // All samples are from before it.
    let adjusted = json!({ "kind": "adjustment", "from": "2026-11-18T06:00:00Z" });
    ada.post(&nao.path("/logbook"), &adjusted).await.good();
    server.work().await;
    let alert = ada.get(&path(&open, "")).await.good();
    assert_eq!(alert["state"], "cleared");
    let reason = alert["clearing_reason"].as_str().unwrap();
    assert!(reason.ends_with("it is not known to be over"), "{reason}");
    server.finish().await;
}

async fn an_adjustment_withdraws_the_old_card_at_once(server: TestServer) {
    let ada = server.admin("ada").await;
    let nao = ship_with_model(&server, &ada).await;
    let model = ada.get(&nao.path("/model")).await.good();
    let has = format!("?model={}", model["id"].as_str().unwrap());
    assert_eq!(nao.downlink(&has).await.get("card_withdrawn"), None);

    let adjusted = json!({ "kind": "adjustment", "from": "2026-11-18T06:00:00Z" });
    let entry = ada.post(&nao.path("/logbook"), &adjusted).await.good();
    server.work().await;
    let response = ada.get(&nao.path("/model")).await;
    assert_eq!(response.problem(), "no-model-yet");
    let detail = response.json()["detail"].as_str().unwrap().to_owned();
    assert!(
        detail.contains("has not held since 2026-11-18T06:00:00Z (adjustment)"),
        "{detail}"
    );
    for vessel in [
        ada.get(&nao.path("")).await.good(),
        ada.get("/vessels").await.good()["items"][0].clone(),
    ] {
        assert_eq!(
            (&vessel["model"], &vessel["worst"]),
            (&Value::Null, &Value::Null)
        );
    }
    let withdrawn = json!({ "since": "2026-11-18T06:00:00Z", "reason": "adjustment" });
    assert_eq!(response.json()["card_withdrawn"], withdrawn);
    let downlink = nao.downlink(&has).await;
    assert_eq!(downlink["card_withdrawn"], withdrawn);
    assert_eq!(nao.downlink("").await.get("card_withdrawn"), None);
    let missed = server.events().await;
    assert_eq!(
        missed.iter().filter(|kind| *kind == "model").count(),
        2,
        "{missed:?}"
    );

    // The report is withdrawn, and the card is valid again.
    let withdraw = format!("/logbook/{}/withdraw", entry["id"].as_str().unwrap());
    ada.post(&nao.path(&withdraw), &json!({})).await.good();
    server.work().await;
    let repeated = ada.get(&nao.path("/model")).await.good();
    assert_eq!(repeated["model"], model["model"]);
    let downlink = nao.downlink(&has).await;
    assert_eq!(
        (&downlink["model"]["id"], downlink.get("card_withdrawn")),
        (&repeated["id"], None)
    );
    server.finish().await;
}
