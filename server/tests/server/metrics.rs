//! Names of metrics: those in the code, in its list, and in the dashboards and alert rules.

use std::collections::BTreeSet;
use std::path::{Path, PathBuf};

fn root() -> PathBuf {
    Path::new(env!("CARGO_MANIFEST_DIR"))
        .parent()
        .unwrap()
        .to_owned()
}

fn files(folder: &Path, found: &mut Vec<PathBuf>) {
    for entry in std::fs::read_dir(folder).unwrap() {
        let path = entry.unwrap().path();
        if path.is_dir() {
            files(&path, found);
        } else {
            found.push(path);
        }
    }
}

/// Returns the names that follow one of these words in the files of a folder.
fn names_after(words: &[&str], folder: &Path) -> BTreeSet<String> {
    let mut paths = Vec::new();
    files(folder, &mut paths);
    let mut names = BTreeSet::new();
    for path in paths {
        let text = std::fs::read_to_string(&path).unwrap_or_default();
        for word in words {
            for rest in text.split(word).skip(1) {
                let rest = rest.trim_start().trim_start_matches('"');
                let is_of_name = |letter: char| letter.is_ascii_lowercase() || letter == '_';
                let end = rest
                    .find(|letter| !is_of_name(letter))
                    .unwrap_or(rest.len());
                let name = rest[..end].trim_end_matches("_bucket");
                if name.starts_with("binnacle_") {
                    names.insert(name.to_owned());
                }
            }
        }
    }
    names
}

#[test]
fn every_metric_is_described_and_those_of_dashboards_and_alerts_exist() {
    let described = names_after(
        &[
            "describe_counter!(",
            "describe_gauge!(",
            "describe_histogram!(",
        ],
        &root().join("server/src/health"),
    );
    let mut used = BTreeSet::new();
    for part in [
        "src",
        "platform/src",
        "fleet/src",
        "orders/src",
        "planning/src",
    ] {
        let folder = root().join("server").join(part);
        used.extend(names_after(
            &[" counter!(", " gauge!(", " histogram!("],
            &folder,
        ));
    }
    assert_eq!(described, used);
    for part in ["prometheus", "grafana"] {
        let folder = root().join("packaging").join(part);
        // A name is behind a bracket, a blank or the begin of an expression.
        let shown = names_after(&["(", " ", "\""], &folder);
        assert!(!shown.is_empty());
        let unknown: Vec<&String> = shown.difference(&described).collect();
        assert!(unknown.is_empty(), "{part}: {unknown:?}");
    }
}
