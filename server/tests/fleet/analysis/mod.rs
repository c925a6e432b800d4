//! Analysis: from batches to models.

mod jobs;
mod segments;

use crate::run;
use binnacle_compass::angle::{CompassHeading, CourseOverGround, TrueHeading, wrap_180};
use binnacle_compass::sample::{Sample, SourceId};
use binnacle_compass::ship::EarthField;
use binnacle_server_testing::on_both;
use binnacle_server_testing::program::good;
use binnacle_server_testing::{TestServer, passage};
use serde_json::{Value, json};

on_both!(
    a_passage_becomes_a_model_that_predicts_the_deviation,
    without_enough_headings_the_response_names_what_is_missing,
    disagreement_of_gyro_and_satellite_compass_refuses_samples,
    the_order_of_batches_does_not_change_the_model,
    samples_with_equal_times_are_all_listed,
    changed_settings_make_a_new_version_and_reach_the_ship,
    samples_are_paged_filtered_and_exported,
    course_roll_temperature_and_source_are_exported,
    the_picture_of_samples_agrees_with_their_list,
    coverage_recommends_headings_once_there_is_a_model,
    fit_reads_the_exported_samples_and_weights_them_once,
);

pub(crate) const DAY: &str = "2026-11-15T00:00:00Z";
/// Longer than the delay before an analysis.
pub(crate) const A_WHILE_S: f64 = 10.0;

async fn a_passage_becomes_a_model_that_predicts_the_deviation(server: TestServer) {
    let ada = server.admin("ada").await;
    let nao = server.ship(&ada, "Nao").await;
    assert_eq!(ada.get(&nao.path("/model")).await.problem(), "no-model-yet");
    nao.put(1, &passage(DAY, 300)).await.good();
    server.advance(A_WHILE_S);
    assert_eq!(server.work().await.len(), 1);

    let model = ada.get(&nao.path("/model")).await.good();
    assert_eq!(model["version"], 1);
    assert_eq!(model["data_from"], DAY);
    assert_eq!(model["input_hash"].as_str().unwrap().len(), 64);
    assert!(model["model"]["rms_deg"].as_f64().unwrap() < 0.2, "{model}");
    let table = ada.get(&nao.path("/deviation?step_deg=10")).await.good();
    assert_eq!(table["model_id"], model["id"]);
    let rows = table["rows"].as_array().unwrap();
    assert_eq!(rows.len(), 36);
    let samples = ada.get(&nao.path("/samples")).await.good();
    for sample in samples["items"].as_array().unwrap() {
        let residual = sample["residual_deg"].as_f64().unwrap();
        assert!(residual.abs() < 0.5, "{sample}");
        assert_eq!(sample["used"], true);
    }
    let vessel = ada.get(&nao.path("")).await.good();
    assert_eq!(vessel["model"]["id"], model["id"]);
    assert!(vessel["worst"]["deviation_deg"].as_f64().unwrap().abs() > 2.0);
    assert_eq!(vessel["last_position"]["lat"], 48.0);

    // The ship gets it in the next response, and not again once it has it.
    let downlink = nao.downlink("").await;
    assert_eq!(downlink["model"]["id"], model["id"]);
    // Without the parts that only the server needs.
    let mut for_the_bridge = model["model"].clone();
    let quality = for_the_bridge.as_object_mut().unwrap().remove("quality");
    assert!(quality.unwrap()["effective_samples"].as_f64().unwrap() > 1.0);
    assert_eq!(downlink["model"]["model"], for_the_bridge);
    let has = format!("?model={}", model["id"].as_str().unwrap());
    assert!(nao.downlink(&has).await.get("model").is_none());

    // The compact form gives the same card.
    let (compact, bytes) = nao.compact_downlink("").await;
    assert!(bytes < 300, "{bytes}");
    let sent = compact.model.unwrap();
    assert_eq!(sent.id.to_string(), model["id"].as_str().unwrap());
    let field = |name: &str| table[name].as_f64().unwrap();
    let earth = EarthField {
        h_nt: field("h_nt"),
        z_nt: field("z_nt"),
    };
    for row in rows {
        let of = |name: &str| row[name].as_f64().unwrap();
        let compass = CompassHeading::new(of("compass_deg")).unwrap();
        let on_board = sent.model.deviation(compass, earth).unwrap();
        let apart = on_board.deviation.degrees_east() - of("deviation_deg");
        assert!(apart.abs() < 0.01, "{row}: {apart}");
        let apart = on_board.band95_deg.unwrap() - of("band95_deg");
        assert!(apart.abs() < 0.02, "{row}: {apart}");
    }
    let (bare, bytes) = nao.compact_downlink(&has.replace('?', "&")).await;
    assert_eq!(
        (bare.contiguous_seq, bare.model),
        (compact.contiguous_seq, None)
    );
    assert!(bytes < 20, "{bytes}");
    server.finish().await;
}

