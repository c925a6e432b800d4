//! Faults of ship, server and link: an acknowledged batch is stored once, and
//! everything else is still on board.

#![allow(clippy::unwrap_used, reason = "these are tests, helpers included")]

use anyhow::{Result, ensure};
use binnacle_tests::link::gateway::{Gateway, Manners};
use binnacle_tests::records::{Spool, ensure_acknowledged_is_ashore, ensure_same_at_both_ends};
use binnacle_tests::sailing::{PATIENCE, day};
use binnacle_tests::ship_and_server::copy_folder;
use binnacle_tests::{Coast, Engine, Pace, Passage, Shore, eventually};
use serde_json::Value;

#[tokio::test(flavor = "multi_thread", worker_threads = 2)]
async fn no_wrong_answer_passes_for_an_acknowledgement() {
    no_wrong_answer().await.unwrap();
}

async fn no_wrong_answer() -> Result<()> {
    let mut coast = Coast::sail().await?;
    coast.until(1.0).await?;
    let mut before = coast.all_ashore().await?;
    let wrong = [
        Manners::Fails,
        Manners::ShowsPage,
        Manners::Refuses("400 Bad Request"),
        Manners::Refuses("401 Unauthorized"),
        Manners::Refuses("404 Not Found"),
        // Cuts a request; then a response.
        Manners::CutsAfter(100),
        Manners::CutsAfter(60),
    ];
    for (days, manners) in (2..).zip(wrong) {
        coast.gateway.set(manners);
        coast.until(f64::from(days)).await?;
        coast.gateway.met(3, PATIENCE).await?;
        let during = Spool::of(&coast.ship).await?;
        ensure!(
            during.acknowledged == before.acknowledged && during.samples_aboard > 0,
            "{manners:?}: {during:?}"
        );
        coast.gateway.set(Manners::Passes);
        before = coast.all_ashore().await?;
        ensure_same_at_both_ends(&coast.shore, coast.vessel, &before).await?;
        coast.says("/spool/parked_batches", "0").await?;
    }
    coast.arrive().await
}

#[tokio::test(flavor = "multi_thread", worker_threads = 2)]
async fn a_proxy_that_cuts_after_a_kilobyte_only_makes_it_longer() {
    let sail = async {
        let mut coast = Coast::sail().await?;
        coast.gateway.set(Manners::CutsAfter(1024));
        coast.until(2.0).await?;
        let spool = coast.all_ashore().await?;
        ensure_same_at_both_ends(&coast.shore, coast.vessel, &spool).await?;
        coast.arrive().await
    };
    sail.await.unwrap();
}

/// Fifty kills of either side; a thousand in `make soak`.
fn kills() -> u32 {
    let soak = std::env::var_os("BINNACLE_SOAK").is_some();
    if soak { 1_000 } else { 50 }
}

#[tokio::test(flavor = "multi_thread", worker_threads = 2)]
async fn fifty_kills_at_random_lose_and_double_nothing() {
    many_kills().await.unwrap();
}

async fn many_kills() -> Result<()> {
    const DAYS: f64 = 11.0;
    let mut coast = Coast::sail().await?;
    let mut state = 5_u64;
    for kill in 1..=kills() {
        let moment = day(DAYS * f64::from(kill) / f64::from(kills()));
        coast.voyage.feed.set_pace(Pace::FastUntil(moment))?;
        state = state
            .wrapping_mul(6_364_136_223_846_793_005)
            .wrapping_add(9);
        // At a random point of the way, whatever agent and uplink are doing
        // then.
        let part = (state >> 33) as f64 / f64::from(1_u32 << 31);
        let from = moment.plus_seconds(-86_400.0 * DAYS / f64::from(kills()) * part);
        let passed = |progress: &binnacle_tests::Progress| progress.time() >= Some(from);
        coast.voyage.feed.reached(PATIENCE, passed).await?;
        if state >> 62 == 0 {
            coast.shore.kill_and_restart().await?;
        } else {
            coast.ship.kill_and_restart().await?;
        }
    }
    // The last kill may have come after everything was sent.
    coast.until(DAYS + 0.5).await?;
    let spool = coast.all_ashore().await?;
    // Sentences under way to an agent that died are lost, so there is less to
    // send.
    let samples = spool.acknowledged.iter().map(|batch| batch.samples);
    ensure!(samples.sum::<i64>() > 50, "{spool:?}");
    ensure_same_at_both_ends(&coast.shore, coast.vessel, &spool).await?;
    coast.arrive().await
}

