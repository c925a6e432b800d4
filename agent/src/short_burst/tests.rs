//! Exchanges with folders for a modem and a server that joins the messages in them.

use super::*;
use crate::config::max_burst_batch_bytes;
use crate::spool::Seal;
use crate::spool::tests::{accepted, alert, identity, restless, sample};
use binnacle_compass::angle::{CompassHeading, TrueHeading};
use binnacle_compass::position::Position;
use binnacle_compass::sample::Sample;
use binnacle_wire::burst::{Ack, Joiner, write_ack};
use std::path::Path;
use tempfile::TempDir;

async fn rig() -> (TempDir, Spool, FileModem) {
    let directory = TempDir::new().unwrap();
    let spool = Spool::open(directory.path()).await.unwrap();
    spool.enrol(&identity(7)).await.unwrap();
    let modem = FileModem::open(&directory.path().join("modem")).unwrap();
    (directory, spool, modem)
}

async fn seal(spool: &Spool, minutes: std::ops::Range<i64>) {
    let samples: Vec<Sample> = minutes.map(sample).collect();
    let counts = accepted(60);
    spool.store(&samples, &counts, Seal::All).await.unwrap();
}

async fn evidence(spool: &Spool, samples: &[Sample]) {
    let counts = accepted(1);
    let alerts = [alert(2)];
    let sealed = spool.store_evidence(samples, &counts, &alerts, None);
    sealed.await.unwrap();
}

/// Messages in the folder, in order.
fn outbox(directory: &Path) -> Vec<Vec<u8>> {
    let folder = directory.join("modem").join("out");
    let files = std::fs::read_dir(folder).unwrap();
    let mut paths: Vec<_> = files.map(|entry| entry.unwrap().path()).collect();
    paths.retain(|path| path.extension().is_some_and(|ending| ending == "sbd"));
    paths.sort();
    paths
        .iter()
        .map(|path| std::fs::read(path).unwrap())
        .collect()
}

fn seqs(messages: &[Vec<u8>]) -> Vec<u64> {
    let mut joiner = Joiner::default();
    let frames = messages.iter().filter_map(|m| joiner.push(m).unwrap());
    let seqs = frames.map(|frame| binnacle_wire::decode(&frame).unwrap().seq);
    seqs.collect()
}

fn deliver(directory: &Path, name: &str, message: &[u8]) {
    let folder = directory.join("modem").join("in");
    std::fs::write(folder.join(name), message).unwrap();
}

fn ack(stream: u128, contiguous_seq: u64) -> Vec<u8> {
    write_ack(Ack {
        stream: StreamTag::from_stream(identity(stream).stream),
        contiguous_seq,
    })
}

#[tokio::test]
async fn each_batch_goes_out_once_and_stays_until_the_server_has_it() {
    let (directory, spool, mut modem) = rig().await;
    seal(&spool, 0..90).await;
    seal(&spool, 100..101).await;
    exchange(&spool, &mut modem).await.unwrap();
    exchange(&spool, &mut modem).await.unwrap();
    let sent = outbox(directory.path());
    assert!(sent.iter().all(|message| message.len() <= 340));
    assert_eq!(seqs(&sent), [1, 2]);
    assert_eq!(spool.status().await.unwrap().waiting_batches, 2);
    deliver(directory.path(), "1.sbd", &ack(7, 1));
    exchange(&spool, &mut modem).await.unwrap();
    let status = spool.status().await.unwrap();
    assert_eq!((status.waiting_batches, status.contiguous_seq), (1, 1));
    assert_eq!(
        (status.acknowledged_batches, status.acknowledged_samples),
        (1, 90)
    );
    assert_eq!(outbox(directory.path()), sent);
}

#[tokio::test]
async fn an_acknowledgement_deletes_only_what_is_out_and_of_this_stream() {
    let (directory, spool, mut modem) = rig().await;
    seal(&spool, 0..1).await;
    deliver(directory.path(), "1.sbd", &ack(7, 9));
    deliver(directory.path(), "2.sbd", &ack(8, 9));
    deliver(directory.path(), "3.sbd", b"\xb2 not an answer");
    deliver(directory.path(), "4.sbd", &[0xb2; 5_000]);
    exchange(&spool, &mut modem).await.unwrap();
    assert_eq!(spool.status().await.unwrap().waiting_batches, 1);
    assert_eq!(seqs(&outbox(directory.path())), [1]);
    assert_eq!(modem.receive().await.unwrap(), None, "each is read once");
}

#[tokio::test]
async fn an_acknowledgement_beyond_what_is_out_is_refused_whole() {
    let (directory, spool, mut modem) = rig().await;
    seal(&spool, 0..1).await;
    exchange(&spool, &mut modem).await.unwrap();
    seal(&spool, 1..2).await;
    deliver(directory.path(), "1.sbd", &ack(7, 2));
    exchange(&spool, &mut modem).await.unwrap();
    let status = spool.status().await.unwrap();
    assert_eq!((status.waiting_batches, status.contiguous_seq), (2, 0));
    deliver(directory.path(), "2.sbd", &ack(7, 2));
    exchange(&spool, &mut modem).await.unwrap();
    let status = spool.status().await.unwrap();
    assert_eq!((status.waiting_batches, status.contiguous_seq), (0, 2));
}