async fn without_enough_headings_the_response_names_what_is_missing(server: TestServer) {
    let ada = server.admin("ada").await;
    let nao = server.ship(&ada, "Nao").await;
    nao.put(1, &passage(DAY, 3)).await.good();
    server.advance(A_WHILE_S);
    server.work().await;
    for path in ["/model", "/deviation"] {
        let response = ada.get(&nao.path(path)).await;
        assert_eq!(response.problem(), "no-model-yet");
        let detail = response.json()["detail"].as_str().unwrap().to_owned();
        assert!(detail.contains("needed"), "{detail}");
        let refusal = &response.json()["refusal"];
        assert_eq!(refusal["reason"], "too_few_samples");
        assert_eq!(refusal["found"], 3);
        let needed = refusal["needed"].as_u64().unwrap();
        assert!(detail.contains(&needed.to_string()), "{detail}");
    }
    let listed = ada.get(&nao.path("/samples")).await.good();
    assert_eq!(listed["items"].as_array().unwrap().len(), 3);
    server.finish().await;
}

async fn disagreement_of_gyro_and_satellite_compass_refuses_samples(server: TestServer) {
    let ada = server.admin("ada").await;
    for (satellite_behind_deg, refused) in [(0.4, false), (12.0, true)] {
        let nao = server.ship(&ada, "Nao").await;
        let none = ada.get(&nao.path("/coverage")).await.good();
        assert_eq!(none["references"], json!(null));
        let before = ada.get(&nao.path("/model")).await;
        assert_eq!(before.problem(), "no-model-yet");
        assert!(before.json().get("refusal").is_none());
        let mut samples = passage(DAY, 300);
        for sample in &mut samples {
            let gyro_deg = sample.gyro.unwrap().degrees();
            sample.satellite = TrueHeading::new(gyro_deg - satellite_behind_deg);
        }
        // For three hours the gyro is far off.
        for sample in &mut samples[100..118] {
            let gyro_deg = sample.gyro.unwrap().degrees();
            sample.gyro = TrueHeading::new(gyro_deg + 20.0);
        }
        nao.put(1, &samples).await.good();
        server.advance(A_WHILE_S);
        server.work().await;
        let references = ada.get(&nao.path("/coverage")).await.good()["references"].take();
        let model = ada.get(&nao.path("/model")).await;
        if refused {
            assert_eq!(references, json!(null));
            assert_eq!(model.problem(), "no-model-yet");
            let refusal = &model.json()["refusal"];
            assert_eq!(refusal["reason"], "references_disagree");
            assert!((refusal["offset_deg"].as_f64().unwrap() - 12.0).abs() < 0.1);
        } else {
            assert_eq!(model.good()["version"], 1);
            assert!((references["offset_deg"].as_f64().unwrap() - 0.4).abs() < 0.05);
            assert_eq!(references["pairs"], 300);
            assert_eq!(references["gyro_dropped"], 18);
            assert_eq!(references["satellite_dropped"], 0);
        }
    }
    server.finish().await;
}