#[tokio::test(flavor = "multi_thread", worker_threads = 2)]
async fn a_write_that_the_power_cut_short_takes_nothing_with_it() {
    torn_tail().await.unwrap();
}

async fn torn_tail() -> Result<()> {
    let mut coast = Coast::sail().await?;
    coast.gateway.set(Manners::Fails);
    for torn in 1..=3 {
        coast.until(f64::from(torn)).await?;
        coast.ship.kill().await?;
        let before = Spool::of(&coast.ship).await?;
        ensure!(before.samples_aboard > 0, "{before:?}");
        // Half a frame of the journal, never reported as durable.
        let journal = coast.ship.data_dir().join("spool.db-wal");
        let mut octets = std::fs::read(&journal)?;
        octets.extend(vec![0xa5; 24 + 1000 * torn as usize]);
        std::fs::write(&journal, octets)?;
        coast.ship.start()?;
        coast.ship.ready().await?;
        let after = Spool::of(&coast.ship).await?;
        ensure!(
            after.samples_aboard >= before.samples_aboard,
            "{after:?}, {before:?}"
        );
    }
    coast.gateway.set(Manners::Passes);
    coast.arrive().await
}

#[tokio::test(flavor = "multi_thread", worker_threads = 2)]
async fn pages_that_are_lost_with_the_power_cost_no_more_than_what_was_on_them() {
    lost_pages().await.unwrap();
}

async fn lost_pages() -> Result<()> {
    let mut coast = Coast::sail().await?;
    for lost in 1..=3_u32 {
        coast.until(f64::from(lost)).await?;
        coast.ship.kill().await?;
        let journal = coast.ship.data_dir().join("spool.db-wal");
        let octets = std::fs::read(&journal)?;
        // The last pages, and a part of one.
        let left = octets.len().saturating_sub(4120 * lost as usize + 700);
        std::fs::write(&journal, &octets[..left])?;
        coast.ship.start()?;
        coast.ship.ready().await?;
    }
    coast.until(4.0).await?;
    coast.arrive().await
}

#[tokio::test(flavor = "multi_thread", worker_threads = 2)]
async fn a_spool_restored_from_an_old_copy_opens_another_stream() {
    old_spool().await.unwrap();
}

async fn old_spool() -> Result<()> {
    let mut coast = Coast::sail().await?;
    coast.until(1.0).await?;
    coast.all_ashore().await?;
    coast.ship.kill().await?;
    let copy = coast.folder().join("copy");
    copy_folder(&coast.ship.data_dir(), &copy)?;
    coast.ship.start()?;
    coast.until(2.0).await?;
    let spool = coast.all_ashore().await?;
    coast.ship.kill().await?;
    std::fs::remove_dir_all(coast.ship.data_dir())?;
    copy_folder(&copy, &coast.ship.data_dir())?;
    coast.ship.start()?;
    coast.until(3.0).await?;
    let after = coast.all_ashore().await?;
    let streams = |spool: &Spool| {
        let streams = spool.acknowledged.iter().map(|batch| batch.stream);
        streams.collect::<std::collections::BTreeSet<_>>().len()
    };
    ensure!((streams(&spool), streams(&after)) == (1, 2), "{after:?}");
    ensure_acknowledged_is_ashore(&coast.shore, coast.vessel, &spool).await?;
    // One computer with an old spool is not two.
    let alerts = coast.shore.list("/alerts").await?;
    let is_clone = |alert: &Value| alert["cause"] == "cloned_agent";
    ensure!(!alerts.iter().any(is_clone), "{alerts:?}");
    coast.arrive().await
}

