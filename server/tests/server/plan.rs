//! The command `plan`, run as a user runs it.

use crate::run;
use binnacle_adjustment::binnacle::{Binnacle, SHIPPED, Setting};
use binnacle_adjustment::corrector::effect;
use binnacle_compass::ship::{EarthField, ShipMagnetism};
use binnacle_server_testing::program::{assert_refused, good};
use serde_json::{Value, json};
use std::path::Path;
use std::process::Output;

const BERTH: EarthField = EarthField {
    h_nt: 24_000.0,
    z_nt: 38_500.0,
};

fn binnacle() -> Value {
    let design: Value = serde_json::from_str(SHIPPED[0].1).unwrap();
    json!({
        "version": 1,
        "serial": "1234",
        "type": design,
        "aboard": {
            "magnets": [{ "magnet": "200 mm", "count": 8 }, { "magnet": "heeling 150 mm", "count": 1 }],
            "quadrantal": ["7 inch"],
            "flinders_pieces_mm": [300, 150, 75],
        },
        "setting": {
            "fore_and_aft": [{ "hole": 5, "magnet": "200 mm", "count": 2, "red": "aft" }],
            "athwartship": [{ "hole": 7, "magnet": "200 mm", "count": 1, "red": "port" }],
            "quadrantal": { "size": "7 inch", "mark_mm": 320, "slew_deg": 0 },
            "flinders": { "length_mm": 225, "side": "forward", "slew_deg": 0 },
            "heeling": { "position": 4, "count": 1, "red": "up" },
        },
    })
}

/// Returns the ship with a corrector setting, in a field.
fn ship_with(setting: &Setting, h_nt: f64) -> ShipMagnetism {
    let binnacle: Binnacle = serde_json::from_value(binnacle()).unwrap();
    let there = effect(&binnacle, setting).as_ship(h_nt);
    let mut ship = ShipMagnetism {
        chi: [[-0.06, 0.002, -0.021], [0.003, -0.15, 0.002], [0.0; 3]],
        b_nt: [2_600.0, -1_900.0, 800.0],
    };
    for row in 0..3 {
        ship.b_nt[row] += there.b_nt[row];
        for column in 0..3 {
            ship.chi[row][column] += there.chi[row][column];
        }
    }
    ship
}

/// Returns the magnetometer reading on true heading 63.
fn read_with(setting: &Setting) -> [f64; 2] {
    // With variation 3 W that is magnetic 66; no needles, bowl out.
    let earth = BERTH.in_ship_axes(66_f64.to_radians());
    let [forward, starboard, _] = ship_with(setting, f64::INFINITY).field_at_compass(earth);
    [forward, starboard]
}

/// Returns the ship's model, and the first berth reading.
fn ship() -> (Value, [f64; 2]) {
    let found: Setting = serde_json::from_value(binnacle()["setting"].clone()).unwrap();
    let parameters = ship_with(&found, BERTH.h_nt)
        .parameters_over_lambda()
        .unwrap();
    let mut covariance = [[0.0; 8]; 8];
    for (index, sd) in [60.0_f64, 1.5e-3, 50.0, 1.5e-3, 2e-3, 2e-3, 2e-3, 0.3]
        .iter()
        .enumerate()
    {
        covariance[index][index] = sd * sd;
    }
    let model = json!({ "parameters_over_lambda": parameters, "covariance": covariance });
    (model, read_with(&found))
}

fn berth([forward, starboard]: [f64; 2]) -> Value {
    json!({
        "reading": {
            "at": "2026-11-21T10:00:00Z",
            "lat": 43.35,
            "lon": -3.03,
            "heading_true_deg": 63.0,
            "heading_from": "ashore",
            "forward": forward,
            "starboard": starboard,
            "unit": "nanotesla",
            "magnetometer": "fluxgate",
        },
        "field": { "h_nt": BERTH.h_nt, "z_nt": BERTH.z_nt, "variation_deg": -3.0 },
        "waters": [
            { "name": "Biscay", "lat": 45.0, "lon": -5.0, "weight": 2 },
            { "name": "Baltic", "h_nt": 17000, "z_nt": 47000, "weight": 1 },
        ],
        "limits": { "residual_deg": 4.0 },
    })
}

fn plan(folder: &Path, model: &Value, binnacle: &Value, berth: &Value) -> Output {
    for (name, value) in [("model", model), ("binnacle", binnacle), ("berth", berth)] {
        std::fs::write(folder.join(format!("{name}.json")), value.to_string()).unwrap();
    }
    let files = [
        "--model",
        "model.json",
        "--binnacle",
        "binnacle.json",
        "--berth",
        "berth.json",
    ];
    run(folder, &[&["plan"], &files[..]].concat())
}

