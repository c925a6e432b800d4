//! The real programs over a satellite: what it costs, and what it may do to them.

#![allow(clippy::unwrap_used, reason = "these are tests, helpers included")]

use anyhow::{Result, ensure};
use binnacle_magnetics::time::Timestamp;
use binnacle_tests::ledger::{Acknowledged, Spool, batch_log};
use binnacle_tests::satellite::{Certificates, INSTRUMENTS, Weather, ensure_used, in_own_network};
use binnacle_tests::{Pace, Satellite, Ship, Shore, Voyage, eventually};
use std::time::Duration;
use tempfile::TempDir;
use uuid::Uuid;

const START: &str = "2026-10-01T00:00:00Z";
const PATIENCE: Duration = Duration::from_mins(8);

fn day(day: f64) -> Timestamp {
    Timestamp::parse(START)
        .unwrap()
        .plus_seconds(day * 86_400.0)
}

/// A ship at sea with all that belongs to her.
struct AtSea {
    folder: TempDir,
    satellite: Satellite,
    shore: Shore,
    vessel: Uuid,
    voyage: Voyage,
    ship: Ship,
}

impl AtSea {
    async fn sail(uplink: &str) -> Result<AtSea> {
        let folder = tempfile::tempdir()?;
        let satellite = Satellite::launch().await?;
        let tls = Certificates::make(folder.path())?;
        let shore = Shore::start_ashore(folder.path(), &tls).await?;
        let (vessel, code) = shore.create_vessel("biscay").await?;
        let pace = Pace::FastUntil(day(0.0));
        let voyage = Voyage::sail_at(INSTRUMENTS, "biscay.toml", 11, folder.path(), pace).await?;
        let uplink = format!("pinned_ca = \"{}\"\n{uplink}", tls.authority.display());
        let feed = voyage.feed.address();
        let ship = Ship::with_uplink("biscay", folder.path(), feed, &uplink)?;
        let mut ship = ship.at_sea(satellite.berth());
        ship.enrol(&shore.url, &code).await?;
        ship.start()?;
        ship.ready().await?;
        Ok(AtSea {
            folder,
            satellite,
            shore,
            vessel: vessel.parse()?,
            voyage,
            ship,
        })
    }

    /// Sails on to an instant; returns when the agent has heard of it.
    async fn until(&mut self, time: Timestamp) -> Result<()> {
        self.voyage.feed.set_pace(Pace::FastUntil(time))?;
        let there = |progress: &binnacle_tests::Progress| progress.time() >= Some(time);
        self.voyage.feed.reached(PATIENCE, there).await?;
        eventually("the agent has heard it", PATIENCE, async || {
            let status = self.ship.status().await?;
            let heard = status["ship_time"].as_str().map(Timestamp::parse);
            let heard = heard.transpose()? >= Some(time);
            Ok(if heard {
                Ok(())
            } else {
                Err(status.to_string())
            })
        })
        .await
    }

    /// Waits until nothing waits on board.
    async fn all_ashore(&self) -> Result<Spool> {
        eventually("all is ashore", PATIENCE, async || {
            let spool = Spool::of(&self.ship).await?;
            let sent = spool.waiting == 0;
            Ok(if sent {
                Ok(spool)
            } else {
                Err(format!("{spool:?}"))
            })
        })
        .await
    }

    /// Both ends' records are the same, to the checksum.
    async fn assert_same_at_both_ends(&self, spool: &Spool) -> Result<()> {
        ensure!(spool.in_trouble == 0, "{spool:?}");
        let logged: Vec<Acknowledged> = batch_log(self.shore.database(), self.vessel)
            .await?
            .into_iter()
            .map(|(stream, seq, bytes)| {
                Ok(Acknowledged {
                    stream,
                    seq,
                    samples: i64::try_from(binnacle_wire::decode(&bytes)?.samples.len())?,
                    crc32: i64::from(crc32fast::hash(&bytes)),
                })
            })
            .collect::<Result<_>>()?;
        ensure!(logged == spool.acknowledged, "{logged:?}, {spool:?}");
        Ok(())
    }

    async fn arrive(mut self) -> Result<()> {
        self.ship.assert_running()?;
        self.ship.kill().await?;
        self.shore.assert_well().await?;
        self.shore.finish().await?;
        drop(self.folder);
        Ok(())
    }
}

#[test]
fn a_week_costs_few_octets_packets_and_all() {
    in_own_network("a_week_costs_few_octets_packets_and_all", async {
        let mut at_sea = AtSea::sail("").await?;
        let quarters = 7 * 4;
        let before = at_sea.satellite.tally().await?;
        for quarter in 1..=quarters {
            at_sea.until(day(f64::from(quarter) / 4.0)).await?;
            at_sea.all_ashore().await?;
        }
        let spool = at_sea.all_ashore().await?;
        at_sea.assert_same_at_both_ends(&spool).await?;
        let after = at_sea.satellite.tally().await?;
        ensure_used(&after)?;
        let per_day = (after.octets() - before.octets()) / 7;
        println!(
            "{after:?} {per_day} octets a day, {} batches",
            spool.acknowledged.len()
        );
        at_sea.arrive().await
    });
}

#[test]
fn a_link_of_one_and_a_half_seconds_that_loses_every_fifth_packet_brings_all_ashore() {
    in_own_network(
        "a_link_of_one_and_a_half_seconds_that_loses_every_fifth_packet_brings_all_ashore",
        async {
            let mut at_sea = AtSea::sail("retry_min_s = 0.2\nretry_max_s = 1").await?;
            at_sea
                .satellite
                .set(Weather {
                    round_trip_ms: Some(1500.0),
                    loss: Some(0.2),
                    bits_per_s: Some(2400.0),
                    ..Weather::default()
                })
                .await?;
            at_sea.until(day(1.0)).await?;
            let spool = at_sea.all_ashore().await?;
            at_sea.assert_same_at_both_ends(&spool).await?;
            ensure_used(&at_sea.satellite.tally().await?)?;
            at_sea.arrive().await
        },
    );
}
