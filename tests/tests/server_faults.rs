//! Faults of the server and of the link: an acknowledged batch is stored once,
//! and everything else is still on board.

#![allow(clippy::unwrap_used, reason = "these are tests, helpers included")]

use anyhow::{Context, Result, ensure};
use binnacle_tests::link::gateway::Behaviour;
use binnacle_tests::link::satellite::Validity;
use binnacle_tests::records::{
    Spool, batch_log, ensure_acknowledged_is_stored, ensure_records_match,
};
use binnacle_tests::sailing::{TIMEOUT, day};
use binnacle_tests::ship_and_server::{copy_folder, wait_until_idle};
use binnacle_tests::{Pace, Setup, Ship, ShipAndServer, Voyage, eventually};
use serde_json::Value;
use std::path::PathBuf;
use std::time::Instant;

const HASTY: &str = "poll_s = 2\nretry_min_s = 0.2\nretry_max_s = 1\nexchange_s = 2";
/// After a refusal it retries in an hour.
const PATIENT: &str = "poll_s = 2\nretry_min_s = 0.2\nretry_max_s = 3600";

#[tokio::test(flavor = "multi_thread", worker_threads = 2)]
async fn an_endless_slow_response_is_given_up() {
    slow_response().await.unwrap();
}

async fn slow_response() -> Result<()> {
    let setup = Setup {
        uplink: HASTY,
        ..Setup::default()
    };
    let mut system = ShipAndServer::start_with(setup, |_| Ok(())).await?;
    system.sail_until(1.0).await?;
    let before = system.wait_until_uploaded().await?;
    system.gateway.set(Behaviour::Drips);
    system.sail_until(2.0).await?;
    let began = Instant::now();
    system.gateway.wait_for_connections(3, TIMEOUT).await?;
    println!("three exchanges were given up in {:?}", began.elapsed());
    system
        .wait_for_status("/link/problem", "no response in time")
        .await?;
    system.ensure_nothing_lost(&before).await?;
    system.gateway.set(Behaviour::Passes);
    let spool = system.wait_until_uploaded().await?;
    ensure_records_match(&system.server, system.vessel, &spool).await?;
    system.ensure_no_window_lost().await?;
    system.check_and_stop().await
}

#[tokio::test(flavor = "multi_thread", worker_threads = 2)]
async fn a_server_with_an_expired_certificate_gets_nothing_until_it_is_renewed() {
    expired_certificate().await.unwrap();
}

async fn expired_certificate() -> Result<()> {
    let setup = Setup {
        tls: true,
        ..Setup::default()
    };
    let mut system = ShipAndServer::start_with(setup, |_| Ok(())).await?;
    system.sail_until(1.0).await?;
    let before = system.wait_until_uploaded().await?;
    let tls = system.tls.clone().context("the server uses TLS")?;
    // A new process cannot resume an old session.
    let expires = || tls.renew(Validity::Past);
    system.server.restart_after(expires).await?;
    system.sail_until(2.0).await?;
    let said = system
        .wait_for_status("/link/problem", "the server's certificate has expired")
        .await?;
    ensure!(said.contains("clock is wrong"), "{said}");
    system.ensure_nothing_lost(&before).await?;
    let renewed = || tls.renew(Validity::Current);
    system.server.restart_after(renewed).await?;
    let spool = system.wait_until_uploaded().await?;
    ensure_records_match(&system.server, system.vessel, &spool).await?;
    system.ensure_no_window_lost().await?;
    system.check_and_stop().await
}

#[tokio::test(flavor = "multi_thread", worker_threads = 2)]
async fn a_revoked_agent_keeps_its_samples_and_stays_silent_until_it_is_enrolled() {
    revoked().await.unwrap();
}

async fn revoked() -> Result<()> {
    let setup = Setup {
        uplink: PATIENT,
        ..Setup::default()
    };
    let mut system = ShipAndServer::start_with(setup, |_| Ok(())).await?;
    system.sail_until(1.0).await?;
    let before = system.wait_until_uploaded().await?;
    let vessel = system.vessel.to_string();
    let agents = system
        .server
        .list(&format!("/vessels/{vessel}/agents"))
        .await?;
    let agent = agents[0]["agent_id"].as_str().context("agent_id")?;
    let revoke = [
        "admin",
        "revoke-agent",
        "--vessel",
        &vessel,
        "--agent",
        agent,
    ];
    system.server.admin(&revoke, "").await?;
    system.sail_until(2.0).await?;
    let said = system
        .wait_for_status("/link/problem", "does not know this agent")
        .await?;
    ensure!(said.contains("enrol it again"), "{said}");
    system.wait_for_status("/link/state", "refused").await?;
    let calls = system.gateway.count();
    // A day with four more batches, which become one.
    system.sail_until(3.0).await?;
    ensure!(system.gateway.count() <= calls + 1, "it called again");
    let unsent = system.ensure_nothing_lost(&before).await?;
    ensure!(unsent.waiting > 1, "{unsent:?}");
    let code = system.server.enrolment_code(&vessel).await?;
    system.ship.enrol(&system.gateway.url(), &code).await?;
    let spool = system.wait_until_uploaded().await?;
    ensure_records_match(&system.server, system.vessel, &spool).await?;
    system.ensure_no_window_lost().await?;
    system.check_and_stop().await
}

