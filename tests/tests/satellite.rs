//! The real programs over a satellite link: data volume and robustness.

#![allow(clippy::unwrap_used, reason = "these are tests, helpers included")]

use anyhow::{Result, ensure};
use binnacle_tests::ShipOnLink;
use binnacle_tests::link::chains::Chain;
use binnacle_tests::link::satellite::{Conditions, Tally, ensure_used};
use binnacle_tests::process::namespace::in_own_network;
use binnacle_tests::records::{Spool, counted_bytes};
use binnacle_tests::sailing::day;
use std::path::Path;
use std::time::Duration;
use tokio::time::interval;

/// A sending interval, and the most bytes that a day of it may cost.
struct Policy {
    profile: &'static str,
    seal_s: u32,
    bytes_a_day: f64,
}

const FOUR_TIMES_A_DAY: Policy = Policy {
    profile: "standard",
    seal_s: 6 * 3600,
    bytes_a_day: 8_000.0,
};
const DAILY: Policy = Policy {
    profile: "metered",
    seal_s: 24 * 3600,
    bytes_a_day: 2_800.0,
};
const HOURLY: Policy = Policy {
    profile: "vsat",
    seal_s: 3600,
    bytes_a_day: 12_900.0,
};

/// Days to measure: as few as given, or a month with `make bench-link`.
fn days_or(few: u32) -> u32 {
    let asked = std::env::var("BINNACLE_LINK_DAYS").ok();
    asked.map_or(few, |days| days.parse().expect("a number of days"))
}

/// Sails for some days in fast time: at each sealed batch the ship waits until
/// it is uploaded and analysed, as it would be before the next one.
async fn costs(policy: Policy) -> Result<()> {
    let days = days_or(2);
    let profile = format!("profile = \"{}\"", policy.profile);
    let mut remote = ShipOnLink::start("month.toml", &profile).await?;
    // The first day brings settings and a first model; later days are alike.
    sail_days(&mut remote, &policy, 0, 2).await?;
    let before = remote.satellite.tally().await?;
    sail_days(&mut remote, &policy, 2, 2 + days).await?;
    let after = remote.satellite.tally().await?;
    ensure_used(&after)?;
    let a_day = per_day(&before, &after, days);
    let spool = remote.wait_until_uploaded().await?;
    println!(
        "{}: {a_day:.0} bytes a day over {} days, {} batches in all",
        policy.profile,
        days,
        spool.acknowledged.len()
    );
    remote.check_and_stop().await?;
    ensure!(a_day <= policy.bytes_a_day, "{a_day} bytes a day");
    Ok(())
}

async fn sail_days(remote: &mut ShipOnLink, policy: &Policy, from: u32, to: u32) -> Result<()> {
    // The next batch is sealed when a sample is older: not two in one step.
    let step = f64::from(policy.seal_s) / 86_400.0;
    let mut time = f64::from(from);
    while time < f64::from(to) {
        time += step;
        remote.sail_until(day(time)).await?;
        remote.wait_until_uploaded().await?;
        remote.wait_until_analysed().await?;
    }
    Ok(())
}

fn per_day(before: &Tally, after: &Tally, days: u32) -> f64 {
    (after.bytes() - before.bytes()) as f64 / f64::from(days)
}

#[test]
fn four_batches_a_day_cost_few_bytes_packets_and_all() {
    let name = "four_batches_a_day_cost_few_bytes_packets_and_all";
    in_own_network(name, costs(FOUR_TIMES_A_DAY));
}

#[test]
fn a_batch_a_day_costs_few_bytes_packets_and_all() {
    let name = "a_batch_a_day_costs_few_bytes_packets_and_all";
    in_own_network(name, costs(DAILY));
}

#[test]
fn a_batch_an_hour_costs_few_bytes_packets_and_all() {
    let name = "a_batch_an_hour_costs_few_bytes_packets_and_all";
    in_own_network(name, costs(HOURLY));
}

#[test]
fn the_agent_counts_what_its_server_s_certificates_cost() {
    let name = "the_agent_counts_what_its_server_s_certificates_cost";
    in_own_network(name, async {
        let mut costs = Vec::new();
        for chain in [Chain::EcdsaLeaf, Chain::RsaTwo, Chain::RsaThree] {
            costs.push(cost_of_chain(chain).await?);
        }
        // How many connections a day needs depends on the machine's load, and so do
        // packets that are sent again: one connection's bytes do not.
        ensure!(costs.is_sorted(), "{costs:?}");
        Ok(())
    });
}

