//! Evidence of an order: the log, the photographs, the archive.

use binnacle_orders::evidence;
use binnacle_orders::work_orders::sha256_hex;
use binnacle_platform::signing_keys::{self, PublishedKey, PublishedKeys};
use binnacle_platform::time::Time;
use binnacle_server_testing::on_both;
use binnacle_server_testing::work_orders::Job;
use binnacle_server_testing::work_orders::{PICTURE, hex};
use binnacle_server_testing::{TestServer, client};
use reqwest::Method;
use ring::signature::{Ed25519KeyPair, KeyPair};
use serde_json::{Value, json};
use std::collections::BTreeMap;
use std::io::{Cursor, Read, Write};
use uuid::Uuid;
use zip::write::SimpleFileOptions;
use zip::{CompressionMethod, ZipArchive, ZipWriter};

on_both!(
    each_entry_names_the_hash_of_the_one_before,
    each_entry_is_signed_by_the_server,
    evidence_stays_valid_after_a_rotation_of_keys,
    a_hidden_reading_and_a_lost_end_are_detected,
    only_an_image_is_accepted_as_a_photograph,
    tampered_evidence_is_detected,
    the_record_is_available_in_each_form,
);

async fn each_entry_names_the_hash_of_the_one_before(server: TestServer) {
    let job = Job::begin(&server).await;
    job.complete().await;
    let log = job.person.get(&job.path("/entries")).await.good();
    let entries = log["items"].as_array().unwrap();
    assert!(entries.len() > 4, "{}", entries.len());
    let mut previous = Value::Null;
    for (index, found) in entries.iter().enumerate() {
        assert_eq!(found["seq"], index + 1);
        assert_eq!(found["entry"]["previous_sha256"], previous);
        previous = found["sha256"].clone();
    }
    assert_eq!(job.view_order().await["last_sha256"], previous);
    server.finish().await;
}

async fn the_record_is_available_in_each_form(server: TestServer) {
    let job = Job::begin(&server).await;
    let forms = [
        ("pdf", "application/pdf"),
        ("svg", "image/svg+xml"),
        ("csv", "text/csv; charset=utf-8"),
    ];
    for (form, _) in forms {
        let early = job.person.get(&job.path(&format!("/record.{form}"))).await;
        assert_eq!(early.problem(), "wrong-state", "{form}");
    }
    job.complete().await;
    let mut archive = ZipArchive::new(Cursor::new(job.evidence().await)).unwrap();
    let mut file = |name: &str| {
        let mut bytes = Vec::new();
        archive
            .by_name(name)
            .unwrap()
            .read_to_end(&mut bytes)
            .unwrap();
        bytes
    };
    for (form, kind) in forms {
        let path = job.path(&format!("/record.{form}"));
        let response = job.person.request(Method::GET, &path).send().await.unwrap();
        assert_eq!(response.headers()["content-type"], kind);
        let bytes = response.bytes().await.unwrap();
        match form {
            "pdf" => assert_eq!(bytes, file("record.pdf")),
            "csv" => assert_eq!(bytes, file("predicted.csv")),
            _ => {
                let text = String::from_utf8(bytes.to_vec()).unwrap();
                assert!(text.starts_with("<svg ") && text.ends_with("</svg>\n"));
                // Each sheet has the notice.
                let sheets = text.matches("<g transform").count();
                assert!(sheets > 0, "{text}");
                let says = text.matches("A prediction, not a certificate.").count();
                assert_eq!(says, sheets);
            }
        }
    }
    server.finish().await;
}

