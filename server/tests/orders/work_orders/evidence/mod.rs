//! Evidence of an order: the log, the photographs, the archive.

mod forgeries;

use binnacle_orders::evidence;
use binnacle_orders::work_orders::sha256_hex;
use binnacle_platform::signing_keys::{self, PublishedKey, PublishedKeys};
use binnacle_platform::time::Time;
use binnacle_server_testing::on_both;
use binnacle_server_testing::work_orders::Job;
use binnacle_server_testing::work_orders::{PICTURE, hex};
use binnacle_server_testing::{TestServer, client};
use forgeries::{
    check_data_beside_files, check_forged_facts, check_forgeries, forge, pack, problems_of_forged,
    unpack,
};
use reqwest::Method;
use ring::signature::{Ed25519KeyPair, KeyPair};
use serde_json::{Value, json};
use std::collections::BTreeMap;
use std::io::{Cursor, Read};
use zip::ZipArchive;

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
    let record = job.person.get(&job.path("/record.json")).await.good();
    assert_eq!(record["as_found"][0]["dockside"]["pivot"], "sound");
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
                for words in ["As found", "sound: bubble, pivot, gimbals, lubber line"] {
                    assert!(text.contains(words), "{words}: {text}");
                }
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
    let log = job.person.get(&job.path("/entries?after=2")).await.good();
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

/// Returns the keys that the server publishes to anyone.
async fn published_keys(server: &TestServer) -> Vec<PublishedKey> {
    let url = format!("{}/api/v1/signing-keys", server.url);
    let response = client().get(url).send().await.unwrap();
    response.json::<PublishedKeys>().await.unwrap().items
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
        fact.contains("cover record.json, predicted.csv, record.pdf, photos/0003.jpeg")
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
    let found = evidence::verify(include_bytes!("version-1.zip"), Some(&[]));
    assert_eq!(found.problems, [""; 0]);
    let fact = "it was made before servers signed";
    assert!(
        found.facts.iter().any(|found| found.contains(fact)),
        "{found:?}"
    );
}
