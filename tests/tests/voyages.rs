//! The complete path: two ships sail, their agents upload, and agents and
//! server are killed on the way. In the end nothing is lost or doubled, the
//! models hold the truth, and the autopilot reads it.

#![allow(clippy::unwrap_used, reason = "these are tests, helpers included")]

use anyhow::{Context, Result, ensure};
use binnacle_compass::angle::wrap_180;
use binnacle_compass::sample::Sample;
use binnacle_compass::time::Timestamp;
use binnacle_tests::records::{Acknowledged, Spool, batch_log, checksum};
use binnacle_tests::voyage::Place;
use binnacle_tests::{Engine, Pace, Progress, ServerProcess, Ship, Voyage, autopilot, eventually};
use binnacle_wire::decode;
use serde_json::Value;
use std::path::Path;
use std::time::Duration;
use uuid::Uuid;

const START: &str = "2026-10-01T00:00:00Z";
const DAYS: f64 = 12.0;
/// Time that a ship sails on while another is killed.
const AFTER_KILL_S: f64 = 12.0 * 3600.0;
/// Sailed live at the end, for the autopilot.
const LIVE_S: f64 = 600.0;
/// Time for a few days' sailing on a busy machine.
const TIMEOUT: Duration = Duration::from_mins(5);
/// A tenth of a degree in a sentence, and interpolation between rows of the
/// truth.
const ROUNDING_DEG: f64 = 0.15;
/// The least number of samples of each ship in these days.
const LEAST_SAMPLES: i64 = 1_000;

struct Vessel {
    id: Uuid,
    ship: Ship,
    voyage: Voyage,
}

/// The process to kill.
#[derive(Clone, Copy, Debug)]
enum Victim {
    Agent(usize),
    Server,
}

fn day(day: f64) -> Timestamp {
    Timestamp::parse(START)
        .unwrap()
        .plus_seconds(day * 86_400.0)
}

/// End of the fast part.
fn fast_end() -> Timestamp {
    day(DAYS).plus_seconds(-LIVE_S)
}

/// One seed of the kills in `make test`, many in `make soak`.
fn seeds() -> std::ops::Range<u64> {
    let soak = std::env::var_os("BINNACLE_SOAK").is_some();
    3..if soak { 23 } else { 4 }
}

/// Eight moments in order, from a seeded generator.
fn kills(seed: u64) -> Vec<(f64, Victim)> {
    let mut state = seed;
    let mut next = || {
        state = state
            .wrapping_mul(6_364_136_223_846_793_005)
            .wrapping_add(1_442_695_040_888_963_407);
        (state >> 33) as f64 / f64::from(1_u32 << 31)
    };
    let victims = [
        Victim::Agent(0),
        Victim::Server,
        Victim::Agent(1),
        Victim::Server,
        Victim::Agent(1),
        Victim::Agent(0),
        Victim::Server,
        Victim::Agent(0),
    ];
    let moment = |(place, victim)| ((place as f64 + 0.5 + next()) * DAYS / 9.0, victim);
    victims.into_iter().enumerate().map(moment).collect()
}

async fn set_sail(
    server: &ServerProcess,
    scenario: &str,
    seed: u64,
    folder: &Path,
) -> Result<Vessel> {
    let (id, code) = server.create_vessel(scenario).await?;
    let pace = Pace::FastUntil(day(0.0));
    let voyage = Voyage::sail(&format!("{scenario}.toml"), seed, folder, pace).await?;
    let mut ship = Ship::new(scenario, folder, voyage.feed.address())?;
    ship.enrol(&server.url, &code).await?;
    ship.start()?;
    Ok(Vessel {
        id: id.parse()?,
        ship,
        voyage,
    })
}

/// Sails to the end of the fast part, with the kills on the way: no ship runs
/// ahead of them, and all are under way at each kill.
async fn sail(server: &mut ServerProcess, vessels: &mut [Vessel], seed: u64) -> Result<()> {
    for (when, victim) in kills(seed) {
        let moment = day(when);
        for vessel in &*vessels {
            let pace = Pace::FastUntil(moment.plus_seconds(AFTER_KILL_S));
            vessel.voyage.feed.set_pace(pace)?;
        }
        let whose = if let Victim::Agent(index) = victim {
            index
        } else {
            0
        };
        let passed = |progress: &Progress| progress.time() >= Some(moment);
        vessels[whose].voyage.feed.reached(TIMEOUT, passed).await?;
        match victim {
            Victim::Agent(index) => vessels[index].ship.kill_and_restart().await?,
            Victim::Server => server.kill_and_restart().await?,
        }
    }
    for vessel in vessels {
        vessel.voyage.feed.set_pace(Pace::FastUntil(fast_end()))?;
        let there = |progress: &Progress| progress.time() >= Some(fast_end());
        vessel.voyage.feed.reached(TIMEOUT, there).await?;
        vessel.ship.assert_running()?;
    }
    Ok(())
}