async fn only_an_image_is_accepted_as_a_photograph(server: TestServer) {
    let job = Job::begin(&server).await;
    let page = job.post_photo(b"<html><script>alert(1)</script>").await;
    assert_eq!(
        (page.status, page.problem().as_str()),
        (415, "unsupported-media-type")
    );
    let cut_off = job.post_photo(b"\x89PNG\r\n\x1a\n").await;
    assert_eq!(cut_off.problem(), "unsupported-media-type");
    assert!(cut_off.text.contains("truncated"), "{cut_off:?}");
    job.post_photo(PICTURE).await.good();
    let order = job.view_order().await;
    assert_eq!(order["photos"].as_array().unwrap().len(), 1);
    let log = job.person.get(&job.path("/entries?after=1")).await.good();
    let taken = &log["items"][0]["entry"]["content"];
    assert_eq!(
        (&taken["media_type"], &taken["caption"]),
        (&json!("image/jpeg"), &json!("trays"))
    );
    let path = job.path(&format!("/photos/{}", taken["photo"].as_str().unwrap()));
    let request = job.person.request(Method::GET, &path).send().await.unwrap();
    assert_eq!(request.headers()["content-type"], "image/jpeg");
    assert_eq!(request.headers()["content-disposition"], "attachment");
    assert_eq!(request.headers()["x-content-type-options"], "nosniff");
    assert_eq!(request.bytes().await.unwrap(), PICTURE);
    let large = Box::leak(vec![0xFF_u8; 11 * 1024 * 1024].into_boxed_slice());
    assert_eq!(job.post_photo(large).await.status, 413);
    server.finish().await;
}

