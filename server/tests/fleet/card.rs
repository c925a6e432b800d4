//! Deviation cards, and reasons to refuse one.

use binnacle_compass::time::Timestamp;
use binnacle_fleet::alerts;
use binnacle_server_testing::binnacles::{binnacle, put};
use binnacle_server_testing::on_both;
use binnacle_server_testing::{
    ApiResponse, Person, Ship, TestServer, days_at_sea, days_in_waters, model_after_step, passage,
    position, true_model,
};
use binnacle_wire::alert::{ShipAlert, ShipAlertState};
use binnacle_wire::batch::Batch;
use reqwest::Method;
use serde_json::{Value, json};
use std::collections::BTreeMap;
use uuid::Uuid;

on_both!(
    a_card_shows_prediction_and_uncertainty,
    the_four_forms_of_a_card_agree_and_are_reproducible,
    a_card_is_for_the_requested_place_and_date,
    each_compass_has_its_own_card,
    a_card_shows_the_last_recorded_correctors,
    an_invalid_query_is_refused_by_field,
    a_misleading_card_is_refused,
    a_card_with_ambiguous_headings_is_refused,
    a_card_of_a_suspected_compass_is_refused,
    a_card_after_a_change_invalidates_older_ones,
);

const FROM: &str = "2026-11-15T00:00:00Z";
const A_WHILE_S: f64 = 10.0;
const DAY_S: f64 = 86_400.0;

/// Enrols a ship with a model of five days of samples.
async fn modelled_ship(server: &TestServer, ada: &Person) -> Ship {
    let nao = server.ship(ada, "Nao Victoria").await;
    nao.put(1, &days_at_sea(&true_model(), FROM, 5.0))
        .await
        .good();
    server.advance(A_WHILE_S);
    server.work().await;
    nao
}

async fn amend(ada: &Person, path: &str, body: Value) {
    ApiResponse::send(ada.request(Method::PATCH, path).json(&body))
        .await
        .good();
}

async fn a_card_shows_prediction_and_uncertainty(server: TestServer) {
    let ada = server.admin("ada").await;
    let nao = modelled_ship(&server, &ada).await;
    let vessel = json!({ "imo_number": "9074729", "call_sign": "EAVN", "flag": "Spain" });
    amend(&ada, &nao.path(""), vessel).await;
    let card = ada.get(&nao.path("/card.json")).await.good();
    assert_eq!(card["status"], "predicted");
    let statement = card["statement"].as_str().unwrap();
    assert!(statement.contains("Not a certificate"), "{statement}");
    let words = ["name", "imo_number", "call_sign", "flag"].map(|word| &card["vessel"][word]);
    assert_eq!(words, ["Nao Victoria", "9074729", "EAVN", "Spain"]);
    assert_eq!(card["compass"]["role"], "standard");
    assert_eq!(card["compass"]["make"], json!(null));

    let model = ada.get(&nao.path("/model")).await.good();
    assert_eq!(card["model"]["id"], model["id"]);
    assert_eq!(card["model"]["input_hash"], model["input_hash"]);
    for name in ["A", "B", "C", "D", "E"] {
        let of = |handbook: &Value| handbook[name].as_f64().unwrap();
        let apart = of(&card["coefficients"]["handbook"]) - of(&model["handbook"]);
        assert!(apart.abs() < 1e-4, "{name}: {apart}");
    }
    let table = ada.get(&nao.path("/deviation")).await.good();
    let rows = card["rows"].as_array().unwrap();
    assert_eq!(rows.len(), 24);
    let mut samples = 0;
    for (row, predicted) in rows.iter().zip(table["rows"].as_array().unwrap()) {
        for name in ["compass_deg", "magnetic_deg", "deviation_deg", "band95_deg"] {
            assert_eq!(row[name], predicted[name], "{row}");
        }
        samples += row["samples"].as_u64().unwrap();
        let residual = row["residual_deg"].as_f64();
        assert!(residual.is_none_or(|degrees| degrees.abs() < 0.5), "{row}");
    }
    assert_eq!(json!(samples), model["model"]["samples_used"]);
    // The exact B and D of this ship, from its known parameters.
    let exact = &card["coefficients"]["exact"];
    assert!(
        (exact["D"].as_f64().unwrap() - 0.02_f64.to_degrees()).abs() < 0.2,
        "{exact}"
    );
    for word in ["correctors", "degaussing_coils", "adjuster", "next_due"] {
        let not_recorded = card["not_recorded"].as_array().unwrap();
        assert!(not_recorded.contains(&json!(word)), "{not_recorded:?}");
    }
    assert_eq!(
        (&card["cargo"], &card["degaussed_at"]),
        (&json!([]), &json!(null))
    );

    amend(&ada, &nao.path(""), json!({ "degaussing": " coils off " })).await;
    let recorded = ada.get(&nao.path("/card.json")).await.good();
    assert_eq!(recorded["degaussing"], "coils off");
    assert!(!recorded["not_recorded"].to_string().contains("degaussing"));
    amend(&ada, &nao.path(""), json!({ "degaussing": null })).await;

    let steel =
        json!({ "kind": "magnetic_cargo", "from": "2026-11-19T00:00:00Z", "cargo": "steel" });
    ada.post(&nao.path("/logbook"), &steel).await.good();
    let laden = ada
        .get(&nao.path("/card.json?at=2026-11-19T12:00:00Z"))
        .await
        .good();
    let cargo = json!([{ "since": "2026-11-19T00:00:00Z", "cargo": "steel" }]);
    assert_eq!(laden["cargo"], cargo);
    assert!(
        laden["notes"].to_string().contains("magnetic cargo"),
        "{laden}"
    );
    server.finish().await;
}

