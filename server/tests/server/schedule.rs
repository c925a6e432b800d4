//! The command `schedule`, run as a user runs it.

use crate::run;
use binnacle_server_testing::program::{assert_refused, good};
use serde_json::Value;

/// Returns the first JSON block of docs/schedule.md.
fn example() -> String {
    let text = include_str!("../../../docs/schedule.md");
    let (_, block) = text.split_once("```json\n").unwrap();
    block.split_once("```").unwrap().0.to_owned()
}

#[test]
fn schedule_plans_the_documented_example() {
    let folder = tempfile::tempdir().unwrap();
    std::fs::write(folder.path().join("fleet.json"), example()).unwrap();
    let printed = good(&run(folder.path(), &["schedule", "--input", "fleet.json"]));
    let schedule: Value = serde_json::from_str(&printed).unwrap();
    assert_eq!(schedule["proven_optimal"], true);
    assert_eq!(schedule["jobs"].as_array().unwrap().len(), 3);
    assert_eq!(schedule["unscheduled"][0]["planned_late"], true);
}

#[test]
fn schedule_names_file_and_path_of_invalid_input() {
    let folder = tempfile::tempdir().unwrap();
    let path = folder.path().join("fleet.json");
    let refused = |text: &str, words: &[&str]| {
        std::fs::write(&path, text).unwrap();
        let output = run(folder.path(), &["schedule", "--input", "fleet.json"]);
        assert_refused(&output, words);
    };
    let without_zone = example().replacen("T06:00:00Z", "T06:00:00", 1);
    refused(
        &without_zone,
        &["fleet.json: port_calls[0].eta", "no time zone"],
    );
    let unpaid = example().replacen("\"fee_eur\": ", "\"fee_eur\": -", 1);
    refused(&unpaid, &["fleet.json: firms[0].fee_eur"]);
    refused("{}", &["fleet.json: ", "now"]);
    refused("", &["fleet.json: "]);
    let missing = run(folder.path(), &["schedule", "--input", "none.json"]);
    assert_refused(&missing, &["none.json"]);
}
