//! Check of an archive by its own content.

use super::archive::{LogHead, Manifest};
use super::coverage::{self, report_coverage};
use super::findings::Findings;
use super::seals::{ReadLine, check_seals};
use crate::work_orders::log::canonical_json::sha256_hex;
use crate::work_orders::payload::photograph::Photo;
use crate::work_orders::payload::signed_record::{Completion, RecordedSignature};
use binnacle_platform::signing_keys::PublishedKey;
use serde::de::DeserializeOwned;
use serde_json::Value;
use std::collections::BTreeMap;
use std::io::{Cursor, Read};
use zip::ZipArchive;

/// Largest evidence of one adjustment, unpacked, bytes.
const MAX_ARCHIVE_BYTES: u64 = 1 << 30;

/// Newest form of the manifest that is known.
const VERSION: u32 = 2;

/// Files of every archive; the log names the photographs.
const FIXED_FILES: [&str; 6] = [
    "README.txt",
    "entries.ndjson",
    "manifest.json",
    "predicted.csv",
    "record.json",
    "record.pdf",
];

/// Checks an archive, against the keys that the server published if they are given. How it is
/// packed does not matter.
pub fn verify(bytes: &[u8], keys: Option<&[PublishedKey]>) -> Findings {
    let mut found = Findings::default();
    let files = match unpack(bytes, &mut found) {
        Ok(files) => files,
        Err(problem) => {
            found.wrong(problem);
            return found;
        }
    };
    let manifest: Option<Manifest> = match files
        .get("manifest.json")
        .map(|b| serde_json::from_slice(b))
    {
        None => {
            found.wrong("manifest.json is missing");
            None
        }
        Some(Err(error)) => {
            found.wrong(format!("manifest.json: {error}"));
            None
        }
        Some(Ok(manifest)) => Some(manifest),
    };
    let Some(manifest) = manifest else {
        return found;
    };
    if manifest.version > VERSION {
        found.wrong(format!(
            "manifest.json is of version {}: a newer release of binnacle-server can check it",
            manifest.version
        ));
        return found;
    }
    check_hashes(&manifest, &files, &mut found);
    let lines = check_log(&manifest, &files, &mut found);
    check_seals(&manifest, &files, &lines, keys, &mut found);
    found
}

fn unpack(bytes: &[u8], found: &mut Findings) -> Result<BTreeMap<String, Vec<u8>>, String> {
    let mut archive =
        ZipArchive::new(Cursor::new(bytes)).map_err(|error| format!("not an archive: {error}"))?;
    let mut files = BTreeMap::new();
    let mut left = MAX_ARCHIVE_BYTES;
    for index in 0..archive.len() {
        let file = archive.by_index(index);
        let mut file = file.map_err(|error| format!("file {}: {error}", index + 1))?;
        let name = file.name().map(std::borrow::Cow::into_owned);
        let name = name.map_err(|error| format!("file {}: {error}", index + 1))?;
        let mut content = Vec::new();
        // Whatever the headers say of sizes.
        match file.by_ref().take(left).read_to_end(&mut content) {
            Err(error) => found.wrong(format!("{name}: {error}")),
            Ok(read) => left -= read as u64,
        }
        if left == 0 {
            return Err("it is larger than 1 GiB when unpacked".to_owned());
        }
        files.insert(name, content);
    }
    if archive.has_duplicate_names() {
        found.wrong(
            "it contains files of one name more than once: an unpacker may show other content \
                than is checked here",
        );
    }
    Ok(files)
}

fn check_hashes(manifest: &Manifest, files: &BTreeMap<String, Vec<u8>>, found: &mut Findings) {
    for (name, sha256) in &manifest.files {
        match files.get(name) {
            None => found.wrong(format!("{name} is missing")),
            Some(content) if sha256_hex(content) != *sha256 => {
                found.wrong(format!("{name} differs from the manifest"));
            }
            Some(_) => {}
        }
    }
    for name in files.keys() {
        if name != "manifest.json" && !manifest.files.contains_key(name) {
            found.wrong(format!("{name} is not in the manifest"));
        }
    }
}