/// Returns what the agent counts for a connection to a server of this chain, in bytes.
async fn cost_of_chain(chain: Chain) -> Result<f64> {
    let days = days_or(1);
    let certify = |folder: &Path, server| chain.make(folder, server);
    let uplink = "profile = \"metered\"";
    let mut remote = ShipOnLink::start_with("month.toml", uplink, certify).await?;
    // The first day brings settings and a first model.
    sail_days(&mut remote, &DAILY, 0, 1).await?;
    let before = remote.satellite.tally().await?;
    let (counted_before, _) = counted_bytes(&remote.ship).await?;
    sail_days(&mut remote, &DAILY, 1, 1 + days).await?;
    let carried = per_day(&before, &remote.satellite.tally().await?, days);
    let (counted_after, connection) = counted_bytes(&remote.ship).await?;
    let counted = (counted_after - counted_before) / f64::from(days);
    println!(
        "{chain:?}: {carried:.0} bytes a day, {counted:.0} counted, {connection:.0} a connection"
    );
    remote.check_and_stop().await?;
    ensure!(
        (counted / carried - 1.0).abs() < 0.2,
        "{counted} of {carried}"
    );
    Ok(connection)
}

/// A link that is up for 20 s every ten minutes, with a round trip of 1.5 s.
struct Windows {
    up_s: f64,
    down_s: f64,
    round_trip_ms: f64,
}

/// The real times with `make soak`, otherwise a quarter of them: a window still
/// holds as many requests. Between two windows the agent has time to give up
/// and to reach its longest backoff; the rest of the ten minutes is left out.
fn windows() -> Windows {
    if std::env::var_os("BINNACLE_SOAK").is_some() {
        return Windows {
            up_s: 20.0,
            down_s: 580.0,
            round_trip_ms: 1_500.0,
        };
    }
    Windows {
        up_s: 5.0,
        down_s: 15.0,
        round_trip_ms: 375.0,
    }
}

#[test]
fn a_link_that_is_up_for_20_s_at_a_time_uploads_everything() {
    let name = "a_link_that_is_up_for_20_s_at_a_time_uploads_everything";
    in_own_network(name, short_windows());
}

async fn short_windows() -> Result<()> {
    // As impatient as possible: it has a few windows, not a day of them.
    let uplink = "retry_min_s = 1\nretry_max_s = 3\nexchange_s = 10";
    let mut remote = ShipOnLink::start("biscay.toml", uplink).await?;
    remote.sail_until(day(1.0)).await?;
    remote.wait_until_uploaded().await?;
    let link = windows();
    let conditions = |up| Conditions {
        up: Some(up),
        round_trip_ms: Some(link.round_trip_ms),
        ..Conditions::default()
    };
    remote.satellite.set(conditions(false)).await?;
    remote.sail_until(day(11.0)).await?;
    let mut unsent = Spool::read(&remote.ship).await?;
    ensure!(unsent.waiting > 9, "{unsent:?}");
    let mut windows = 0;
    while unsent.waiting > 0 {
        windows += 1;
        ensure!(windows < 30, "{unsent:?}");
        for (is_up, seconds) in [(true, link.up_s), (false, link.down_s)] {
            remote.satellite.set(conditions(is_up)).await?;
            let mut over = interval(Duration::from_secs_f64(seconds));
            over.tick().await;
            over.tick().await;
        }
        let now = Spool::read(&remote.ship).await?;
        let goes_on = now.acknowledged.starts_with(&unsent.acknowledged);
        ensure!(goes_on, "{now:?}, before {unsent:?}");
        println!("{} wait after {windows} windows", now.waiting);
        unsent = now;
    }
    ensure!(windows > 1, "one was enough: it proves nothing");
    remote.satellite.set(conditions(true)).await?;
    remote.check_and_stop().await
}

#[test]
fn a_link_of_one_and_a_half_seconds_that_loses_every_fifth_packet_uploads_everything() {
    in_own_network(
        "a_link_of_one_and_a_half_seconds_that_loses_every_fifth_packet_uploads_everything",
        async {
            let uplink = "retry_min_s = 0.2\nretry_max_s = 1";
            let mut remote = ShipOnLink::start("biscay.toml", uplink).await?;
            remote
                .satellite
                .set(Conditions {
                    round_trip_ms: Some(1500.0),
                    loss: Some(0.2),
                    bits_per_s: Some(2400.0),
                    ..Conditions::default()
                })
                .await?;
            remote.sail_until(day(1.0)).await?;
            remote.wait_until_uploaded().await?;
            ensure_used(&remote.satellite.tally().await?)?;
            remote.check_and_stop().await
        },
    );
}
