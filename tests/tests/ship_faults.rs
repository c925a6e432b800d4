//! Faults on board: a full or read-only disk, a receiver with a wrong clock or
//! a false position, and hostile input from outside.

#![allow(clippy::unwrap_used, reason = "these are tests, helpers included")]

use anyhow::{Context, Result, bail, ensure};
use binnacle_compass::position::Position;
use binnacle_compass::sample::Sample;
use binnacle_compass::time::Timestamp;
use binnacle_tests::link::gateway::Behaviour;
use binnacle_tests::process::namespace::in_own_mounts;
use binnacle_tests::process::program::output_of;
use binnacle_tests::records::{Spool, clear_journal, ensure_records_match, stored_samples};
use binnacle_tests::sailing::{TIMEOUT, day};
use binnacle_tests::{Pace, Progress, Setup, ShipAndServer, eventually};
use serde_json::Value;
use std::collections::BTreeSet;
use std::fs::File;
use std::io::Write;
use std::path::{Path, PathBuf};
use std::process::Command;

/// Mounts, in a namespace of this test's own.
fn mount(arguments: &[&str], place: &Path) -> Result<()> {
    let status = Command::new("mount").args(arguments).arg(place).status()?;
    ensure!(status.success(), "mount {arguments:?}: {status}");
    Ok(())
}

/// Mounts a disk of a limited size for the agent's data.
fn small_disk(place: &Path, size: &str) -> Result<()> {
    std::fs::create_dir_all(place)?;
    let size = format!("size={size},mode=700");
    mount(&["-t", "tmpfs", "-o", &size, "tmpfs"], place)
}

/// Fills a disk to the last byte, and returns the file to remove.
fn fill(place: &Path, name: &str) -> Result<PathBuf> {
    let path = place.join(name);
    let mut file = File::create(&path)?;
    for size in [65_536, 4_096, 1] {
        let bytes = vec![0; size];
        while file.write_all(&bytes).is_ok() {}
    }
    Ok(path)
}

#[test]
fn a_full_disk_stops_nothing_and_costs_nothing() {
    in_own_mounts("a_full_disk_stops_nothing_and_costs_nothing", full_disk());
}

async fn full_disk() -> Result<()> {
    let disk = |ship: &binnacle_tests::Ship| small_disk(&ship.data_dir(), "24m");
    let mut system = ShipAndServer::start_with(Setup::default(), disk).await?;
    system.sail_until(1.0).await?;
    let before = system.wait_until_uploaded().await?;
    // First the raw log gives way to the spool; then there is nothing left to
    // free.
    let state = system.ship.data_dir();
    let most = fill(&state, "somebody-elses")?;
    system.sail_until(2.0).await?;
    system
        .wait_for_status("/ring/problem", "No space left")
        .await?;
    system.wait_for_status("/storage_problem", "null").await?;
    for days in [3.0, 5.0] {
        clear_journal(&system.ship).await?;
        let rest = fill(&state, "more")?;
        system.sail_until(days).await?;
        let said = system
            .wait_for_status("/storage_problem", "cannot be stored")
            .await?;
        ensure!(said.contains("wait in memory"), "{said}");
        std::fs::remove_file(rest)?;
        system.sail_until(days + 1.0).await?;
        system.wait_for_status("/storage_problem", "null").await?;
    }
    std::fs::remove_file(most)?;
    let spool = system.wait_until_uploaded().await?;
    ensure!(
        spool.acknowledged.starts_with(&before.acknowledged),
        "{spool:?}"
    );
    ensure_records_match(&system.server, system.vessel, &spool).await?;
    system.ensure_no_window_lost().await?;
    system.check_and_stop().await
}

#[test]
fn a_read_only_disk_is_reported_and_keeps_its_data() {
    let name = "a_read_only_disk_is_reported_and_keeps_its_data";
    in_own_mounts(name, read_only_disk());
}