#[tokio::test(flavor = "multi_thread", worker_threads = 2)]
async fn a_cloned_agent_is_noticed_and_neither_takes_from_the_other() {
    cloned().await.unwrap();
}

async fn cloned() -> Result<()> {
    let mut system = ShipAndServer::start().await?;
    system.sail_until(1.0).await?;
    system.wait_until_uploaded().await?;
    system.ship.kill().await?;
    let pace = Pace::FastUntil(day(0.0));
    let mut other = Voyage::sail("biscay.toml", 12, system.folder(), pace).await?;
    let mut twin = Ship::new("twin", system.folder(), other.feed.address())?;
    copy_folder(&system.ship.data_dir(), &twin.data_dir())?;
    system.ship.start()?;
    twin.start()?;
    twin.ready().await?;
    for days in [2.0, 3.0, 4.0] {
        system.sail_until(days).await?;
        system.wait_until_uploaded().await?;
        binnacle_tests::sailing::sail_until(&mut other, &twin, day(days)).await?;
        wait_until_idle(&twin).await?;
    }
    let alert = clone_alert(&system).await?;
    ensure!(alert["state"] == "raised", "{alert}");
    for ship in [&system.ship, &twin] {
        let spool = wait_until_idle(ship).await?;
        ensure_acknowledged_is_stored(&system.server, system.vessel, &spool).await?;
    }
    twin.kill().await?;
    // Two ships' samples: their windows must overlap.
    system.ship.assert_running()?;
    system.ship.kill().await?;
    system.server.assert_healthy().await?;
    system.server.finish().await
}

async fn clone_alert(system: &ShipAndServer) -> Result<Value> {
    eventually("the clone is an alert", TIMEOUT, async || {
        let mut alerts = system.server.list("/alerts").await?;
        alerts.retain(|alert| alert["cause"] == "cloned_agent");
        ensure!(alerts.len() < 2, "{alerts:?}");
        Ok(alerts.pop().ok_or("no alert".to_owned()))
    })
    .await
}

#[tokio::test(flavor = "multi_thread", worker_threads = 2)]
async fn a_server_restored_from_a_backup_receives_the_lost_batches_again() {
    restored_server().await.unwrap();
}

async fn restored_server() -> Result<()> {
    let mut system = ShipAndServer::start().await?;
    system.sail_until(2.0).await?;
    system.wait_until_uploaded().await?;
    let url = system.server.database().url();
    let file = PathBuf::from(url.strip_prefix("sqlite://").context("SQLite")?);
    let files = ["", "-wal", "-shm"].map(|suffix| {
        let mut path = file.clone().into_os_string();
        path.push(suffix);
        PathBuf::from(path)
    });
    let backup = system.folder().join("backup");
    std::fs::create_dir(&backup)?;
    let kept = |path: &PathBuf| backup.join(path.file_name().unwrap_or_default());
    let save = || {
        for path in files.iter().filter(|path| path.exists()) {
            std::fs::copy(path, kept(path))?;
        }
        Ok(())
    };
    system.server.restart_after(save).await?;
    system.sail_until(5.0).await?;
    let lost = system.wait_until_uploaded().await?;
    ensure_records_match(&system.server, system.vessel, &lost).await?;
    let restore = || {
        for path in &files {
            if path.exists() {
                std::fs::remove_file(path)?;
            }
            if kept(path).exists() {
                std::fs::copy(kept(path), path)?;
            }
        }
        Ok(())
    };
    system.server.restart_after(restore).await?;
    let there = batch_log(system.server.database(), system.vessel)
        .await?
        .len();
    ensure!(there < lost.acknowledged.len(), "{there} of {lost:?}");
    system.sail_until(6.0).await?;
    let spool = eventually("the server has all batches again", TIMEOUT, async || {
        let spool = Spool::read(&system.ship).await?;
        let there = batch_log(system.server.database(), system.vessel)
            .await?
            .len();
        let has_all = spool.waiting == 0 && there > lost.acknowledged.len();
        Ok(if has_all {
            Ok(spool)
        } else {
            Err(format!("{there}, {spool:?}"))
        })
    })
    .await?;
    ensure_records_match(&system.server, system.vessel, &spool).await?;
    system.ensure_no_window_lost().await?;
    system.check_and_stop().await
}