/// Waits until the agent has read all sentences and no batch waits.
async fn settled(vessel: &Vessel, until: Timestamp) -> Result<Spool> {
    eventually("the agent has sent all", TIMEOUT, async || {
        let status = vessel.ship.status().await?;
        let time = status["ship_time"]
            .as_str()
            .map(Timestamp::parse)
            .transpose()?;
        let spool = Spool::read(&vessel.ship).await?;
        let settled = time >= Some(until) && spool.waiting == 0;
        Ok(if settled {
            Ok(spool)
        } else {
            Err(status.to_string())
        })
    })
    .await
}

/// Compares both ends' records: the batches that the agent holds for
/// acknowledged must be those of the server, to the checksum. Returns their
/// samples in order of time.
async fn assert_every_batch_once(
    server: &ServerProcess,
    vessel: &Vessel,
    spool: &Spool,
) -> Result<Vec<Sample>> {
    ensure!(
        spool.refused == 0,
        "{} batches are in trouble",
        spool.refused
    );
    // The number of batches depends on the waiting times at a busy server.
    let samples: i64 = spool.acknowledged.iter().map(|batch| batch.samples).sum();
    ensure!(
        samples > LEAST_SAMPLES,
        "only {samples} samples are on the server"
    );
    let mut sent = Vec::new();
    let mut logged = Vec::new();
    for (stream, seq, bytes) in batch_log(server.database(), vessel.id).await? {
        let batch = decode(&bytes)?;
        logged.push(Acknowledged {
            stream,
            seq,
            samples: i64::try_from(batch.samples.len())?,
            crc32: i64::from(checksum(&bytes)),
        });
        sent.extend(batch.samples);
    }
    let unsent = &spool.acknowledged;
    let lacking = |of: &[Acknowledged], other: &[Acknowledged]| -> Vec<Acknowledged> {
        let lacks = |batch: &&Acknowledged| !other.contains(batch);
        of.iter().filter(lacks).cloned().collect()
    };
    ensure!(
        logged == *unsent,
        "only on board {:?}, only on the server {:?}",
        lacking(unsent, &logged),
        lacking(&logged, unsent)
    );
    sent.sort_by_key(|sample| sample.time);
    for pair in sent.windows(2) {
        let apart = pair[1].time.seconds_since(pair[0].time);
        let both = 5.0 * f64::from(pair[0].windows) + 5.0 * f64::from(pair[1].windows);
        ensure!(apart >= both, "these share windows: {pair:?}");
    }
    Ok(sent)
}

/// Waits for a model of all samples.
async fn final_model(server: &ServerProcess, vessel: &Vessel, sent: &[Sample]) -> Result<()> {
    let last = sent.last().context("there are samples")?.time;
    let path = format!("/vessels/{}/model", vessel.id);
    eventually("a model of all samples", TIMEOUT, async || {
        let Some(model) = server.find(&path).await? else {
            return Ok(Err("there is none".to_owned()));
        };
        let until = model["data_until"].as_str().context("data_until")?;
        let complete = Timestamp::parse(until)? >= last;
        Ok(if complete {
            Ok(())
        } else {
            Err(format!("{until}, {last}"))
        })
    })
    .await
}

/// Checks that the API returns the samples sent, each once.
async fn assert_every_sample_once(
    server: &ServerProcess,
    vessel: &Vessel,
    sent: &[Sample],
) -> Result<()> {
    let listed = server
        .list(&format!("/vessels/{}/samples", vessel.id))
        .await?;
    let mut listed: Vec<Sample> = listed
        .into_iter()
        .map(serde_json::from_value)
        .collect::<Result<_, _>>()?;
    listed.sort_by_key(|sample| sample.time);
    ensure!(
        listed.len() == sent.len(),
        "{} of {} samples",
        listed.len(),
        sent.len()
    );
    for (listed, sent) in listed.iter().zip(sent) {
        let same = (listed.time, listed.windows) == (sent.time, sent.windows)
            && apart_deg(listed.compass.degrees(), sent.compass.degrees()) < 1e-6;
        ensure!(same, "sent {sent:?}, listed {listed:?}");
    }
    Ok(())
}

fn apart_deg(a: f64, b: f64) -> f64 {
    wrap_180(a - b).abs()
}

