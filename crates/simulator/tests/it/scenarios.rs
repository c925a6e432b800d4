//! Faults of a scenario are named.

use binnacle_simulator::scenario::Scenario;
use std::path::Path;

fn small() -> String {
    let path = Path::new(env!("CARGO_MANIFEST_DIR")).join("scenarios/small.toml");
    std::fs::read_to_string(path).expect("the scenario is there")
}

/// The error after replacing the first occurrence of something in small.toml.
fn error(old: &str, new: &str) -> String {
    let text = small();
    assert!(text.contains(old), "{old}");
    let text = text.replacen(old, new, 1);
    let refused = Scenario::parse("s.toml", &text).expect_err("something is wrong");
    refused.to_string()
}

#[test]
fn all_scenarios_that_come_with_the_program_are_right() {
    let folder = Path::new(env!("CARGO_MANIFEST_DIR")).join("scenarios");
    let mut read = 0;
    for entry in std::fs::read_dir(folder).unwrap() {
        Scenario::read(&entry.unwrap().path()).unwrap();
        read += 1;
    }
    assert!(read >= 3);
}

#[test]
fn an_error_names_file_line_and_field() {
    let line = small()
        .lines()
        .position(|line| line.starts_with("speed_kn"))
        .unwrap()
        + 1;
    for (new, problem) in [
        ("speed_kn = nan", "NaN is not within 5 to 40"),
        ("speed_kn = 99", "99 is not within 5 to 40"),
        (
            "speed_kn = \"fast\"",
            "invalid type: string \"fast\", expected f64",
        ),
    ] {
        let expected = format!("s.toml:{line}: speed_kn: {problem}");
        assert_eq!(error("speed_kn = 14.5", new), expected);
    }
    assert!(
        error("speed_kn = 14.5", "sped_kn = 14.5")
            .starts_with(&format!("s.toml:{line}: sped_kn: unknown"))
    );
    assert!(error("speed_kn = 14.5", "").contains("missing field `speed_kn`"));
}

#[test]
fn an_impossible_scenario_is_refused() {
    assert!(error("lat = 36.30", "lat = 95").contains("lat: 95 is not within"));
    assert!(
        error("route = \"biscay\"", "route = \"moon\"")
            .contains("route: there is no route \"moon\"")
    );
    assert!(
        error("name = \"Noordzee\"", "name = \"Estrella del Sur\"")
            .contains("already taken by another ship")
    );
    assert!(
        error(
            "start = \"2026-03-01T00:00:00Z\"",
            "start = \"1850-03-01T00:00:00Z\""
        )
        .contains("start: igrf14 covers")
    );
    assert!(error("start = \"2026-03-01T00:00:00Z\"", "start = \"tomorrow\"").contains("start: "));
    assert!(error("port = \"Algeciras\", ", "").contains("must be ports"));
    assert!(
        error("[2060, -2930, 1400]", "[2060, -2930]").contains("magnetism.b_nt: invalid length 2")
    );
    assert!(error("[2060, -2930, 1400]", "[30000, 0, 0]").contains("magnetism: at "));
    assert!(
        error("start_point = 2", "start_point = 11")
            .contains("start_point: 11 is not within 0 to 10")
    );
}

#[test]
fn an_event_error_names_the_missing_field() {
    let with = |event: &str| {
        let satellite = "satellite = { alignment_deg = 0.2, dropouts_per_day = 4 }";
        error(satellite, &format!("{satellite}\nevents = [{event}]"))
    };
    assert!(with("{ kind = \"meteor\" }").contains("kind: \"meteor\" is not one of"));
    assert!(with("{ kind = \"lightning\" }").contains("day: missing"));
    assert!(
        with("{ kind = \"cargo\", from_day = 3, to_day = 2 }").contains("to_day: 2 is not after")
    );
    assert!(
        with("{ kind = \"lightning\", day = 1, b_nt = [40000, 0, 0] }").contains("events: at ")
    );
}

#[test]
fn noise_is_no_scenario() {
    for text in [
        "",
        "\u{0}\u{1}",
        "ships = 3",
        "name = \"x\"\nroutes = {}\nships = []",
    ] {
        let error = Scenario::parse("s.toml", text).unwrap_err().to_string();
        assert!(
            error.starts_with("s.toml:1") || error.starts_with("s.toml:3"),
            "{error}"
        );
        assert_eq!(error.lines().count(), 1, "{error}");
    }
}

#[test]
fn the_settings_of_instruments_are_checked() {
    let with = |settings: &str| {
        let satellite = "satellite = { alignment_deg = 0.2, dropouts_per_day = 4 }";
        error(satellite, settings)
    };
    assert!(with("satellite = { talker = \"H\" }").contains("talker: \"H\" is not two capital"));
    assert!(with("satellite = { alignment_deg = 31 }").contains("alignment_deg: 31 is not"));
    assert!(with("compass = { lag_s = -1 }").contains("lag_s: -1 is not within 0 to 300"));
    assert!(with("compass = { resolution_deg = 9 }").contains("resolution_deg: 9 is not"));
    assert!(error("alignment_deg = 0.3", "alignment_deg = 31").contains("not within -30 to 30"));
}
