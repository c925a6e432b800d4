//! Samples of recordings, imported into a vessel's log.

use crate::run;
use binnacle_compass::sample::Sample;
use binnacle_fleet::alerts;
use binnacle_platform::ids::{CompassId, VesselId};
use binnacle_server::command::{Import, ImportedSamples, import_samples};
use binnacle_server_testing::on_both;
use binnacle_server_testing::program::{assert_refused, samples_csv};
use binnacle_server_testing::{HOUR_S, Person, TestServer, passage};
use serde_json::json;
use tempfile::TempDir;
use uuid::Uuid;

on_both!(
    imported_samples_are_analysed_like_uploaded_ones,
    an_import_repeated_or_overlapping_stores_nothing_twice,
    an_import_is_no_agent_that_falls_silent,
    a_compass_that_the_vessel_does_not_have_is_named,
);

const DAY: &str = "2026-09-01T00:00:00Z";

async fn import(server: &TestServer, vessel: &str, samples: &[Sample]) -> ImportedSamples {
    let import = Import {
        vessel: VesselId(vessel.parse().unwrap()),
        compass: None,
        samples: samples.to_vec(),
    };
    let now = server.app.clock.now().into();
    let mut last = None;
    let imported = import_samples(&server.app.db, import, now, |progress| {
        last = Some(progress);
    });
    let imported = imported.await.unwrap();
    assert_eq!(last, Some(imported), "the last progress is the result");
    imported
}

fn result(stored: usize, repeated: usize, batches: usize) -> ImportedSamples {
    ImportedSamples {
        stored,
        repeated,
        batches,
    }
}

async fn imported_samples_are_analysed_like_uploaded_ones(server: TestServer) {
    let ada = server.admin("ada").await;
    let nao = server.ship(&ada, "Nao").await;
    let uploaded = server.ship(&ada, "Arrano").await;
    let samples = passage(DAY, 300);
    assert_eq!(import(&server, &nao.id, &samples).await, result(300, 0, 1));
    uploaded.put(1, &samples).await.good();
    server.advance(HOUR_S);
    server.work().await;
    let models = ada.get(&nao.path("/models")).await.good();
    assert_ne!(models["items"], json!([]), "it has a model");
    let of_import = ada.get(&nao.path("/samples.csv")).await.text;
    let of_upload = ada.get(&uploaded.path("/samples.csv")).await.text;
    assert!(of_import.lines().count() > 300);
    assert_eq!(of_import, of_upload);
    server.finish().await;
}

async fn an_import_repeated_or_overlapping_stores_nothing_twice(server: TestServer) {
    let ada = server.admin("ada").await;
    let nao = server.ship(&ada, "Nao").await;
    let samples = passage(DAY, 4_500);
    nao.put(1, &samples[..100]).await.good();
    let imported = import(&server, &nao.id, &samples[..2_500]).await;
    assert_eq!(imported, result(2_400, 100, 2));
    let imported = import(&server, &nao.id, &samples[..2_500]).await;
    assert_eq!(imported, result(0, 2_500, 0));
    let imported = import(&server, &nao.id, &samples[1_000..]).await;
    assert_eq!(imported, result(2_000, 1_500, 2));
    let streams = ada.get(&nao.path("/agents")).await.good();
    let streams = streams["items"].as_array().unwrap();
    let counts: Vec<_> = streams
        .iter()
        .map(|stream| stream["samples"].as_u64())
        .collect();
    assert_eq!(counts, [Some(100), Some(4_400)]);
    assert_eq!(streams[1]["agent_version"], "import");
    assert_eq!(streams[1]["contiguous_seq"], 4);
    server.finish().await;
}

async fn an_import_is_no_agent_that_falls_silent(server: TestServer) {
    let ada = server.admin("ada").await;
    let vessel = ada.create_vessel("Nao").await;
    let id = vessel["id"].as_str().unwrap();
    let imported = import(&server, id, &passage(DAY, 10)).await;
    assert_eq!(imported, result(10, 0, 1));
    server.advance(30.0 * 86_400.0);
    alerts::check_silence(&server.app).await.unwrap();
    let ada = Person::sign_in(&server, ada.operator, &ada.email).await;
    let raised = ada.get("/alerts").await.good();
    assert_eq!(raised["items"], json!([]));
    server.finish().await;
}

async fn a_compass_that_the_vessel_does_not_have_is_named(server: TestServer) {
    let ada = server.admin("ada").await;
    let nao = server.ship(&ada, "Nao").await;
    let compass = Uuid::from_u128(2);
    let import = Import {
        vessel: VesselId(nao.id.parse().unwrap()),
        compass: Some(CompassId(compass)),
        samples: passage(DAY, 10),
    };
    let now = server.app.clock.now().into();
    let refused = import_samples(&server.app.db, import, now, |_| {}).await;
    let refused = refused.unwrap_err().to_string();
    let (vessel, compass) = (&nao.id, compass.to_string());
    assert_eq!(refused, format!("vessel {vessel} has no compass {compass}"));
    server.finish().await;
}

#[test]
fn a_table_that_cannot_be_read_stops_the_command_before_anything_is_stored() {
    let folder = TempDir::new().unwrap();
    let vessel = Uuid::from_u128(1).to_string();
    let refused = run(folder.path(), &["import", "--vessel", &vessel, "no.csv"]);
    assert_refused(&refused, &["no.csv"]);
    assert!(!folder.path().join("binnacle.db").exists());
}

#[test]
fn a_vessel_that_is_not_there_is_named() {
    let folder = TempDir::new().unwrap();
    samples_csv(folder.path());
    let vessel = Uuid::from_u128(1).to_string();
    let import = ["import", "--vessel", &vessel, "samples.csv"];
    assert_refused(&run(folder.path(), &import), &["no vessel", &vessel]);
}