async fn read_only_disk() -> Result<()> {
    let disk = |ship: &binnacle_tests::Ship| small_disk(&ship.data_dir(), "24m");
    let mut system = ShipAndServer::start_with(Setup::default(), disk).await?;
    system.sail_until(1.0).await?;
    system.wait_until_uploaded().await?;
    system.gateway.set(Behaviour::Fails);
    system.sail_until(2.0).await?;
    system.ship.kill().await?;
    let before = Spool::read(&system.ship).await?;
    ensure!(before.waiting > 1, "{before:?}");
    // As a system treats a failing disk.
    let state = system.ship.data_dir();
    eventually("nobody writes to the disk", TIMEOUT, async || {
        Ok(mount(&["-o", "remount,ro"], &state).map_err(|why| why.to_string()))
    })
    .await?;
    system.ship.start()?;
    let log = system.ship.fails().await?;
    ensure!(
        log.to_lowercase().contains("read-only file system"),
        "{log}"
    );
    ensure!(log.contains("state") && !log.contains("panicked"), "{log}");
    mount(&["-o", "remount,rw"], &state)?;
    system.ship.start()?;
    system.ship.ready().await?;
    system.ensure_nothing_lost(&before).await?;
    system.gateway.set(Behaviour::Passes);
    system.sail_until(3.0).await?;
    let spool = system.wait_until_uploaded().await?;
    ensure_records_match(&system.server, system.vessel, &spool).await?;
    system.check_and_stop().await
}

#[test]
fn a_disk_that_fails_under_a_running_agent_is_reported_and_keeps_its_data() {
    let name = "a_disk_that_fails_under_a_running_agent_is_reported_and_keeps_its_data";
    in_own_mounts(name, failing_disk());
}

/// Mounts a separate file system for the agent's data, which can be made to
/// fail.
fn own_disk(image: &Path, place: &Path) -> Result<()> {
    std::fs::create_dir_all(place)?;
    File::create(image)?.set_len(64_000_000)?;
    let made = Command::new("mkfs.ext4").arg("-q").arg(image).status()?;
    ensure!(made.success(), "mkfs.ext4: {made}");
    mount_image(image, place)
}

fn mount_image(image: &Path, place: &Path) -> Result<()> {
    let image = image.to_str().context("a path in UTF-8")?;
    mount(&["-o", "loop", image], place)
}

async fn failing_disk() -> Result<()> {
    if !rustix::process::geteuid().is_root() || !Path::new("/dev/loop-control").exists() {
        println!("not shown here: it takes root and a loop device");
        return Ok(());
    }
    let folder = tempfile::tempdir()?;
    let image = folder.path().join("disk");
    let disk = |ship: &binnacle_tests::Ship| own_disk(&image, &ship.data_dir());
    let mut system = ShipAndServer::start_with(Setup::default(), disk).await?;
    system.sail_until(1.0).await?;
    system.wait_until_uploaded().await?;
    system.gateway.set(Behaviour::Fails);
    system.sail_until(2.0).await?;
    let before = Spool::read(&system.ship).await?;
    ensure!(before.waiting > 0, "{before:?}");
    // From here on every write fails, as on a disk that the system has given
    // up.
    let state = system.ship.data_dir();
    mount(&["-o", "remount,abort"], &state)?;
    system.sail_until(3.0).await?;
    let said = system
        .wait_for_status("/storage_problem", "cannot be stored")
        .await?;
    ensure!(said.contains("wait in memory"), "{said}");
    let config = system.ship.config();
    let status = [Path::new("status"), Path::new("--config"), &config];
    let shown = output_of("binnacle-agent", status).await?;
    let shown = String::from_utf8(shown.stdout)?;
    ensure!(shown.contains("cannot be stored"), "{shown}");
    system.ensure_nothing_lost(&before).await?;
    system.ship.assert_running()?;
    system.ship.kill().await?;
    let shown = output_of("binnacle-agent", status).await?;
    ensure!(shown.status.success(), "{shown:?}");
    eventually("nobody uses the disk", TIMEOUT, async || {
        let left = Command::new("umount").arg(&state).output()?;
        Ok(if left.status.success() {
            Ok(())
        } else {
            Err(format!("{left:?}"))
        })
    })
    .await?;
    // A repair has an exit code other than 0.
    Command::new("e2fsck").arg("-fy").arg(&image).output()?;
    mount_image(&image, &state)?;
    system.ship.start()?;
    system.ship.ready().await?;
    system.ensure_nothing_lost(&before).await?;
    system.gateway.set(Behaviour::Passes);
    system.sail_until(4.0).await?;
    let spool = system.wait_until_uploaded().await?;
    ensure_records_match(&system.server, system.vessel, &spool).await?;
    system.check_and_stop().await
}

