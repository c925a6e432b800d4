//! The real agent with no link but a modem.

#![allow(clippy::unwrap_used, reason = "helpers of tests may panic too")]

mod common;

use binnacle_wire::batch::StreamId;
use binnacle_wire::burst::{Ack, Joiner, MESSAGE_BYTES, StreamTag, write_ack};
use common::agent::Agent;
use common::bridge::Bridge;
use common::fetch;
use common::server::{STREAM, TestServer};
use std::path::Path;
use std::time::Duration;
use tokio::time::timeout;

const PATIENCE: Duration = Duration::from_mins(3);

/// Messages in a folder, in order.
fn messages(folder: &Path) -> Vec<Vec<u8>> {
    let Ok(files) = std::fs::read_dir(folder) else {
        return Vec::new();
    };
    let mut paths: Vec<_> = files.map(|entry| entry.unwrap().path()).collect();
    paths.retain(|path| path.extension().is_some_and(|ending| ending == "sbd"));
    paths.sort();
    paths
        .iter()
        .map(|path| std::fs::read(path).unwrap())
        .collect()
}

#[tokio::test]
async fn a_day_goes_ashore_in_three_messages_and_is_forgotten_when_it_is_answered() {
    let server = TestServer::start(None, None).await;
    let bridge = Bridge::new(25 * 3_600).await;
    let agent = Agent::new(bridge.address);
    agent.configure("[uplink]", "profile = \"short-burst\"");
    agent.configure("stale_s = 3", "[modem]\ndirectory = \"modem\"");
    agent.enrol(&server.url).await;
    // At sea there is nothing but the modem.
    server.stored.lock().unwrap().down = true;
    bridge.sail();
    let running = agent.run().await;
    let modem = agent.config().with_file_name("modem");
    let whole = async {
        loop {
            let mut joiner = Joiner::default();
            let sent = messages(&modem.join("out"));
            let frame = sent.iter().find_map(|m| joiner.push(m).unwrap());
            if let Some(frame) = frame {
                return (sent, frame);
            }
            // So that the test waits for something.
            fetch(running.page, "/api/status").await;
        }
    };
    let (sent, frame) = timeout(PATIENCE, whole).await.expect("a day is out");
    assert!(sent.len() <= 3, "{}", sent.len());
    assert!(sent.iter().all(|m| m.len() <= MESSAGE_BYTES));
    let batch = binnacle_wire::decode(&frame).unwrap();
    let (first, last) = (&batch.samples[0], batch.samples.last().unwrap());
    let hours = last.time.seconds_since(first.time) / 3_600.0;
    assert!((23.0..25.0).contains(&hours), "{hours}");
    assert!(batch.samples.len() > 100, "{}", batch.samples.len());
    let ack = write_ack(Ack {
        stream: StreamTag::from_stream(StreamId(STREAM)),
        contiguous_seq: 1,
    });
    std::fs::write(modem.join("in").join("answer.tmp"), ack).unwrap();
    std::fs::rename(
        modem.join("in").join("answer.tmp"),
        modem.join("in").join("answer.sbd"),
    )
    .unwrap();
    let answered = "\"contiguous_seq\":1";
    let forgotten = async { while !fetch(running.page, "/api/status").await.contains(answered) {} };
    timeout(PATIENCE, forgotten).await.expect("it is forgotten");
    assert!(messages(&modem.join("in")).is_empty());
    running.terminate().await;
}
