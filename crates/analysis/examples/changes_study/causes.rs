//! Causes that each kind of event is attributed to.

use crate::voyages::fleet::{Event, Happened, Log, Name, Plan, sail_log};
use crate::voyages::lorden::information_while_laden;
use crate::{
    DAY_S, HOUR_S, alarms, each, planned, run, seeds, share, telling, variety, was_withdrawn,
};
use binnacle_compass::result::{Analysis, Cause, Change, FleetDisturbance, weigh_with_fleet};
use binnacle_compass::time::Timestamp;
use std::collections::BTreeMap;

/// Ships of a fleet, which meet the same storms.
const FLEET: u64 = 6;

type Counts = BTreeMap<String, usize>;

fn name_of(change: Option<&Change>) -> String {
    change.map_or("nothing".to_owned(), |c| format!("{:?}", c.cause))
}

fn print(name: &str, counts: &Counts) {
    let sum: usize = counts.values().sum();
    println!("  {name} ({sum}): {counts:?}");
}

/// Lightning, cargo and faults of the gyro.
pub(crate) fn causes(ships: u64) {
    let kinds = [
        (
            Name::Lightning,
            Event::Lightning(4000.0),
            Cause::LightningOrShock,
        ),
        (Name::Cargo, Event::Cargo, Cause::MagneticCargo),
        (
            Name::GyroFault,
            Event::GyroFault(4.0),
            Cause::ReferenceFault,
        ),
    ];
    println!("taken for:");
    for (name, event, cause) in kinds {
        let found = each(seeds(300_000, ships), |seed| {
            let mut plan = Plan::new(event, variety(seed));
            plan.gyro_faults = 0.0;
            let log = sail_log(seed, &plan);
            let happened = planned(&log, name)?;
            let analysis = run(&log.samples);
            let reported = telling(&analysis, &happened);
            if reported.is_none_or(|c| c.cause != cause) {
                print_wrong(seed, &log, &analysis, &happened);
            }
            Some(name_of(reported))
        });
        let mut counts = Counts::new();
        for called in found.into_iter().flatten() {
            *counts.entry(called).or_default() += 1;
        }
        print(&format!("{name:?}"), &counts);
    }
}

/// Prints the report of an event with a wrong cause, and the port calls around it.
fn print_wrong(seed: u64, log: &Log, analysis: &Analysis, happened: &Happened) {
    let hours = |at: Timestamp| at.seconds_since(happened.from) / HOUR_S;
    println!(
        "  seed {seed}: {} to {:?} h",
        happened.from,
        happened.to.map(hours)
    );
    println!(
        "    by the samples with cargo {:.1?} log-likelihood ratio at most",
        information_while_laden(log)
    );
    let gaps = log.samples.windows(2);
    let gaps = gaps.filter(|leg| leg[1].time.seconds_since(leg[0].time) > 2.5 * HOUR_S);
    let near = gaps.filter(|leg| {
        let from_s = leg[0].time.seconds_since(happened.from);
        (-10.0 * DAY_S..30.0 * DAY_S).contains(&from_s)
    });
    for leg in near {
        println!(
            "    no samples from {:.1} to {:.1} h",
            hours(leg[0].time),
            hours(leg[1].time)
        );
    }
    for h in &log.happened {
        if (-48.0..960.0).contains(&hours(h.from)) {
            println!(
                "    {:?} {:.1} to {:?} h",
                h.what,
                hours(h.from),
                h.to.map(hours)
            );
        }
    }
    for c in &analysis.changes {
        if c.detected_at >= happened.from && hours(c.from) < 40.0 * 24.0 {
            println!(
                "    at {:.1} h ({:.1} to {:.1}), reported {:.1} h, confirmed {}, until {:?}: {:?} {:?}",
                hours(c.from),
                hours(c.from_earliest),
                hours(c.from_latest),
                hours(c.detected_at),
                c.confirmed,
                c.ended.map(hours),
                c.causes,
                c.evidence
            );
        }
    }
}

/// Prints storms that all ships of a fleet meet: by each ship alone, and with the others.
pub(crate) fn storms(ships: u64) {
    let (mut alone, mut together) = (Counts::new(), Counts::new());
    for fleet in seeds(600_000, ships.div_ceil(FLEET)) {
        let fleet: Vec<(Log, Analysis)> = each(FLEET * fleet..FLEET * (fleet + 1), |seed| {
            let plan = Plan {
                sun: Some(seed / FLEET),
                ..Plan::new(Event::Nothing, variety(seed))
            };
            let log = sail_log(seed, &plan);
            let analysis = run(&log.samples);
            (log, analysis)
        });
        for (ship, (log, analysis)) in fleet.iter().enumerate() {
            let others = elsewhere(&fleet, ship);
            let until = log.samples.last().unwrap().time;
            let seen = analysis.changes.iter();
            let seen = seen.map(|c| weigh_with_fleet(c, position(log, c.from), until, &others));
            let by_fleet = Analysis {
                changes: seen.collect(),
                ..analysis.clone()
            };
            let storms = log.happened.iter();
            for storm in storms.filter(|h| h.what == Name::Storm && at_sea(log, h)) {
                for (analysis, counts) in [(analysis, &mut alone), (&by_fleet, &mut together)] {
                    let reported = telling(analysis, storm).or_else(|| covering(analysis, storm));
                    *counts.entry(name_of(reported)).or_default() += 1;
                }
            }
        }
    }
    print("Storm, by one ship alone", &alone);
    print(&format!("Storm, in a fleet of {FLEET}"), &together);
}