async fn the_four_forms_of_a_card_agree_and_are_reproducible(server: TestServer) {
    let ada = server.admin("ada").await;
    let nao = modelled_ship(&server, &ada).await;
    amend(
        &ada,
        &nao.path(""),
        json!({ "name": "Nao <b>Victoria</b>" }),
    )
    .await;
    let card = ada.get(&nao.path("/card.json")).await.good();
    let first = &card["rows"][6];
    for (form, kind) in [
        ("pdf", "application/pdf"),
        ("svg", "image/svg+xml"),
        ("csv", "text/csv; charset=utf-8"),
    ] {
        let get = async || {
            let path = nao.path(&format!("/card.{form}"));
            let response = ada.request(Method::GET, &path).send().await.unwrap();
            assert_eq!(response.status(), 200);
            assert_eq!(response.headers()["content-type"], kind);
            let name = response.headers()["content-disposition"].to_str().unwrap();
            let expected = format!(
                "inline; filename=\"deviation-card-nao-b-victoria-b-standard-compass-v1.{form}\"; \
                 filename*=UTF-8''deviation-card%20Nao%20b%20Victoria%20b%20Standard%20compass%20v1.{form}"
            );
            assert_eq!(name, expected);
            response.bytes().await.unwrap()
        };
        let bytes = get().await;
        server.advance(3600.0);
        assert!(bytes == get().await, "{form} is not the same an hour later");
        let text = String::from_utf8_lossy(&bytes);
        match form {
            "pdf" => assert!(text.starts_with("%PDF-1."), "{text}"),
            "svg" => {
                assert!(text.contains("PREDICTED – NOT A CERTIFICATE"), "{text}");
                assert!(text.contains("Nao &lt;b&gt;Victoria"), "{text}");
                let deviation_deg = first["deviation_deg"].as_f64().unwrap();
                let side = if deviation_deg < 0.0 { "W" } else { "E" };
                let cell = format!(">{:.1}° {side}<", deviation_deg.abs());
                assert!(text.contains(&cell), "{cell}");
            }
            _ => {
                let lines: Vec<&str> = text.lines().collect();
                assert_eq!(lines.len(), 25);
                let deviation_deg = first["deviation_deg"].as_f64().unwrap();
                let fields: Vec<&str> = lines[7].split(',').collect();
                assert_eq!(fields[0], "90.00");
                assert_eq!(fields[2], format!("{deviation_deg:.2}"));
                assert!(lines[1..].iter().all(|line| line.contains(",predicted,")));
            }
        }
    }
    server.finish().await;
}

async fn a_card_is_for_the_requested_place_and_date(server: TestServer) {
    let ada = server.admin("ada").await;
    let nao = modelled_ship(&server, &ada).await;
    let here = ada.get(&nao.path("/card.json")).await.good();
    assert_eq!(
        (&here["place"]["lat"], &here["place"]["lon"]),
        (&json!(48.0), &json!(-6.0))
    );
    let near = "/card.json?lat=43.4&lon=-3.1&at=2026-11-21T00:00:00Z";
    let there = ada.get(&nao.path(near)).await.good();
    assert_eq!(there["place"]["at"], "2026-11-21T00:00:00Z");
    assert_eq!(there["place"]["variation_source"], "igrf14");
    assert_ne!(there["rows"], here["rows"]);
    // This ship's deviation is smaller where the field is stronger.
    let worst = |card: &Value| card["worst"]["deviation_deg"].as_f64().unwrap().abs();
    assert!(worst(&there) < worst(&here), "{there}");
    server.finish().await;
}

