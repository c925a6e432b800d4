//! Effects of the logbook on the analysis.

use super::{A_WHILE_S, DAY};
use binnacle_server::worker::Worked;
use binnacle_server_testing::on_both;
use binnacle_server_testing::patch;
use binnacle_server_testing::{Person, Ship, TestServer, passage};
use serde_json::{Value, json};

on_both!(
    samples_with_magnetic_cargo_are_excluded_until_the_entry_is_withdrawn,
    an_adjustment_opens_an_epoch_of_its_compass_alone,
    a_planned_adjustment_withdraws_the_card_at_its_time,
    a_changed_note_makes_no_new_model,
    without_a_model_the_response_counts_samples_excluded_by_the_logbook,
    overlapping_and_outlying_entries_keep_the_timeline_consistent,
    a_thousand_entries_cause_one_analysis,
);

async fn count_excluded(person: &Person, ship: &Ship, reason: &str) -> usize {
    let samples = person.get(&ship.path("/samples")).await.good();
    let samples = samples["items"].as_array().unwrap();
    samples.iter().filter(|s| s["reason"] == reason).count()
}

/// Returns a compass's epochs, after checking that each begins where the previous one ends
/// and has either a curve or a refusal.
async fn checked_epochs(person: &Person, ship: &Ship) -> Vec<Value> {
    let timeline = person.get(&ship.path("/changes")).await.good();
    let epochs = timeline["epochs"].as_array().unwrap().clone();
    assert_eq!(epochs[0]["from"], Value::Null);
    assert_eq!(epochs[epochs.len() - 1]["to"], Value::Null);
    for pair in epochs.windows(2) {
        assert_eq!(pair[0]["to"], pair[1]["from"]);
        assert!(
            pair[1]["from"].as_str() < pair[1]["to"].as_str().or(Some("9")),
            "{pair:?}"
        );
    }
    for epoch in &epochs {
        assert_ne!(
            epoch["curve"].is_null(),
            epoch["refusal"].is_null(),
            "{epoch}"
        );
    }
    epochs
}

async fn samples_with_magnetic_cargo_are_excluded_until_the_entry_is_withdrawn(server: TestServer) {
    let ada = server.admin("ada").await;
    let nao = server.ship(&ada, "Nao").await;
    nao.put(1, &passage(DAY, 90)).await.good();
    server.advance(A_WHILE_S);
    server.work().await;
    let scrap = json!({
        "kind": "magnetic_cargo", "from": "2026-11-15T05:00:00Z", "cargo": "scrap", "hatch": "2",
    });
    let entry = nao.report(&ada, &scrap).await;
    assert!(matches!(server.work().await[..], [Worked::Analysed(_, 1)]));
    assert_eq!(count_excluded(&ada, &nao, "magnetic_cargo").await, 60);
    assert_eq!(ada.get(&nao.path("/model")).await.good()["version"], 2);

    let path = nao.path(&format!("/logbook/{}", entry["id"].as_str().unwrap()));
    let closed = patch(&ada, &path, &json!({ "to": "2026-11-15T07:00:00Z" })).await;
    assert_eq!(
        closed.good()["hatch"],
        "2",
        "what was not named is as it was"
    );
    server.work().await;
    assert_eq!(count_excluded(&ada, &nao, "magnetic_cargo").await, 13);

    let berth = json!({ "kind": "berth", "from": DAY, "to": "2026-11-15T00:50:00Z" });
    nao.report(&ada, &berth).await;
    ada.post(&format!("{path}/withdraw"), &json!({}))
        .await
        .good();
    assert_eq!(server.work().await.len(), 1, "one job for both");
    assert_eq!(count_excluded(&ada, &nao, "magnetic_cargo").await, 0);
    assert_eq!(count_excluded(&ada, &nao, "berth").await, 6);
    server.finish().await;
}

async fn an_adjustment_opens_an_epoch_of_its_compass_alone(server: TestServer) {
    let ada = server.admin("ada").await;
    let nao = server.ship(&ada, "Nao").await;
    let aft = json!({ "name": "Aft", "role": "steering" });
    let aft = ada.post(&nao.path("/compasses"), &aft).await.good();
    nao.put(1, &passage(DAY, 200)).await.good();
    server.advance(A_WHILE_S);
    server.work().await;
    let mut adjusted = json!({ "kind": "adjustment", "from": "2026-11-15T12:00:00Z" });
    adjusted["compass_id"] = aft["id"].clone();
    nao.report(&ada, &adjusted).await;
    assert!(matches!(server.work().await[..], [Worked::Analysed(_, 0)]));
    adjusted["compass_id"] = json!(null);
    nao.report(&ada, &adjusted).await;
    server.work().await;
    let model = ada.get(&nao.path("/model")).await.good();
    assert_eq!(model["version"], 2);
    assert_eq!(model["epoch_from"], "2026-11-15T12:00:00Z");
    assert_eq!(model["data_from"], "2026-11-15T12:00:00Z");
    server.finish().await;
}

async fn a_planned_adjustment_withdraws_the_card_at_its_time(server: TestServer) {
    let ada = server.admin("ada").await;
    let nao = server.ship(&ada, "Nao").await;
    nao.put(1, &passage(DAY, 200)).await.good();
    server.advance(A_WHILE_S);
    server.work().await;
    let at = server.app.clock.now().plus_seconds(7200.0);
    let planned = json!({ "kind": "adjustment", "from": at.to_string() });
    nao.report(&ada, &planned).await;
    server.work().await;
    let model = ada.get(&nao.path("/model")).await.good();
    assert_eq!(model["version"], 1, "the card holds until then");
    assert!(server.work().await.is_empty(), "nothing is due before");
    server.advance(7201.0);
    assert!(matches!(server.work().await[..], [Worked::Analysed(_, 1)]));
    let withdrawn = ada.get(&nao.path("/model")).await;
    assert_eq!(withdrawn.status, 404);
    server.finish().await;
}

