//! Alerts raised by the ship's agent, as the server stores them.

use binnacle_compass::time::Timestamp;
use binnacle_fleet::alerts;
use binnacle_server_testing::alerts::{agent_alert, put_agent_alerts};
use binnacle_server_testing::on_both;
use binnacle_server_testing::{Person, TestServer, passage};
use binnacle_wire::alert::{ShipAlert, ShipAlertState};
use binnacle_wire::batch::{Batch, Thinned};
use serde_json::{Value, json};
use std::collections::BTreeMap;
use uuid::Uuid;

on_both!(
    an_agent_alert_is_raised_and_its_samples_analysed_at_once,
    revisions_in_any_order_and_repeated_give_the_same_state,
    an_analysis_does_not_clear_an_agent_alert,
    an_alert_of_a_lost_spool_is_closed,
    repeated_departures_within_hours_are_one_alert,
    a_new_departure_after_a_clearing_is_another_alert,
    samples_thinned_on_board_are_counted,
);

const DAY: &str = "2026-11-20T00:00:00Z";

/// Advances some hours without a batch.
async fn advance_hours(server: &TestServer) {
    server.advance(7.0 * 3600.0);
    alerts::check_timed(&server.app).await.unwrap();
}

async fn list(person: &Person) -> Vec<Value> {
    let listed = person.get("/alerts").await.good();
    listed["items"].as_array().unwrap().clone()
}

async fn an_agent_alert_is_raised_and_its_samples_analysed_at_once(server: TestServer) {
    let ada = server.admin("ada").await;
    let nao = server.ship(&ada, "Nao").await;
    nao.put(1, &passage(DAY, 6)).await.good();
    assert_eq!(server.work().await.len(), 0, "it waits for more batches");

    let open = agent_alert(1, 1, ShipAlertState::Open);
    put_agent_alerts(&nao, 3, passage("2026-11-20T04:00:00Z", 3), vec![open]).await;
    let raised = list(&ada).await;
    assert_eq!(raised.len(), 1, "{raised:?}");
    let alert = &raised[0];
    assert_eq!(alert["cause"], "reported_aboard");
    assert_eq!(alert["severity"], "critical");
    assert_eq!(alert["since"], "2026-11-20T04:00:00Z");
    let summary = alert["summary"].as_str().unwrap();
    assert!(
        summary.contains("reported by the ship's agent"),
        "{summary}"
    );
    assert!(!server.work().await.is_empty(), "nothing is waited for");
    server.finish().await;
}

async fn revisions_in_any_order_and_repeated_give_the_same_state(server: TestServer) {
    use ShipAlertState::{Agree, Open};
    let ada = server.admin("ada").await;
    let nao = server.ship(&ada, "Nao").await;
    let say = |seq: u64, revision: u32| {
        let state = if revision < 3 { Open } else { Agree };
        put_agent_alerts(&nao, seq, Vec::new(), vec![agent_alert(1, revision, state)])
    };
    // The agent sends the newest first.
    say(3, 2).await;
    say(2, 1).await;
    let raised = list(&ada).await;
    assert_eq!((raised.len(), &raised[0]["state"]), (1, &json!("raised")));
    say(4, 3).await;
    say(2, 1).await;
    say(3, 2).await;
    let quiet = list(&ada).await;
    assert_eq!((quiet.len(), &quiet[0]["state"]), (1, &json!("raised")));
    let summary = quiet[0]["summary"].as_str().unwrap();
    assert!(summary.contains("they agree"), "{summary}");
    advance_hours(&server).await;
    let over = list(&ada).await;
    assert_eq!((over.len(), &over[0]["state"]), (1, &json!("cleared")));
    assert_eq!(over[0]["cleared_by"], Value::Null);
    assert_eq!(over[0]["clearing_reason"], "it is over");
    server.finish().await;
}

async fn an_analysis_does_not_clear_an_agent_alert(server: TestServer) {
    let ada = server.admin("ada").await;
    let nao = server.ship(&ada, "Nao").await;
    let open = agent_alert(1, 1, ShipAlertState::Open);
    put_agent_alerts(&nao, 1, passage(DAY, 300), vec![open]).await;
    server.work().await;
    alerts::check_silence(&server.app).await.unwrap();
    let open: Vec<Value> = list(&ada)
        .await
        .into_iter()
        .filter(|alert| alert["cause"] == "reported_aboard")
        .collect();
    assert_eq!(open.len(), 1);
    assert_eq!(open[0]["state"], "raised");
    server.finish().await;
}

