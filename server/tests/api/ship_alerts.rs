//! Alerts that the ship's agent raises itself, on shore.

use crate::on_both;
use crate::support::{Person, Ship, Shore, passage};
use binnacle_magnetics::sample::Sample;
use binnacle_magnetics::time::Timestamp;
use binnacle_server::alerts;
use binnacle_wire::alert::{ShipAlert, ShipAlertState};
use binnacle_wire::batch::{Batch, Thinned};
use serde_json::{Value, json};
use std::collections::BTreeMap;
use uuid::Uuid;

on_both!(
    a_ships_alert_is_the_vessels_at_once_and_her_samples_are_analysed_at_once,
    revisions_in_any_order_and_again_end_alike,
    an_analysis_does_not_clear_what_the_ship_says,
    an_alert_of_a_spool_that_was_lost_does_not_stay_open,
    what_was_thinned_on_board_is_counted,
);

const DAY: &str = "2026-11-20T00:00:00Z";

fn alert(id: u128, revision: u32, state: ShipAlertState) -> ShipAlert {
    let since = Timestamp::parse("2026-11-20T04:00:00Z").unwrap();
    ShipAlert {
        id: Uuid::from_u128(id),
        revision,
        state,
        since,
        at: since.plus_seconds(1800.0 * f64::from(revision) + id as f64),
        gyro_departure_deg: Some(-28.4),
        satellite_departure_deg: None,
        limit_deg: 3.9,
        model_version: 2,
    }
}

async fn put(ship: &Ship, seq: u64, samples: Vec<Sample>, alerts: Vec<ShipAlert>) {
    let batch = Batch {
        stream: ship.stream,
        seq,
        samples,
        tally: BTreeMap::new(),
        alerts,
        thinned: None,
    };
    let bytes = binnacle_wire::encode(&batch).unwrap();
    ship.put_bytes(seq, bytes).await.good();
}

async fn list(person: &Person) -> Vec<Value> {
    let listed = person.get("/alerts").await.good();
    listed["items"].as_array().unwrap().clone()
}

async fn a_ships_alert_is_the_vessels_at_once_and_her_samples_are_analysed_at_once(shore: Shore) {
    let ada = shore.admin("ada").await;
    let nao = shore.ship(&ada, "Nao").await;
    nao.put(1, &passage(DAY, 6)).await.good();
    assert_eq!(shore.work().await.len(), 0, "it waits for more batches");

    let open = alert(1, 1, ShipAlertState::Open);
    put(&nao, 3, passage("2026-11-20T04:00:00Z", 3), vec![open]).await;
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
    assert!(!shore.work().await.is_empty(), "nothing is waited for");
    shore.finish().await;
}

async fn revisions_in_any_order_and_again_end_alike(shore: Shore) {
    use ShipAlertState::{Agree, Open};
    let ada = shore.admin("ada").await;
    let nao = shore.ship(&ada, "Nao").await;
    let say = |seq: u64, revision: u32| {
        let state = if revision < 3 { Open } else { Agree };
        put(&nao, seq, Vec::new(), vec![alert(1, revision, state)])
    };
    // The agent sends the newest first.
    say(3, 2).await;
    say(2, 1).await;
    let raised = list(&ada).await;
    assert_eq!((raised.len(), &raised[0]["state"]), (1, &json!("raised")));
    say(4, 3).await;
    say(2, 1).await;
    say(3, 2).await;
    let over = list(&ada).await;
    assert_eq!((over.len(), &over[0]["state"]), (1, &json!("cleared")));
    assert_eq!(over[0]["cleared_by"], Value::Null);
    shore.finish().await;
}

async fn an_analysis_does_not_clear_what_the_ship_says(shore: Shore) {
    let ada = shore.admin("ada").await;
    let nao = shore.ship(&ada, "Nao").await;
    let open = alert(1, 1, ShipAlertState::Open);
    put(&nao, 1, passage(DAY, 300), vec![open]).await;
    shore.work().await;
    alerts::for_silence(&shore.app).await.unwrap();
    let open: Vec<Value> = list(&ada)
        .await
        .into_iter()
        .filter(|alert| alert["cause"] == "reported_aboard")
        .collect();
    assert_eq!(open.len(), 1);
    assert_eq!(open[0]["state"], "raised");
    shore.finish().await;
}

async fn an_alert_of_a_spool_that_was_lost_does_not_stay_open(shore: Shore) {
    use ShipAlertState::{NotJudged, Open};
    let ada = shore.admin("ada").await;
    let nao = shore.ship(&ada, "Nao").await;
    put(&nao, 1, Vec::new(), vec![alert(1, 1, Open)]).await;
    // The agent that was put in its place knows nothing of it, and has one of its own.
    put(&nao, 2, Vec::new(), vec![alert(2, 1, Open)]).await;
    assert_eq!(list(&ada).await.len(), 1, "updated, not repeated");
    put(&nao, 3, Vec::new(), vec![alert(2, 2, NotJudged)]).await;
    assert_eq!(list(&ada).await[0]["state"], "cleared");
    shore.finish().await;
}

async fn what_was_thinned_on_board_is_counted(shore: Shore) {
    let ada = shore.admin("ada").await;
    let nao = shore.ship(&ada, "Nao").await;
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
    shore.finish().await;
}
