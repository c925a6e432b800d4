//! Faults of the server and of the link: an acknowledged batch is stored once,
//! and everything else is still on board.

#![allow(clippy::unwrap_used, reason = "these are tests, helpers included")]

use anyhow::{Context, Result, ensure};
use binnacle_tests::link::gateway::Manners;
use binnacle_tests::link::satellite::Validity;
use binnacle_tests::records::{
    Spool, batch_log, ensure_acknowledged_is_ashore, ensure_same_at_both_ends,
};
use binnacle_tests::sailing::{PATIENCE, day};
use binnacle_tests::ship_and_server::{calm, copy_folder};
use binnacle_tests::{Coast, Pace, Passage, Ship, Voyage, eventually};
use serde_json::Value;
use std::path::PathBuf;
use std::time::Instant;

const HASTY: &str = "poll_s = 2\nretry_min_s = 0.2\nretry_max_s = 1\nexchange_s = 2";
/// After a refusal it retries in an hour.
const PATIENT: &str = "poll_s = 2\nretry_min_s = 0.2\nretry_max_s = 3600";

#[tokio::test(flavor = "multi_thread", worker_threads = 2)]
async fn an_answer_that_drips_for_ever_is_given_up() {
    dripping_answer().await.unwrap();
}

async fn dripping_answer() -> Result<()> {
    let passage = Passage {
        uplink: HASTY,
        ..Passage::default()
    };
    let mut coast = Coast::sail_on(passage, |_| Ok(())).await?;
    coast.until(1.0).await?;
    let before = coast.all_ashore().await?;
    coast.gateway.set(Manners::Drips);
    coast.until(2.0).await?;
    let began = Instant::now();
    coast.gateway.met(3, PATIENCE).await?;
    println!("three exchanges were given up in {:?}", began.elapsed());
    coast.says("/link/problem", "no answer in time").await?;
    coast.ensure_nothing_went(&before).await?;
    coast.gateway.set(Manners::Passes);
    let spool = coast.all_ashore().await?;
    ensure_same_at_both_ends(&coast.shore, coast.vessel, &spool).await?;
    coast.ensure_every_window_is_there().await?;
    coast.arrive().await
}

#[tokio::test(flavor = "multi_thread", worker_threads = 2)]
async fn a_shore_whose_certificate_expired_gets_nothing_until_it_is_renewed() {
    expired_certificate().await.unwrap();
}

async fn expired_certificate() -> Result<()> {
    let passage = Passage {
        tls: true,
        ..Passage::default()
    };
    let mut coast = Coast::sail_on(passage, |_| Ok(())).await?;
    coast.until(1.0).await?;
    let before = coast.all_ashore().await?;
    let tls = coast.tls.clone().context("the shore speaks TLS")?;
    // A new process cannot resume an old session.
    let expires = || tls.renew(Validity::Past);
    coast.shore.stopped_for(expires).await?;
    coast.until(2.0).await?;
    let said = coast
        .says("/link/problem", "the shore's certificate has expired")
        .await?;
    ensure!(said.contains("clock is wrong"), "{said}");
    coast.ensure_nothing_went(&before).await?;
    let renewed = || tls.renew(Validity::Current);
    coast.shore.stopped_for(renewed).await?;
    let spool = coast.all_ashore().await?;
    ensure_same_at_both_ends(&coast.shore, coast.vessel, &spool).await?;
    coast.ensure_every_window_is_there().await?;
    coast.arrive().await
}

#[tokio::test(flavor = "multi_thread", worker_threads = 2)]
async fn a_revoked_agent_keeps_its_samples_and_its_peace_until_it_is_enrolled_again() {
    revoked().await.unwrap();
}

async fn revoked() -> Result<()> {
    let passage = Passage {
        uplink: PATIENT,
        ..Passage::default()
    };
    let mut coast = Coast::sail_on(passage, |_| Ok(())).await?;
    coast.until(1.0).await?;
    let before = coast.all_ashore().await?;
    let vessel = coast.vessel.to_string();
    let agents = coast
        .shore
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
    coast.shore.admin(&revoke, "").await?;
    coast.until(2.0).await?;
    let said = coast
        .says("/link/problem", "does not know this agent")
        .await?;
    ensure!(said.contains("enrol it again"), "{said}");
    coast.says("/link/state", "refused").await?;
    let calls = coast.gateway.count();
    // A day with four more batches, which become one.
    coast.until(3.0).await?;
    ensure!(coast.gateway.count() <= calls + 1, "it called again");
    let aboard = coast.ensure_nothing_went(&before).await?;
    ensure!(aboard.waiting > 1, "{aboard:?}");
    let code = coast.shore.enrolment_code(&vessel).await?;
    coast.ship.enrol(&coast.gateway.url(), &code).await?;
    let spool = coast.all_ashore().await?;
    ensure_same_at_both_ends(&coast.shore, coast.vessel, &spool).await?;
    coast.ensure_every_window_is_there().await?;
    coast.arrive().await
}