/// Checks the log, and what it names. Returns its lines.
fn check_log(
    manifest: &Manifest,
    files: &BTreeMap<String, Vec<u8>>,
    found: &mut Findings,
) -> Vec<ReadLine> {
    let text = files
        .get("entries.ndjson")
        .map(|text| std::str::from_utf8(text));
    let Some(Ok(text)) = text else {
        found.wrong("entries.ndjson is missing, or is not text");
        return Vec::new();
    };
    let by = match &manifest.seal {
        Some(_) => "the log says, and the server signed it:",
        None => "the log says, and no signature covers it:",
    };
    let mut lines: Vec<ReadLine> = Vec::new();
    let mut previous: Option<String> = None;
    let mut signed = 0;
    let mut withheld: Vec<String> = Vec::new();
    let mut known: Vec<String> = FIXED_FILES.map(str::to_owned).to_vec();
    known.extend(manifest.seal.iter().map(|_| "seals.ndjson".to_owned()));
    let mut completed: Option<Completion> = None;
    let mut entries: i64 = 0;
    let recorded = coverage::log_head(files);
    for line in text.lines() {
        entries += 1;
        let at = format!("entries.ndjson, line {entries}");
        let (entry, read) = read_line(line, &at, found);
        if !entry.is_null() {
            check_place(&entry, entries, previous.as_deref(), manifest, &at, found);
        }
        match entry["kind"].as_str() {
            Some("completion") => {
                completed = content(&entry, &at, found);
                check_record(completed.as_ref(), files, found);
            }
            Some("photo") => known.extend(check_photo(&entry, entries, &at, files, found)),
            Some("signature") => {
                signed += check_signature(&entry, completed.as_ref(), &at, by, found);
            }
            Some("verification") => {
                let words = entry["content"]["words"].as_str().unwrap_or_default();
                // The record was made before the vessel sailed.
                found.facts.push(format!("{by} at sea, {words}"));
            }
            _ => {}
        }
        if read.is_withheld {
            withheld.push(entries.to_string());
        }
        previous = Some(read.sha256.clone());
        lines.push(read);
        if let Some(head) = recorded.as_ref().filter(|head| head.entries == entries)
            && previous.as_ref() != Some(&head.last_sha256)
        {
            found.wrong(format!("{at} is not the one that record.json names"));
        }
    }
    for name in files.keys().filter(|name| !known.contains(name)) {
        found.wrong(format!("{name} is not part of this evidence"));
    }
    if !withheld.is_empty() {
        found.facts.push(format!(
            "entries {} are withheld: their content cannot be checked here",
            withheld.join(", ")
        ));
    }
    if completed.is_none() {
        found.wrong("the log has no completion");
    }
    let head = LogHead {
        entries,
        last_sha256: previous.unwrap_or_default(),
    };
    if manifest.log != head {
        found.wrong("the log does not end where the manifest says");
    }
    found.facts.push(format!(
        "the log has {entries} entries, the last with SHA-256 {}: ask the server whether more \
            followed",
        head.last_sha256
    ));
    // A record other than the signed one covers nothing.
    let text = files.get("record.json").map(|text| sha256_hex(text));
    if completed.is_some_and(|completed| Some(completed.record_sha256) == text) {
        report_coverage(manifest, files, signed, found);
    }
    if signed == 0 {
        found
            .facts
            .push("no firm's key has signed the record".to_owned());
    }
    lines
}

/// Reads a line of the log: the entry, null if it is not JSON, and what its seal is checked by.
fn read_line(line: &str, at: &str, found: &mut Findings) -> (Value, ReadLine) {
    let entry: Value = serde_json::from_str(line).unwrap_or_else(|_| {
        found.wrong(format!("{at} is not JSON"));
        Value::Null
    });
    let withheld = entry["withheld_sha256"].as_str();
    let read = ReadLine {
        sha256: withheld.map_or_else(|| sha256_hex(line.as_bytes()), str::to_owned),
        at: serde_json::from_value(entry["at"].clone()).ok(),
        is_withheld: withheld.is_some(),
    };
    (entry, read)
}

/// Checks that an entry is the next one of its order's log.
fn check_place(
    entry: &Value,
    number: i64,
    previous: Option<&str>,
    manifest: &Manifest,
    at: &str,
    found: &mut Findings,
) {
    if entry["previous_sha256"].as_str() != previous {
        found.wrong(format!("{at} does not follow the line before it"));
    }
    if entry["seq"] != number {
        found.wrong(format!("{at} is not the entry of that number"));
    }
    if entry["order"] != manifest.order.as_str() {
        found.wrong(format!("{at} is of another order"));
    }
}

fn content<T: DeserializeOwned>(entry: &Value, at: &str, found: &mut Findings) -> Option<T> {
    let read = serde_json::from_value(entry["content"].clone());
    read.map_err(|error| found.wrong(format!("{at}: {error}")))
        .ok()
}

fn check_record(
    completed: Option<&Completion>,
    files: &BTreeMap<String, Vec<u8>>,
    found: &mut Findings,
) {
    let Some(completed) = completed else {
        return;
    };
    match files.get("record.json") {
        None => found.wrong("record.json is missing"),
        Some(text) if sha256_hex(text) != completed.record_sha256 => {
            found.wrong("record.json is not the one that the adjuster signed");
        }
        Some(text) => {
            let record: Value = serde_json::from_slice(text).unwrap_or_default();
            let adjuster = &record["adjuster"];
            if adjuster["name"] != completed.adjuster_name
                || adjuster["licence"] != completed.adjuster_licence
            {
                found.wrong("the log's completion names another adjuster than record.json");
            }
            found.facts.push(format!(
                "{}, licence {}, completed it; record SHA-256 {}",
                completed.adjuster_name, completed.adjuster_licence, completed.record_sha256
            ));
        }
    }
}

/// Checks a photograph; returns its file name.
fn check_photo(
    entry: &Value,
    number: i64,
    at: &str,
    files: &BTreeMap<String, Vec<u8>>,
    found: &mut Findings,
) -> Option<String> {
    let photo = content::<Photo>(entry, at, found)?;
    let name = photo.file(number);
    match files.get(&name) {
        None => found.wrong(format!("{name} is missing")),
        Some(bytes) if sha256_hex(bytes) != photo.sha256 => {
            found.wrong(format!("{name} is not the photograph that was taken"));
        }
        Some(_) => {}
    }
    Some(name)
}

/// Returns the number of valid signatures in an entry: one or none.
fn check_signature(
    entry: &Value,
    completed: Option<&Completion>,
    at: &str,
    recorded: &str,
    found: &mut Findings,
) -> usize {
    let Some(by) = content::<RecordedSignature>(entry, at, found) else {
        return 0;
    };
    let Some(completed) = completed else {
        found.wrong(format!("{at}: a signature before the completion"));
        return 0;
    };
    if let Err(error) = by.signature.checked(&completed.record_sha256) {
        found.wrong(format!("{at}: {error}"));
        return 0;
    }
    let public_key = &by.signature.public_key;
    found.facts.push(match &by.key {
        Some(key) => format!(
            "signed by the key {public_key}; {recorded} {} had registered it as {:?}. Ask the \
                firm whether the key is its own",
            key.firm_name, key.name
        ),
        None => format!(
            "signed by the key {public_key}; {recorded} no firm had registered it. Ask the firm \
                whether the key is its own"
        ),
    });
    1
}
