//! Batches sent as short-burst messages.

use crate::run;
use binnacle_compass::sample::Sample;
use binnacle_fleet::ingest::{ImportResult, IncompleteBatch, ShortBurst, import_messages};
use binnacle_platform::ids::VesselId;
use binnacle_server_testing::on_both;
use binnacle_server_testing::program::assert_refused;
use binnacle_server_testing::{Ship, TestServer, frame, passage};
use binnacle_wire::burst::{read_ack, split};
use serde_json::json;
use tempfile::TempDir;
use uuid::Uuid;

on_both!(
    messages_are_reassembled_into_batches_stored_once,
    an_invalid_message_does_not_block_the_others,
    other_bytes_under_a_stored_number_are_refused,
);

const DAY: &str = "2026-11-20T00:00:00Z";

/// Number of samples that do not fit in one message.
fn long_passage(ship: &Ship) -> Vec<Sample> {
    let lengths = (100..1_500).step_by(100);
    let passages = lengths.map(|samples| passage("2026-11-01T00:00:00Z", samples));
    let mut long = passages.filter(|p| split(&frame(ship.stream, 1, p)).unwrap().len() > 2);
    long.next().unwrap()
}

async fn import_as_files(server: &TestServer, ship: &Ship, messages: &[Vec<u8>]) -> ImportResult {
    let vessel = VesselId(ship.id.parse().unwrap());
    let named = messages.iter().zip(1..);
    let named: Vec<_> = named
        .map(|(bytes, n)| ShortBurst {
            name: format!("{n}.sbd"),
            bytes: bytes.clone(),
        })
        .collect();
    let now = server.app.clock.now().into();
    import_messages(&server.app.db, vessel, &named, now)
        .await
        .unwrap()
}

async fn messages_are_reassembled_into_batches_stored_once(server: TestServer) {
    let ada = server.admin("ada").await;
    let nao = server.ship(&ada, "Nao").await;
    let passage_1 = long_passage(&nao);
    let first = split(&frame(nao.stream, 1, &passage_1)).unwrap();
    let second = split(&frame(nao.stream, 2, &passage("2026-11-21T00:00:00Z", 3))).unwrap();
    let mut messages = [second, first].concat();
    messages.reverse();
    let missing = messages.pop().unwrap();
    let imported = import_as_files(&server, &nao, &messages).await;
    assert_eq!((imported.stored, imported.repeated), (1, 0));
    assert!(imported.incomplete.is_empty() && imported.refused.is_empty());
    assert_eq!(
        read_ack(&imported.acknowledgements[0].bytes)
            .unwrap()
            .contiguous_seq,
        1
    );
    messages.push(missing);
    let imported = import_as_files(&server, &nao, &messages).await;
    assert_eq!((imported.stored, imported.repeated), (1, 1));
    assert_eq!(
        read_ack(&imported.acknowledgements[0].bytes)
            .unwrap()
            .contiguous_seq,
        2
    );
    // The same batch over the ordinary link.
    let response = nao.put(1, &passage_1).await.good();
    assert_eq!(response["contiguous_seq"], 2);
    let streams = ada.get(&nao.path("/agents")).await.good();
    let samples = passage_1.len() + 3;
    assert_eq!(streams["items"][0]["samples"], samples);
    let tally = json!({ "accepted": samples * 60 });
    assert_eq!(streams["items"][0]["tally"], tally);
    assert_eq!(server.work().await.len(), 1, "it is analysed");
    server.finish().await;
}

async fn an_invalid_message_does_not_block_the_others(server: TestServer) {
    let ada = server.admin("ada").await;
    let nao = server.ship(&ada, "Nao").await;
    let other = server.ship(&ada, "Arrano").await;
    let mut messages = split(&frame(other.stream, 1, &passage(DAY, 3))).unwrap();
    messages.push(b"AT+SBDIX".to_vec());
    messages.extend(split(&frame(nao.stream, 1, &passage(DAY, 3))).unwrap());
    let day = split(&frame(nao.stream, 2, &long_passage(&nao))).unwrap();
    messages.push(day[0].clone());
    let imported = import_as_files(&server, &nao, &messages).await;
    assert_eq!(imported.stored, 1);
    let refused: Vec<&str> = imported
        .refused
        .iter()
        .map(|r| r.message.as_str())
        .collect();
    assert_eq!(refused, ["1.sbd", "2.sbd"]);
    let waits = IncompleteBatch {
        seq: 2,
        messages: 1,
        of: day.len(),
    };
    assert_eq!(imported.incomplete, [waits]);
    let streams = ada.get(&other.path("/agents")).await.good();
    assert_eq!(streams["items"][0]["batches"], 0);
    server.finish().await;
}

async fn other_bytes_under_a_stored_number_are_refused(server: TestServer) {
    let ada = server.admin("ada").await;
    let nao = server.ship(&ada, "Nao").await;
    nao.put(1, &passage(DAY, 6)).await.good();
    let messages = split(&frame(nao.stream, 1, &passage(DAY, 5))).unwrap();
    let imported = import_as_files(&server, &nao, &messages).await;
    assert_eq!(imported.refused.len(), 1);
    let streams = ada.get(&nao.path("/agents")).await.good();
    assert_eq!(streams["items"][0]["samples"], 6);
    server.finish().await;
}

#[test]
fn an_unreadable_file_stops_the_command_before_anything_is_stored() {
    let folder = TempDir::new().unwrap();
    let vessel = Uuid::from_u128(1).to_string();
    let refused = run(folder.path(), &["bursts", "--vessel", &vessel, "no.sbd"]);
    assert_refused(&refused, &["no.sbd"]);
    assert!(!folder.path().join("binnacle.db").exists());
}

#[test]
fn a_damaged_message_is_named_and_sets_the_exit_code() {
    let folder = TempDir::new().unwrap();
    std::fs::write(folder.path().join("1.sbd"), b"\xb1 damaged").unwrap();
    let vessel = Uuid::from_u128(1).to_string();
    let output = run(folder.path(), &["bursts", "--vessel", &vessel, "1.sbd"]);
    assert_eq!(output.status.code(), Some(2));
    let errors = String::from_utf8_lossy(&output.stderr);
    assert!(errors.contains("1.sbd: the message is damaged"), "{errors}");
    let result: serde_json::Value = serde_json::from_slice(&output.stdout).unwrap();
    assert_eq!(
        (&result["stored"], &result["refused"][0]["message"]),
        (&json!(0), &json!("1.sbd"))
    );
}