async fn the_order_of_batches_does_not_change_the_model(server: TestServer) {
    let ada = server.admin("ada").await;
    let samples = passage(DAY, 300);
    let halves = [&samples[..150], &samples[150..]];
    let mut models: Vec<Value> = Vec::new();
    for order in [[0, 1], [1, 0]] {
        let ship = server.ship(&ada, "Nao").await;
        for half in order {
            ship.put(half as u64 + 1, halves[half]).await.good();
            server.advance(A_WHILE_S);
            server.work().await;
        }
        models.push(ada.get(&ship.path("/model")).await.good());
    }
    assert_eq!(models[0]["input_hash"], models[1]["input_hash"]);
    assert_eq!(models[0]["model"], models[1]["model"]);
    server.finish().await;
}

async fn samples_with_equal_times_are_all_listed(server: TestServer) {
    let ada = server.admin("ada").await;
    let nao = server.ship(&ada, "Nao").await;
    let mut samples = passage(DAY, 7);
    for index in 1..6 {
        samples[index].time = samples[1].time;
    }
    nao.put(1, &samples).await.good();
    server.advance(A_WHILE_S);
    server.work().await;
    let all = ada.get(&nao.path("/samples")).await.good()["items"].clone();
    let mut listed = Vec::new();
    let mut after = String::new();
    loop {
        let page = format!("/samples?limit=2{after}");
        let page = ada.get(&nao.path(&page)).await.good();
        listed.extend(page["items"].as_array().unwrap().clone());
        let Some(next) = page["next"].as_str() else {
            break;
        };
        after = format!("&after={next}");
    }
    assert_eq!((listed.len(), Value::Array(listed)), (7, all));
    server.finish().await;
}

async fn changed_settings_make_a_new_version_and_reach_the_ship(server: TestServer) {
    let ada = server.admin("ada").await;
    let nao = server.ship(&ada, "Nao").await;
    nao.put(1, &passage(DAY, 300)).await.good();
    server.advance(A_WHILE_S);
    server.work().await;
    let mut settings = ada.get(&nao.path("/settings")).await.good();
    assert_eq!(settings["agent"]["version"], 0);
    settings["agent"]["min_sog_kn"] = json!(6.0);
    settings["analysis"]["gyro_speed_error"] = json!("uncorrected");
    let put = |body: Value| {
        let request = ada.request(reqwest::Method::PUT, &nao.path("/settings"));
        binnacle_server_testing::ApiResponse::send(request.json(&body))
    };
    assert_eq!(put(settings.clone()).await.good()["agent"]["version"], 1);
    assert_eq!(nao.downlink("").await["settings"]["min_sog_kn"], 6.0);
    assert!(nao.downlink("?settings=1").await.get("settings").is_none());
    server.work().await;
    assert_eq!(ada.get(&nao.path("/model")).await.good()["version"], 2);

    settings["agent"]["min_sog_kn"] = json!(-1.0);
    assert_eq!(put(settings.clone()).await.problem(), "invalid");
    settings["agent"]["min_sog_kn"] = json!(6.0);
    settings["analysis"]["reference_constant_sd_deg"] = json!(-1.0);
    assert_eq!(put(settings).await.problem(), "invalid");
    server.finish().await;
}

async fn the_picture_of_samples_agrees_with_their_list(server: TestServer) {
    let ada = server.admin("ada").await;
    let nao = server.ship(&ada, "Nao").await;
    nao.put(1, &passage(DAY, 300)).await.good();
    server.advance(A_WHILE_S);
    server.work().await;
    let listed = ada.get(&nao.path("/samples?limit=300")).await.good();
    let listed = listed["items"].as_array().unwrap();
    let picture = ada.get(&nao.path("/samples/picture")).await.good();
    assert_eq!(picture["samples"], 300);
    assert_eq!(picture["with_residual"], 300);
    assert_eq!(picture["first"], listed[0]["time"]);
    assert_eq!(picture["last"], listed[299]["time"]);
    let used = listed.iter().filter(|sample| sample["used"] == json!(true));
    let intervals = picture["intervals"].as_array().unwrap();
    let counted: u64 = intervals
        .iter()
        .map(|interval| interval["samples"].as_u64().unwrap())
        .sum();
    assert_eq!(counted, used.count() as u64);
    assert_eq!(picture["dots"]["used"].as_array().unwrap().len(), 300);
    let near = |column: &str, field: &str, most: f64| {
        let drawn = picture["dots"][column][17].as_f64().unwrap();
        let exact = listed[17][field].as_f64().unwrap();
        assert!((drawn - exact).abs() <= most, "{column}: {drawn}, {exact}");
    };
    near("compass_deg", "compass_deg", 0.051);
    near("deviation_deg", "deviation_deg", 0.0051);
    near("residual_deg", "residual_deg", 0.0051);
    near("lon", "lon", 0.051);

    let none = "/samples/picture?to=2020-01-01T00:00:00Z";
    let none = ada.get(&nao.path(none)).await.good();
    assert_eq!(
        (&none["samples"], &none["rms_deg"]),
        (&json!(0), &json!(null))
    );
    server.finish().await;
}

