//! The tables of `docs/science.md` §9 and BENCHMARKS.md on changes: false alarms, delay,
//! date, cause and return, on simulated ships, beside a threshold on hourly means
//! and a cumulative sum.
//!
//! Takes a while: `make study-changes`, or `cargo run --release -p binnacle-magnetics
//! --example changes_study [SHIPS] [PART]`, with the number of ships of each kind.
//! `SEEDS=7000` takes other ships: what was tuned on some is to be judged on others.

#![allow(clippy::unwrap_used)] // a study, run by hand

#[allow(dead_code)]
#[path = "../tests/voyages/mod.rs"]
mod voyages;

use binnacle_magnetics::analyse::{Analysis, AnalysisSettings, analyse};
use binnacle_magnetics::angle::wrap_180;
use binnacle_magnetics::change::{Cause, Change};
use binnacle_magnetics::sample::Sample;
use binnacle_magnetics::time::Timestamp;
use std::collections::BTreeMap;
use voyages::fleet::{Event, Happened, Log, Name, Plan, START, sail_log};
use voyages::{Variety, predicted, true_deviation};

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
        quiet(ships);
    }
    for (name, event) in [
        ("step1", Event::Step(1000.0)),
        ("step2", Event::Step(2000.0)),
    ] {
        if wanted(name) {
            steps(name, event, ships);
        }
    }
    if wanted("causes") {
        causes(ships);
    }
    if wanted("return") {
        returns(ships);
    }
    if wanted("permanent") {
        permanent(ships);
    }
    if wanted("gyro") {
        gyro_alone(ships);
    }
}

/// Does a piece of work for every ship, on all cores, results in order.
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
    changes.filter(|c| c.confirmed && c.cause.is_the_ships())
}

/// False alarms where nothing happens but storms, anomalies, gyro faults and
/// outliers.
fn quiet(ships: u64) {
    let found = each(seeds(100_000, ships), |seed| {
        let plan = Plan {
            days: 365.0,
            ..Plan::of(Event::Nothing, variety(seed))
        };
        let log = sail_log(seed, &plan);
        let analysis = run(&log.samples);
        for c in alarms(&analysis) {
            println!(
                "  seed {seed} {:?} {} +{:.1} h {:?}",
                c.cause,
                c.from,
                c.detected_at.seconds_since(c.from) / HOUR_S,
                c.evidence
            );
        }
        for c in alarms(&analysis) {
            for h in log.happened.iter().filter(|h| near(h, c)) {
                println!(
                    "    {:?} {} {:?}",
                    h.what,
                    h.from,
                    h.to.map(|t| t.to_string())
                );
            }
        }
        let references = analysis.changes.iter().filter(|c| {
            let is_fault = c.cause == Cause::ReferenceFault && c.confirmed;
            is_fault
                && !log
                    .happened
                    .iter()
                    .any(|h| h.what == Name::GyroFault && near(h, c))
        });
        let passing = |c: &&Change| {
            matches!(
                c.cause,
                Cause::MagneticStorm | Cause::LocalAnomaly | Cause::BerthSteel
            )
        };
        let truly = |c: &&Change| {
            let passed = |h: &&Happened| matches!(h.what, Name::Storm | Name::Anomaly);
            log.happened.iter().filter(passed).any(|h| near(h, c))
        };
        let passed: Vec<&Change> = analysis.changes.iter().filter(passing).collect();
        let false_passing = passed.iter().filter(|c| !truly(c)).count();
        [
            alarms(&analysis).count(),
            references.count(),
            passed.len(),
            false_passing,
        ]
    });
    let sum = |i: usize| found.iter().map(|f| f[i]).sum::<usize>();
    let years = ships as f64;
    println!("no event, {ships} vessel-years, false alarms a vessel-year:");
    println!("  change of magnetism {:.2}", sum(0) as f64 / years);
    println!("  reference fault     {:.2}", sum(1) as f64 / years);
    println!(
        "  passing disturbance {:.2} (and {:.2} that were)",
        sum(3) as f64 / years,
        (sum(2) - sum(3)) as f64 / years
    );
}

