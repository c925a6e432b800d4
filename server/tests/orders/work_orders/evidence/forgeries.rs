//! Forgeries of evidence, by someone who can do all but know the server's key.

use binnacle_orders::evidence;
use binnacle_orders::work_orders::sha256_hex;
use binnacle_platform::signing_keys::PublishedKey;
use binnacle_server_testing::work_orders::hex;
use ring::signature::{Ed25519KeyPair, KeyPair};
use serde_json::{Value, json};
use std::collections::BTreeMap;
use std::io::{Cursor, Read, Write};
use uuid::Uuid;
use zip::write::SimpleFileOptions;
use zip::{CompressionMethod, ZipArchive, ZipWriter};

/// Returns the files of an archive.
pub(super) fn unpack(bytes: &[u8]) -> BTreeMap<String, Vec<u8>> {
    let mut archive = ZipArchive::new(Cursor::new(bytes)).unwrap();
    (0..archive.len())
        .map(|index| {
            let mut file = archive.by_index(index).unwrap();
            let name = file.name().unwrap().into_owned();
            let mut content = Vec::new();
            file.read_to_end(&mut content).unwrap();
            (name, content)
        })
        .collect()
}

/// Packs files, as anyone may.
pub(super) fn pack(files: &BTreeMap<String, Vec<u8>>) -> Vec<u8> {
    let mut writer = ZipWriter::new(Cursor::new(Vec::new()));
    let options = SimpleFileOptions::default().compression_method(CompressionMethod::Deflated);
    for (name, content) in files {
        writer.start_file(name.as_str(), options).unwrap();
        writer.write_all(content).unwrap();
    }
    writer.finish().unwrap().into_inner()
}

/// Signs text as a server would, by a key that none has published.
fn forged_seal(text: &str) -> Value {
    let key = Ed25519KeyPair::from_seed_unchecked(&[9; 32]).unwrap();
    json!({
        "key": hex(key.public_key().as_ref()),
        "signature": hex(key.sign(text.as_bytes()).as_ref()),
    })
}

/// Signs the log and the manifest again, as a forger would who can do all but know the server's
/// key.
fn reseal(files: &mut BTreeMap<String, Vec<u8>>) {
    let mut manifest: Value = serde_json::from_slice(&files["manifest.json"]).unwrap();
    let log = String::from_utf8(files["entries.ndjson"].clone()).unwrap();
    let seals = String::from_utf8(files["seals.ndjson"].clone()).unwrap();
    let mut seals = seals.lines();
    let (mut lines, mut last) = (Vec::new(), Value::Null);
    for (index, line) in log.lines().enumerate() {
        let entry: Value = serde_json::from_str(line).unwrap();
        let before: Value = seals
            .next()
            .map_or(Value::Null, |line| serde_json::from_str(line).unwrap());
        let hash = match &entry["withheld_sha256"] {
            Value::Null => json!(sha256_hex(line.as_bytes())),
            withheld => withheld.clone(),
        };
        let readers = before["readers"].as_str().unwrap_or("parties");
        let text = json!({
            "what": "entry of a work order", "order": manifest["order"], "seq": index + 1,
            "sha256": hash, "readers": readers,
        });
        let sealed = json!({
            "seq": index + 1, "sha256": hash, "readers": readers,
            "seal": forged_seal(&text.to_string()),
        });
        lines.push(sealed.to_string());
        last = hash;
    }
    manifest["log"] = json!({ "entries": lines.len(), "last_sha256": last });
    let text = format!("{}\n", lines.join("\n"));
    files.insert("seals.ndjson".to_owned(), text.into_bytes());
    manifest["files"] = files
        .iter()
        .filter(|(name, _)| *name != "manifest.json")
        .map(|(name, content)| (name.clone(), json!(sha256_hex(content))))
        .collect();
    manifest["seal"] = json!("evidence of a work order");
    manifest["seal"] = forged_seal(&manifest.to_string());
    files.insert(
        "manifest.json".to_owned(),
        manifest.to_string().into_bytes(),
    );
}

