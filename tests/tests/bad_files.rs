//! Unusable files and arguments: exit code 2, one line with the place and the
//! fault, and no output that looks complete.

#![allow(clippy::unwrap_used, reason = "these are tests, helpers included")]

use binnacle_tests::output_of;
use std::fmt::Write as _;
use std::path::{Path, PathBuf};
use std::process::Output;

fn file(folder: &Path, name: &str, content: impl AsRef<[u8]>) -> PathBuf {
    let path = folder.join(name);
    std::fs::write(&path, content).unwrap();
    path
}

fn text_of(output: &Output) -> (String, String) {
    let text = |bytes: &[u8]| String::from_utf8_lossy(bytes).into_owned();
    (text(&output.stdout), text(&output.stderr))
}

fn assert_refused(what: &str, output: &Output, words: &[&str]) {
    let (out, errors) = text_of(output);
    assert_eq!(output.status.code(), Some(2), "{what}: {errors}");
    assert_eq!(out, "", "{what}");
    assert_eq!(errors.trim_end().lines().count(), 1, "{what}: {errors}");
    assert!(
        errors.len() < 1000,
        "{what}: a line to be read, not {} bytes",
        errors.len()
    );
    for word in words {
        assert!(
            errors.contains(word),
            "{what}: {errors:?} does not say {word:?}"
        );
    }
}

/// Bytes of every kind, without structure.
fn noise(count: usize) -> Vec<u8> {
    let mut state = 1_u64;
    let mut next = || {
        state = state
            .wrapping_mul(6_364_136_223_846_793_005)
            .wrapping_add(1_442_695_040_888_963_407);
        (state >> 56) as u8
    };
    (0..count).map(|_| next()).collect()
}

const HEADER: &str = "time,lat,lon,compass_deg,gyro_deg";

fn rows(bad: &str) -> String {
    let mut text = format!("{HEADER}\n");
    for i in 0..30 {
        let heading = 12 * i;
        writeln!(
            text,
            "2026-11-20T00:{i:02}:00Z,48.0,-6.0,{heading},{heading}"
        )
        .unwrap();
    }
    text + bad + "\n"
}

#[tokio::test]
async fn fit_names_file_line_and_field() {
    let folder = tempfile::tempdir().unwrap();
    let cases = [
        (
            "missing.csv",
            rows("").replace("compass_deg", "compass"),
            vec!["compass_deg"],
        ),
        (
            "nan.csv",
            rows("2026-11-20T01:00:00Z,48,-6,NaN,10"),
            vec!["32", "compass_deg"],
        ),
        (
            "lat.csv",
            rows("2026-11-20T01:00:00Z,95,-6,10,10"),
            vec!["32", "lat", "95"],
        ),
        (
            "date.csv",
            rows("1850-01-01T00:00:00Z,48,-6,10,10"),
            vec!["32", "time", "1850"],
        ),
        (
            "word.csv",
            rows("2026-11-20T01:00:00Z,48,-6,north,10"),
            vec!["32", "compass_deg"],
        ),
        ("short.csv", rows("2026-11-20T01:00:00Z,48"), vec!["32"]),
        ("empty.csv", String::new(), vec!["the file is empty"]),
        (
            "header.csv",
            format!("{HEADER}\n"),
            vec!["no row after the column names"],
        ),
        (
            "digits.csv",
            rows("2026-11-20T01:00:00Z,48,-6,1e308,10"),
            vec!["32", "compass_deg", "1e308"],
        ),
        (
            "no_reference.csv",
            (0..30).fold(format!("{HEADER}\n"), |text, i| {
                text + &format!("2026-11-20T00:{i:02}:00Z,48,-6,{},\n", 12 * i)
            }),
            vec!["no gyro, satellite or other true heading", "30"],
        ),
        (
            "long.csv",
            format!("{HEADER}\n{}", "1".repeat(10_000_000)),
            vec![],
        ),
    ];
    for (name, content, words) in cases {
        let path = file(folder.path(), name, content);
        let output = output_of("binnacle-server", ["fit".as_ref(), path.as_os_str()])
            .await
            .unwrap();
        assert_refused(name, &output, &[&[name][..], &words].concat());
    }
    let path = file(folder.path(), "noise.csv", noise(100_000));
    let output = output_of("binnacle-server", ["fit".as_ref(), path.as_os_str()])
        .await
        .unwrap();
    assert_refused("noise.csv", &output, &["noise.csv"]);
}

#[tokio::test]
async fn field_names_the_value_out_of_range() {
    let cases = [
        (["--lat", "95", "--lon", "0", "--date", "2026-01-01"], "95"),
        (
            ["--lat", "NaN", "--lon", "0", "--date", "2026-01-01"],
            "NaN",
        ),
        (
            ["--lat", "45", "--lon", "0", "--date", "1850-01-01"],
            "1850",
        ),
        (
            ["--lat", "45", "--lon", "0", "--date", "yesterday"],
            "yesterday",
        ),
    ];
    for (arguments, word) in cases {
        let output = output_of("binnacle-server", [&["field"][..], &arguments].concat()).await;
        assert_refused(word, &output.unwrap(), &[word]);
    }
}

#[tokio::test]
async fn replay_refuses_a_file_that_is_not_a_log() {
    let folder = tempfile::tempdir().unwrap();
    let cases = [
        ("noise.log", noise(1_000_000)),
        ("line.log", vec![b'$'; 10_000_000]),
        ("text.log", b"Dear diary,\ntoday we sailed.\n".to_vec()),
    ];
    for (name, content) in cases {
        let path = file(folder.path(), name, content);
        let samples = folder.path().join("samples.csv");
        let arguments = [
            "replay".as_ref(),
            path.as_os_str(),
            "--csv".as_ref(),
            samples.as_os_str(),
        ];
        let output = output_of("binnacle-agent", arguments).await.unwrap();
        assert_refused(name, &output, &[name]);
        assert!(!samples.exists(), "{name}: a partial output was left");
    }
}

#[tokio::test]
async fn a_file_that_is_not_there_is_named() {
    for (program, command) in [("binnacle-server", "fit"), ("binnacle-agent", "replay")] {
        let output = output_of(program, [command, "no-such-file"]).await.unwrap();
        assert_refused(command, &output, &["no-such-file"]);
    }
}