#[test]
fn plan_prints_settings_steps_and_residuals() {
    let folder = tempfile::tempdir().unwrap();
    let (model, read) = ship();
    let output = plan(folder.path(), &model, &binnacle(), &berth(read));
    let found: Value = serde_json::from_str(&good(&output)).unwrap();
    assert_eq!(found["verdict"], "planned", "{}", found["refusals"]);
    let best = &found["plans"][0];
    assert!(best["worst_residual_deg"].as_f64().unwrap() < 1.5);
    assert_eq!(best["after"][0]["rows"].as_array().unwrap().len(), 24);
    assert!(best["after"][1]["rows"][3]["band95_deg"].as_f64().unwrap() > 0.3);
    let step = &best["steps"][0];
    for name in [
        "words",
        "expected_compass_deg",
        "tolerance_deg",
        "setting_after",
    ] {
        assert!(!step[name].is_null(), "{name}");
    }
    assert_eq!(found["optimality"]["proven"], true);
    // The needles were fitted in another field than the mean of these waters.
    assert!((found["berth"]["consistency"]["angle_deg"].as_f64().unwrap()).abs() < 0.5);
}

#[test]
fn a_refusal_is_a_result_with_its_cure() {
    let folder = tempfile::tempdir().unwrap();
    let (model, [x, y]) = ship();
    let blind = json!({ "parameters_over_lambda": model["parameters_over_lambda"] });
    let mut against = model.clone();
    // The ship's own field cancels the earth's on this heading.
    let (sin, cos) = 66_f64.to_radians().sin_cos();
    against["parameters_over_lambda"]["bx_nt"] = json!(-BERTH.h_nt * cos);
    against["parameters_over_lambda"]["by_nt"] = json!(BERTH.h_nt * sin);
    let with = |path: &str, value: Value| {
        let mut berth = berth([x, y]);
        *berth.pointer_mut(path).unwrap() = value;
        berth
    };
    let limits = |limits: Value| with("/limits", limits);
    let mut old = berth([x, y]);
    old["model_until"] = json!("2026-08-01T00:00:00Z");
    let mut laden = berth([x, y]);
    laden["reading"]["cargo_on_board"] = json!(true);
    let mut poor = limits(json!({ "residual_deg": 0.5, "lambda_sd": 0.005 }));
    poor["reading"]["magnetometer"] = json!("magnetoresistive");
    for (model, berth, refusal, cure) in [
        (&blind, berth([x, y]), "no_covariance", "headings_at_sea"),
        (&model, old, "model_too_old", "headings_at_sea"),
        (&model, laden, "cargo_on_board", "after_discharge"),
        (
            &model,
            with("/reading/heading_true_deg", json!(75.0)),
            "inconsistent_berth",
            "read_again",
        ),
        (
            &model,
            berth([4.0 * x, 4.0 * y]),
            "implausible_lambda",
            "read_again",
        ),
        (&against, berth([x, y]), "ambiguous_headings", "swing"),
        (
            &model,
            limits(json!({ "band_deg": 0.2 })),
            "band_too_wide",
            "headings_at_sea",
        ),
        (
            &model,
            limits(json!({ "residual_deg": 0.5 })),
            "residual_too_large",
            "other_correctors",
        ),
        // The magnetometer is not named where a better one would not help.
        (&model, poor, "residual_too_large", "other_correctors"),
    ] {
        let output = plan(folder.path(), model, &binnacle(), &berth);
        let found: Value = serde_json::from_str(&good(&output)).unwrap();
        assert_eq!(found["verdict"], "refused", "{refusal}");
        assert_eq!(
            found["refusals"][0]["refusal"], refusal,
            "{}",
            found["refusals"]
        );
        assert_eq!(found["refusals"][0]["cures"][0], cure);
        assert_eq!(found["plans"], json!([]));
    }
}

