//! Changes of a ship's magnetism: from samples to the timeline, the alert and the
//! model on board.

use binnacle_compass::angle::CompassHeading;
use binnacle_compass::model::Model;
use binnacle_compass::position::Position;
use binnacle_compass::sample::Sample;
use binnacle_compass::ship::EarthField;
use binnacle_server_testing::{
    Person, Relay, Ship, TestServer, days_at_sea, days_in_waters, mail, model_after_step, on_both,
    position, true_model,
};
use serde_json::{Value, json};
use std::f64::consts::PI;

on_both!(
    the_timeline_after_a_strike_has_both_epochs_with_curves,
    before_the_first_analysis_the_timeline_is_empty,
    a_strike_raises_one_alert_that_is_updated,
    a_second_strike_raises_an_alert_after_the_first_was_acknowledged,
    a_strike_dated_before_the_last_clearing_raises_an_alert,
    after_a_strike_the_agent_gets_an_interim_model_with_a_wider_band,
    after_discharge_the_agent_gets_the_base_model_again,
    logged_work_opens_an_epoch_without_an_alert,
    a_storm_is_named_when_two_ships_were_disturbed,
    an_alert_is_updated_by_other_ships_without_a_new_fit,
    a_swinging_compass_raises_one_alert_whatever_the_amplitude,
);

const A_WHILE_S: f64 = 10.0;
/// Start of twenty days at sea.
const DEPARTURE: &str = "2026-10-20T00:00:00Z";
/// Time of the strike, at their end.
const STRIKE: &str = "2026-11-09T00:00:00Z";

async fn the_timeline_after_a_strike_has_both_epochs_with_curves(server: TestServer) {
    let ada = server.admin("ada").await;
    let nao = modelled_ship(&server, &ada).await;
    let calm = ada.get(&nao.path("/changes")).await.good();
    assert_eq!(calm["changes"], json!([]));
    assert_eq!(calm["epochs"].as_array().unwrap().len(), 1);
    assert_eq!(calm["epochs"][0]["model_version"], 1);

    let samples_after = days_at_sea(&model_after_step(3000.0, 2000.0), STRIKE, 2.0);
    send_and_analyse(&server, &nao, 2, &samples_after).await;
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
    // The curves differ by the stated change, apart from the compass heading they refer to.
    let deviation = |epoch: &Value, row: usize| epoch["curve"][row]["deviation_deg"].as_f64();
    let parted = (0..36)
        .map(|row| deviation(&epochs[1], row).unwrap() - deviation(&epochs[0], row).unwrap());
    let most = parted.map(f64::abs).fold(0.0, f64::max);
    let change_deg = change["deviation_change_deg"].as_f64().unwrap();
    assert!(
        (most - change_deg).abs() < 0.15 * change_deg,
        "{most} and {change_deg}"
    );
    assert!(epochs[1]["curve"][0]["band95_deg"].as_f64().unwrap() > 0.0);
    assert_eq!(timeline["place"]["lat"], 48.0);
    server.finish().await;
}

async fn before_the_first_analysis_the_timeline_is_empty(server: TestServer) {
    let ada = server.admin("ada").await;
    let nao = server.ship(&ada, "Nao").await;
    let timeline = ada.get(&nao.path("/changes")).await.good();
    assert_eq!(timeline["analysed_at"], Value::Null);
    assert_eq!(timeline["epochs"], json!([]));
    assert_eq!(timeline["changes"], json!([]));
    let eve = server.admin("eve").await;
    assert_eq!(eve.get(&nao.path("/changes")).await.problem(), "not-found");
    server.finish().await;
}

/// Enrols a ship with a model of three weeks at sea.
async fn modelled_ship(server: &TestServer, person: &Person) -> Ship {
    let ship = server.ship(person, "Nao").await;
    send_and_analyse(
        server,
        &ship,
        1,
        &days_at_sea(&true_model(), DEPARTURE, 20.0),
    )
    .await;
    ship
}

async fn send_and_analyse(server: &TestServer, ship: &Ship, seq: u64, samples: &[Sample]) {
    ship.put(seq, samples).await.good();
    server.advance(A_WHILE_S);
    server.work().await;
}

async fn open_alerts(person: &Person) -> Vec<Value> {
    let listed = person.get("/alerts?open=true").await.good();
    listed["items"].as_array().unwrap().clone()
}

/// Returns the downlink of an agent that has the model of an earlier response, or none.
async fn downlink_with(ship: &Ship, has: &Value) -> Value {
    let query = has["id"].as_str().map(|id| format!("?model={id}"));
    ship.downlink(&query.unwrap_or_default()).await
}