/// Returns a change from before the storm that covers most of it.
fn covering<'a>(analysis: &'a Analysis, storm: &Happened) -> Option<&'a Change> {
    let to = storm.to?;
    analysis.changes.iter().find(|c| {
        let shared_s = c
            .ended
            .map_or(to, |ended| ended.min(to))
            .seconds_since(storm.from);
        c.confirmed && c.from <= storm.from && shared_s > 0.5 * to.seconds_since(storm.from)
    })
}

/// Returns the evidence of the other ships, as the server keeps it.
fn elsewhere(fleet: &[(Log, Analysis)], but: usize) -> Vec<FleetDisturbance> {
    let others = fleet.iter().enumerate().filter(|(ship, _)| *ship != but);
    let reported = others.flat_map(|(ship, (log, analysis))| {
        let passing = analysis.changes.iter();
        let passing = passing.filter(|c| c.confirmed && c.cause.is_transient());
        passing.filter_map(move |c| {
            let last = log.samples.last().unwrap().time;
            Some(FleetDisturbance {
                ship,
                from: c.from,
                until: c.ended.unwrap_or(last).max(c.from),
                position: position(log, c.from)?,
            })
        })
    });
    reported.collect()
}

fn position(log: &Log, at: Timestamp) -> Option<binnacle_compass::position::Position> {
    let next = log.samples.partition_point(|s| s.time < at);
    log.samples.get(next).map(|s| s.position)
}

/// Returns true if samples were taken through most of it.
fn at_sea(log: &Log, h: &Happened) -> bool {
    let to = h.to.unwrap_or(h.from);
    let during = log
        .samples
        .iter()
        .filter(|s| s.time >= h.from && s.time <= to);
    during.count() as f64 * 600.0 > 0.7 * to.seconds_since(h.from)
}

/// Prints events that are over within an hour and a half to three, at sea.
pub(crate) fn brief(ships: u64) {
    let kinds = [
        ("a magnet of 2 uT by the compass", Event::Magnet(2000.0)),
        ("a magnet of 3 uT by the compass", Event::Magnet(3000.0)),
        ("variation off by 4 degrees", Event::VariationError(4.0)),
        ("variation off by 8 degrees", Event::VariationError(8.0)),
    ];
    println!("over within 1.5 to 3 hours at sea, taken for:");
    for (name, event) in kinds {
        let found = each(seeds(310_000, ships), |seed| {
            let log = sail_log(seed, &Plan::new(event, variety(seed)));
            let happened = planned(&log, Name::Brief)?;
            let analysis = run(&log.samples);
            for c in alarms(&analysis) {
                let hours = |to: Timestamp| to.seconds_since(happened.from) / HOUR_S;
                println!(
                    "  seed {seed} alarm at {:.1} h, reported {:.1} h, of {:.1?}: {:?}",
                    hours(c.from),
                    hours(c.detected_at),
                    happened.to.map(hours),
                    c.ended.map(hours)
                );
            }
            let reported = telling(&analysis, &happened);
            Some((name_of(reported), reported.is_some_and(was_withdrawn)))
        });
        let found: Vec<_> = found.into_iter().flatten().collect();
        let mut counts = Counts::new();
        for (called, _) in &found {
            *counts.entry(called.clone()).or_default() += 1;
        }
        print(name, &counts);
        println!(
            "    of which for a change of the ship at first {:.0} %",
            share(&found, |f| f.1)
        );
    }
}

/// Prints changes that grow for weeks: each should be one drift.
pub(crate) fn ramps(ships: u64) {
    println!("what grows for weeks, taken for:");
    for (nt, days) in [(2000.0, 20.0), (3000.0, 30.0), (4000.0, 30.0)] {
        let found = each(seeds(320_000, ships), |seed| {
            let plan = Plan::new(Event::Ramp(nt, days), variety(seed));
            let log = sail_log(seed, &plan);
            let began = planned(&log, Name::Ramp)?.from;
            let analysis = run(&log.samples);
            let reported: Vec<&Change> = alarms(&analysis)
                .filter(|c| c.detected_at > began)
                .collect();
            let drifts = reported.iter().filter(|c| c.cause == Cause::Drift).count();
            Some((reported.len(), drifts))
        });
        let found: Vec<_> = found.into_iter().flatten().collect();
        let reported = found.iter().map(|f| f.0).sum::<usize>() as f64;
        println!(
            "  {nt} nT in {days} days, {} ships: a drift {:.0} %, one drift and nothing else {:.0} %, \
             nothing {:.0} %; changes reported {:.1} a ship",
            found.len(),
            share(&found, |f| f.1 > 0),
            share(&found, |f| *f == (1, 1)),
            share(&found, |f| f.0 == 0),
            reported / found.len() as f64,
        );
    }
}