const DAY_S: f64 = 86_400.0;
const ROLL_OVER_S: f64 = 1_024.0 * 7.0 * DAY_S;

#[tokio::test(flavor = "multi_thread", worker_threads = 2)]
async fn no_sample_has_a_wrong_time_with_a_wrong_receiver_clock() {
    wrong_clock().await.unwrap();
}

async fn wrong_clock() -> Result<()> {
    let mut system = ShipAndServer::start().await?;
    system.sail_until(1.0).await?;
    // A quarter of a day each, while the ship is under way.
    let wrong = [(1.0, DAY_S), (2.0, -DAY_S), (3.0, DAY_S)];
    for (from, off_s) in wrong {
        system.voyage.feed.set_clock(off_s)?;
        reach(&mut system, from + 0.25).await?;
        let said = system
            .wait_for_status("/clock_problem", "jumped by")
            .await?;
        ensure!(said.contains("nothing is sampled"), "{said}");
        system.voyage.feed.set_clock(0.0)?;
        system.sail_until(from + 1.0).await?;
        system.wait_for_status("/clock_problem", "null").await?;
    }
    // Here the agent knows the right time.
    system.voyage.feed.set_clock(-ROLL_OVER_S)?;
    system.sail_until(5.0).await?;
    system
        .wait_for_status("/clock_problem", "1024 weeks")
        .await?;
    system.voyage.feed.set_clock(0.0)?;
    system.sail_until(6.0).await?;
    system.wait_for_status("/clock_problem", "null").await?;
    let spool = system.wait_until_uploaded().await?;
    ensure_records_match(&system.server, system.vessel, &spool).await?;
    system.ensure_no_window_lost().await?;
    let samples = stored_samples(&system.server, system.vessel).await?;
    for (from, _) in wrong {
        let at = |s: &&Sample| s.time > day(from).plus_seconds(900.0) && s.time < day(from + 0.25);
        let stored: Vec<&Sample> = samples.iter().filter(at).collect();
        ensure!(stored.is_empty(), "while the clock was wrong: {stored:?}");
    }
    let at = |s: &&Sample| s.time > day(4.0) && s.time < day(5.0);
    ensure!(
        samples.iter().filter(at).count() > 20,
        "none of the day that rolled over"
    );
    ensure_she_sailed(&samples)?;
    system.check_and_stop().await
}

#[tokio::test(flavor = "multi_thread", worker_threads = 2)]
async fn a_receiver_that_is_a_week_wrong_after_a_restart_is_not_believed() {
    wrong_from_the_start().await.unwrap();
}

