//! The model's JSON agrees with docs/model.md, and its worked example gives the printed
//! values.

#![allow(clippy::unwrap_used)] // all of this is tests

use binnacle_compass::angle::CompassHeading;
use binnacle_compass::deviation::Coefficients;
use binnacle_compass::model::Model;
use binnacle_compass::ship::EarthField;
use serde_json::{Value, json};

const PAGE: &str = include_str!("../../../docs/model.md");

const BISCAY: EarthField = EarthField {
    h_nt: 24_000.0,
    z_nt: 38_500.0,
};
const CAPE: EarthField = EarthField {
    h_nt: 12_000.0,
    z_nt: -25_000.0,
};

fn example_text() -> &'static str {
    let after = PAGE.split_once("```json").unwrap().1;
    after.split_once("```").unwrap().0
}

fn example() -> Model {
    serde_json::from_str(example_text()).unwrap()
}

/// Rows below a table's heading, as cells.
fn table(heading: &str) -> Vec<Vec<&'static str>> {
    let after = PAGE.split_once(heading).unwrap().1;
    let rows = after
        .lines()
        .skip(2)
        .take_while(|line| line.starts_with('|'));
    rows.map(|line| line.trim_matches('|').split('|').map(str::trim).collect())
        .collect()
}

fn number(cell: &str) -> f64 {
    cell.trim_end_matches('°').parse().unwrap()
}

/// Compares to half of the last printed digit.
fn assert_printed(printed: &str, value: f64, what: &str) {
    let (_, places) = printed.trim_end_matches('°').split_once('.').unwrap();
    let half = places.bytes().fold(0.500_1, |half, _| half / 10.0);
    let off = (number(printed) - value).abs();
    assert!(off <= half, "{what}: {value} for {printed}");
}

#[test]
fn the_example_is_a_model_and_is_written_as_it_is_printed() {
    let model = example();
    model.check().unwrap();
    let written = serde_json::to_string_pretty(&model).unwrap();
    let order = |text: &str| {
        let quoted = text.split('"').skip(1).step_by(2);
        quoted.map(str::to_owned).collect::<Vec<_>>()
    };
    assert_eq!(order(&written), order(example_text()));
    assert_eq!(serde_json::from_str::<Model>(&written).unwrap(), model);
    let first = written.lines().nth(1).unwrap();
    assert_eq!(first.trim(), "\"version\": 1,");
}

#[test]
fn every_field_is_described() {
    let described = table("| field | unit | when absent | meaning |");
    let described: Vec<&str> = described
        .iter()
        .map(|row| row[0].trim_matches('`'))
        .collect();
    let Value::Object(fields) = serde_json::to_value(example()).unwrap() else {
        panic!("a model is an object");
    };
    let parameters = fields["parameters_over_lambda"].as_object().unwrap();
    let quality = fields["quality"].as_object().unwrap();
    // Written only where the reference is not a heading, and where a fit or a binnacle has them.
    let of_other_models = ["reference_grade", "mean_h_nt", "needles"].map(str::to_owned);
    let written = fields.keys().chain(parameters.keys()).chain(quality.keys());
    let written = written.chain(&of_other_models);
    assert_eq!(written.clone().count(), described.len());
    for field in written {
        assert!(described.contains(&field.as_str()), "{field}");
    }
}

#[test]
fn the_worked_example_comes_out() {
    let model = example();
    let zeta = CompassHeading::new(120.0).unwrap();
    let Coefficients { a, b, c, d, e } =
        Coefficients::new(&model.parameters_over_lambda, BISCAY).unwrap();
    let (s1, c1) = zeta.radians().sin_cos();
    let (s2, c2) = (2.0 * zeta.radians()).sin_cos();
    let (k1, k2, k3) = (1.0 - d * c2 + e * s2, a + d * s2 + e * c2, b * s1 + c * c1);
    let predicted = model.deviation(zeta, BISCAY).unwrap();
    let deviation = predicted.deviation.degrees_east();
    let expected = [
        ("A", a),
        ("B", b),
        ("C", c),
        ("D", d),
        ("E", e),
        ("K1", k1),
        ("K2", k2),
        ("K3", k3),
        ("G", (k1 * k1 + k2 * k2 - k3 * k3).sqrt()),
        ("ship's own deviation", deviation - model.constant_deg),
        ("deviation", deviation),
        ("standard error", predicted.standard_error_deg.unwrap()),
        ("95 % band", predicted.band95_deg.unwrap()),
    ];
    let rows = table("| quantity | value |");
    assert_eq!(rows.len(), expected.len());
    for (row, (name, value)) in rows.iter().zip(expected) {
        assert_eq!(row[0], name);
        assert_printed(row[1], value, name);
    }
}

#[test]
fn its_table_of_two_places_comes_out() {
    let model = example();
    let rows = table("| compass | deviation, Biscay | band | deviation, Cape | band |");
    assert_eq!(rows.len(), 8);
    for row in rows {
        let compass = CompassHeading::new(number(row[0])).unwrap();
        for (cells, earth) in [(&row[1..3], BISCAY), (&row[3..5], CAPE)] {
            let predicted = model.deviation(compass, earth).unwrap();
            assert_printed(cells[0], predicted.deviation.degrees_east(), row[0]);
            assert_printed(cells[1], predicted.band95_deg.unwrap(), row[0]);
        }
    }
}

#[test]
fn without_a_version_it_is_the_first() {
    let whole = example();
    let mut old = serde_json::to_value(&whole).unwrap();
    old.as_object_mut().unwrap().remove("version");
    assert_eq!(serde_json::from_value::<Model>(old).unwrap(), whole);

    let parameters = serde_json::to_value(whole.parameters_over_lambda).unwrap();
    let bare = json!({ "parameters_over_lambda": parameters });
    let bare: Model = serde_json::from_value(bare).unwrap();
    assert_eq!(bare.parameters_over_lambda, whole.parameters_over_lambda);
    assert_eq!((bare.constant_deg, bare.covariance), (0.0, None));
}

#[test]
fn another_version_is_refused_by_its_number() {
    for (version, words) in [
        (
            json!(2),
            "version: a model of version 2; this program reads version 1",
        ),
        (json!(0), "a model of version 0"),
        (json!("1"), "version: invalid type: string \"1\""),
        (json!(null), "version: invalid type: null"),
        (json!(-1), "version: invalid value: integer `-1`"),
        (json!(1.5), "version: invalid type: floating point `1.5`"),
    ] {
        let mut model = serde_json::to_value(example()).unwrap();
        model["version"] = version;
        let refused = serde_json::from_value::<Model>(model).unwrap_err();
        assert!(refused.to_string().contains(words), "{refused}");
    }
}
