//! Ships without gyro and satellite compass: their model's grade, wherever it is shown.

use binnacle_compass::angle::{CourseOverGround, TrueHeading};
use binnacle_compass::sample::Sample;
use binnacle_server_testing::alerts::set_alert_limits;
use binnacle_server_testing::{TestServer, days_at_sea, on_both, true_model};
use serde_json::{Value, json};

on_both!(a_model_by_course_is_marked_on_model_card_and_book,);

const DEPARTURE: &str = "2026-10-20T00:00:00Z";
const A_WHILE_S: f64 = 10.0;

/// Returns the sample as a ship without true headings gives it.
fn by_course(sample: &Sample) -> Sample {
    let true_deg = sample.gyro.map(TrueHeading::degrees).unwrap();
    Sample {
        gyro: None,
        satellite: None,
        cog: CourseOverGround::new(true_deg.rem_euclid(360.0)),
        ..*sample
    }
}

async fn a_model_by_course_is_marked_on_model_card_and_book(server: TestServer) {
    let ada = server.admin("ada").await;
    let nao = server.ship(&ada, "Nao").await;
    let samples = days_at_sea(&true_model(), DEPARTURE, 20.0);
    let samples: Vec<Sample> = samples.iter().map(by_course).collect();
    nao.put(1, &samples).await.good();
    server.advance(A_WHILE_S);
    server.work().await;

    let model = ada.get(&nao.path("/model")).await.good();
    assert_eq!(model["model"]["reference_grade"], "course_over_ground");
    let table = ada.get(&nao.path("/deviation")).await.good();
    let rows = table["rows"].as_array().unwrap();
    let band = |row: &Value| row["band95_deg"].as_f64().unwrap();
    assert!(rows.iter().all(|row| band(row) > 1.0), "{table}");
    let book = ada.get(&nao.path("/deviation-book")).await.good();
    let entries = book["items"].as_array().unwrap();
    assert!(!entries.is_empty());
    for entry in entries {
        assert_eq!(entry["reference"], "course_over_ground", "{entry}");
    }
    // With the usual limits there is no card so uncertain.
    let refused = ada.get(&nao.path("/card.json")).await.problem();
    assert_eq!(refused, "band-too-wide");
    let limits = json!({ "deviation_deg": 45.0, "band95_deg": 45.0 });
    set_alert_limits(&server, &ada, &nao, limits).await;
    let card = ada.get(&nao.path("/card.json")).await.good();
    let notes = card["notes"].to_string();
    assert!(notes.contains("course over ground alone"), "{notes}");
    server.finish().await;
}
