//! Faults of ship, server and link: an acknowledged batch is stored once, and
//! everything else is still on board.

#![allow(clippy::unwrap_used, reason = "these are tests, helpers included")]

use anyhow::{Result, ensure};
use binnacle_tests::link::gateway::{Behaviour, Gateway};
use binnacle_tests::records::{Spool, ensure_acknowledged_is_stored, ensure_records_match};
use binnacle_tests::sailing::{TIMEOUT, day};
use binnacle_tests::ship_and_server::copy_folder;
use binnacle_tests::{Engine, Pace, ServerProcess, Setup, ShipAndServer, eventually};
use serde_json::Value;

#[tokio::test(flavor = "multi_thread", worker_threads = 2)]
async fn no_wrong_response_counts_as_an_acknowledgement() {
    no_wrong_response().await.unwrap();
}

async fn no_wrong_response() -> Result<()> {
    let mut system = ShipAndServer::start().await?;
    system.sail_until(1.0).await?;
    let mut before = system.wait_until_uploaded().await?;
    let wrong = [
        Behaviour::Fails,
        Behaviour::ShowsPage,
        Behaviour::Refuses("400 Bad Request"),
        Behaviour::Refuses("401 Unauthorized"),
        Behaviour::Refuses("404 Not Found"),
        // Cuts a request; then a response.
        Behaviour::CutsAfter(100),
        Behaviour::CutsAfter(60),
    ];
    for (days, behaviour) in (2..).zip(wrong) {
        system.gateway.set(behaviour);
        system.sail_until(f64::from(days)).await?;
        system.gateway.wait_for_connections(3, TIMEOUT).await?;
        let during = Spool::read(&system.ship).await?;
        ensure!(
            during.acknowledged == before.acknowledged && during.unsent_samples > 0,
            "{behaviour:?}: {during:?}"
        );
        system.gateway.set(Behaviour::Passes);
        before = system.wait_until_uploaded().await?;
        ensure_records_match(&system.server, system.vessel, &before).await?;
        system.wait_for_status("/spool/parked_batches", "0").await?;
    }
    system.check_and_stop().await
}