/// Returns the problems of files, whose signatures a forger has made.
pub(super) fn problems_of_forged(files: &BTreeMap<String, Vec<u8>>) -> Vec<String> {
    evidence::verify(&pack(files), None).problems
}

/// Replaces a file and signs all again, as a forger would.
pub(super) fn forge(files: &mut BTreeMap<String, Vec<u8>>, name: &str, content: Vec<u8>) {
    files.insert(name.to_owned(), content);
    reseal(files);
}

/// Tries every forgery with a correct manifest.
pub(super) fn check_forgeries(files: &BTreeMap<String, Vec<u8>>) {
    // A changed file with a correct manifest is found by the log,
    for name in files
        .keys()
        .filter(|name| name.starts_with("photos/") || *name == "record.json")
    {
        let mut forged = files.clone();
        let mut content = files[name].clone();
        content.push(b' ');
        forge(&mut forged, name, content);
        let problems = problems_of_forged(&forged);
        assert_eq!(problems.len(), 1, "{name}: {problems:?}");
    }
    // a changed drawing by the record,
    for (name, content) in [
        (
            "predicted.csv",
            b"place,compass_deg,predicted_deviation_deg,band95_deg\n".to_vec(),
        ),
        (
            "record.pdf",
            b"%PDF-1.7 CERTIFICATE OF ADJUSTMENT\n".to_vec(),
        ),
    ] {
        let mut forged = files.clone();
        forge(&mut forged, name, content);
        let problems = problems_of_forged(&forged);
        assert_eq!(problems.len(), 1, "{name}: {problems:?}");
        assert!(problems[0].starts_with(name), "{problems:?}");
    }
    // an added file by the form of the archive,
    for name in ["certificate.pdf", "photos/0099.png"] {
        let mut forged = files.clone();
        forge(&mut forged, name, b"CERTIFICATE".to_vec());
        let problems = problems_of_forged(&forged);
        assert_eq!(problems, [format!("{name} is not part of this evidence")]);
    }
    // a removed log line by its chain. Without the completion nothing is evidence.
    let log = String::from_utf8(files["entries.ndjson"].clone()).unwrap();
    let lines: Vec<&str> = log.lines().collect();
    let completion = lines
        .iter()
        .position(|line| line.contains(r#""kind":"completion""#));
    for left_out in 0..=completion.unwrap() {
        let mut kept = lines.clone();
        kept.remove(left_out);
        let mut forged = files.clone();
        forge(&mut forged, "entries.ndjson", kept.join("\n").into_bytes());
        let problems = problems_of_forged(&forged);
        assert!(!problems.is_empty(), "without line {}", left_out + 1);
    }
}

/// Returns the archive with two entries of one name: packs the file under another name
/// of the same length, and renames it in the bytes.
fn with_duplicate_entry(files: &BTreeMap<String, Vec<u8>>, name: &str, content: &[u8]) -> Vec<u8> {
    let stand_in = "x".repeat(name.len());
    let mut more = files.clone();
    more.insert(stand_in.clone(), content.to_vec());
    let mut bytes = pack(&more);
    let stands_at = |bytes: &[u8]| {
        let mut places = bytes.windows(name.len());
        places.position(|found| found == stand_in.as_bytes())
    };
    while let Some(at) = stands_at(&bytes) {
        bytes[at..at + name.len()].copy_from_slice(name.as_bytes());
    }
    bytes
}

/// Checks that a repeated name is found, and that a comment is not.
pub(super) fn check_data_beside_files(files: &BTreeMap<String, Vec<u8>>, keys: &[PublishedKey]) {
    let whole = pack(files);
    assert_eq!(evidence::verify(&whole, Some(keys)).problems, [""; 0]);
    for content in [b"%PDF-1.7 CERTIFICATE".as_slice(), &files["record.pdf"]] {
        let twice = with_duplicate_entry(files, "record.pdf", content);
        let problems = evidence::verify(&twice, Some(keys)).problems;
        assert!(
            problems.iter().any(|problem| problem.contains("one name")),
            "{problems:?}"
        );
    }
    let mut commented = whole;
    let length = commented.len() - 2;
    commented[length] = 4;
    commented.extend(b"seal");
    assert_eq!(evidence::verify(&commented, Some(keys)).problems, [""; 0]);
}

/// Returns the files with a changed log, its chain and the manifest corrected.
fn with_changed_log(
    files: &BTreeMap<String, Vec<u8>>,
    change: &dyn Fn(&mut Vec<Value>),
) -> BTreeMap<String, Vec<u8>> {
    let text = String::from_utf8(files["entries.ndjson"].clone()).unwrap();
    let texts: Vec<&str> = text.lines().collect();
    let entries = texts.iter().map(|line| serde_json::from_str(line).unwrap());
    let entries: Vec<Value> = entries.collect();
    let mut changed = entries.clone();
    change(&mut changed);
    let (mut lines, mut previous) = (Vec::new(), Value::Null);
    for (index, mut entry) in changed.into_iter().enumerate() {
        entry["previous_sha256"] = previous;
        let line = match entries.get(index) {
            Some(same) if *same == entry => texts[index].to_owned(),
            _ => entry.to_string(),
        };
        previous = json!(sha256_hex(line.as_bytes()));
        lines.push(line);
    }
    let mut forged = files.clone();
    let log = format!("{}\n", lines.join("\n"));
    forge(&mut forged, "entries.ndjson", log.into_bytes());
    forged
}

/// Checks that what a forger with a key of its own writes is found by the published keys alone, where
/// nothing contradicts it.
pub(super) fn check_forged_facts(files: &BTreeMap<String, Vec<u8>>, keys: &[PublishedKey]) {
    let with = |change: &dyn Fn(&mut Vec<Value>)| {
        let forged = pack(&with_changed_log(files, change));
        let problems = evidence::verify(&forged, Some(keys)).problems;
        let unknown = "has published no key";
        assert!(
            problems.iter().any(|problem| problem.contains(unknown)),
            "{problems:?}"
        );
        evidence::verify(&forged, None)
    };
    let found = with(&|log| {
        let mut entry = log.last().unwrap().clone();
        entry["seq"] = json!(log.len() + 1);
        entry["kind"] = json!("verification");
        entry["content"] = json!({ "words": "30 headings agree" });
        log.push(entry);
    });
    assert_eq!(found.problems, Vec::<String>::new());
    let fact = "the log says, and the server signed it: at sea, 30 headings agree";
    assert!(found.facts.iter().any(|found| found == fact), "{found:?}");
    let found = with(&|log| {
        log.last_mut().unwrap()["content"]["key"] = json!({
            "id": Uuid::nil(), "name": "Head office", "firm_id": Uuid::nil(),
            "firm_name": "Lloyd's",
        });
    });
    assert_eq!(found.problems, Vec::<String>::new());
    let fact = "the server signed it: Lloyd's had registered it as \"Head office\"";
    assert!(
        found.facts.iter().any(|found| found.contains(fact)),
        "{found:?}"
    );
    // One signature by this key fits every text.
    let found = with(&|log| {
        let content = &mut log.last_mut().unwrap()["content"];
        content["public_key"] = json!(format!("01{}", "00".repeat(31)));
        content["signature"] = json!(format!("01{}", "00".repeat(63)));
    });
    assert_eq!(found.problems.len(), 1, "{found:?}");
    assert!(found.problems[0].contains("small order"), "{found:?}");
    // The record names the person who completed it too.
    let found = with(&|log| {
        let mut entries = log.iter_mut();
        let completion = entries.find(|entry| entry["kind"] == "completion");
        completion.unwrap()["content"]["adjuster_name"] = json!("A. N. Other");
    });
    assert_eq!(found.problems.len(), 1, "{found:?}");
    assert!(found.problems[0].contains("another adjuster"), "{found:?}");
}