/// Whether a change can be this happening.
fn near(h: &Happened, c: &Change) -> bool {
    let end = h.to.unwrap_or(h.from).plus_seconds(0.5 * DAY_S);
    let begin = h.from.plus_seconds(-0.5 * DAY_S);
    let ended = c.ended.unwrap_or(c.from).max(c.from_latest);
    ended >= begin && c.from_earliest <= end
}

/// The change that tells of a happening, if one does.
fn telling<'a>(analysis: &'a Analysis, h: &Happened) -> Option<&'a Change> {
    let mut told = analysis.changes.iter().filter(|c| {
        c.confirmed && c.detected_at >= h.from && near(h, c) && h.from.seconds_since(c.from) < DAY_S
    });
    let first = told.next()?;
    // A disturbance that was taken back for a change counts as the change.
    Some(if first.cause.is_the_ships() {
        first
    } else {
        told.find(|c| c.cause.is_the_ships()).unwrap_or(first)
    })
}

fn planned(log: &Log, what: Name) -> Option<Happened> {
    log.happened.iter().find(|h| h.what == what).copied()
}

fn quantile(of: &mut [f64], q: f64) -> f64 {
    of.sort_by(f64::total_cmp);
    if of.is_empty() {
        return f64::NAN;
    }
    of[((of.len() - 1) as f64 * q).round() as usize]
}

fn steps(name: &str, event: Event, ships: u64) {
    let found = each(seeds(200_000, ships), |seed| {
        let log = sail_log(seed, &Plan::of(event, variety(seed)));
        let happened = planned(&log, Name::Step)?;
        let analysis = run(&log.samples);
        let told = alarms(&analysis).find(|c| {
            c.detected_at >= happened.from
                && (c.from.seconds_since(happened.from)).abs() < 3.0 * DAY_S
        });
        let Some(told) = told else {
            println!(
                "  seed {seed} missed {happened:?}: {:?}",
                analysis
                    .changes
                    .iter()
                    .filter(|c| c.detected_at >= happened.from)
                    .map(|c| (c.cause, c.confirmed, c.from.to_string()))
                    .collect::<Vec<_>>()
            );
            return Some((f64::INFINITY, f64::NAN, false));
        };
        let delay = told.detected_at.seconds_since(happened.from);
        if let Some(e) = told.ended {
            println!(
                "  seed {seed} called off {} to {e} {:?}",
                told.from, told.evidence
            );
        }
        let off = told.from.seconds_since(happened.from).abs();
        Some((delay, off, told.ended.is_some()))
    });
    let found: Vec<_> = found.into_iter().flatten().collect();
    let n = found.len() as f64;
    let mut delays: Vec<f64> = found.iter().map(|f| f.0).collect();
    let mut dates: Vec<f64> = found
        .iter()
        .map(|f| f.1)
        .filter(|f| f.is_finite())
        .collect();
    let within =
        |days: f64| 100.0 * found.iter().filter(|f| f.0 <= days * DAY_S).count() as f64 / n;
    println!(
        "{name}: {n} ships, delay median {:.2} h, 95 % {:.2} d; within 1 d {:.0} %, 3 d {:.0} %; \
         date off median {:.0} min, 90 % {:.1} h; called off {:.1} %",
        quantile(&mut delays, 0.5) / HOUR_S,
        quantile(&mut delays, 0.95) / DAY_S,
        within(1.0),
        within(3.0),
        quantile(&mut dates, 0.5) / 60.0,
        quantile(&mut dates, 0.9) / HOUR_S,
        100.0 * found.iter().filter(|f| f.2).count() as f64 / n,
    );
}