async fn an_alert_of_a_lost_spool_is_closed(server: TestServer) {
    use ShipAlertState::{NotJudged, Open};
    let ada = server.admin("ada").await;
    let nao = server.ship(&ada, "Nao").await;
    put_agent_alerts(&nao, 1, Vec::new(), vec![agent_alert(1, 1, Open)]).await;
    // The agent that replaced it does not know that alert, and raises its own.
    put_agent_alerts(&nao, 2, Vec::new(), vec![agent_alert(2, 1, Open)]).await;
    assert_eq!(list(&ada).await.len(), 1, "updated, not repeated");
    put_agent_alerts(&nao, 3, Vec::new(), vec![agent_alert(2, 2, NotJudged)]).await;
    advance_hours(&server).await;
    let cleared = &list(&ada).await[0];
    assert_eq!(cleared["state"], "cleared");
    let why = cleared["clearing_reason"].as_str().unwrap();
    assert!(why.contains("not known to be over"), "{why}");
    server.finish().await;
}

async fn repeated_departures_within_hours_are_one_alert(server: TestServer) {
    use ShipAlertState::{Agree, Open};
    let ada = server.admin("ada").await;
    let nao = server.ship(&ada, "Nao").await;
    let begun = Timestamp::parse("2026-11-20T04:00:00Z").unwrap();
    let said = |id: u128, hours: f64, revision: u32, state| {
        let since = begun.plus_seconds(3600.0 * hours);
        let at = since.plus_seconds(1800.0 * f64::from(revision));
        ShipAlert {
            since,
            at,
            ..agent_alert(id, revision, state)
        }
    };
    let mut seq = 0;
    for (id, hours) in [(1, 0.0), (2, 4.0), (3, 8.5)] {
        for (revision, state) in [(1, Open), (2, Agree)] {
            seq += 1;
            put_agent_alerts(
                &nao,
                seq,
                Vec::new(),
                vec![said(id, hours, revision, state)],
            )
            .await;
        }
    }
    let one = list(&ada).await;
    assert_eq!(
        (one.len(), &one[0]["state"]),
        (1, &json!("raised")),
        "{one:?}"
    );
    assert_eq!(one[0]["since"], "2026-11-20T04:00:00Z");
    // Samples show agreement before the timeout does.
    put_agent_alerts(&nao, 7, passage("2026-11-20T14:00:00Z", 60), Vec::new()).await;
    server.advance(3600.0);
    server.work().await;
    let over = list(&ada).await;
    let states: Vec<&Value> = over.iter().map(|alert| &alert["state"]).collect();
    assert_eq!(states, [&json!("cleared")], "{over:?}");
    // A day later it is another alert.
    put_agent_alerts(&nao, 8, Vec::new(), vec![said(4, 30.0, 1, Open)]).await;
    assert_eq!(list(&ada).await.len(), 2);
    server.finish().await;
}

async fn a_new_departure_after_a_clearing_is_another_alert(server: TestServer) {
    let ada = server.admin("ada").await;
    let nao = server.ship(&ada, "Nao").await;
    let since = Timestamp::parse("2026-11-21T04:00:00Z").unwrap();
    let open = ShipAlert {
        since,
        at: since.plus_seconds(1800.0),
        ..agent_alert(1, 1, ShipAlertState::Open)
    };
    put_agent_alerts(&nao, 1, Vec::new(), vec![open]).await;
    let id = list(&ada).await[0]["id"].as_str().unwrap().to_owned();
    let reason = json!({ "reason": "gyro was set right" });
    ada.post(&format!("/alerts/{id}/clear"), &reason)
        .await
        .good();
    let again = ShipAlert {
        revision: 2,
        ..open
    };
    put_agent_alerts(&nao, 2, Vec::new(), vec![again]).await;
    assert_eq!(list(&ada).await.len(), 1, "of the same it has been said");
    let anew = ShipAlert {
        id: Uuid::from_u128(2),
        since: open.since.plus_seconds(4.0 * 3600.0),
        at: open.since.plus_seconds(4.5 * 3600.0),
        ..open
    };
    put_agent_alerts(&nao, 3, Vec::new(), vec![anew]).await;
    let raised = list(&ada).await;
    assert_eq!((raised.len(), &raised[0]["state"]), (2, &json!("raised")));
    server.finish().await;
}

async fn samples_thinned_on_board_are_counted(server: TestServer) {
    let ada = server.admin("ada").await;
    let nao = server.ship(&ada, "Nao").await;
    let batch = Batch {
        stream: nao.stream,
        seq: 1,
        samples: passage(DAY, 6),
        tally: BTreeMap::from([("accepted".to_owned(), 1080)]),
        alerts: Vec::new(),
        thinned: Some(Thinned {
            samples: 12,
            windows: 720,
        }),
    };
    nao.put_bytes(1, binnacle_wire::encode(&batch).unwrap())
        .await
        .good();
    let streams = ada.get(&nao.path("/agents")).await.good();
    let tally = &streams["items"][0]["tally"];
    assert_eq!(*tally, json!({ "accepted": 1080, "thinned": 720 }));
    server.finish().await;
}