async fn samples_are_paged_filtered_and_exported(server: TestServer) {
    let ada = server.admin("ada").await;
    let nao = server.ship(&ada, "Nao").await;
    nao.put(1, &passage(DAY, 100)).await.good();
    server.advance(A_WHILE_S);
    server.work().await;
    let first = ada.get(&nao.path("/samples?limit=60")).await.good();
    assert_eq!(first["items"].as_array().unwrap().len(), 60);
    let next = format!(
        "/samples?limit=60&after={}",
        first["next"].as_str().unwrap()
    );
    let second = ada.get(&nao.path(&next)).await.good();
    assert_eq!(second["items"].as_array().unwrap().len(), 40);
    assert_eq!(second["next"], json!(null));
    assert_eq!(second["items"][0]["time"], "2026-11-15T10:00:00Z");

    let range = "/samples?from=2026-11-15T01:00:00Z&to=2026-11-15T02:00:00Z";
    let found = ada.get(&nao.path(range)).await.good();
    assert_eq!(found["items"].as_array().unwrap().len(), 6);
    assert_eq!(
        ada.get(&nao.path("/samples?from=yesterday"))
            .await
            .problem(),
        "invalid"
    );
    assert_eq!(
        ada.get(&nao.path("/samples?after=x")).await.problem(),
        "bad-request"
    );

    let csv = ada.get(&nao.path("/samples.csv")).await;
    assert_eq!(csv.headers["content-type"], "text/csv; charset=utf-8");
    assert_eq!(csv.text.lines().count(), 101);
    let lines = ada.get(&nao.path("/samples.ndjson")).await;
    assert_eq!(lines.text.lines().count(), 100);
    let coverage = ada.get(&nao.path("/coverage")).await.good();
    let cells = coverage["cells"].as_array().unwrap();
    let counted: u64 = cells
        .iter()
        .map(|cell| cell["samples"].as_u64().unwrap())
        .sum();
    assert_eq!(counted, 100);
    for wrong in [
        "?lat=95&lon=0",
        "?lat=1",
        "?at=1850-01-01T00:00:00Z",
        "?step_deg=0",
    ] {
        let response = ada.get(&nao.path(&format!("/deviation{wrong}"))).await;
        assert_eq!(response.problem(), "invalid", "{wrong}");
    }
    server.finish().await;
}

