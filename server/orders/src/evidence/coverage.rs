//! Coverage of the adjuster's and the firm's signature over the record's SHA-256: the record, what is
//! made from it, and the log up to the entry it names.
//!
//! Invariant: a file without coverage is reported as such, or as a problem.

use super::archive::{LogHead, Manifest};
use super::findings::Findings;
use super::sheets::{predicted_csv, record_pdf};
use serde_json::Value;
use std::collections::BTreeMap;

/// Length of the log at completion, by the record.
pub(super) fn log_head(files: &BTreeMap<String, Vec<u8>>) -> Option<LogHead> {
    let record: Value = serde_json::from_slice(files.get("record.json")?).ok()?;
    serde_json::from_value(record["log"].clone()).ok()
}

/// Compares derived files with the record, and reports the record's coverage of an archive with
/// this number of signatures.
pub(super) fn report_coverage(
    manifest: &Manifest,
    files: &BTreeMap<String, Vec<u8>>,
    signatures: usize,
    found: &mut Findings,
) {
    check_derived_files(manifest, files, found);
    let entries = manifest.log.entries;
    let Some(head) = log_head(files) else {
        found
            .problems
            .push("record.json does not name the log".to_owned());
        return;
    };
    let of_the_record = |name: &&String| {
        let number = name.get("photos/".len()..).and_then(|rest| rest.get(..4));
        let number = number.and_then(|number| number.parse::<i64>().ok());
        number.is_some_and(|number| number <= head.entries)
    };
    let photos = files.keys().filter(|name| name.starts_with("photos/"));
    let (within, later): (Vec<&String>, Vec<&String>) = photos.partition(of_the_record);
    let mut covers = vec!["record.json".to_owned(), "predicted.csv".to_owned()];
    covers.push("record.pdf".to_owned());
    covers.extend(within.into_iter().cloned());
    found.facts.push(format!(
        "{} {} and the log's entries 1 to {}",
        if signatures > 0 {
            "the adjuster's sign-off, and the signature by a key, cover"
        } else {
            "the adjuster's sign-off covers"
        },
        covers.join(", "),
        head.entries
    ));
    let mut uncovered: Vec<String> = later.into_iter().cloned().collect();
    if entries > head.entries {
        uncovered.push(format!("the log's entries from {}", head.entries + 1));
    }
    if !uncovered.is_empty() {
        found.facts.push(format!(
            "{} covers {}: they were written with the record or after it",
            match &manifest.seal {
                Some(_) => "only the server's signature",
                None => "no signature",
            },
            uncovered.join(", ")
        ));
    }
    if files.get("README.txt").map(Vec::as_slice) != Some(super::README.as_bytes()) {
        found.facts.push(
            "README.txt differs from this version's; it is not part of the evidence".to_owned(),
        );
    }
}

/// Compares what is made from the record with what this version makes from it. Another version
/// draws otherwise; its hash is in the manifest that the server signed.
fn check_derived_files(
    manifest: &Manifest,
    files: &BTreeMap<String, Vec<u8>>,
    found: &mut Findings,
) {
    let version = env!("CARGO_PKG_VERSION");
    let is_of_this_version = manifest.made_by.as_deref() == Some(version);
    let text = files
        .get("record.json")
        .map(|bytes| std::str::from_utf8(bytes));
    let Some(Ok(text)) = text else {
        // A missing or unreadable record is reported by the check against the log.
        return;
    };
    let made = [
        ("predicted.csv", predicted_csv(text).map(String::into_bytes)),
        ("record.pdf", record_pdf(text)),
    ];
    for (name, made) in made {
        let is_so = made.is_ok_and(|made| files.get(name) == Some(&made));
        if !is_so && is_of_this_version {
            found.wrong(format!("{name} is not what is made from record.json"));
        } else if !is_so {
            found.facts.push(format!(
                "{name} differs from what version {version} makes from record.json: another \
                 version made it; the file that was signed is record.json"
            ));
        }
    }
}
