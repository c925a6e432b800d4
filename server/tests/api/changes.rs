//! What changed a ship's magnetism: from her samples to the timeline, the alert and
//! the bridge.

use crate::on_both;
use crate::support::{Shore, days_at_sea, struck, truth};
use serde_json::{Value, json};

on_both!(
    a_struck_ships_timeline_has_both_epochs_with_their_curves,
    before_the_first_analysis_the_timeline_is_empty,
);

const A_WHILE_S: f64 = 10.0;

async fn a_struck_ships_timeline_has_both_epochs_with_their_curves(shore: Shore) {
    let ada = shore.admin("ada").await;
    let nao = shore.ship(&ada, "Nao").await;
    let before = days_at_sea(&truth(), "2026-10-20T00:00:00Z", 20.0);
    nao.put(1, &before).await.good();
    shore.advance(A_WHILE_S);
    shore.work().await;
    let calm = ada.get(&nao.path("/changes")).await.good();
    assert_eq!(calm["changes"], json!([]));
    assert_eq!(calm["epochs"].as_array().unwrap().len(), 1);
    assert_eq!(calm["epochs"][0]["model_version"], 1);

    let hit = "2026-11-09T00:00:00Z";
    nao.put(2, &days_at_sea(&struck(3000.0, 2000.0), hit, 2.0))
        .await
        .good();
    shore.advance(A_WHILE_S);
    shore.work().await;
    let timeline = ada.get(&nao.path("/changes")).await.good();
    let changes = timeline["changes"].as_array().unwrap();
    assert_eq!(changes.len(), 1, "{changes:?}");
    let change = &changes[0];
    assert_eq!(change["cause"], "lightning_or_shock");
    assert_eq!(change["confirmed"], true);
    assert!(
        change["from"].as_str().unwrap() > "2026-11-08T22",
        "{change}"
    );
    assert!(
        change["from"].as_str().unwrap() < "2026-11-09T01",
        "{change}"
    );
    assert_eq!(
        [
            &change["epoch_before"],
            &change["epoch_after"],
            &change["epoch_ended"]
        ],
        [&json!(0), &json!(1), &Value::Null]
    );
    let epochs = timeline["epochs"].as_array().unwrap();
    assert_eq!(epochs.len(), 2);
    assert_eq!(epochs[0]["to"], epochs[1]["from"]);
    assert_eq!(epochs[1]["from"], change["from"]);
    assert_eq!(
        [&epochs[0]["model_version"], &epochs[1]["model_version"]],
        [&json!(1), &json!(2)]
    );
    assert_eq!(epochs[1]["begun_by_change"], "lightning_or_shock");
    // The curves part by what the change says, but for what a heading is by compass.
    let deviation = |epoch: &Value, row: usize| epoch["curve"][row]["deviation_deg"].as_f64();
    let parted = (0..36)
        .map(|row| deviation(&epochs[1], row).unwrap() - deviation(&epochs[0], row).unwrap());
    let most = parted.map(f64::abs).fold(0.0, f64::max);
    let said = change["deviation_change_deg"].as_f64().unwrap();
    assert!((most - said).abs() < 0.15 * said, "{most} and {said}");
    assert!(epochs[1]["curve"][0]["band95_deg"].as_f64().unwrap() > 0.0);
    assert_eq!(timeline["place"]["lat"], 48.0);
    shore.finish().await;
}

async fn before_the_first_analysis_the_timeline_is_empty(shore: Shore) {
    let ada = shore.admin("ada").await;
    let nao = shore.ship(&ada, "Nao").await;
    let timeline = ada.get(&nao.path("/changes")).await.good();
    assert_eq!(timeline["analysed_at"], Value::Null);
    assert_eq!(timeline["epochs"], json!([]));
    assert_eq!(timeline["changes"], json!([]));
    let eve = shore.admin("eve").await;
    assert_eq!(eve.get(&nao.path("/changes")).await.problem(), "not-found");
    shore.finish().await;
}