async fn each_compass_has_its_own_card(server: TestServer) {
    let ada = server.admin("ada").await;
    let nao = modelled_ship(&server, &ada).await;
    let element = json!({ "name": "Element", "role": "transmitting", "serial_number": "7" });
    let other = ada.post(&nao.path("/compasses"), &element).await.good();
    let of = |id: &Value| nao.path(&format!("/card.json?compass={}", id.as_str().unwrap()));
    let card = ada.get(&nao.path("/card.json")).await.good();
    assert_eq!(ada.get(&of(&card["compass"]["id"])).await.good(), card);
    // It has no samples, and does not use those of another compass.
    assert_eq!(ada.get(&of(&other["id"])).await.problem(), "no-model-yet");
    assert_eq!(
        ada.get(&of(&card["vessel"]["id"])).await.problem(),
        "not-found"
    );
    server.finish().await;
}

async fn a_card_shows_the_last_recorded_correctors(server: TestServer) {
    let ada = server.admin("ada").await;
    let nao = modelled_ship(&server, &ada).await;
    let card = ada.get(&nao.path("/card.json")).await.good();
    assert_eq!(card["correctors"], json!(null));
    let compass = card["compass"]["id"].as_str().unwrap();
    let path = nao.path(&format!("/compasses/{compass}/binnacle"));
    let mut moved = binnacle();
    moved["setting"]["athwartship"] =
        json!([{ "hole": 7, "magnet": "200 mm", "count": 1, "red": "port" }]);
    put(&ada, &path, &moved).await.good();
    let card = ada.get(&nao.path("/card.json")).await.good();
    assert_eq!(card["correctors"]["revision"], 1);
    let athwartship = &card["correctors"]["setting"]["athwartship"];
    assert_eq!(*athwartship, moved["setting"]["athwartship"]);
    let unrecorded = card["not_recorded"].to_string();
    assert!(!unrecorded.contains("correctors"), "{unrecorded}");
    let svg = ada.get(&nao.path("/card.svg")).await.text;
    let stands_in = card["correctors"]["binnacle"].as_str().unwrap();
    assert!(stands_in.ends_with(", no. 2047"), "{stands_in}");
    for words in ["1 × 200 mm in hole 7, red to port", ">Flinders bar<"] {
        assert!(svg.contains(words), "{words}");
    }
    server.finish().await;
}

async fn an_invalid_query_is_refused_by_field(server: TestServer) {
    let ada = server.admin("ada").await;
    let nao = modelled_ship(&server, &ada).await;
    for (wrong, problem) in [
        ("?lat=95&lon=0", "invalid"),
        ("?lat=1", "invalid"),
        ("?at=today", "invalid"),
        ("?at=2050-01-01T00:00:00Z", "invalid"),
        ("?lat=north&lon=0", "bad-request"),
        ("?compass=1", "bad-request"),
    ] {
        for form in ["json", "pdf", "svg", "csv"] {
            let response = ada.get(&nao.path(&format!("/card.{form}{wrong}"))).await;
            assert_eq!(response.problem(), problem, "{form}{wrong}");
        }
    }
    server.finish().await;
}

/// Returns status, last segment of the problem's type, and detail.
async fn refused_card(ada: &Person, nao: &Ship, query: &str) -> (u16, String, String) {
    let response = ada.get(&nao.path(&format!("/card.pdf{query}"))).await;
    let detail = response.json()["detail"].to_string();
    (response.status, response.problem(), detail)
}

async fn a_misleading_card_is_refused(server: TestServer) {
    let ada = server.admin("ada").await;
    let nao = modelled_ship(&server, &ada).await;
    let refused = async |query: &str| {
        let response = ada.get(&nao.path(&format!("/card.pdf{query}"))).await;
        (
            response.status,
            response.problem(),
            response.json()["detail"].to_string(),
        )
    };
    // One latitude says little about another.
    let (status, problem, detail) = refused("?lat=-48&lon=20").await;
    assert_eq!((status, problem.as_str()), (409, "band-too-wide"));
    assert!(detail.contains("limit is ±3°"), "{detail}");
    let (_, problem, _) = refused("?lat=-64.1&lon=136").await;
    assert_eq!(problem, "field-too-weak");

    server.advance(100.0 * DAY_S);
    let ada = Person::sign_in(&server, ada.operator, &ada.email).await;
    let refused = async |query: &str| refused_card(&ada, &nao, query).await;
    let (status, problem, detail) = refused("").await;
    assert_eq!((status, problem.as_str()), (409, "model-too-old"));
    assert!(detail.contains("2026-11-19 23:50 UTC"), "{detail}");

    let moved = json!({ "kind": "corrector_change", "from": "2026-11-20T00:00:00Z" });
    ada.post(&nao.path("/logbook"), &moved).await.good();
    server.work().await;
    let (status, problem, detail) = refused("").await;
    assert_eq!((status, problem.as_str()), (404, "no-model-yet"));
    assert!(detail.contains("the card has not held since"), "{detail}");
    server.finish().await;
}

