//! Two servers on one database, and a database that fails over: what was acknowledged is stored,
//! once, and is analysed.

#![allow(clippy::unwrap_used, reason = "these are tests, helpers included")]

use anyhow::{Context, Result, ensure};
use binnacle_tests::link::relay::Relay;
use binnacle_tests::process::postgres::{PostgresPair, url};
use binnacle_tests::records::batch_log;
use binnacle_tests::uploader::{frame, samples};
use binnacle_tests::{Database, Engine, ServerProcess, Uploader, eventually};
use futures_util::future::try_join_all;
use reqwest::{Client, StatusCode};
use std::collections::BTreeMap;
use std::sync::atomic::{AtomicUsize, Ordering};
use std::time::{Duration, Instant};
use uuid::Uuid;

/// Time for what a machine that may be busy does.
const TIMEOUT: Duration = Duration::from_mins(2);
/// Time for one request: a dead server's connection says nothing.
const REQUEST: Duration = Duration::from_secs(10);
/// Agents that upload at once.
const AGENTS: usize = 4;
/// Batches of each agent.
const BATCHES: usize = 12;
/// Samples of each batch.
const SAMPLES: usize = 6;
/// Acknowledged batches after which something is killed.
const BEFORE: usize = AGENTS * BATCHES / 3;

/// Agents that upload, to each server in turn, until all is acknowledged.
struct Storm {
    agents: Vec<Uploader>,
    acknowledged: AtomicUsize,
}

impl Storm {
    async fn prepare(server: &ServerProcess) -> Result<Storm> {
        let mut agents = Vec::new();
        for number in 0..AGENTS {
            agents.push(Uploader::enrol(server, &format!("Ship {number}")).await?);
        }
        Ok(Storm {
            agents,
            acknowledged: AtomicUsize::new(0),
        })
    }

    /// Uploads everything, and meanwhile does something to the servers.
    async fn run(
        &self,
        servers: &[String],
        meanwhile: impl Future<Output = Result<()>>,
    ) -> Result<()> {
        let uploads = self.agents.iter().map(|agent| self.upload(agent, servers));
        let uploads = async { try_join_all(uploads).await.map(drop) };
        let meanwhile = async {
            self.wait_for(BEFORE).await?;
            meanwhile.await
        };
        tokio::try_join!(uploads, meanwhile).map(drop)
    }

    async fn wait_for(&self, batches: usize) -> Result<()> {
        let what = format!("{batches} batches are acknowledged");
        eventually(what, TIMEOUT, async || {
            let now = self.acknowledged.load(Ordering::Relaxed);
            Ok(if now < batches {
                Err(now.to_string())
            } else {
                Ok(())
            })
        })
        .await
    }

    async fn upload(&self, agent: &Uploader, servers: &[String]) -> Result<()> {
        let http = Client::builder().timeout(REQUEST).no_proxy().build()?;
        let mut tries = 0_usize;
        for number in 0..BATCHES {
            let body = batch(agent, number)?;
            let path = format!("/api/v1/streams/{}/batches/{}", agent.stream, number + 1);
            let begun = Instant::now();
            loop {
                let server = &servers[tries % servers.len()];
                tries += 1;
                let request = http.put(format!("{server}{path}")).body(body.clone());
                let answer = request.bearer_auth(&agent.token).send().await;
                match answer.map(|answer| answer.status()) {
                    Ok(StatusCode::OK) => break,
                    // Refused for now, or the server or its database is gone.
                    Ok(status) => ensure!(status.is_server_error(), "{path}: {status}"),
                    Err(_) => {}
                }
                ensure!(begun.elapsed() < TIMEOUT, "{path} was not acknowledged");
                tokio::task::yield_now().await;
            }
            self.acknowledged.fetch_add(1, Ordering::Relaxed);
        }
        Ok(())
    }

    /// Checks that each batch is stored as it was sent, and each sample analysed once.
    async fn ensure_stored_once(&self, server: &ServerProcess) -> Result<()> {
        for agent in &self.agents {
            let vessel: Uuid = agent.vessel.parse()?;
            let log = batch_log(server.database(), vessel).await?;
            let stored: BTreeMap<i64, Vec<u8>> = log
                .iter()
                .map(|(_, seq, bytes)| (*seq, bytes.clone()))
                .collect();
            ensure!(log.len() == BATCHES && stored.len() == BATCHES, "{log:?}");
            for number in 0..BATCHES {
                let sent = batch(agent, number)?;
                let seq = i64::try_from(number + 1)?;
                ensure!(stored[&seq] == sent, "batch {seq} is another");
            }
            let path = format!("/vessels/{}/samples", agent.vessel);
            eventually("all samples are analysed", TIMEOUT, async || {
                let listed = server.list(&path).await?.len();
                ensure!(listed <= BATCHES * SAMPLES, "{listed} samples");
                Ok(if listed == BATCHES * SAMPLES {
                    Ok(())
                } else {
                    Err(format!("{listed} samples"))
                })
            })
            .await?;
        }
        Ok(())
    }
}

fn batch(agent: &Uploader, number: usize) -> Result<Vec<u8>> {
    let seq = u64::try_from(number + 1)?;
    frame(agent.stream, seq, samples(number * SAMPLES, SAMPLES)?)
}

#[tokio::test(flavor = "multi_thread", worker_threads = 2)]
async fn a_killed_server_of_two_loses_and_doubles_nothing() {
    killed_server().await.unwrap();
}

async fn killed_server() -> Result<()> {
    let folders = [tempfile::tempdir()?, tempfile::tempdir()?];
    let mut first = ServerProcess::start(Engine::Postgres, folders[0].path()).await?;
    let second = first.start_beside(folders[1].path()).await?;
    let storm = Storm::prepare(&first).await?;
    let servers = [first.url.clone(), second.url.clone()];
    storm.run(&servers, first.kill_and_restart()).await?;
    storm.ensure_stored_once(&second).await?;
    second.finish().await?;
    first.finish().await
}

#[tokio::test(flavor = "multi_thread", worker_threads = 2)]
async fn a_standby_takes_over_with_all_that_was_acknowledged() {
    failover().await.unwrap();
}

async fn failover() -> Result<()> {
    let mut pair = PostgresPair::start().await?;
    let relay = Relay::open(pair.primary_address).await?;
    let database = Database::at(url(relay.address));
    let folders = [tempfile::tempdir()?, tempfile::tempdir()?];
    let first = ServerProcess::start_on(database, folders[0].path()).await?;
    let second = first.start_beside(folders[1].path()).await?;
    let storm = Storm::prepare(&first).await?;
    let servers = [first.url.clone(), second.url.clone()];
    let fail_over = async {
        pair.kill_primary().await?;
        pair.promote_standby().await?;
        relay.redirect(pair.standby_address);
        Ok(())
    };
    storm.run(&servers, fail_over).await.context("the storm")?;
    storm.ensure_stored_once(&second).await?;
    second.finish().await?;
    first.finish().await?;
    pair.finish().await
}
