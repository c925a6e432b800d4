//! Schedules a made-up fleet and prints the time it took:
//! `cargo run --release -p binnacle-schedule --example fleet VESSELS CALLS
//! FIRMS SEED PORTS DAYS`.
//!
//! Ships call at forty large ports, or at the first PORTS of them, and more
//! often at the larger ones. An eighth of the calls last less than a working
//! day. An ETA is good to two hours tomorrow and to two days in half a year.
//! All calls begin, and all needs are due, within half a year or within DAYS:
//! the fewer, the scarcer the teams. Firms serve three to nine ports with one
//! to three teams, each of which does one or two jobs a day. Half of the firms
//! are not accepted by every flag.

#![allow(clippy::unwrap_used, clippy::print_stdout)] // a benchmark, run by hand

use binnacle_schedule::input::read;
use binnacle_schedule::plan::plan;
use binnacle_schedule::time::Instant as Time;
use rand::seq::IndexedRandom;
use rand::{RngExt, SeedableRng};
use rand_chacha::ChaCha8Rng;
use serde_json::{Value, json};
use std::time::Instant;

const PORTS: [&str; 40] = [
    "CNSGH", "SGSIN", "CNNBO", "KRPUS", "HKHKG", "NLRTM", "AEJEA", "BEANR", "MYPKG", "TWKHH",
    "DEHAM", "USLAX", "USLGB", "MATNG", "VNSGN", "LKCMB", "IDJKT", "INMUN", "ESVLC", "GRPIR",
    "BRSSZ", "ESALG", "USNYC", "INNSA", "JPTYO", "EGPSD", "USHOU", "PABLB", "GBFXT", "FRLEH",
    "ITGOA", "MXZLO", "ZADUR", "AUMEL", "CLSAI", "PECLL", "JPYOK", "GBSOU", "USSAV", "NOOSL",
];
const FLAGS: [&str; 6] = ["PA", "MH", "LR", "NO", "MT", "SG"];

/// Size of the fleet, as given on the command line.
struct Size {
    vessels: u64,
    calls: u64,
    firms: u64,
    seed: u64,
    ports: u64,
    days: u64,
}

fn main() {
    let mut arguments = std::env::args()
        .skip(1)
        .map(|text| text.parse::<u64>().unwrap());
    let mut next = |default| arguments.next().unwrap_or(default);
    let size = Size {
        vessels: next(200),
        calls: next(6),
        firms: next(15),
        seed: next(1),
        ports: next(PORTS.len() as u64),
        days: next(180),
    };
    let text = fleet(&size).to_string();
    let checked = read(&text).unwrap();
    let began = Instant::now();
    let schedule = plan(&checked);
    let took_s = began.elapsed().as_secs_f64();
    let Size {
        vessels,
        calls,
        firms,
        seed,
        ports,
        days,
    } = size;
    println!(
        "{vessels} vessels × {calls} calls × {firms} firms, seed {seed}, {ports} ports, {days} days: {} jobs, {} unscheduled, \
         {:.0} euros, gap {:.4} %, optimal {}, {took_s:.2} s",
        schedule.jobs.len(),
        schedule.unscheduled.len(),
        schedule.cost_eur,
        schedule.gap_percent,
        schedule.proven_optimal,
    );
}

fn fleet(size: &Size) -> Value {
    let mut random = ChaCha8Rng::seed_from_u64(size.seed);
    let now = Time::parse("2026-11-21T00:00:00Z").unwrap();
    let known: Vec<&str> = PORTS
        .into_iter()
        .filter(|code| {
            binnacle_schedule::ports::find(code.to_string().try_into().unwrap()).is_some()
        })
        .take(size.ports as usize)
        .collect();
    let mut input = json!({"now": now, "vessels": [], "needs": [], "port_calls": [], "firms": []});
    let mut push = |list: &str, item: Value| input[list].as_array_mut().unwrap().push(item);
    for vessel in 0..size.vessels {
        let id = format!("v{vessel}");
        push(
            "vessels",
            json!({"id": id, "flag": FLAGS.choose(&mut random).unwrap()}),
        );
        let due = now
            .plus_hours(24.0 * random.random_range(5.0..size.days as f64))
            .utc_date();
        push(
            "needs",
            json!({"id": format!("n{vessel}"), "vessel": id, "due": due}),
        );
        let apart_h = size.days as f64 * 24.0 / size.calls as f64;
        for call in 0..size.calls {
            let begins_h = apart_h * (call as f64 + random.random_range(0.0..0.6));
            let short = random.random_range(0..8) == 0;
            let stay_h = if short {
                random.random_range(3.0..10.0)
            } else {
                random.random_range(14.0..72.0)
            };
            let stay_h = f64::min(stay_h, 0.35 * apart_h);
            let eta = now.plus_hours(1.0 + begins_h.round());
            let uncertainty_h = (2.0 + begins_h * 46.0 / 4320.0).round();
            push(
                "port_calls",
                json!({
                    "id": format!("{id}-{call}"), "vessel": id, "port": often(&known, &mut random),
                    "eta": eta, "eta_uncertainty_h": uncertainty_h,
                    "etd": eta.plus_hours(stay_h.round().max(3.0)), "etd_uncertainty_h": uncertainty_h,
                }),
            );
        }
    }
    for firm in 0..size.firms {
        let mut ports: Vec<&str> = Vec::new();
        for _ in 0..random.random_range(3..10) {
            let port = often(&known, &mut random);
            if !ports.contains(&port) {
                ports.push(port);
            }
        }
        let served: Vec<Value> = ports
            .iter()
            .map(|port| json!({"port": port, "travel_eur": random.random_range(0..800)}))
            .collect();
        let all = random.random_range(0..2) == 0;
        let flags: Vec<&str> = if all {
            Vec::new()
        } else {
            FLAGS.sample(&mut random, 4).copied().collect()
        };
        push(
            "firms",
            json!({
                "id": format!("f{firm}"), "ports": served, "flags": flags,
                "teams": random.random_range(1..4), "jobs_a_team_day": random.random_range(1..3),
                "fee_eur": random.random_range(1200..3500), "lead_time_h": random.random_range(24..120),
            }),
        );
    }
    input
}

/// Draws two ports and returns the larger.
fn often<'a>(ports: &[&'a str], random: &mut ChaCha8Rng) -> &'a str {
    let drawn = random
        .random_range(0..ports.len())
        .min(random.random_range(0..ports.len()));
    ports[drawn]
}