#[tokio::test(flavor = "multi_thread", worker_threads = 2)]
async fn a_proxy_that_cuts_after_a_kilobyte_only_makes_it_longer() {
    let sail = async {
        let mut system = ShipAndServer::start().await?;
        system.gateway.set(Behaviour::CutsAfter(1024));
        system.sail_until(2.0).await?;
        let spool = system.wait_until_uploaded().await?;
        ensure_records_match(&system.server, system.vessel, &spool).await?;
        system.check_and_stop().await
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
    let mut system = ShipAndServer::start().await?;
    let mut state = 5_u64;
    for kill in 1..=kills() {
        let moment = day(DAYS * f64::from(kill) / f64::from(kills()));
        system.voyage.feed.set_pace(Pace::FastUntil(moment))?;
        state = state
            .wrapping_mul(6_364_136_223_846_793_005)
            .wrapping_add(9);
        // At a random point of the way, whatever agent and uplink are doing
        // then.
        let part = (state >> 33) as f64 / f64::from(1_u32 << 31);
        let from = moment.plus_seconds(-86_400.0 * DAYS / f64::from(kills()) * part);
        let passed = |progress: &binnacle_tests::Progress| progress.time() >= Some(from);
        system.voyage.feed.reached(TIMEOUT, passed).await?;
        if state >> 62 == 0 {
            system.server.kill_and_restart().await?;
        } else {
            system.ship.kill_and_restart().await?;
        }
    }
    // The last kill may have come after everything was sent.
    system.sail_until(DAYS + 0.5).await?;
    let spool = system.wait_until_uploaded().await?;
    // Sentences under way to an agent that died are lost, so there is less to
    // send.
    let samples = spool.acknowledged.iter().map(|batch| batch.samples);
    ensure!(samples.sum::<i64>() > 50, "{spool:?}");
    ensure_records_match(&system.server, system.vessel, &spool).await?;
    system.check_and_stop().await
}

#[tokio::test(flavor = "multi_thread", worker_threads = 2)]
async fn a_write_that_the_power_cut_short_takes_nothing_with_it() {
    torn_tail().await.unwrap();
}

async fn torn_tail() -> Result<()> {
    let mut system = ShipAndServer::start().await?;
    system.gateway.set(Behaviour::Fails);
    for torn in 1..=3 {
        system.sail_until(f64::from(torn)).await?;
        system.ship.kill().await?;
        let before = Spool::read(&system.ship).await?;
        ensure!(before.unsent_samples > 0, "{before:?}");
        // Half a frame of the journal, never reported as durable.
        let journal = system.ship.data_dir().join("spool.db-wal");
        let mut bytes = std::fs::read(&journal)?;
        bytes.extend(vec![0xa5; 24 + 1000 * torn as usize]);
        std::fs::write(&journal, bytes)?;
        system.ship.start()?;
        system.ship.ready().await?;
        let after = Spool::read(&system.ship).await?;
        ensure!(
            after.unsent_samples >= before.unsent_samples,
            "{after:?}, {before:?}"
        );
    }
    system.gateway.set(Behaviour::Passes);
    system.check_and_stop().await
}

#[tokio::test(flavor = "multi_thread", worker_threads = 2)]
async fn pages_lost_with_the_power_cost_only_their_own_data() {
    lost_pages().await.unwrap();
}

async fn lost_pages() -> Result<()> {
    let mut system = ShipAndServer::start().await?;
    for lost in 1..=3_u32 {
        system.sail_until(f64::from(lost)).await?;
        system.ship.kill().await?;
        let journal = system.ship.data_dir().join("spool.db-wal");
        let bytes = std::fs::read(&journal)?;
        // The last pages, and a part of one.
        let left = bytes.len().saturating_sub(4120 * lost as usize + 700);
        std::fs::write(&journal, &bytes[..left])?;
        system.ship.start()?;
        system.ship.ready().await?;
    }
    system.sail_until(4.0).await?;
    system.check_and_stop().await
}

#[tokio::test(flavor = "multi_thread", worker_threads = 2)]
async fn a_spool_restored_from_an_old_copy_opens_another_stream() {
    old_spool().await.unwrap();
}

async fn old_spool() -> Result<()> {
    let mut system = ShipAndServer::start().await?;
    system.sail_until(1.0).await?;
    system.wait_until_uploaded().await?;
    system.ship.kill().await?;
    let copy = system.folder().join("copy");
    copy_folder(&system.ship.data_dir(), &copy)?;
    system.ship.start()?;
    system.sail_until(2.0).await?;
    let spool = system.wait_until_uploaded().await?;
    system.ship.kill().await?;
    std::fs::remove_dir_all(system.ship.data_dir())?;
    copy_folder(&copy, &system.ship.data_dir())?;
    system.ship.start()?;
    system.sail_until(3.0).await?;
    let after = system.wait_until_uploaded().await?;
    let streams = |spool: &Spool| {
        let streams = spool.acknowledged.iter().map(|batch| batch.stream);
        streams.collect::<std::collections::BTreeSet<_>>().len()
    };
    ensure!((streams(&spool), streams(&after)) == (1, 2), "{after:?}");
    ensure_acknowledged_is_stored(&system.server, system.vessel, &spool).await?;
    // One computer with an old spool is not two.
    let alerts = system.server.list("/alerts").await?;
    let is_clone = |alert: &Value| alert["cause"] == "cloned_agent";
    ensure!(!alerts.iter().any(is_clone), "{alerts:?}");
    system.check_and_stop().await
}

#[tokio::test(flavor = "multi_thread", worker_threads = 2)]
async fn a_reinstalled_agent_opens_a_stream_of_its_own() {
    reinstalled().await.unwrap();
}

async fn reinstalled() -> Result<()> {
    let mut system = ShipAndServer::start().await?;
    system.sail_until(1.0).await?;
    let first = system.wait_until_uploaded().await?;
    system.ship.kill().await?;
    std::fs::remove_dir_all(system.ship.data_dir())?;
    let code = system
        .server
        .enrolment_code(&system.vessel.to_string())
        .await?;
    system.ship.enrol(&system.gateway.url(), &code).await?;
    system.ship.start()?;
    system.sail_until(2.0).await?;
    let second = system.wait_until_uploaded().await?;
    ensure!(first.acknowledged[0].stream != second.acknowledged[0].stream);
    ensure_acknowledged_is_stored(&system.server, system.vessel, &first).await?;
    system.check_and_stop().await
}

#[tokio::test(flavor = "multi_thread", worker_threads = 2)]
async fn thirty_days_without_a_link_are_caught_up_with() {
    long_silence().await.unwrap();
}

async fn long_silence() -> Result<()> {
    let setup = Setup {
        scenario: "month.toml",
        ..Setup::default()
    };
    let mut system = ShipAndServer::start_with(setup, |_| Ok(())).await?;
    system.sail_until(1.0).await?;
    let before = system.wait_until_uploaded().await?;
    system.gateway.set(Behaviour::Fails);
    system.sail_until(31.0).await?;
    let unsent = system.ensure_nothing_lost(&before).await?;
    // Four a day were sealed, and most of them joined to the one before.
    ensure!((10..60).contains(&unsent.waiting), "{unsent:?}");
    system.gateway.set(Behaviour::Passes);
    let back = std::time::Instant::now();
    let spool = system.wait_until_uploaded().await?;
    let since = &spool.acknowledged[before.acknowledged.len()..];
    let samples: i64 = since.iter().map(|batch| batch.samples).sum();
    println!(
        "{samples} samples in {} batches in {:?}",
        since.len(),
        back.elapsed()
    );
    ensure_records_match(&system.server, system.vessel, &spool).await?;
    system.ensure_no_window_lost().await?;
    system.check_and_stop().await
}

/// Checks the gateway's behaviour that the other tests need.
#[tokio::test]
async fn a_gateway_passes_connections_or_responds_itself() {
    let folder = tempfile::tempdir().unwrap();
    let server = ServerProcess::start(Engine::Sqlite, folder.path())
        .await
        .unwrap();
    let mut gateway = Gateway::open(&server.url).await.unwrap();
    let health = async |gateway: &Gateway| {
        let answer = reqwest::get(format!("{}/healthz", gateway.url())).await?;
        anyhow::Ok((answer.status().as_u16(), answer.text().await?))
    };
    assert_eq!(health(&gateway).await.unwrap(), (200, "ok".to_owned()));
    gateway.set(Behaviour::Fails);
    assert_eq!(health(&gateway).await.unwrap().0, 500);
    gateway.set(Behaviour::ShowsPage);
    assert!(health(&gateway).await.unwrap().1.contains("Harbour"));
    gateway.set(Behaviour::CutsAfter(10));
    assert!(health(&gateway).await.is_err());
    eventually("it passes again", TIMEOUT, async || {
        gateway.set(Behaviour::Passes);
        Ok(health(&gateway).await.map_err(|error| error.to_string()))
    })
    .await
    .unwrap();
    server.finish().await.unwrap();
}
