//! The command `validate`, run as a user runs it.

use crate::run;
use binnacle_server_testing::program::{assert_refused, good, samples_csv};
use serde_json::Value;
use std::fmt::Write;

#[test]
fn validate_says_what_was_predicted_and_what_each_half_says_of_the_other() {
    let folder = tempfile::tempdir().unwrap();
    samples_csv(folder.path());
    let text = good(&run(folder.path(), &["validate", "samples.csv"]));
    for words in [
        "300 rows read as settled samples",
        "Predicted before use",
        "watches inside their 95 % band",
        "Second half, predicted by a model of the first half",
        "heading  samples",
    ] {
        assert!(text.contains(words), "{words}: {text}");
    }
    let json = good(&run(folder.path(), &["validate", "samples.csv", "--json"]));
    let found: Value = serde_json::from_str(&json).unwrap();
    assert_eq!(found["settled"]["rows"], 300);
    assert_eq!(found["parts"][0]["model_of"], "first_half");
    assert!(found["predictions"]["widening"].as_f64().unwrap() >= 1.0);
}

#[test]
fn a_recording_of_every_second_is_settled_and_may_be_too_short() {
    let folder = tempfile::tempdir().unwrap();
    let mut text = "time,lat,lon,compass_deg,reference_deg,sog_kn\n".to_owned();
    for second in 0..600 {
        let (minute, second) = (second / 60, second % 60);
        writeln!(
            text,
            "2026-11-15T00:{minute:02}:{second:02}Z,48,-6,100,97,8"
        )
        .unwrap();
    }
    std::fs::write(folder.path().join("short.csv"), text).unwrap();
    let text = good(&run(folder.path(), &["validate", "short.csv"]));
    for words in [
        "600 rows read, settled to 9 samples of at most 60 seconds",
        "too short for a conclusion",
        "The whole recording has no model: 9 usable samples; at least 12 are needed",
        "not possible: ",
    ] {
        assert!(text.contains(words), "{words}: {text}");
    }
}

#[test]
fn a_bad_row_is_refused_by_file_line_and_field() {
    let folder = tempfile::tempdir().unwrap();
    let text = "time,lat,lon,compass_deg,gyro_deg\n2026-11-15T00:00:00Z,48,-6,400,8\n";
    std::fs::write(folder.path().join("bad.csv"), text).unwrap();
    assert_refused(
        &run(folder.path(), &["validate", "bad.csv"]),
        &["bad.csv:2", "compass_deg", "400"],
    );
    assert_refused(
        &run(folder.path(), &["validate", "none.csv"]),
        &["none.csv"],
    );
}
