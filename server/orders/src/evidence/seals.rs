//! Check of the server's signatures over an archive and over the entries of its log.
//!
//! Invariant: an archive that says of itself that servers sign passes with valid signatures alone.

use super::archive::Manifest;
use super::findings::Findings;
use crate::work_orders::log::seal::{PARTIES, SealedEntry};
use binnacle_platform::signing_keys::{PublishedKey, Seal};
use binnacle_platform::time::Time;
use serde_json::Value;
use std::collections::{BTreeMap, BTreeSet};

/// Greatest difference of the clocks of two servers, seconds.
const CLOCKS_APART_S: f64 = 300.0;

/// Line of a log, as its own check has read it.
pub(super) struct ReadLine {
    /// SHA-256 of the original line, hexadecimal.
    pub(super) sha256: String,
    /// Time of writing; none of a line that is withheld.
    pub(super) at: Option<Time>,
    /// True if its content is withheld.
    pub(super) is_withheld: bool,
}

/// Checks all signatures of the server, against the keys that it published if they are given.
pub(super) fn check_seals(
    manifest: &Manifest,
    files: &BTreeMap<String, Vec<u8>>,
    lines: &[ReadLine],
    keys: Option<&[PublishedKey]>,
    found: &mut Findings,
) {
    let Some(seal) = &manifest.seal else {
        found_unsealed(files, found);
        return;
    };
    let mut used = BTreeSet::from([seal.key.clone()]);
    match manifest.text() {
        Ok(text) => check(seal, &text, "manifest.json", None, keys, found),
        Err(error) => found.wrong(format!("manifest.json: {error}")),
    }
    check_entries(manifest, files, lines, keys, &mut used, found);
    if keys.is_none() {
        let used: Vec<String> = used.into_iter().collect();
        found.facts.push(format!(
            "signed by the server's key {}: compare it with the list that the server publishes, \
             /api/v1/signing-keys, or give that list with --keys",
            used.join(" and ")
        ));
    }
}

/// Reports an archive without the server's signature: one from before servers signed, or one that
/// has lost it.
fn found_unsealed(files: &BTreeMap<String, Vec<u8>>, found: &mut Findings) {
    let record = files.get("record.json");
    let record = record.and_then(|text| serde_json::from_slice::<Value>(text).ok());
    let is_of_old = record.is_some_and(|record| record["log"]["server_key"].is_null());
    if is_of_old {
        found.facts.push(
            "it was made before servers signed: only the server that keeps the log can tell \
             whether its end was cut off"
                .to_owned(),
        );
    } else {
        found.wrong("the server's signature is missing from manifest.json");
    }
}

fn check_entries(
    manifest: &Manifest,
    files: &BTreeMap<String, Vec<u8>>,
    lines: &[ReadLine],
    keys: Option<&[PublishedKey]>,
    used: &mut BTreeSet<String>,
    found: &mut Findings,
) {
    let text = files
        .get("seals.ndjson")
        .map(|text| std::str::from_utf8(text));
    let Some(Ok(text)) = text else {
        found.wrong("seals.ndjson is missing, or is not text");
        return;
    };
    let mut sealed = text.lines();
    let mut unsigned: Vec<String> = Vec::new();
    for (index, line) in lines.iter().enumerate() {
        let number = index as i64 + 1;
        let at = format!("seals.ndjson, line {number}");
        let entry = sealed.next().unwrap_or_default();
        let entry: SealedEntry = match serde_json::from_str(entry) {
            Ok(entry) => entry,
            Err(error) => {
                found.wrong(format!("{at}: {error}"));
                continue;
            }
        };
        if entry.seq != number || entry.sha256 != line.sha256 {
            found.wrong(format!("{at} is not of that entry of the log"));
        }
        let is_readers =
            entry.readers == PARTIES || Some(&entry.readers) == manifest.reader.as_ref();
        if line.is_withheld && is_readers {
            found.wrong(format!(
                "entry {number} is withheld, though the readers of this archive may see it: it \
                 was hidden"
            ));
        }
        match (&entry.seal, entry.text(&manifest.order)) {
            (Some(seal), Ok(text)) => {
                used.insert(seal.key.clone());
                check(seal, &text, &at, line.at, keys, found);
            }
            (Some(_), Err(error)) => found.wrong(format!("{at}: {error}")),
            (None, _) => unsigned.push(number.to_string()),
        }
    }
    if sealed.next().is_some() {
        found.wrong("seals.ndjson has more lines than the log");
    }
    if !unsigned.is_empty() {
        found.facts.push(format!(
            "entries {} were written before servers signed",
            unsigned.join(", ")
        ));
    }
}

/// Checks one signature, and that its key was the server's at the time.
fn check(
    seal: &Seal,
    text: &str,
    called: &str,
    at: Option<Time>,
    keys: Option<&[PublishedKey]>,
    found: &mut Findings,
) {
    if let Err(error) = seal.check(text.as_bytes(), called) {
        found.wrong(format!("{called}: the server's {error}"));
        return;
    }
    let Some(keys) = keys else {
        return;
    };
    let Some(key) = keys.iter().find(|key| key.public_key == seal.key) else {
        found.wrong(format!(
            "{called}: the server has published no key {}",
            seal.key
        ));
        return;
    };
    let was_in_use = |at: Time| {
        at.0.seconds_since(key.created_at.0) > -CLOCKS_APART_S
            && key
                .retired_at
                .is_none_or(|until| at.0.seconds_since(until.0) < CLOCKS_APART_S)
    };
    if at.is_some_and(|at| !was_in_use(at)) {
        found.wrong(format!(
            "{called}: the key {} was not the server's at that time",
            seal.key
        ));
    }
}