/// Returns the largest half-width of the band over all headings, at the default position.
fn widest_band_deg(model: &Value) -> f64 {
    let model: Model = serde_json::from_value(model["model"].clone()).unwrap();
    let earth = EarthField {
        h_nt: 20_500.0,
        z_nt: 43_500.0,
    };
    (0..36)
        .map(|k| {
            let compass = CompassHeading::new(10.0 * f64::from(k)).unwrap();
            model.deviation(compass, earth).unwrap().band95_deg.unwrap()
        })
        .fold(0.0, f64::max)
}

async fn a_strike_raises_one_alert_that_is_updated(server: TestServer) {
    let ada = server.admin("ada").await;
    let nao = modelled_ship(&server, &ada).await;
    assert_eq!(open_alerts(&ada).await, Vec::<Value>::new());
    let samples_after = days_at_sea(&model_after_step(3000.0, 2000.0), STRIKE, 4.0);
    send_and_analyse(&server, &nao, 2, &samples_after[..36]).await;
    let lightning_alerts = |alerts: Vec<Value>| -> Vec<Value> {
        let mut alerts = alerts;
        alerts.retain(|alert| alert["cause"] == "lightning_or_shock");
        alerts
    };
    let raised = lightning_alerts(open_alerts(&ada).await);
    assert_eq!(raised.len(), 1, "{raised:?}");
    assert_eq!(raised[0]["severity"], "critical", "{raised:?}");
    let field_of = |alert: &Value, field: &str| alert[field].as_str().unwrap().to_owned();
    assert!(
        field_of(&raised[0], "advice").contains("azimuth"),
        "{raised:?}"
    );
    assert!(field_of(&raised[0], "summary").contains("lightning or a shock"));
    assert!(field_of(&raised[0], "since").as_str() > "2026-11-08T20");
    for day in 0..3 {
        let samples = &samples_after[36 + 144 * day..36 + 144 * (day + 1)];
        send_and_analyse(&server, &nao, 3 + day as u64, samples).await;
    }
    let later = lightning_alerts(open_alerts(&ada).await);
    assert_eq!(later.len(), 1, "{later:?}");
    assert_eq!(later[0]["id"], raised[0]["id"], "updated, not repeated");
    assert_eq!(later[0]["severity"], "warning", "{later:?}");
    assert!(field_of(&later[0], "advice").contains("Print and post a new card"));
    // A compass changed by lightning needs an adjustment.
    let needs = ada.get(&nao.path("/needs")).await.good();
    let mut causes = needs["items"][0]["causes"].as_array().unwrap().iter();
    let change = causes.find(|cause| cause["kind"] == "change");
    let change = change.unwrap_or_else(|| panic!("{needs}"));
    let reason = field_of(change, "reason");
    assert!(
        reason.contains("magnetism changed on 2026-11-08"),
        "{reason}"
    );
    assert_eq!(change["due_on"], "2026-12-08");
    server.finish().await;
}

async fn lightning_alerts(person: &Person, query: &str) -> Vec<Value> {
    let listed = person.get(&format!("/alerts{query}")).await.good();
    let mut alerts = listed["items"].as_array().unwrap().clone();
    alerts.retain(|alert| alert["cause"] == "lightning_or_shock");
    alerts
}

/// Time of the second strike, and the magnetism after it.
const SECOND_STRIKE: &str = "2026-11-14T00:00:00Z";

fn second_strike(days: f64) -> Vec<Sample> {
    days_at_sea(&model_after_step(1200.0, 3200.0), SECOND_STRIKE, days)
}