async fn wrong_from_the_start() -> Result<()> {
    let mut system = ShipAndServer::start().await?;
    system.wait_for_status("/link/state", "up").await?;
    // A day's voyage that ends now: the computer's clock is the ship's.
    let now = system.ship.status().await?["link"]["last_contact"].clone();
    let now = Timestamp::parse(now.as_str().context("no contact with the server")?)?;
    let off_s = now.seconds_since(day(1.0));
    system.voyage.feed.set_clock(off_s)?;
    reach(&mut system, 1.0).await?;
    system.wait_until_uploaded().await?;
    system.ship.stop().await?;
    let wrong = [7.0, -7.0, 7_305.0].map(|days| days * DAY_S);
    let mut minutes = 0.0;
    for wrong_s in wrong {
        system.voyage.feed.set_clock(off_s + wrong_s)?;
        system.ship.start()?;
        system.ship.ready().await?;
        // The first sentences to an agent that has ended are lost.
        eventually("the agent reads a sentence", TIMEOUT, async || {
            minutes += 0.5;
            reach(&mut system, 1.0 + minutes / 1_440.0).await?;
            let status = system.ship.status().await?;
            let heard = status["inputs"][0]["sentences"]["RMC"].is_number();
            Ok(if heard {
                Ok(())
            } else {
                Err(status.to_string())
            })
        })
        .await?;
        let said = system
            .wait_for_status("/clock_problem", "computer's clock")
            .await?;
        ensure!(said.contains("nothing is sampled"), "{said}");
        system.ship.stop().await?;
    }
    system.voyage.feed.set_clock(off_s)?;
    system.ship.start()?;
    system.ship.ready().await?;
    reach(&mut system, 1.9).await?;
    system.wait_for_status("/clock_problem", "null").await?;
    system.wait_until_uploaded().await?;
    let samples = stored_samples(&system.server, system.vessel).await?;
    let (from, to) = (now.plus_seconds(-DAY_S), now.plus_seconds(DAY_S));
    let strange: Vec<&Sample> = samples
        .iter()
        .filter(|sample| sample.time < from || sample.time > to)
        .collect();
    ensure!(strange.is_empty(), "{strange:?}");
    ensure!(
        samples.iter().any(|sample| sample.time > now),
        "nothing since"
    );
    system.check_and_stop().await
}

/// Sails on while the agent's clock stands still.
#[tokio::test(flavor = "multi_thread", worker_threads = 2)]
async fn a_spoofed_hour_is_an_alert_ashore_with_its_place_until_it_passes() {
    spoofed_hour().await.unwrap();
}

async fn spoofed_hour() -> Result<()> {
    const HOUR: f64 = 1.0 / 24.0;
    let setup = Setup {
        uplink: "profile = \"broadband\"\npoll_s = 2\nretry_min_s = 0.2",
        ..Setup::default()
    };
    let mut system = ShipAndServer::start_with(setup, |_| Ok(())).await?;
    system.sail_until(1.0).await?;
    system.voyage.feed.set_spoofed(true)?;
    system.sail_until(1.0 + HOUR).await?;
    let alert = interference_alert(&system, |found| !found.is_empty()).await?;
    let summary = alert[0]["summary"].to_string();
    // Where she is, and not where the receiver says.
    ensure!(
        summary.contains("GNSS interference near 46.") && summary.contains("since 2026-10-02 00:"),
        "{summary}"
    );
    system.voyage.feed.set_spoofed(false)?;
    system.sail_until(1.0 + 2.0 * HOUR).await?;
    interference_alert(&system, <[Value]>::is_empty).await?;
    let path = format!("/vessels/{}/changes", system.vessel);
    let timeline = system.server.get(&path).await?;
    let changes = timeline["changes"].as_array().context("changes")?;
    let [met] = changes.as_slice() else {
        bail!("{timeline}");
    };
    let time = |name: &str| Timestamp::parse(met[name].as_str().unwrap_or_default());
    let lasted_s = time("ended")?.seconds_since(time("from")?);
    ensure!(
        met["cause"] == "gnss_interference" && (3_000.0..6_000.0).contains(&lasted_s),
        "{met}"
    );

    let path = format!("/vessels/{}/samples", system.vessel);
    let mut left_out = 0;
    for sample in system.server.list(&path).await? {
        let is_reckoned = sample["position_reckoned"] == true;
        ensure!(
            (sample["reason"] == "gnss_interference") == is_reckoned,
            "{sample}"
        );
        ensure!(!is_reckoned || sample["used"] == false, "{sample}");
        left_out += u32::from(is_reckoned);
    }
    ensure!(left_out >= 4, "{left_out} samples");
    ensure_she_sailed(&stored_samples(&system.server, system.vessel).await?)?;
    system.check_and_stop().await
}