/// What each kind of happening is taken for.
fn causes(ships: u64) {
    let kinds = [
        (Name::Lightning, Event::Lightning(4000.0)),
        (Name::Cargo, Event::Cargo),
        (Name::GyroFault, Event::GyroFault(4.0)),
    ];
    println!("taken for:");
    let mut storms: BTreeMap<String, usize> = BTreeMap::new();
    for (name, event) in kinds {
        let found = each(seeds(300_000, ships), |seed| {
            let mut plan = Plan::of(event, variety(seed));
            plan.gyro_faults = 0.0;
            let log = sail_log(seed, &plan);
            let analysis = run(&log.samples);
            let called = |h: &Happened| {
                telling(&analysis, h).map_or("nothing".to_owned(), |c| format!("{:?}", c.cause))
            };
            let storms: Vec<String> = log
                .happened
                .iter()
                .filter(|h| h.what == Name::Storm && at_sea(&log, h))
                .map(&called)
                .collect();
            (planned(&log, name).map(|h| called(&h)), storms)
        });
        let mut row: BTreeMap<String, usize> = BTreeMap::new();
        for (of, stormy) in found {
            if let Some(of) = of {
                *row.entry(of).or_default() += 1;
            }
            for storm in stormy {
                *storms.entry(storm).or_default() += 1;
            }
        }
        println!("  {name:?}: {row:?}");
    }
    println!("  Storm: {storms:?}");
}

/// Whether samples were taken through most of it.
fn at_sea(log: &Log, h: &Happened) -> bool {
    let to = h.to.unwrap_or(h.from);
    let during = log
        .samples
        .iter()
        .filter(|s| s.time >= h.from && s.time <= to);
    during.count() as f64 * 600.0 > 0.7 * to.seconds_since(h.from)
}

/// What becomes of the base model after cargo is discharged.
fn returns(ships: u64) {
    let found = each(seeds(400_000, ships), |seed| {
        let mut plan = Plan::of(Event::Cargo, variety(seed));
        plan.days = 130.0;
        let log = sail_log(seed, &plan);
        let discharged = planned(&log, Name::Cargo)?.to?;
        let analysis = run(&log.samples);
        let ended = analysis
            .changes
            .iter()
            .filter_map(|c| c.ended.filter(|_| c.cause.is_the_ships()));
        let back = ended
            .map(|e| e.seconds_since(discharged).abs() / DAY_S)
            .fold(f64::INFINITY, f64::min);
        let then = a_day_after(seed, &plan, &log, discharged)?;
        Some((
            analysis
                .changes
                .iter()
                .any(|c| c.cause == Cause::MagneticCargo),
            back,
            then.resumed,
            then.held,
        ))
    });
    let found: Vec<_> = found.into_iter().flatten().collect();
    let share = |of: usize| 100.0 * of as f64 / found.len() as f64;
    println!(
        "cargo, {} ships: noticed {:.0} %, its end dated within a day {:.0} %; a day after sailing the base is \
         resumed {:.0} %, band holds the truth on 9 headings in 10 {:.0} %, on {:.1} % of all headings",
        found.len(),
        share(found.iter().filter(|f| f.0).count()),
        share(found.iter().filter(|f| f.1 < 1.5).count()),
        share(found.iter().filter(|f| f.2).count()),
        share(found.iter().filter(|f| f.3 >= 33).count()),
        share(found.iter().map(|f| f.3).sum()) / 36.0,
    );
}

/// What was known a day after the ship sailed from a port.
struct Then {
    resumed: bool,
    /// On how many headings of 36 the band held the truth.
    held: usize,
}

fn a_day_after(seed: u64, plan: &Plan, log: &Log, port: Timestamp) -> Option<Then> {
    let sailed = log.samples.iter().find(|s| s.time > port)?.time;
    let until = log
        .samples
        .partition_point(|s| s.time.seconds_since(sailed) < DAY_S);
    let then = run(&log.samples[..until]);
    // The same ship, as she was at that time.
    let begun = Timestamp::parse(START).unwrap();
    let last = log.samples[until - 1].time;
    let days = last.seconds_since(begun) / DAY_S + 0.001;
    let truth = sail_log(seed, &Plan { days, ..*plan }).truth;
    let epoch = then.current_epoch()?;
    let held = epoch.model.as_ref().map_or(0, |model| {
        let place = then.last_place.unwrap();
        let held = (0..36).filter(|k| {
            let compass = f64::from(*k) * 10.0;
            let truth = true_deviation(&truth, compass, place.h_nt, place.z_nt);
            let (predicted, se) = predicted(model, compass, place.h_nt, place.z_nt);
            wrap_180(predicted - truth).abs() <= 1.96 * se
        });
        held.count()
    });
    Some(Then {
        resumed: epoch.resumes.is_some(),
        held,
    })
}