async fn a_second_strike_raises_an_alert_after_the_first_was_acknowledged(server: TestServer) {
    let ada = server.admin("ada").await;
    let relay = Relay::start().await;
    mail::add(&ada, "bridge@example.com", "notice").await;
    let kinds = json!(["alert.raised", "alert.updated", "alert.cleared"]);
    let hook = json!({ "url": "https://example.com/hook", "kinds": kinds });
    let hook = ada.post("/webhooks", &hook).await.good();
    let nao = modelled_ship(&server, &ada).await;
    let first = days_at_sea(&model_after_step(3000.0, 2000.0), STRIKE, 5.0);
    send_and_analyse(&server, &nao, 2, &first[..36]).await;
    let alert = lightning_alerts(&ada, "?open=true").await.remove(0);
    let path = format!("/alerts/{}", alert["id"].as_str().unwrap());
    let note = json!({ "note": "Master informed" });
    ada.post(&format!("{path}/acknowledge"), &note).await.good();
    send_and_analyse(&server, &nao, 3, &first[36..]).await;
    // The same strike, perhaps with a better date, is still acknowledged.
    let known = ada.get(&path).await.good();
    assert_eq!(known["state"], "acknowledged", "{known}");
    mail::deliver(&server, &relay).await;
    let sent_before = mail::subjects(&relay).len();

    send_and_analyse(&server, &nao, 4, &second_strike(2.0)).await;
    let open = lightning_alerts(&ada, "?open=true").await;
    assert_eq!(open.len(), 1, "{open:?}");
    assert_eq!(
        (&open[0]["state"], &open[0]["acknowledged_by"]),
        (&json!("raised"), &Value::Null)
    );
    assert!(
        open[0]["since"].as_str().unwrap() > "2026-11-13T20",
        "{open:?}"
    );
    // The acknowledgement stays with the first alert.
    let first = ada.get(&path).await.good();
    assert_eq!(
        (&first["state"], &first["acknowledgement_note"]),
        (&json!("cleared"), &json!("Master informed"))
    );
    assert_eq!(
        first["clearing_reason"],
        "another event of the same cause followed"
    );
    mail::deliver(&server, &relay).await;
    let subjects = mail::subjects(&relay).split_off(sent_before);
    let lightning: Vec<&String> = subjects
        .iter()
        .filter(|s| s.contains("lightning"))
        .collect();
    assert_eq!(lightning.len(), 1, "{subjects:?}");
    assert!(!lightning[0].contains("over"), "{subjects:?}");
    let sent = format!("/webhooks/{}/deliveries", hook["id"].as_str().unwrap());
    let sent = ada.get(&sent).await.good();
    let sent: Vec<&Value> = sent["items"].as_array().unwrap().iter().collect();
    let raised = sent.iter().filter(|sent| sent["kind"] == "alert.raised");
    assert!(raised.count() >= 2, "{sent:?}");
    server.finish().await;
}

async fn a_strike_dated_before_the_last_clearing_raises_an_alert(server: TestServer) {
    let ada = server.admin("ada").await;
    let nao = modelled_ship(&server, &ada).await;
    let first = days_at_sea(&model_after_step(3000.0, 2000.0), STRIKE, 5.0);
    send_and_analyse(&server, &nao, 2, &first[..36]).await;
    let alert = lightning_alerts(&ada, "?open=true").await.remove(0);
    let clear = format!("/alerts/{}/clear", alert["id"].as_str().unwrap());
    let reason = json!({ "reason": "Azimuths taken" });
    ada.post(&clear, &reason).await.good();
    send_and_analyse(&server, &nao, 3, &first[36..]).await;
    let open = lightning_alerts(&ada, "?open=true").await;
    assert_eq!(open, Vec::<Value>::new(), "the same strike stays cleared");

    // From a week before the person cleared the alert.
    send_and_analyse(&server, &nao, 4, &second_strike(2.0)).await;
    let open = lightning_alerts(&ada, "?open=true").await;
    assert_eq!(open.len(), 1, "{open:?}");
    assert!(
        open[0]["since"].as_str().unwrap() > "2026-11-13T20",
        "{open:?}"
    );
    let cleared = lightning_alerts(&ada, "?state=cleared").await;
    assert_eq!(cleared[0]["clearing_reason"], "Azimuths taken");
    server.finish().await;
}

async fn after_a_strike_the_agent_gets_an_interim_model_with_a_wider_band(server: TestServer) {
    let ada = server.admin("ada").await;
    let nao = modelled_ship(&server, &ada).await;
    let base = downlink_with(&nao, &Value::Null).await["model"].take();
    assert_eq!(base.get("replaces"), None);
    let samples_after = days_at_sea(&model_after_step(3000.0, 2000.0), STRIKE, 4.0);
    send_and_analyse(&server, &nao, 2, &samples_after[..36]).await;
    let interim = downlink_with(&nao, &base).await["model"].take();
    assert_eq!(
        interim["replaces"]["reason"], "lightning_or_shock",
        "{interim}"
    );
    assert!(interim["replaces"]["since"].as_str().unwrap() > "2026-11-08T20");
    let (before, after) = (widest_band_deg(&base), widest_band_deg(&interim));
    assert!(after > 1.05 * before, "{before} and then {after}");
    // The band contains the ship's present deviation.
    send_and_analyse(&server, &nao, 3, &samples_after[36..]).await;
    let later = downlink_with(&nao, &interim).await["model"].take();
    assert!(widest_band_deg(&later) < after);
    server.finish().await;
}