/// Waits until the alerts of interference ashore are as wanted, and returns
/// them.
async fn interference_alert(
    system: &ShipAndServer,
    wanted: impl Fn(&[Value]) -> bool,
) -> Result<Vec<Value>> {
    eventually("the alert is as wanted", TIMEOUT, async || {
        let alerts = system.server.list("/alerts?state=raised").await?;
        let is_wanted = |alert: &Value| alert["cause"] == "gnss_interference";
        let found: Vec<Value> = alerts.into_iter().filter(is_wanted).collect();
        Ok(if wanted(&found) {
            Ok(found)
        } else {
            Err(format!("{found:?}"))
        })
    })
    .await
}

async fn reach(system: &mut ShipAndServer, days: f64) -> Result<()> {
    system.voyage.feed.set_pace(Pace::FastUntil(day(days)))?;
    let there = |progress: &Progress| progress.time() >= Some(day(days));
    system.voyage.feed.reached(TIMEOUT, there).await?;
    Ok(())
}

/// Checks that no sample is from an impossible position for its time; a wrong
/// one would be 300 nm off.
fn ensure_she_sailed(samples: &[Sample]) -> Result<()> {
    let (first, last) = (
        samples.first().context("samples")?,
        samples.last().context("samples")?,
    );
    ensure!(
        first.time >= day(0.0) && last.time <= day(6.1),
        "{first:?}, {last:?}"
    );
    for pair in samples.windows(2) {
        let hours = pair[1].time.seconds_since(pair[0].time) / 3_600.0;
        let sailed_nm = distance_nm(pair[0].position, pair[1].position);
        ensure!(
            sailed_nm < 16.0 * hours + 2.0,
            "{sailed_nm} nm between {pair:?}"
        );
    }
    Ok(())
}

fn distance_nm(a: Position, b: Position) -> f64 {
    let north = b.lat_deg() - a.lat_deg();
    let east = (b.lon_deg() - a.lon_deg()) * a.lat_deg().to_radians().cos();
    60.0 * north.hypot(east)
}

#[tokio::test(flavor = "multi_thread", worker_threads = 2)]
async fn nothing_from_outside_makes_the_agent_write_outside_its_folder() {
    hostile_input().await.unwrap();
}

async fn hostile_input() -> Result<()> {
    let setup = Setup {
        name: "../../../../outside",
        ..Setup::default()
    };
    let mut system = ShipAndServer::start_with(setup, |_| Ok(())).await?;
    system.sail_until(1.0).await?;
    system.wait_until_uploaded().await?;
    let page = system.ship.page()?;
    let http = reqwest::Client::builder().no_proxy().build()?;
    for path in ["../../outside", "..%2f..%2foutside", "%2fetc%2foutside"] {
        let url = format!("http://{page}/api/reports/{path}");
        let report = serde_json::json!({ "kind": "lightning", "from": "2026-10-01T00:00:00Z" });
        let answer = http.put(url).json(&report).send().await?;
        ensure!(!answer.status().is_success(), "{path}: {}", answer.status());
    }
    system.sail_until(2.0).await?;
    system.wait_until_uploaded().await?;
    let mut found = BTreeSet::new();
    list(system.folder(), system.folder(), &mut found)?;
    let of_others = [
        "binnacle.db",
        "server.log",
        "biscay.toml",
        "ship/agent.toml",
        "ship/agent.log",
    ];
    found.retain(|path| !of_others.iter().any(|other| path.starts_with(other)));
    let state = [
        "agent.lock",
        "ring.bin",
        "spool.db",
        "spool.db-shm",
        "spool.db-wal",
        "status.sock",
    ];
    let state: BTreeSet<String> = state
        .iter()
        .map(|name| format!("ship/state/{name}"))
        .collect();
    ensure!(found == state, "{found:?}");
    system.check_and_stop().await
}

fn list(folder: &Path, top: &Path, found: &mut BTreeSet<String>) -> Result<()> {
    for entry in std::fs::read_dir(folder)? {
        let path = entry?.path();
        if path.is_dir() {
            list(&path, top, found)?;
        } else {
            found.insert(path.strip_prefix(top)?.display().to_string());
        }
    }
    Ok(())
}