/// Checks that the band of the deviation curve at the voyage's end contains the
/// truth on at least nine headings in ten.
async fn assert_band_holds_truth(
    server: &ServerProcess,
    vessel: &Vessel,
    truth: &Place,
) -> Result<()> {
    let Place { lat, lon, at, .. } = truth;
    let path = format!("/vessels/{}/deviation", vessel.id);
    let curve = server
        .get(&format!("{path}?lat={lat}&lon={lon}&at={at}&step_deg=10"))
        .await?;
    let variation = curve["variation_deg"].as_f64().context("variation_deg")?;
    ensure!(
        apart_deg(variation, truth.variation_deg) < 0.02,
        "{variation}, {truth:?}"
    );
    let rows = curve["rows"].as_array().context("rows")?;
    ensure!(rows.len() == 36, "{} rows", rows.len());
    let missed: Vec<String> = rows.iter().filter_map(|row| missed(row, truth)).collect();
    ensure!(missed.len() <= 3, "the band misses the truth: {missed:#?}");
    Ok(())
}

fn missed(row: &Value, truth: &Place) -> Option<String> {
    let field = |name: &str| row[name].as_f64();
    let error = match (
        field("compass_deg"),
        field("deviation_deg"),
        field("band95_deg"),
    ) {
        (Some(compass), Some(deviation), Some(band)) => {
            let error = deviation - truth.deviation_deg(compass);
            if error.abs() <= band {
                return None;
            }
            error
        }
        _ => f64::NAN,
    };
    Some(format!("{row}: {error:+.3} from the truth"))
}

/// Sails on for ten minutes and reads the output as an autopilot.
async fn assert_autopilot_hears_truth(vessel: &mut Vessel, last: Timestamp) -> Result<()> {
    eventually("the model is on board", TIMEOUT, async || {
        let status = vessel.ship.status().await?;
        let until = status["model"]["data_until"].as_str();
        let until = until.map(Timestamp::parse).transpose()?;
        // A nearly identical model is sent once it is three days younger.
        let unsent = until > Some(last.plus_seconds(-3.0 * 86_400.0));
        Ok(if unsent {
            Ok(())
        } else {
            Err(status.to_string())
        })
    })
    .await?;
    let output = vessel.ship.ready().await?;
    vessel.voyage.feed.set_pace(Pace::Live)?;
    let received = autopilot::corrections(output, 20, TIMEOUT).await?;
    vessel
        .voyage
        .feed
        .reached(TIMEOUT, |progress| *progress == Progress::Ended)
        .await?;
    let truth = vessel.voyage.truth().await?.at_the_end;
    for correction in received {
        let deviation = truth.deviation_deg(correction.compass_deg);
        let error = correction.deviation_deg - deviation;
        let band = 1.96 * correction.standard_error_deg;
        ensure!(
            error.abs() <= band + ROUNDING_DEG,
            "{correction:?}: the truth is {deviation:.2}"
        );
        let variation = correction.variation_deg - truth.variation_deg;
        ensure!(
            variation.abs() <= ROUNDING_DEG,
            "{correction:?}: {}",
            truth.variation_deg
        );
        let sum = correction.compass_deg + correction.deviation_deg + correction.variation_deg;
        ensure!(
            apart_deg(sum, correction.true_deg) <= ROUNDING_DEG,
            "{correction:?}"
        );
    }
    Ok(())
}

async fn whole_way(engine: Engine) -> Result<()> {
    for seed in seeds() {
        with_kills(engine, seed)
            .await
            .with_context(|| format!("with the kills of seed {seed}"))?;
    }
    Ok(())
}

async fn with_kills(engine: Engine, seed: u64) -> Result<()> {
    let folder = tempfile::tempdir()?;
    let mut server = ServerProcess::start(engine, folder.path()).await?;
    let mut vessels = Vec::new();
    for (scenario, seed) in [("biscay", 11), ("agulhas", 12)] {
        vessels.push(set_sail(&server, scenario, seed, folder.path()).await?);
    }
    sail(&mut server, &mut vessels, seed).await?;
    for vessel in &mut vessels {
        let spool = settled(vessel, fast_end()).await?;
        let sent = assert_every_batch_once(&server, vessel, &spool).await?;
        final_model(&server, vessel, &sent).await?;
        assert_every_sample_once(&server, vessel, &sent).await?;
        let last = sent.last().context("there are samples")?.time;
        assert_autopilot_hears_truth(vessel, last).await?;
        let truth = vessel.voyage.truth().await?.at_the_end;
        assert_band_holds_truth(&server, vessel, &truth).await?;
        vessel.ship.kill().await?;
    }
    server.assert_healthy().await?;
    server.finish().await
}

#[tokio::test(flavor = "multi_thread", worker_threads = 2)]
async fn nothing_is_lost_and_the_truth_is_found_on_sqlite() {
    whole_way(Engine::Sqlite).await.unwrap();
}

#[tokio::test(flavor = "multi_thread", worker_threads = 2)]
async fn nothing_is_lost_and_the_truth_is_found_on_postgres() {
    whole_way(Engine::Postgres).await.unwrap();
}