async fn after_discharge_the_agent_gets_the_base_model_again(server: TestServer) {
    let ada = server.admin("ada").await;
    let nao = modelled_ship(&server, &ada).await;
    let base = downlink_with(&nao, &Value::Null).await["model"].take();
    // Loaded for eight hours, at sea for five days, discharged.
    let loaded = days_at_sea(
        &model_after_step(2500.0, -2500.0),
        "2026-11-09T08:00:00Z",
        5.0,
    );
    send_and_analyse(&server, &nao, 2, &loaded).await;
    let with_cargo = downlink_with(&nao, &base).await["model"].take();
    assert_eq!(
        with_cargo["replaces"]["reason"], "magnetic_cargo",
        "{with_cargo}"
    );
    let raised = open_alerts(&ada).await;
    let cargo = raised
        .iter()
        .find(|alert| alert["cause"] == "magnetic_cargo");
    assert!(cargo.is_some(), "{raised:?}");

    let discharged = days_at_sea(&true_model(), "2026-11-14T16:00:00Z", 1.0);
    send_and_analyse(&server, &nao, 3, &discharged).await;
    let timeline = ada.get(&nao.path("/changes")).await.good();
    assert_eq!(
        timeline["epochs"][2]["resumes"], 0,
        "{}",
        timeline["changes"]
    );
    assert_eq!(timeline["changes"][0]["epoch_ended"], 2);
    let back = downlink_with(&nao, &with_cargo).await["model"].take();
    assert_eq!(back["replaces"]["reason"], "ship_as_before");
    assert!(widest_band_deg(&back) < 1.2 * widest_band_deg(&base));
    let open = open_alerts(&ada).await;
    assert!(
        open.iter().all(|alert| alert["cause"] != "magnetic_cargo"),
        "{open:?}"
    );
    server.finish().await;
}

async fn logged_work_opens_an_epoch_without_an_alert(server: TestServer) {
    let ada = server.admin("ada").await;
    let nao = modelled_ship(&server, &ada).await;
    let base = downlink_with(&nao, &Value::Null).await["model"].take();
    let repair = json!({ "kind": "repair", "from": "2026-11-09T00:00:00Z" });
    ada.post(&nao.path("/logbook"), &repair).await.good();
    server.work().await;
    // No sample since: the card is withdrawn, and the ship learns it at once.
    let withdrawn = downlink_with(&nao, &base).await["card_withdrawn"].take();
    assert_eq!(withdrawn["reason"], "repair");
    let after = days_at_sea(
        &model_after_step(3000.0, 2000.0),
        "2026-11-09T12:00:00Z",
        4.0,
    );
    send_and_analyse(&server, &nao, 2, &after).await;
    let timeline = ada.get(&nao.path("/changes")).await.good();
    assert_eq!(timeline["epochs"].as_array().unwrap().len(), 2);
    assert_eq!(timeline["epochs"][1]["begun_by"], "repair");
    assert_eq!(timeline["changes"][0]["cause"], "adjustment_or_repair");
    assert_eq!(timeline["changes"][0]["epoch_after"], 1);
    let open = open_alerts(&ada).await;
    let causes: Vec<&str> = open.iter().map(|a| a["cause"].as_str().unwrap()).collect();
    assert!(
        causes.iter().all(|cause| *cause == "deviation_over_limit"),
        "{causes:?}"
    );
    server.finish().await;
}

/// Returns thirty days at sea with the compass deflected for some hours before the end.
fn deflected(position: Position, from_h: usize, to_h: usize, deg: Swing) -> Vec<Sample> {
    let mut samples = days_in_waters(position, &true_model(), "2026-10-21T00:00:00Z", 30.0);
    let place = |hours| samples.len() - 6 * hours;
    let (from, to) = (place(from_h), place(to_h));
    for (i, sample) in samples[from..to].iter_mut().enumerate() {
        let deflected_deg = sample.compass.degrees() + deg(i as f64);
        sample.compass = CompassHeading::new(deflected_deg).unwrap();
    }
    samples
}

/// A deflection of two hours and more, the same on two headings, that comes and goes.
fn short_deflection(lat: f64, lon: f64, hours_ago: usize) -> Vec<Sample> {
    let bump = |i: f64| (4.0 + (2.1 * i).cos()) * (PI * (i + 0.5) / 14.0).sin().max(0.0);
    deflected(position(lat, lon), hours_ago + 3, hours_ago, bump)
}