#[tokio::test(flavor = "multi_thread", worker_threads = 2)]
async fn a_cloned_agent_is_noticed_and_neither_takes_from_the_other() {
    cloned().await.unwrap();
}

async fn cloned() -> Result<()> {
    let mut coast = Coast::sail().await?;
    coast.until(1.0).await?;
    coast.all_ashore().await?;
    coast.ship.kill().await?;
    let pace = Pace::FastUntil(day(0.0));
    let mut other = Voyage::sail("biscay.toml", 12, coast.folder(), pace).await?;
    let mut twin = Ship::new("twin", coast.folder(), other.feed.address())?;
    copy_folder(&coast.ship.data_dir(), &twin.data_dir())?;
    coast.ship.start()?;
    twin.start()?;
    twin.ready().await?;
    for days in [2.0, 3.0, 4.0] {
        coast.until(days).await?;
        coast.all_ashore().await?;
        binnacle_tests::sailing::until(&mut other, &twin, day(days)).await?;
        calm(&twin).await?;
    }
    let alert = clone_alert(&coast).await?;
    ensure!(alert["state"] == "raised", "{alert}");
    for ship in [&coast.ship, &twin] {
        let spool = calm(ship).await?;
        ensure_acknowledged_is_ashore(&coast.shore, coast.vessel, &spool).await?;
    }
    twin.kill().await?;
    // Two ships' samples: their windows must overlap.
    coast.ship.assert_running()?;
    coast.ship.kill().await?;
    coast.shore.assert_well().await?;
    coast.shore.finish().await
}

async fn clone_alert(coast: &Coast) -> Result<Value> {
    eventually("the clone is an alert", PATIENCE, async || {
        let mut alerts = coast.shore.list("/alerts").await?;
        alerts.retain(|alert| alert["cause"] == "cloned_agent");
        ensure!(alerts.len() < 2, "{alerts:?}");
        Ok(alerts.pop().ok_or("no alert".to_owned()))
    })
    .await
}

#[tokio::test(flavor = "multi_thread", worker_threads = 2)]
async fn a_shore_restored_from_a_backup_gets_again_what_it_lost() {
    restored_shore().await.unwrap();
}

async fn restored_shore() -> Result<()> {
    let mut coast = Coast::sail().await?;
    coast.until(2.0).await?;
    coast.all_ashore().await?;
    let url = coast.shore.database().url();
    let file = PathBuf::from(url.strip_prefix("sqlite://").context("SQLite")?);
    let files = ["", "-wal", "-shm"].map(|suffix| {
        let mut path = file.clone().into_os_string();
        path.push(suffix);
        PathBuf::from(path)
    });
    let backup = coast.folder().join("backup");
    std::fs::create_dir(&backup)?;
    let kept = |path: &PathBuf| backup.join(path.file_name().unwrap_or_default());
    let save = || {
        for path in files.iter().filter(|path| path.exists()) {
            std::fs::copy(path, kept(path))?;
        }
        Ok(())
    };
    coast.shore.stopped_for(save).await?;
    coast.until(5.0).await?;
    let lost = coast.all_ashore().await?;
    ensure_same_at_both_ends(&coast.shore, coast.vessel, &lost).await?;
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
    coast.shore.stopped_for(restore).await?;
    let there = batch_log(coast.shore.database(), coast.vessel).await?.len();
    ensure!(there < lost.acknowledged.len(), "{there} of {lost:?}");
    coast.until(6.0).await?;
    let spool = eventually("the shore has all again", PATIENCE, async || {
        let spool = Spool::of(&coast.ship).await?;
        let there = batch_log(coast.shore.database(), coast.vessel).await?.len();
        let has_all = spool.waiting == 0 && there > lost.acknowledged.len();
        Ok(if has_all {
            Ok(spool)
        } else {
            Err(format!("{there}, {spool:?}"))
        })
    })
    .await?;
    ensure_same_at_both_ends(&coast.shore, coast.vessel, &spool).await?;
    coast.ensure_every_window_is_there().await?;
    coast.arrive().await
}
