//! Handling of alerts by several people.

use crate::alerts::{list, path};
use binnacle_compass::time::Timestamp;
use binnacle_server_testing::alerts::{set_alert_limits, ship_with_model};
use binnacle_server_testing::on_both;
use binnacle_server_testing::{ApiResponse, Person, TestServer};
use binnacle_server_testing::{DAY_S, START};
use reqwest::Method;
use serde_json::{Value, json};

on_both!(
    several_alerts_are_acknowledged_together_or_not_at_all,
    an_alert_is_assigned_to_a_colleague_and_commented,
    an_alert_has_so_many_comments_and_no_more,
    a_snoozed_alert_leaves_the_fleets_rows_until_its_time_or_until_it_gets_worse,
);

async fn put(person: &Person, path: &str, body: Value) -> ApiResponse {
    ApiResponse::send(person.request(Method::PUT, path).json(&body)).await
}

async fn several_alerts_are_acknowledged_together_or_not_at_all(server: TestServer) {
    let ada = server.admin("ada").await;
    let eve = server.admin("eve").await;
    for _ in 0..2 {
        let ship = ship_with_model(&server, &ada).await;
        set_alert_limits(&server, &ada, &ship, json!({ "deviation_deg": 2.5 })).await;
    }
    let raised = list(&ada, "").await;
    assert_eq!(raised.len(), 2);
    let alert = &raised[0];
    let ids: Vec<&Value> = raised.iter().map(|alert| &alert["id"]).collect();
    let all = json!({ "alerts": [ids[0], ids[1], ids[0]], "note": "Master informed" });
    assert_eq!(
        eve.post("/alerts/acknowledge", &all).await.problem(),
        "not-found"
    );
    let unknown = json!({ "alerts": [alert["id"], "019a0000-0000-7000-8000-000000000000"] });
    assert_eq!(
        ada.post("/alerts/acknowledge", &unknown).await.problem(),
        "not-found"
    );
    assert_eq!(list(&ada, "").await[0]["state"], "raised");
    let none = json!({ "alerts": [] });
    assert_eq!(
        ada.post("/alerts/acknowledge", &none).await.problem(),
        "invalid"
    );
    for expected in [2, 0] {
        let done = ada.post("/alerts/acknowledge", &all).await.good();
        assert_eq!(done["acknowledged"], expected);
    }
    let known = list(&ada, "").await.remove(0);
    assert_eq!(
        (&known["state"], &known["acknowledgement_note"]),
        (&json!("acknowledged"), &json!("Master informed"))
    );
    server.finish().await;
}

async fn an_alert_is_assigned_to_a_colleague_and_commented(server: TestServer) {
    let ada = server.admin("ada").await;
    let eve = server.admin("eve").await;
    let nao = ship_with_model(&server, &ada).await;
    set_alert_limits(&server, &ada, &nao, json!({ "deviation_deg": 2.5 })).await;
    let alert = list(&ada, "").await.remove(0);
    let id = async |person: &Person| person.get("/me").await.good()["user_id"].clone();
    let stranger = json!({ "user_id": id(&eve).await });
    let refused = put(&ada, &path(&alert, "/assignee"), stranger).await;
    assert_eq!(refused.problem(), "not-found");
    let me = id(&ada).await;
    let assigned = put(&ada, &path(&alert, "/assignee"), json!({ "user_id": me })).await;
    let assigned = assigned.good();
    assert_eq!(
        (&assigned["assigned_to"], &assigned["state"]),
        (&me, &json!("raised"))
    );
    assert_eq!(assigned["assigned_name"], "ada@example.com");
    let nobody = put(&ada, &path(&alert, "/assignee"), json!({ "user_id": null })).await;
    assert_eq!(nobody.good()["assigned_name"], Value::Null);
    let comments = path(&alert, "/comments");
    ada.post(&comments, &json!({ "text": "Azimuth tonight." }))
        .await
        .good();
    let [long, too_long] = [1000, 1001].map(|length| json!({ "text": "x".repeat(length) }));
    ada.post(&comments, &long).await.good();
    assert_eq!(ada.post(&comments, &too_long).await.problem(), "invalid");
    let listed = ada.get(&comments).await.good();
    assert_eq!(listed["items"][0]["text"], "Azimuth tonight.");
    assert_eq!(listed["items"][0]["by"], "ada@example.com");
    assert_eq!(eve.get(&comments).await.problem(), "not-found");
    assert_eq!(
        ada.post(&comments, &json!({ "text": " " })).await.problem(),
        "invalid"
    );
    server.finish().await;
}

async fn an_alert_has_so_many_comments_and_no_more(server: TestServer) {
    let ada = server.admin("ada").await;
    let nao = ship_with_model(&server, &ada).await;
    set_alert_limits(&server, &ada, &nao, json!({ "deviation_deg": 2.5 })).await;
    let comments = path(&list(&ada, "").await[0], "/comments");
    for number in 1..=200 {
        let comment = json!({ "text": format!("{number}") });
        assert_eq!(ada.post(&comments, &comment).await.status, 201, "{number}");
    }
    let one_more = ada.post(&comments, &json!({ "text": "201" })).await;
    assert_eq!(one_more.problem(), "wrong-state");
    server.finish().await;
}

async fn a_snoozed_alert_leaves_the_fleets_rows_until_its_time_or_until_it_gets_worse(
    server: TestServer,
) {
    let ada = server.admin("ada").await;
    let nao = ship_with_model(&server, &ada).await;
    set_alert_limits(&server, &ada, &nao, json!({ "deviation_deg": 2.5 })).await;
    let alert = list(&ada, "").await.remove(0);
    let shown = async || ada.get("/fleet").await.good()["vessels"][0]["alert"].clone();
    assert_eq!(shown().await["id"], alert["id"]);
    let snooze = path(&alert, "/snooze");
    for until in ["2020-01-01T00:00:00Z", "2030-01-01T00:00:00Z"] {
        let refused = put(&ada, &snooze, json!({ "until": until })).await;
        assert_eq!(refused.problem(), "invalid");
    }
    let until = Timestamp::parse(START).unwrap().plus_seconds(5.0 * DAY_S);
    let asleep = put(&ada, &snooze, json!({ "until": until })).await.good();
    assert_eq!(asleep["state"], "raised");
    assert_eq!(shown().await, Value::Null);
    put(&ada, &snooze, json!({ "until": null })).await.good();
    assert_eq!(shown().await["id"], alert["id"]);
    put(&ada, &snooze, json!({ "until": until })).await.good();
    // A lower limit makes the same deviation a worse alert.
    set_alert_limits(&server, &ada, &nao, json!({ "deviation_deg": 1.0 })).await;
    let worse = list(&ada, "").await.remove(0);
    assert_eq!(worse["snoozed_until"], Value::Null, "{worse}");
    assert_eq!(shown().await["id"], alert["id"]);
    let now: Timestamp = server.app.clock.now();
    let later = now.plus_seconds(3600.0);
    put(&ada, &snooze, json!({ "until": later })).await.good();
    assert_eq!(shown().await, Value::Null);
    server.advance(3601.0);
    assert_eq!(shown().await["id"], alert["id"]);
    server.finish().await;
}