/// An oscillating deflection in the last six hours.
fn oscillating_deflection(lat: f64, lon: f64) -> Vec<Sample> {
    deflected(position(lat, lon), 6, 0, |i| 3.0 * (0.7 * i).sin())
}

async fn last_change(person: &Person, ship: &Ship) -> Value {
    let timeline = person.get(&ship.path("/changes")).await.good();
    timeline["changes"]
        .as_array()
        .unwrap()
        .last()
        .unwrap()
        .clone()
}

async fn a_storm_is_named_when_two_ships_were_disturbed(server: TestServer) {
    let (ada, eve) = (server.admin("ada").await, server.admin("eve").await);
    let nao = server.ship(&ada, "Nao").await;
    send_and_analyse(&server, &nao, 1, &short_deflection(48.0, -6.0, 14)).await;
    let alone = last_change(&ada, &nao).await;
    assert_eq!(alone["cause"], "local_anomaly", "{alone}");

    // A ship disturbed in other hours is not part of it.
    let victoria = server.ship(&eve, "Victoria").await;
    send_and_analyse(&server, &victoria, 1, &short_deflection(30.0, -40.0, 62)).await;
    assert_eq!(last_change(&eve, &victoria).await["cause"], "local_anomaly");
    assert_eq!(last_change(&ada, &nao).await, alone);

    let gaviota = server.ship(&eve, "Gaviota").await;
    send_and_analyse(&server, &gaviota, 1, &short_deflection(58.0, -20.0, 14)).await;
    let stormy = last_change(&ada, &nao).await;
    assert_eq!(stormy["cause"], "magnetic_storm", "{stormy}");
    let text = stormy.to_string();
    assert!(
        text.contains("1 other ship was disturbed in the same hours"),
        "{text}"
    );
    assert!(!text.contains("Gaviota"));
    assert_eq!(last_change(&eve, &gaviota).await["cause"], "magnetic_storm");
    server.finish().await;
}

async fn an_alert_is_updated_by_other_ships_without_a_new_fit(server: TestServer) {
    let (ada, eve) = (server.admin("ada").await, server.admin("eve").await);
    let nao = server.ship(&ada, "Nao").await;
    send_and_analyse(&server, &nao, 1, &oscillating_deflection(48.0, -6.0)).await;
    let before = open_alerts(&ada).await;
    assert_eq!(before.len(), 1, "{before:?}");
    assert_eq!(before[0]["severity"], "warning");
    assert!(!before[0]["evidence"].to_string().contains("other ship"));

    let gaviota = server.ship(&eve, "Gaviota").await;
    send_and_analyse(&server, &gaviota, 1, &oscillating_deflection(58.0, -20.0)).await;
    server.advance(100.0);
    server.work().await;
    let after = open_alerts(&ada).await;
    assert_eq!(after.len(), 1, "{after:?}");
    assert_eq!(after[0]["cause"], "magnetic_storm");
    assert!(
        after[0]["evidence"].to_string().contains("1 other ship"),
        "{after:?}"
    );
    let versions = ada.get(&nao.path("/models")).await.good();
    assert_eq!(versions["items"].as_array().unwrap().len(), 1);
    server.advance(1000.0);
    assert_eq!(
        server.work().await,
        [],
        "they do not wake each other for ever"
    );
    server.finish().await;
}

/// Deflection in degrees by the number of the sample.
type Swing = fn(f64) -> f64;

async fn a_swinging_compass_raises_one_alert_whatever_the_amplitude(server: TestServer) {
    let ada = server.admin("ada").await;
    let swings: [(&str, Swing); 4] = [
        ("Pinta", |i| 3.0 * (0.7 * i).sin()),
        ("Nina", |i| 10.0 * (0.7 * i).sin()),
        ("Trinidad", |i| 20.0 * (0.7 * i).sin()),
        ("Victoria", |i| 40.0 * (0.7 * i).sin()),
    ];
    let mut causes = Vec::new();
    for (name, swing) in swings {
        let ship = server.ship(&ada, name).await;
        let samples = deflected(position(48.0, -6.0), 6, 0, swing);
        send_and_analyse(&server, &ship, 1, &samples).await;
        let open = open_alerts(&ada).await;
        let of_her: Vec<&Value> = open.iter().filter(|a| a["vessel_name"] == name).collect();
        assert_eq!(of_her.len(), 1, "{name}: {open:?}");
        causes.push(of_her[0]["cause"].as_str().unwrap().to_owned());
    }
    assert!(causes[0] != "compass_fault", "{causes:?}");
    assert_eq!(causes[2..], ["compass_fault"; 2], "{causes:?}");
    server.finish().await;
}