#[test]
fn plan_checks_the_field_after_the_steps() {
    let folder = tempfile::tempdir().unwrap();
    let (model, read) = ship();
    let output = plan(folder.path(), &model, &binnacle(), &berth(read));
    let found: Value = serde_json::from_str(&good(&output)).unwrap();
    let best = &found["plans"][0];
    let after = |setting: &Setting| {
        let [forward, starboard] = read_with(setting);
        json!({ "reading": {
            "at": "2026-11-21T11:40:00Z", "unit": "nanotesla",
            "forward": forward, "starboard": starboard,
        } })
    };
    let judged = |after: &Value| {
        std::fs::write(folder.path().join("after.json"), after.to_string()).unwrap();
        let files = ["--model", "model.json", "--binnacle", "binnacle.json"];
        let berths = ["--berth", "berth.json", "--after", "after.json"];
        run(
            folder.path(),
            &[&["plan"], &files[..], &berths[..]].concat(),
        )
    };
    let judgement =
        |after: &Value| -> Value { serde_json::from_str(&good(&judged(after))).unwrap() };
    let planned: Setting = serde_json::from_value(best["setting"].clone()).unwrap();
    let right = judgement(&after(&planned));
    assert_eq!(right["verdict"], "as_planned", "{right}");
    assert_eq!(right["parts"].as_array().unwrap().len(), 2);
    // No step was done.
    let found: Setting = serde_json::from_value(binnacle()["setting"].clone()).unwrap();
    let wrong = judgement(&after(&found));
    assert_ne!(wrong["verdict"], "as_planned", "{wrong}");
    let with = |path: &str, value: Value| {
        let mut after = after(&planned);
        after[path] = value;
        after
    };
    let refused = |after: &Value, words: &[&str]| {
        assert_refused(&judged(after), &[&["after.json"], words].concat());
    };
    refused(&with("plan", json!(99)), &["there are plans 1 to"]);
    refused(
        &with("turned_deg", json!(vec![0.0; 40])),
        &["turned_deg", "steps"],
    );
    refused(
        &with("turned_deg", json!([400.0])),
        &["turned_deg[0]", "180"],
    );
    let mut early = after(&planned);
    early["reading"]["at"] = json!("2026-11-21T09:00:00Z");
    refused(&early, &["reading.at", "before the first"]);
}

#[test]
fn invalid_berth_readings_are_refused_by_file_and_field() {
    let folder = tempfile::tempdir().unwrap();
    let (model, [x, y]) = ship();
    let refused = |berth: &Value, words: &[&str]| {
        let output = plan(folder.path(), &model, &binnacle(), berth);
        assert_refused(&output, &[&["berth.json"], words].concat());
    };
    refused(&berth([x / 1e5, y / 1e5]), &["reading.forward", "gauss"]);
    refused(
        &berth([x / 1e3, y / 1e3]),
        &["reading.forward", "microtesla"],
    );
    refused(&berth([y, x]), &["reading.forward", "axes are swapped"]);
    refused(&berth([1e6, y]), &["reading.forward", "1000000 nT is not"]);
    refused(&berth([1e300, y]), &["reading.forward", "1e300 nT is not"]);
    let with = |path: &str, value: Value| {
        let mut berth = berth([x, y]);
        *berth.pointer_mut(path).unwrap() = value;
        berth
    };
    let unit = with("/reading/unit", json!("microtesla"));
    refused(&unit, &["reading.forward", "figures are in nanotesla"]);
    let unit = with("/reading/unit", json!("gamma"));
    refused(&unit, &["gamma"]);
    let stern = with("/reading/heading_true_deg", json!(243.0));
    refused(&stern, &["reading.heading_true_deg", "180 degrees off"]);
    refused(&stern, &["it could be that the heading is"]);
    let wrong = with("/reading/heading_true_deg", json!(400.0));
    refused(&wrong, &["reading.heading_true_deg", "400"]);
    refused(
        &with("/waters/1/h_nt", json!(-5)),
        &["waters[1].h_nt", "-5"],
    );
    refused(
        &with("/limits/residual_deg", json!(9)),
        &["limits.residual_deg", "9"],
    );
    let mut wrong = berth([x, y]);
    wrong["forwards"] = json!(1);
    refused(&wrong, &["forwards"]);
    let mut weak = berth([x, y]);
    weak["field"] = Value::Null;
    (weak["reading"]["lat"], weak["reading"]["lon"]) = (json!(-64.1), json!(136.0));
    refused(&weak, &["the berth's h_nt"]);
}

#[test]
fn an_invalid_binnacle_is_refused_by_file_and_field() {
    let folder = tempfile::tempdir().unwrap();
    let (model, read) = ship();
    let refused = |binnacle: &Value, words: &[&str]| {
        let output = plan(folder.path(), &model, binnacle, &berth(read));
        assert_refused(&output, &[&["binnacle.json"], words].concat());
    };
    let mut wrong = binnacle();
    wrong["setting"]["fore_and_aft"][0]["hole"] = json!(25);
    refused(&wrong, &["setting.fore_and_aft[0].hole", "no hole 25"]);
    let mut wrong = binnacle();
    wrong["setting"]["heeling"]["position"] = json!(99);
    refused(&wrong, &["setting.heeling.position", "no position 99"]);
    let mut wrong = binnacle();
    wrong["type"]["magnets"] = json!([]);
    refused(&wrong, &["magnets", "is empty"]);
    let mut wrong = binnacle();
    wrong["type"]["athwartship"]["holes"][2]["below_card_mm"] = json!(-30);
    refused(&wrong, &["athwartship.holes[2].below_card_mm", "-30"]);
}