async fn course_roll_temperature_and_source_are_exported(server: TestServer) {
    let ada = server.admin("ada").await;
    let nao = server.ship(&ada, "Nao").await;
    let mut samples = passage(DAY, 10);
    samples[9] = Sample {
        cog: CourseOverGround::new(samples[9].gyro.unwrap().degrees() + 3.0),
        roll_deg: Some(-1.4),
        roll_spread_deg: Some(2.5),
        temperature_c: Some(-7.0),
        gyro_source: Some(SourceId::from_name("bridge HE THS")),
        ..samples[9]
    };
    nao.put(1, &samples).await.good();
    server.advance(A_WHILE_S);
    server.work().await;
    let csv = ada.get(&nao.path("/samples.csv")).await.text;
    let rows: Vec<Vec<&str>> = csv.lines().map(|line| line.split(',').collect()).collect();
    let columns = [
        "cog_deg",
        "roll_deg",
        "roll_spread_deg",
        "temperature_c",
        "gyro_source",
        "satellite_source",
        "position_reckoned",
    ];
    assert!(rows[0].ends_with(&columns), "{:?}", rows[0]);
    assert!(rows[1].ends_with(&[""; 7]), "{:?}", rows[1]);
    let course = rows[10][19].parse::<f64>().unwrap();
    let drift = wrap_180(course - rows[10][4].parse::<f64>().unwrap());
    assert!((drift - 3.0).abs() < 0.6, "{drift}");
    let expected = ["-1.4", "2.5", "-7.0", "41947", "", ""];
    assert_eq!(rows[10][20..], expected);
    let listed = ada.get(&nao.path("/samples")).await.good();
    assert_eq!(listed["items"][9]["roll_deg"], -1.4);
    assert_eq!(listed["items"][9]["gyro_source"], 41_947);
    assert!(listed["items"][0].get("roll_deg").is_none());
    let folder = tempfile::tempdir().unwrap();
    std::fs::write(folder.path().join("exported.csv"), &csv).unwrap();
    let analysed = good(&run(folder.path(), &["analyse", "exported.csv"]));
    let analysed: Value = serde_json::from_str(&analysed).unwrap();
    assert_eq!(analysed["samples"][9]["roll_spread_deg"], 2.5);
    assert_eq!(analysed["samples"][9]["cog_deg"], course);
    server.finish().await;
}

async fn coverage_recommends_headings_once_there_is_a_model(server: TestServer) {
    let ada = server.admin("ada").await;
    let nao = server.ship(&ada, "Nao").await;
    let before = ada.get(&nao.path("/coverage")).await.good();
    assert_eq!(before["sail_next"], json!(null));
    nao.put(1, &passage(DAY, 300)).await.good();
    server.advance(A_WHILE_S);
    server.work().await;
    let coverage = ada.get(&nao.path("/coverage")).await.good();
    assert_eq!(coverage["cells"].as_array().unwrap().len(), 24);
    let next = &coverage["sail_next"];
    assert_eq!(next["watch_hours"], 4.0);
    // Two days in one place say little about other places.
    let band = |of: &Value| of["rms_deg"].as_f64().unwrap();
    let elsewhere = &next["elsewhere"];
    assert!(
        band(&elsewhere["band"]) > band(&next["here"]["band"]),
        "{next}"
    );
    let best = &elsewhere["suggestions"][0];
    assert!(
        best["magnetic_latitude_from_deg"].as_i64().unwrap() < 0,
        "{best}"
    );
    assert_eq!(best["headings"].as_array().unwrap().len(), 3);
    assert!(
        band(&best["after_three"]) < band(&best["after_one"]),
        "{best}"
    );
    assert!(
        band(&best["after_one"]) < band(&elsewhere["band"]),
        "{best}"
    );
    server.finish().await;
}

async fn fit_reads_the_exported_samples_and_weights_them_once(server: TestServer) {
    let ada = server.admin("ada").await;
    let nao = server.ship(&ada, "Nao").await;
    let mut samples = passage(DAY, 300);
    // A sample with less than full weight in the analysis.
    let gyro_deg = samples[150].gyro.unwrap().degrees();
    samples[150].gyro = Some(TrueHeading::new(gyro_deg + 3.0).unwrap());
    nao.put(1, &samples).await.good();
    server.advance(A_WHILE_S);
    server.work().await;
    let exported = ada.get(&nao.path("/samples.csv")).await.text;
    let table: Vec<Vec<&str>> = exported.lines().map(|l| l.split(',').collect()).collect();
    let column = table[0].iter().position(|name| *name == "robust_weight");
    let column = column.unwrap();
    assert!(
        table[151][column].parse::<f64>().unwrap() < 0.9,
        "{:?}",
        table[151]
    );

    let mut unweighted = String::new();
    for mut row in table {
        row.remove(column);
        unweighted += &(row.join(",") + "\n");
    }
    let folder = tempfile::tempdir().unwrap();
    std::fs::write(folder.path().join("exported.csv"), &exported).unwrap();
    std::fs::write(folder.path().join("unweighted.csv"), unweighted).unwrap();
    let fit = |file| good(&run(folder.path(), &["fit", file, "--json"]));
    assert_eq!(fit("exported.csv"), fit("unweighted.csv"));
    server.finish().await;
}