fn unpack(bytes: &[u8]) -> BTreeMap<String, Vec<u8>> {
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
fn pack(files: &BTreeMap<String, Vec<u8>>) -> Vec<u8> {
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
fn problems_of_forged(files: &BTreeMap<String, Vec<u8>>) -> Vec<String> {
    evidence::verify(&pack(files), None).problems
}

/// Returns the keys that the server publishes to anyone.
async fn published_keys(server: &TestServer) -> Vec<PublishedKey> {
    let url = format!("{}/api/v1/signing-keys", server.url);
    let response = client().get(url).send().await.unwrap();
    response.json::<PublishedKeys>().await.unwrap().items
}

/// Replaces a file and signs all again, as a forger would.
fn forge(files: &mut BTreeMap<String, Vec<u8>>, name: &str, content: Vec<u8>) {
    files.insert(name.to_owned(), content);
    reseal(files);
}

/// Tries every forgery with a correct manifest.
fn check_forgeries(files: &BTreeMap<String, Vec<u8>>) {
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
fn check_data_beside_files(files: &BTreeMap<String, Vec<u8>>, keys: &[PublishedKey]) {
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
fn check_forged_facts(files: &BTreeMap<String, Vec<u8>>, keys: &[PublishedKey]) {
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

async fn tampered_evidence_is_detected(server: TestServer) {
    let job = Job::begin(&server).await;
    job.post_photo(PICTURE).await.good();
    let done = job.complete().await;
    let record_sha256 = done["completion"]["record_sha256"].as_str().unwrap();
    let key = Ed25519KeyPair::from_seed_unchecked(&[7; 32]).unwrap();
    let over = ring::digest::digest(
        &ring::digest::SHA256,
        job.person
            .get(&job.path("/record.json"))
            .await
            .text
            .as_bytes(),
    );
    assert_eq!(hex(over.as_ref()), record_sha256);
    let signature = hex(key.sign(over.as_ref()).as_ref());
    let public_key = hex(key.public_key().as_ref());
    let mut wrong = signature.clone();
    wrong.replace_range(0..2, if &signature[..2] == "00" { "01" } else { "00" });
    let signed = |signature: &str| json!({ "public_key": public_key, "signature": signature });
    assert_eq!(
        job.post("/signatures", &signed(&wrong)).await.problem(),
        "invalid"
    );
    let weak = json!({
        "public_key": format!("01{}", "00".repeat(31)),
        "signature": format!("01{}", "00".repeat(63)),
    });
    let refused = job.post("/signatures", &weak).await;
    assert_eq!(refused.problem(), "invalid");
    assert!(refused.text.contains("small order"), "{refused:?}");
    job.post("/signatures", &signed(&signature)).await.good();

    let whole = job.evidence().await;
    assert_eq!(
        whole,
        job.evidence().await,
        "the same state gives the same bytes"
    );
    let keys = published_keys(&server).await;
    let found = evidence::verify(&whole, Some(&keys));
    assert_eq!(found.problems, Vec::<String>::new());
    assert!(
        found.facts.iter().any(|fact| fact.contains(&public_key)),
        "{found:?}"
    );
    assert!(found.facts.iter().any(|fact| {
        fact.contains("cover record.json, predicted.csv, record.pdf, photos/0002.jpeg")
    }));
    let files = unpack(&whole);
    assert!(String::from_utf8_lossy(&files["README.txt"]).contains("not a certificate"));
    assert!(
        String::from_utf8_lossy(&files["record.json"]).contains("predicted, not a certificate")
    );
    assert!(
        files.keys().any(|name| name.starts_with("photos/")),
        "{:?}",
        files.keys()
    );
    for name in files.keys() {
        let mut without = files.clone();
        without.remove(name);
        assert!(
            !evidence::verify(&pack(&without), None).problems.is_empty(),
            "without {name}"
        );
        let mut changed = files.clone();
        let content = changed.get_mut(name).unwrap();
        // Another digit, so that JSON stays valid; a picture has none.
        let place = content.iter().rposition(u8::is_ascii_digit);
        let byte = &mut content[place.unwrap_or(0)];
        *byte = if *byte == b'7' { b'8' } else { b'7' };
        let problems = evidence::verify(&pack(&changed), None).problems;
        assert!(!problems.is_empty(), "{name} changed");
    }

    check_forgeries(&files);
    check_data_beside_files(&files, &keys);
    check_forged_facts(&files, &keys);
    let no_archive = evidence::verify(b"not an archive", None);
    assert!(!no_archive.problems.is_empty());
    // A photograph after the record is evidence, and is not signed.
    job.post_photo(PICTURE).await.good();
    let found = evidence::verify(&job.evidence().await, Some(&keys));
    assert_eq!(found.problems, Vec::<String>::new());
    let uncovered = found
        .facts
        .iter()
        .find(|fact| fact.starts_with("only the server's signature covers"));
    let entries = String::from_utf8_lossy(&files["entries.ndjson"]);
    let later = format!("photos/{:04}.jpeg", entries.lines().count() + 1);
    assert!(
        uncovered.is_some_and(|fact| fact.contains(&later)),
        "{found:?}"
    );
    server.finish().await;
}

async fn each_entry_is_signed_by_the_server(server: TestServer) {
    let job = Job::begin(&server).await;
    job.complete().await;
    let keys = published_keys(&server).await;
    assert_eq!(keys.len(), 1);
    assert_eq!(keys[0].retired_at, None);
    let log = job.person.get(&job.path("/entries")).await.good();
    for found in log["items"].as_array().unwrap() {
        assert_eq!(found["seal"]["key"], keys[0].public_key, "{found}");
    }
    let record = job.person.get(&job.path("/record.json")).await.good();
    assert_eq!(record["log"]["server_key"], keys[0].public_key);
    server.finish().await;
}

async fn evidence_stays_valid_after_a_rotation_of_keys(server: TestServer) {
    let job = Job::begin(&server).await;
    job.complete().await;
    let before = job.evidence().await;
    server.advance(60.0);
    let mut tx = server.app.db.begin().await.unwrap();
    signing_keys::rotate(&mut tx, server.app.clock.now().into())
        .await
        .unwrap();
    tx.commit().await.unwrap();
    job.post_photo(PICTURE).await.good();
    let after = job.evidence().await;
    let keys = published_keys(&server).await;
    assert_eq!(keys.len(), 2);
    for (when, evidence) in [("before", &before), ("after", &after)] {
        let problems = evidence::verify(evidence, Some(&keys)).problems;
        assert_eq!(problems, [""; 0], "{when}");
        // The list of another server, or of too early a day.
        let problems = evidence::verify(evidence, Some(&keys[..0])).problems;
        assert!(problems[0].contains("has published no key"), "{problems:?}");
    }
    let old = evidence::verify(&after, Some(&keys[..1])).problems;
    assert!(old[0].contains("has published no key"), "{old:?}");
    // A retired key signs nothing that is dated long after.
    let mut retired = keys.clone();
    let year = 365.0 * 86_400.0;
    retired[0].retired_at = Some(Time(keys[0].created_at.0.plus_seconds(-year)));
    let late = evidence::verify(&before, Some(&retired)).problems;
    assert!(
        late[0].contains("was not the server's at that time"),
        "{late:?}"
    );
    server.finish().await;
}

async fn a_hidden_reading_and_a_lost_end_are_detected(server: TestServer) {
    let job = Job::begin(&server).await;
    job.complete().await;
    job.post_photo(PICTURE).await.good();
    let keys = published_keys(&server).await;
    let files = unpack(&job.evidence().await);
    let log = String::from_utf8(files["entries.ndjson"].clone()).unwrap();
    let lines: Vec<&str> = log.lines().collect();
    // A reading as if it were an exchange with another firm.
    let reading = lines
        .iter()
        .position(|line| line.contains(r#""kind":"berth_reading""#))
        .unwrap();
    let entry: Value = serde_json::from_str(lines[reading]).unwrap();
    let hidden = json!({
        "order": entry["order"], "seq": entry["seq"],
        "previous_sha256": entry["previous_sha256"],
        "withheld_sha256": sha256_hex(lines[reading].as_bytes()),
    });
    let hidden = hidden.to_string();
    let mut kept = lines.clone();
    kept[reading] = &hidden;
    let mut forged = files.clone();
    forge(
        &mut forged,
        "entries.ndjson",
        format!("{}\n", kept.join("\n")).into_bytes(),
    );
    let problems = problems_of_forged(&forged);
    assert_eq!(problems.len(), 1, "{problems:?}");
    assert!(problems[0].contains("it was hidden"), "{problems:?}");
    // The last entry with its photograph left out.
    let mut cut = files.clone();
    let without = format!("{}\n", lines[..lines.len() - 1].join("\n"));
    cut.insert("entries.ndjson".to_owned(), without.into_bytes());
    cut.retain(|name, _| !name.starts_with("photos/"));
    let seals = String::from_utf8(files["seals.ndjson"].clone()).unwrap();
    let kept: Vec<&str> = seals.lines().take(lines.len() - 1).collect();
    let kept = format!("{}\n", kept.join("\n"));
    cut.insert("seals.ndjson".to_owned(), kept.into_bytes());
    let mut manifest: Value = serde_json::from_slice(&files["manifest.json"]).unwrap();
    let last = sha256_hex(lines[lines.len() - 2].as_bytes());
    manifest["log"] = json!({ "entries": lines.len() - 1, "last_sha256": last });
    manifest["files"] = cut
        .iter()
        .filter(|(name, _)| *name != "manifest.json")
        .map(|(name, content)| (name.clone(), json!(sha256_hex(content))))
        .collect();
    let put = |cut: &mut BTreeMap<String, Vec<u8>>, manifest: &Value| {
        let text = manifest.to_string().into_bytes();
        cut.insert("manifest.json".to_owned(), text);
    };
    put(&mut cut, &manifest);
    let problems = evidence::verify(&pack(&cut), Some(&keys)).problems;
    assert_eq!(problems.len(), 1, "{problems:?}");
    assert!(
        problems[0].contains("is not this key's signature"),
        "{problems:?}"
    );
    // As if servers did not sign yet.
    manifest["version"] = json!(1);
    for name in ["reader", "made_by", "seal"] {
        manifest.as_object_mut().unwrap().remove(name);
    }
    manifest["files"]
        .as_object_mut()
        .unwrap()
        .remove("seals.ndjson");
    cut.remove("seals.ndjson");
    put(&mut cut, &manifest);
    let problems = evidence::verify(&pack(&cut), None).problems;
    assert_eq!(
        problems,
        ["the server's signature is missing from manifest.json"]
    );
    server.finish().await;
}

/// An archive that the release before servers signed has made.
#[test]
fn an_older_archive_is_still_verified() {
    let found = evidence::verify(include_bytes!("data/evidence-version-1.zip"), Some(&[]));
    assert_eq!(found.problems, [""; 0]);
    let fact = "it was made before servers signed";
    assert!(
        found.facts.iter().any(|found| found.contains(fact)),
        "{found:?}"
    );
}
