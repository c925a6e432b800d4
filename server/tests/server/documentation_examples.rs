//! The examples in docs/ are valid, and do what the pages say.

use crate::run;
use binnacle_adjustment::binnacle::Binnacle;
use binnacle_adjustment::corrector::effect;
use binnacle_compass::field::{FieldModel, field};
use binnacle_compass::position::Position;
use binnacle_compass::ship::ShipMagnetism;
use binnacle_compass::time::Timestamp;
use binnacle_server_testing::program::good;
use serde_json::{Value, json};

const BINNACLE: &str = include_str!("../../../docs/binnacle.md");
const PLAN: &str = include_str!("../../../docs/plan.md");
const WORK_ORDERS: &str = include_str!("../../../docs/work-orders.md");

/// Returns the JSON blocks of a page.
fn blocks(page: &str) -> Vec<Value> {
    let blocks = page.split("```json\n").skip(1);
    let read = |block: &str| {
        let text = block.split("```").next().unwrap();
        serde_json::from_str(text).unwrap_or_else(|error| panic!("{error}: {text}"))
    };
    blocks.map(read).collect()
}

/// Returns the binnacle of its page, with "as below" and "the same" filled in.
fn binnacle() -> Value {
    let [mut binnacle, mut design]: [Value; 2] = blocks(BINNACLE).try_into().unwrap();
    design["athwartship"] = design["fore_and_aft"].clone();
    binnacle["type"] = design;
    binnacle
}

/// Returns a ship that this binnacle nearly corrects, and the magnetometer reading on the
/// page's heading.
fn ship(binnacle: &Binnacle, berth: &Value) -> (Value, [f64; 3]) {
    let read = &berth["reading"];
    let number = |name: &str| read[name].as_f64().unwrap();
    let time = Timestamp::parse(read["at"].as_str().unwrap()).unwrap();
    let position = Position::new(number("lat"), number("lon")).unwrap();
    let found = field(FieldModel::Igrf14, position, 0.0, time).unwrap();
    let earth = found.for_ship();
    let wanted = ShipMagnetism {
        chi: [[-0.09, 0.001, -0.002], [0.002, -0.11, 0.001], [0.0; 3]],
        b_nt: [900.0, -600.0, 0.0],
    };
    let correctors = effect(binnacle, &binnacle.setting);
    let (with, without) = (
        correctors.as_ship(earth.h_nt),
        correctors.as_ship(f64::INFINITY),
    );
    // The needles magnetise the spheres; they are out when the bowl is.
    let mut bowl_out = wanted;
    for row in 0..3 {
        bowl_out.b_nt[row] += without.b_nt[row] - with.b_nt[row];
        for column in 0..3 {
            bowl_out.chi[row][column] += without.chi[row][column] - with.chi[row][column];
        }
    }
    let magnetic_deg = number("heading_true_deg") - found.declination().degrees_east();
    let field_nt = bowl_out.field_at_compass(earth.in_ship_axes(magnetic_deg.to_radians()));
    let mut covariance = [[0.0; 8]; 8];
    for (index, sd) in [60.0_f64, 1.5e-3, 50.0, 1.5e-3, 2e-3, 2e-3, 2e-3, 0.3]
        .iter()
        .enumerate()
    {
        covariance[index][index] = sd * sd;
    }
    let parameters = wanted.parameters_over_lambda().unwrap();
    let model = json!({ "parameters_over_lambda": parameters, "covariance": covariance });
    (model, field_nt)
}

#[test]
fn the_documented_berth_and_binnacle_give_a_plan() {
    let binnacle = binnacle();
    let known: Binnacle = serde_json::from_value(binnacle.clone()).unwrap();
    // The second block is the reading after the steps.
    let [mut berth, _]: [Value; 2] = blocks(PLAN).try_into().unwrap();
    let (model, field_nt) = ship(&known, &berth);
    for (name, nt) in ["forward", "starboard", "down"].iter().zip(field_nt) {
        berth["reading"][name] = json!(nt / 1000.0);
    }
    let folder = tempfile::tempdir().unwrap();
    for (name, value) in [
        ("model", &model),
        ("binnacle", &binnacle),
        ("berth", &berth),
    ] {
        let path = folder.path().join(format!("{name}.json"));
        std::fs::write(path, value.to_string()).unwrap();
    }
    // The exact words of the page.
    let words = PLAN.split("```sh\n").nth(1).unwrap();
    let words = words.lines().next().unwrap().split(' ').skip(1);
    let output = run(folder.path(), &words.collect::<Vec<_>>());
    let found: Value = serde_json::from_str(&good(&output)).unwrap();
    assert_eq!(found["verdict"], "planned", "{}", found["refusals"]);
    assert!(!found["plans"][0]["steps"].as_array().unwrap().is_empty());
}

#[test]
fn every_request_in_the_work_orders_page_is_in_the_openapi_document() {
    let document: Value = serde_json::from_str(include_str!("../../openapi.json")).unwrap();
    let paths = document["paths"].as_object().unwrap();
    let quoted = WORK_ORDERS.split('`').skip(1).step_by(2);
    let requests = quoted.filter_map(|words| words.split_once(' '));
    let requests = requests.filter(|(method, _)| ["GET", "POST", "PUT"].contains(method));
    let mut seen = 0;
    for (method, path) in requests {
        let path = path.split(['?', ' ']).next().unwrap();
        let path = path.replace('…', "/work-orders/{id}");
        let is_it = |known: &String| {
            let known = known.trim_start_matches("/api/v1");
            let (known, asked) = (known.split('/'), path.split('/'));
            let same = |(known, asked): (&str, &str)| {
                known == asked || (known.starts_with('{') && asked.starts_with('{'))
            };
            known.clone().count() == asked.clone().count() && known.zip(asked).all(same)
        };
        let found = paths.iter().find(|(known, _)| is_it(known));
        let (_, methods) = found.unwrap_or_else(|| panic!("no {path}"));
        assert!(!methods[method.to_lowercase()].is_null(), "{method} {path}");
        seen += 1;
    }
    assert!(seen >= 12, "{seen}");
}