async fn a_card_with_ambiguous_headings_is_refused(server: TestServer) {
    let ada = server.admin("ada").await;
    let nao = server.ship(&ada, "Nao").await;
    // A field of the ship's own that is small against the earth's in Biscay, and larger in the
    // far south.
    let ship = model_after_step(3000.0, 0.0);
    let mut strong = days_in_waters(position(10.0, -25.0), &ship, "2026-11-10T00:00:00Z", 4.0);
    strong.extend(days_at_sea(&ship, FROM, 5.0));
    nao.put(1, &strong).await.good();
    server.advance(A_WHILE_S);
    server.work().await;
    ada.get(&nao.path("/card.json")).await.good();
    let (status, problem, detail) = refused_card(&ada, &nao, "?lat=-61&lon=136").await;
    assert_eq!((status, problem.as_str()), (409, "headings-ambiguous"));
    assert!(detail.contains("heading"), "{detail}");
    server.finish().await;
}

async fn a_card_of_a_suspected_compass_is_refused(server: TestServer) {
    let ada = server.admin("ada").await;
    let nao = modelled_ship(&server, &ada).await;
    ada.get(&nao.path("/card.json")).await.good();
    let since = Timestamp::parse("2026-11-20T04:00:00Z").unwrap();
    let mut agent_alert = ShipAlert {
        id: Uuid::from_u128(1),
        revision: 1,
        state: ShipAlertState::Open,
        since,
        at: since.plus_seconds(1800.0),
        gyro_departure_deg: Some(-28.4),
        satellite_departure_deg: None,
        limit_deg: 3.9,
        model_version: 1,
    };
    nao.put_bytes(2, batch_with_alert(&nao, 2, agent_alert))
        .await
        .good();
    let (status, problem, detail) = refused_card(&ada, &nao, "").await;
    assert_eq!((status, problem.as_str()), (409, "compass-suspected"));
    assert!(detail.contains("parted by 28°"), "{detail}");
    // There is a card again after compass and gyro have agreed for some hours.
    (agent_alert.revision, agent_alert.state) = (2, ShipAlertState::Agree);
    nao.put_bytes(3, batch_with_alert(&nao, 3, agent_alert))
        .await
        .good();
    let (status, _, detail) = refused_card(&ada, &nao, "").await;
    assert_eq!(status, 409);
    assert!(detail.contains("they agree"), "{detail}");
    server.advance(7.0 * 3600.0);
    alerts::check_timed(&server.app).await.unwrap();
    ada.get(&nao.path("/card.json")).await.good();
    server.finish().await;
}

/// Returns a batch with an alert of the agent alone.
fn batch_with_alert(ship: &Ship, seq: u64, alert: ShipAlert) -> Vec<u8> {
    let batch = Batch {
        stream: ship.stream,
        seq,
        samples: Vec::new(),
        tally: BTreeMap::new(),
        alerts: vec![alert],
        thinned: None,
    };
    binnacle_wire::encode(&batch).unwrap()
}

async fn a_card_after_a_change_invalidates_older_ones(server: TestServer) {
    let ada = server.admin("ada").await;
    let nao = server.ship(&ada, "Nao").await;
    let mut samples = days_at_sea(&true_model(), "2026-11-01T00:00:00Z", 10.0);
    samples.extend(days_at_sea(
        &model_after_step(1500.0, 900.0),
        "2026-11-11T00:00:00Z",
        8.0,
    ));
    nao.put(1, &samples).await.good();
    server.advance(A_WHILE_S);
    server.work().await;
    let card = ada.get(&nao.path("/card.json")).await.good();
    let since = card["replaces"]["since"].as_str().unwrap().to_owned();
    assert!(since.starts_with("2026-11-1"), "{card}");
    let first = card["notes"][0].as_str().unwrap();
    // To the minute: a change is not known to the second.
    let expected = format!(
        "No card from before {} {} UTC holds (",
        &since[..10],
        &since[11..16]
    );
    assert!(first.starts_with(&expected), "{first}");
    let before = ada
        .get(&nao.path("/card.json?at=2026-11-05T00:00:00Z"))
        .await;
    assert_eq!(before.problem(), "invalid");
    assert!(
        before.text.contains("the model is valid only from"),
        "{before:?}"
    );

    let calm = server.ship(&ada, "Calm").await;
    calm.put(1, &passage(FROM, 300)).await.good();
    server.advance(A_WHILE_S);
    server.work().await;
    let card = ada.get(&calm.path("/card.json")).await.good();
    assert_eq!(card["replaces"], json!(null));
    server.finish().await;
}