#[tokio::test(flavor = "multi_thread", worker_threads = 2)]
async fn an_agent_installed_anew_goes_on_in_a_stream_of_its_own() {
    installed_anew().await.unwrap();
}

async fn installed_anew() -> Result<()> {
    let mut coast = Coast::sail().await?;
    coast.until(1.0).await?;
    let first = coast.all_ashore().await?;
    coast.ship.kill().await?;
    std::fs::remove_dir_all(coast.ship.data_dir())?;
    let code = coast
        .shore
        .enrolment_code(&coast.vessel.to_string())
        .await?;
    coast.ship.enrol(&coast.gateway.url(), &code).await?;
    coast.ship.start()?;
    coast.until(2.0).await?;
    let second = coast.all_ashore().await?;
    ensure!(first.acknowledged[0].stream != second.acknowledged[0].stream);
    ensure_acknowledged_is_ashore(&coast.shore, coast.vessel, &first).await?;
    coast.arrive().await
}

#[tokio::test(flavor = "multi_thread", worker_threads = 2)]
async fn thirty_days_without_a_link_are_caught_up_with() {
    long_silence().await.unwrap();
}

async fn long_silence() -> Result<()> {
    let passage = Passage {
        scenario: "month.toml",
        ..Passage::default()
    };
    let mut coast = Coast::sail_on(passage, |_| Ok(())).await?;
    coast.until(1.0).await?;
    let before = coast.all_ashore().await?;
    coast.gateway.set(Manners::Fails);
    coast.until(31.0).await?;
    let aboard = coast.ensure_nothing_went(&before).await?;
    // Four a day were sealed, and most of them joined to the one before.
    ensure!((10..60).contains(&aboard.waiting), "{aboard:?}");
    coast.gateway.set(Manners::Passes);
    let back = std::time::Instant::now();
    let spool = coast.all_ashore().await?;
    let since = &spool.acknowledged[before.acknowledged.len()..];
    let samples: i64 = since.iter().map(|batch| batch.samples).sum();
    println!(
        "{samples} samples in {} batches in {:?}",
        since.len(),
        back.elapsed()
    );
    ensure_same_at_both_ends(&coast.shore, coast.vessel, &spool).await?;
    coast.ensure_every_window_is_there().await?;
    coast.arrive().await
}

/// Checks the gateway's behaviour that the other tests need.
#[tokio::test]
async fn a_gateway_passes_and_answers_in_the_shores_place() {
    let folder = tempfile::tempdir().unwrap();
    let shore = Shore::start(Engine::Sqlite, folder.path()).await.unwrap();
    let mut gateway = Gateway::open(&shore.url).await.unwrap();
    let health = async |gateway: &Gateway| {
        let answer = reqwest::get(format!("{}/healthz", gateway.url())).await?;
        anyhow::Ok((answer.status().as_u16(), answer.text().await?))
    };
    assert_eq!(health(&gateway).await.unwrap(), (200, "ok".to_owned()));
    gateway.set(Manners::Fails);
    assert_eq!(health(&gateway).await.unwrap().0, 500);
    gateway.set(Manners::ShowsPage);
    assert!(health(&gateway).await.unwrap().1.contains("Harbour"));
    gateway.set(Manners::CutsAfter(10));
    assert!(health(&gateway).await.is_err());
    eventually("it passes again", PATIENCE, async || {
        gateway.set(Manners::Passes);
        Ok(health(&gateway).await.map_err(|error| error.to_string()))
    })
    .await
    .unwrap();
    shore.finish().await.unwrap();
}
