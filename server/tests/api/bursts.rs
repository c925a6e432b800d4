//! Batches that came as short-burst messages.

use crate::commands::{assert_refused, run};
use crate::on_both;
use crate::support::{Ship, Shore, frame, passage};
use binnacle_compass::sample::Sample;
use binnacle_fleet::ingest::{ImportResult, IncompleteBatch, import_messages};
use binnacle_platform::ids::VesselId;
use binnacle_wire::burst::{read_ack, split};
use serde_json::json;
use tempfile::TempDir;
use uuid::Uuid;

on_both!(
    messages_become_the_batches_that_they_were_cut_from_and_once,
    what_is_no_message_or_no_batch_of_the_vessel_keeps_nothing_else_back,
    other_bytes_under_a_number_that_is_there_are_refused,
);

const DAY: &str = "2026-11-20T00:00:00Z";

/// More than one message holds.
fn long_passage(ship: &Ship) -> Vec<Sample> {
    let lengths = (100..1_500).step_by(100);
    let passages = lengths.map(|samples| passage("2026-11-01T00:00:00Z", samples));
    let mut long = passages.filter(|p| split(&frame(ship.stream, 1, p)).unwrap().len() > 2);
    long.next().unwrap()
}

async fn brought(shore: &Shore, ship: &Ship, messages: &[Vec<u8>]) -> ImportResult {
    let vessel = VesselId(ship.id.parse().unwrap());
    let named = messages.iter().zip(1..);
    let named: Vec<_> = named
        .map(|(m, n)| (format!("{n}.sbd"), m.clone()))
        .collect();
    let now = shore.app.clock.now().into();
    import_messages(&shore.app.db, vessel, &named, now)
        .await
        .unwrap()
}

async fn messages_become_the_batches_that_they_were_cut_from_and_once(shore: Shore) {
    let ada = shore.admin("ada").await;
    let nao = shore.ship(&ada, "Nao").await;
    let passage_1 = long_passage(&nao);
    let first = split(&frame(nao.stream, 1, &passage_1)).unwrap();
    let second = split(&frame(nao.stream, 2, &passage("2026-11-21T00:00:00Z", 3))).unwrap();
    let mut messages = [second, first].concat();
    messages.reverse();
    let missing = messages.pop().unwrap();
    let imported = brought(&shore, &nao, &messages).await;
    assert_eq!((imported.stored, imported.repeated), (1, 0));
    assert!(imported.incomplete.is_empty() && imported.refused.is_empty());
    assert_eq!(
        read_ack(&imported.acknowledgements[0].1)
            .unwrap()
            .contiguous_seq,
        1
    );
    messages.push(missing);
    let imported = brought(&shore, &nao, &messages).await;
    assert_eq!((imported.stored, imported.repeated), (1, 1));
    assert_eq!(
        read_ack(&imported.acknowledgements[0].1)
            .unwrap()
            .contiguous_seq,
        2
    );
    // Over the ordinary link, too.
    let answer = nao.put(1, &passage_1).await.good();
    assert_eq!(answer["contiguous_seq"], 2);
    let streams = ada.get(&nao.path("/agents")).await.good();
    let samples = passage_1.len() + 3;
    assert_eq!(streams["items"][0]["samples"], samples);
    let tally = json!({ "accepted": samples * 60 });
    assert_eq!(streams["items"][0]["tally"], tally);
    assert_eq!(shore.work().await.len(), 1, "it is analysed");
    shore.finish().await;
}

async fn what_is_no_message_or_no_batch_of_the_vessel_keeps_nothing_else_back(shore: Shore) {
    let ada = shore.admin("ada").await;
    let nao = shore.ship(&ada, "Nao").await;
    let other = shore.ship(&ada, "Arrano").await;
    let mut messages = split(&frame(other.stream, 1, &passage(DAY, 3))).unwrap();
    messages.push(b"AT+SBDIX".to_vec());
    messages.extend(split(&frame(nao.stream, 1, &passage(DAY, 3))).unwrap());
    let day = split(&frame(nao.stream, 2, &long_passage(&nao))).unwrap();
    messages.push(day[0].clone());
    let imported = brought(&shore, &nao, &messages).await;
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
    shore.finish().await;
}

async fn other_bytes_under_a_number_that_is_there_are_refused(shore: Shore) {
    let ada = shore.admin("ada").await;
    let nao = shore.ship(&ada, "Nao").await;
    nao.put(1, &passage(DAY, 6)).await.good();
    let messages = split(&frame(nao.stream, 1, &passage(DAY, 5))).unwrap();
    let imported = brought(&shore, &nao, &messages).await;
    assert_eq!(imported.refused.len(), 1);
    let streams = ada.get(&nao.path("/agents")).await.good();
    assert_eq!(streams["items"][0]["samples"], 6);
    shore.finish().await;
}

#[test]
fn a_file_that_cannot_be_read_stops_the_command_before_anything_is_stored() {
    let folder = TempDir::new().unwrap();
    let vessel = Uuid::from_u128(1).to_string();
    let refused = run(folder.path(), &["bursts", "--vessel", &vessel, "no.sbd"]);
    assert_refused(&refused, &["no.sbd"]);
    assert!(!folder.path().join("binnacle.db").exists());
}

#[test]
fn a_message_that_is_damaged_is_named_and_the_exit_code_says_so() {
    let folder = TempDir::new().unwrap();
    std::fs::write(folder.path().join("1.sbd"), b"\xb1 damaged").unwrap();
    let vessel = Uuid::from_u128(1).to_string();
    let output = run(folder.path(), &["bursts", "--vessel", &vessel, "1.sbd"]);
    assert_eq!(output.status.code(), Some(2));
    let errors = String::from_utf8_lossy(&output.stderr);
    assert!(errors.contains("1.sbd: the message is damaged"), "{errors}");
    let told: serde_json::Value = serde_json::from_slice(&output.stdout).unwrap();
    assert_eq!(
        (&told["stored"], &told["refused"][0]["message"]),
        (&json!(0), &json!("1.sbd"))
    );
}