/// What looks like cargo, and stays: it must not pass for discharged, though the
/// ship calls at ports. And how good the band is a day after lightning.
fn permanent(ships: u64) {
    let found = each(seeds(410_000, ships), |seed| {
        let mut plan = Plan::of(Event::Refit, variety(seed));
        plan.days = 130.0;
        let log = sail_log(seed, &plan);
        let changed = planned(&log, Name::Refit)?.from;
        let analysis = run(&log.samples);
        let told = alarms(&analysis).find(|c| near(&planned(&log, Name::Refit).unwrap(), c));
        let then = a_day_after(seed, &plan, &log, changed)?;
        Some((told.map(|c| c.ended.is_some()), then.held))
    });
    let found: Vec<_> = found.into_iter().flatten().collect();
    let told: Vec<bool> = found.iter().filter_map(|f| f.0).collect();
    println!(
        "changed for good in port, {} ships: noticed {:.0} %, of which taken for ended {:.0} %; a day after \
         sailing the band holds the truth on {:.1} % of all headings",
        found.len(),
        100.0 * told.len() as f64 / found.len() as f64,
        100.0 * told.iter().filter(|ended| **ended).count() as f64 / told.len() as f64,
        100.0 * found.iter().map(|f| f.1).sum::<usize>() as f64 / (36 * found.len()) as f64,
    );
    for weeks in [1.0, 4.0] {
        let found = each(seeds(420_000, ships), |seed| {
            let plan = Plan::of(Event::Lightning(4000.0), variety(seed));
            let log = sail_log(seed, &plan);
            let struck = planned(&log, Name::Lightning)?.from;
            a_day_after(seed, &plan, &log, struck.plus_seconds(7.0 * DAY_S * weeks))
        });
        let found: Vec<_> = found.into_iter().flatten().collect();
        let held = found.iter().map(|then| then.held).sum::<usize>();
        println!(
            "{weeks} weeks after lightning, {} ships: the band holds the truth on {:.1} % of all headings, \
             called off {}",
            found.len(),
            100.0 * held as f64 / (36 * found.len()) as f64,
            found.iter().filter(|then| then.resumed).count(),
        );
    }
}

/// One reference only: harder.
fn gyro_alone(ships: u64) {
    let found = each(seeds(500_000, ships), |seed| {
        let mut plan = Plan::of(Event::Step(2000.0), variety(seed));
        plan.faults.satellite = false;
        plan.gyro_faults = 0.0;
        let log = sail_log(seed, &plan);
        let happened = planned(&log, Name::Step)?;
        let analysis = run(&log.samples);
        let before = alarms(&analysis)
            .filter(|c| c.detected_at < happened.from)
            .count();
        let told = alarms(&analysis).find(|c| c.detected_at >= happened.from);
        let delay = told.map_or(f64::INFINITY, |c| {
            c.detected_at.seconds_since(happened.from)
        });
        Some((delay, before))
    });
    let found: Vec<_> = found.into_iter().flatten().collect();
    let mut delays: Vec<f64> = found.iter().map(|f| f.0).collect();
    println!(
        "2 uT by gyro alone: delay median {:.1} h, 90 % {:.1} d; false alarms in 60 days {}",
        quantile(&mut delays, 0.5) / HOUR_S,
        quantile(&mut delays, 0.9) / DAY_S,
        found.iter().map(|f| f.1).sum::<usize>(),
    );
}