#[tokio::test]
async fn an_alert_goes_before_the_backlog() {
    let (directory, spool, mut modem) = rig().await;
    seal(&spool, 0..1).await;
    seal(&spool, 1..2).await;
    evidence(&spool, &[]).await;
    exchange(&spool, &mut modem).await.unwrap();
    assert_eq!(seqs(&outbox(directory.path())), [3, 1, 2]);
}

/// A modem that fails after the given number of messages.
struct Failing {
    modem: FileModem,
    takes: usize,
}

impl Modem for Failing {
    async fn send(&mut self, message: &[u8]) -> io::Result<()> {
        if self.takes == 0 {
            return Err(io::Error::other("no satellite in sight"));
        }
        self.takes -= 1;
        self.modem.send(message).await
    }

    async fn receive(&mut self) -> io::Result<Option<Vec<u8>>> {
        self.modem.receive().await
    }
}

#[tokio::test]
async fn a_modem_that_fails_half_way_goes_on_with_the_next_message() {
    let (directory, spool, modem) = rig().await;
    let restless: Vec<Sample> = (0..400).map(restless).collect();
    let counts = accepted(400);
    spool.store(&restless, &counts, Seal::All).await.unwrap();
    let whole = spool.next_burst_batch().await.unwrap().unwrap().0;
    let wanted = split(&whole.bytes).unwrap();
    assert!(wanted.len() > 2, "{}", wanted.len());
    let mut failing = Failing { modem, takes: 2 };
    assert!(exchange(&spool, &mut failing).await.is_err());
    drop(spool);
    let spool = Spool::open(directory.path()).await.unwrap();
    failing.takes = 100;
    exchange(&spool, &mut failing).await.unwrap();
    assert_eq!(outbox(directory.path()), wanted);
}

#[tokio::test]
async fn a_batch_is_thinned_until_it_fits_into_three_messages_and_evidence_is_not() {
    let (directory, spool, mut modem) = rig().await;
    let restless: Vec<Sample> = (0..500).map(restless).collect();
    let counts = accepted(500);
    spool.store(&restless, &counts, Seal::All).await.unwrap();
    evidence(&spool, &restless[..200]).await;
    spool
        .thin_batches_to(max_burst_batch_bytes())
        .await
        .unwrap();
    exchange(&spool, &mut modem).await.unwrap();
    let mut joiner = Joiner::default();
    let sent = outbox(directory.path());
    let frames = sent.iter().filter_map(|m| joiner.push(m).unwrap());
    let batches: Vec<_> = frames.map(|f| binnacle_wire::decode(&f).unwrap()).collect();
    let thinned = batches.iter().find(|batch| batch.seq == 1).unwrap();
    assert_eq!(
        thinned.samples.len() as u64 + thinned.thinned.unwrap().samples,
        500
    );
    assert!(binnacle_wire::encode(thinned).unwrap().len() <= max_burst_batch_bytes());
    let evidence = batches.iter().find(|batch| batch.seq == 2).unwrap();
    assert_eq!((evidence.samples.len(), evidence.alerts.len()), (200, 1));
}

#[tokio::test]
async fn what_is_too_large_for_any_messages_waits_and_keeps_nothing_back() {
    let (directory, spool, mut modem) = rig().await;
    let mut wild: Vec<Sample> = (0..512).map(restless).collect();
    let mut state = 1_u64;
    let mut noise = || {
        state = state
            .wrapping_mul(6_364_136_223_846_793_005)
            .wrapping_add(1);
        f64::from((state >> 40) as u32) / f64::from(1 << 24)
    };
    for sample in &mut wild {
        sample.position = Position::new(90.0 * noise(), 360.0 * noise() - 180.0).unwrap();
        sample.compass = CompassHeading::new(360.0 * noise()).unwrap();
        sample.gyro = TrueHeading::new(360.0 * noise());
        sample.satellite = TrueHeading::new(360.0 * noise());
        sample.spread_deg = Some(180.0 * noise());
        sample.rate_of_turn_deg_min = Some(3_600.0 * noise());
    }
    evidence(&spool, &wild).await;
    seal(&spool, 0..1).await;
    exchange(&spool, &mut modem).await.unwrap();
    assert_eq!(seqs(&outbox(directory.path())), [2]);
    assert_eq!(spool.status().await.unwrap().waiting_batches, 2);
}

#[cfg(unix)]
#[tokio::test]
async fn no_link_in_the_folder_leads_a_message_out_of_it() {
    let (directory, spool, mut modem) = rig().await;
    let elsewhere = directory.path().join("elsewhere");
    std::fs::write(&elsewhere, "mine").unwrap();
    let outbox = directory.path().join("modem").join("out");
    for name in ["partial", "next", "00000001.sbd"] {
        std::os::unix::fs::symlink(&elsewhere, outbox.join(name)).unwrap();
    }
    seal(&spool, 0..1).await;
    modem.send(b"a message").await.unwrap();
    assert_eq!(std::fs::read(&elsewhere).unwrap(), b"mine");
    let sent = std::fs::read(outbox.join("00000002.sbd"));
    assert_eq!(sent.unwrap(), b"a message");
}