async fn a_changed_note_makes_no_new_model(server: TestServer) {
    let ada = server.admin("ada").await;
    let nao = server.ship(&ada, "Nao").await;
    nao.put(1, &passage(DAY, 90)).await.good();
    let entry = nao
        .report(&ada, &json!({ "kind": "lightning", "from": DAY }))
        .await;
    server.advance(A_WHILE_S);
    server.work().await;
    let path = nao.path(&format!("/logbook/{}", entry["id"].as_str().unwrap()));
    let words = json!({ "note": "on the foremast", "port": "off Ushant" });
    patch(&ada, &path, &words).await.good();
    nao.report(&ada, &json!({ "kind": "note", "from": DAY }))
        .await;
    assert!(matches!(server.work().await[..], [Worked::Analysed(_, 0)]));
    assert_eq!(ada.get(&nao.path("/model")).await.good()["version"], 1);
    server.finish().await;
}

async fn without_a_model_the_response_counts_samples_excluded_by_the_logbook(server: TestServer) {
    let ada = server.admin("ada").await;
    let nao = server.ship(&ada, "Nao").await;
    // Loaded, without an entry about the discharge.
    let cargo = json!({ "kind": "magnetic_cargo", "from": "2026-11-14T00:00:00Z" });
    nao.report(&ada, &cargo).await;
    nao.put(1, &passage(DAY, 60)).await.good();
    server.advance(A_WHILE_S);
    server.work().await;
    let response = ada.get(&nao.path("/model")).await;
    assert_eq!(response.problem(), "no-model-yet");
    let problem = response.json();
    assert_eq!(problem["refusal"]["found"], 0, "{problem}");
    assert_eq!(
        problem["left_out"],
        json!({ "magnetic_cargo": 60, "berth": 0 })
    );
    let detail = problem["detail"].as_str().unwrap();
    assert!(
        detail.ends_with("samples are left out: 60 for magnetic cargo"),
        "{detail}"
    );
    server.finish().await;
}

async fn overlapping_and_outlying_entries_keep_the_timeline_consistent(server: TestServer) {
    let ada = server.admin("ada").await;
    let nao = server.ship(&ada, "Nao").await;
    for entry in [
        // Long before the first sample, and twice the same;
        json!({ "kind": "adjustment", "from": "1987-03-01T00:00:00Z" }),
        json!({ "kind": "adjustment", "from": "1987-03-01T00:00:00Z" }),
        json!({ "kind": "lightning", "from": "1999-12-31T00:00:00Z" }),
        // two cargoes and a berth that overlap;
        json!({ "kind": "magnetic_cargo", "from": "2026-11-15T02:00:00Z", "to": "2026-11-15T05:55:00Z" }),
        json!({ "kind": "magnetic_cargo", "from": "2026-11-15T04:00:00Z", "to": "2026-11-15T07:55:00Z" }),
        json!({ "kind": "berth", "from": "2026-11-15T03:00:00Z", "to": "2026-11-15T04:55:00Z" }),
        // a stay without an end from before all samples, and work still to come today.
        json!({ "kind": "berth", "from": "2000-01-01T00:00:00Z" }),
        json!({ "kind": "dry_docking", "from": "2026-11-21T12:00:00Z", "to": "2027-02-01T00:00:00Z" }),
    ] {
        nao.report(&ada, &entry).await;
    }
    nao.put(1, &passage(DAY, 300)).await.good();
    server.advance(A_WHILE_S);
    assert!(matches!(server.work().await[..], [Worked::Analysed(_, 1)]));
    let epochs = checked_epochs(&ada, &nao).await;
    assert_eq!(epoch_causes(&epochs), [&Value::Null, &json!("adjustment")]);
    assert_eq!(epochs[0]["refusal"]["reason"], "too_few_samples");
    assert!(
        epochs[1]["samples_used"].as_u64().unwrap() > 200,
        "{}",
        epochs[1]
    );
    // Six hours with a sample every ten minutes, each excluded once.
    let out = count_excluded(&ada, &nao, "magnetic_cargo").await
        + count_excluded(&ada, &nao, "berth").await;
    assert_eq!(out, 36);

    // The work begins at noon.
    server.advance(5.0 * 3600.0);
    assert!(matches!(server.work().await[..], [Worked::Analysed(_, 1)]));
    let epochs = checked_epochs(&ada, &nao).await;
    assert_eq!(
        epoch_causes(&epochs),
        [&Value::Null, &json!("adjustment"), &json!("dry_docking")]
    );
    server.finish().await;
}

fn epoch_causes(epochs: &[Value]) -> Vec<&Value> {
    epochs.iter().map(|epoch| &epoch["begun_by"]).collect()
}

async fn a_thousand_entries_cause_one_analysis(server: TestServer) {
    let ada = server.admin("ada").await;
    let nao = server.ship(&ada, "Nao").await;
    nao.put(1, &passage(DAY, 300)).await.good();
    for minute in 0..1000 {
        let from = format!("2026-11-15T{:02}:{:02}:00Z", minute / 60, minute % 60);
        let kind = ["corrector_change", "magnetic_cargo", "lightning", "repair"][minute % 4];
        nao.report(&ada, &json!({ "kind": kind, "from": from, "to": from }))
            .await;
    }
    server.advance(A_WHILE_S);
    assert!(matches!(server.work().await[..], [Worked::Analysed(_, 1)]));
    assert_eq!(checked_epochs(&ada, &nao).await.len(), 501);
    assert_eq!(ada.get(&nao.path("/model")).await.good()["version"], 1);
    server.finish().await;
}
