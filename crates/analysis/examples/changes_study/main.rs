//! The tables of `docs/science.md` §9 and BENCHMARKS.md on changes: false alarms, delay,
//! date, cause and return, on simulated ships.
//!
//! Takes a while: `make study-changes`, or `cargo run --release -p binnacle-analysis
//! --example changes_study [SHIPS] [PART]`, with the number of ships of each kind.
//! `SEEDS=7000` takes other ships: what was tuned on some is to be judged on others.

#![allow(clippy::unwrap_used)] // a study, run by hand

#[allow(dead_code)]
#[path = "../../tests/voyages/mod.rs"]
mod voyages;

mod bands;
mod causes;
mod jams;
mod large;
mod quiet;
mod references;
mod returns;
mod steps;

use binnacle_analysis::analyse::analyse;
use binnacle_compass::result::{Analysis, Change};
use binnacle_compass::sample::Sample;
use binnacle_compass::settings::AnalysisSettings;
use binnacle_compass::time::Timestamp;
use voyages::Variety;
use voyages::fleet::{Event, Happened, Log, Name};

const HOUR_S: f64 = 3600.0;
const DAY_S: f64 = 86_400.0;

fn main() {
    let args: Vec<String> = std::env::args().collect();
    let ships: u64 = args
        .get(1)
        .map_or(30, |n| n.parse().expect("the number of ships"));
    let only = args.get(2).map(String::as_str);
    let wanted = |name: &str| only.is_none_or(|only| only == name);
    if wanted("quiet") {
        quiet::quiet(ships);
    }
    for (name, event) in [
        ("step1", Event::Step(1000.0)),
        ("step2", Event::Step(2000.0)),
    ] {
        if wanted(name) {
            steps::steps(name, event, ships);
        }
    }
    if wanted("causes") {
        causes::causes(ships);
    }
    if wanted("storms") {
        causes::storms(ships);
    }
    if wanted("brief") {
        causes::brief(ships);
    }
    if wanted("large") {
        large::large(ships);
    }
    if wanted("jams") {
        jams::jams(ships);
    }
    if wanted("bands") {
        bands::bands(ships);
    }
    if wanted("undisturbed") {
        bands::undisturbed(ships);
    }
    if wanted("return") {
        returns::returns(ships);
    }
    if wanted("permanent") {
        returns::permanent(ships);
    }
    if wanted("calm") {
        returns::calm(ships);
    }
    if wanted("lightning") {
        returns::lightning(ships);
    }
    if wanted("references") {
        references::references(ships);
    }
    if wanted("ramps") {
        causes::ramps(ships);
    }
    if wanted("gyro") {
        steps::gyro_alone(ships);
    }
}

/// Runs a piece of work for every ship, on all cores, with the results in order.
fn each<T: Send>(seeds: std::ops::Range<u64>, work: impl Fn(u64) -> T + Sync) -> Vec<T> {
    let threads = std::env::var("THREADS").map_or(1, |n| n.parse().unwrap());
    let seeds: Vec<u64> = seeds.collect();
    let mut results: Vec<(u64, T)> = std::thread::scope(|scope| {
        let work = &work;
        let started: Vec<_> = (0..threads)
            .map(|t| {
                let own: Vec<u64> = seeds.iter().copied().skip(t).step_by(threads).collect();
                scope.spawn(move || own.into_iter().map(|s| (s, work(s))).collect::<Vec<_>>())
            })
            .collect();
        let joined = started
            .into_iter()
            .flat_map(|thread| thread.join().unwrap());
        joined.collect()
    });
    results.sort_by_key(|(seed, _)| *seed);
    results.into_iter().map(|(_, result)| result).collect()
}

/// The ships of a part of the study.
fn seeds(first: u64, ships: u64) -> std::ops::Range<u64> {
    let others: u64 = std::env::var("SEEDS").map_or(0, |n| n.parse().unwrap());
    first + others..first + others + ships
}

fn variety(seed: u64) -> Variety {
    [Variety::Rich, Variety::Medium, Variety::Poor][(seed % 3) as usize]
}

fn run(samples: &[Sample]) -> Analysis {
    analyse(samples, &[], &AnalysisSettings::default())
}

fn alarms(analysis: &Analysis) -> impl Iterator<Item = &Change> {
    let changes = analysis.changes.iter();
    changes.filter(|c| c.confirmed && c.cause.changes_deviation())
}

/// Returns true if a change can be this event.
fn near(h: &Happened, c: &Change) -> bool {
    let end = h.to.unwrap_or(h.from).plus_seconds(0.5 * DAY_S);
    let begin = h.from.plus_seconds(-0.5 * DAY_S);
    let ended = c.ended.unwrap_or(c.from).max(c.from_latest);
    ended >= begin && c.from_earliest <= end
}

/// Returns the change that reports an event, if there is one.
fn telling<'a>(analysis: &'a Analysis, h: &Happened) -> Option<&'a Change> {
    let mut reports = analysis.changes.iter().filter(|c| {
        c.confirmed && c.detected_at >= h.from && near(h, c) && h.from.seconds_since(c.from) < DAY_S
    });
    let first = reports.next()?;
    // A disturbance withdrawn in favour of a change counts as the change.
    Some(if first.cause.changes_deviation() {
        first
    } else {
        reports
            .find(|c| c.cause.changes_deviation())
            .unwrap_or(first)
    })
}

fn planned(log: &Log, what: Name) -> Option<Happened> {
    log.happened.iter().find(|h| h.what == what).copied()
}

/// Hours of settled sailing, of which a sample is ten minutes.
fn settled_hours(log: &Log, from: Timestamp, to: Timestamp) -> f64 {
    let between = log.samples.iter().filter(|s| s.time > from && s.time <= to);
    between.count() as f64 / 6.0
}

/// Returns true if it was reported as the vessel's until it passed.
fn was_withdrawn(c: &Change) -> bool {
    c.evidence
        .iter()
        .any(|line| line.contains("at first taken for a change of the vessel"))
}

/// Per cent.
fn share<T>(of: &[T], such: impl Fn(&T) -> bool) -> f64 {
    100.0 * of.iter().filter(|x| such(x)).count() as f64 / of.len() as f64
}

fn quantile(of: &mut [f64], q: f64) -> f64 {
    of.sort_by(f64::total_cmp);
    if of.is_empty() {
        return f64::NAN;
    }
    of[((of.len() - 1) as f64 * q).round() as usize]
}
