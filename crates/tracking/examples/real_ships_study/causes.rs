//! Causes given for events and faults, and the probabilities stated with them.

use crate::arguments::Arguments;
use crate::detector::{self, leave_gyro_alone, plan};
use crate::score::{DAY_S, near};
use crate::table::{at_least, share};
use crate::voyages::fleet::{Event, Happened, Log, Name, Plan, sail_log};
use crate::voyages::incidents::Incident;
use binnacle_compass::result::{Analysis, Cause, Change};
use std::collections::BTreeMap;

const SEEDS: u64 = 4_000_000;
/// Duration of a drift.
const RAMP_DAYS: f64 = 20.0;
/// Lower edges of the stated probabilities in the table of calibration.
const BINS: [f64; 5] = [0.0, 0.5, 0.8, 0.9, 0.97];

pub(crate) struct Row {
    pub(crate) name: &'static str,
    event: Name,
    cause: Cause,
    /// Per cent that should be named rightly.
    target: f64,
    event_of: fn(&mut Plan),
}

const fn row(
    name: &'static str,
    event: Name,
    cause: Cause,
    target: f64,
    event_of: fn(&mut Plan),
) -> Row {
    Row {
        name,
        event,
        cause,
        target,
        event_of,
    }
}

pub(crate) const ROWS: [Row; 13] = [
    row(
        "lightning",
        Name::Lightning,
        Cause::LightningOrShock,
        95.0,
        |p| {
            p.event = Event::Lightning(4000.0);
        },
    ),
    row(
        "strikes",
        Name::Lightning,
        Cause::LightningOrShock,
        95.0,
        |p| {
            p.incident = Incident::Strikes(2500.0);
        },
    ),
    row(
        "storm_strike",
        Name::Lightning,
        Cause::LightningOrShock,
        95.0,
        |p| {
            p.incident = Incident::StrikeInStorm(4000.0);
        },
    ),
    row("cargo", Name::Cargo, Cause::MagneticCargo, 95.0, |p| {
        p.event = Event::Cargo;
    }),
    row(
        "gyro_step",
        Name::GyroFault,
        Cause::ReferenceFault,
        95.0,
        |p| {
            p.event = Event::GyroFault(4.0);
        },
    ),
    row(
        "gyro_ramp",
        Name::GyroRamp,
        Cause::ReferenceFault,
        95.0,
        |p| {
            p.incident = Incident::GyroRamp(1.0);
        },
    ),
    row(
        "gyro_ramp_alone",
        Name::GyroRamp,
        Cause::ReferenceFault,
        95.0,
        |p| {
            p.incident = Incident::GyroRamp(1.0);
            leave_gyro_alone(p);
        },
    ),
    row(
        "settling",
        Name::Settling,
        Cause::ReferenceFault,
        90.0,
        |p| {
            p.incident = Incident::Settling;
        },
    ),
    row(
        "settling_alone",
        Name::Settling,
        Cause::ReferenceFault,
        90.0,
        |p| {
            p.incident = Incident::Settling;
            leave_gyro_alone(p);
        },
    ),
    row("zero_moved", Name::ZeroMoved, Cause::Alignment, 95.0, |p| {
        p.incident = Incident::ZeroMoved(5.0);
    }),
    row("jam", Name::Jam, Cause::CompassFault, 95.0, |p| {
        p.incident = Incident::Jam;
    }),
    row("storm", Name::Storm, Cause::MagneticStorm, 95.0, |p| {
        p.faults.storms_per_month = 1.5;
    }),
    row("drift", Name::Ramp, Cause::Drift, 90.0, |p| {
        p.event = Event::Ramp(2000.0, RAMP_DAYS);
    }),
];

/// Report of one event: cause and its stated probability, none where there is no report.
struct Named {
    reported: Option<Stated>,
    is_right: bool,
    /// True if any change of the ship was reported near it.
    blames_ship: bool,
}

#[derive(Clone, Copy)]
struct Stated {
    cause: Cause,
    probability: f64,
}

pub(crate) fn run(arguments: &Arguments) {
    let rows: Vec<&Row> = ROWS.iter().filter(|row| arguments.has(row.name)).collect();
    if rows.is_empty() {
        return;
    }
    println!(
        "\n{:16} {:>6} {:>12} {:>8} {:>9} {:>7} {:>7}  taken for",
        "cause", "events", "right %", "stated p", "right", "silent%", "ship %"
    );
    let mut all = Vec::new();
    for row in rows {
        let named = arguments.each(SEEDS, |seed| events(arguments, row, seed));
        let named: Vec<Named> = named.into_iter().flatten().collect();
        print(row, &named);
        all.extend(named);
    }
    calibration(&all);
}

/// Judges the events of one ship: the planned one, or every storm.
fn events(arguments: &Arguments, row: &Row, seed: u64) -> Vec<Named> {
    let mut plan = plan(seed, Event::Nothing);
    plan.gyro_faults = 0.0;
    (row.event_of)(&mut plan);
    let log = sail_log(seed, &plan);
    let analysis = detector::run(&log);
    let happened = log.happened.iter().filter(|h| h.what == row.event);
    let seen = happened.filter(|h| row.event != Name::Storm || at_sea(&log, h));
    seen.map(|h| {
        let h = &lasting(h);
        let change = telling(row, &analysis, h);
        if arguments.words && change.is_none_or(|c| c.cause != row.cause) {
            print_wrong(seed, h, &analysis);
        }
        named(row, change, &analysis, h)
    })
    .collect()
}

fn named(row: &Row, change: Option<&Change>, analysis: &Analysis, h: &Happened) -> Named {
    let mut near_it = analysis
        .changes
        .iter()
        .filter(|c| c.confirmed && near(h, c));
    Named {
        reported: change.map(|c| Stated {
            cause: c.cause,
            probability: c.causes.first().map_or(f64::NAN, |first| first.probability),
        }),
        is_right: change.is_some_and(|c| c.cause == row.cause),
        blames_ship: near_it.any(|c| c.cause.changes_deviation()),
    }
}

/// Returns an event with its end: what grows can be seen at any time meanwhile.
fn lasting(h: &Happened) -> Happened {
    let grows = h.what == Name::Ramp;
    Happened {
        to: h
            .to
            .or(grows.then(|| h.from.plus_seconds(RAMP_DAYS * DAY_S))),
        ..*h
    }
}

/// Returns the change that reports an event, if there is one. A fault or a storm may be
/// reported in parts, of which the rightly named one counts.
fn telling<'a>(row: &Row, analysis: &'a Analysis, h: &Happened) -> Option<&'a Change> {
    let reports = analysis.changes.iter().filter(|c| {
        c.confirmed && c.detected_at >= h.from && near(h, c) && h.from.seconds_since(c.from) < DAY_S
    });
    let reports: Vec<&Change> = reports.collect();
    // A disturbance withdrawn in favour of a change counts as the change.
    let counts = |c: &&&Change| match row.cause {
        cause if cause.changes_deviation() => c.cause.changes_deviation(),
        cause => c.cause == cause,
    };
    reports.iter().find(counts).or(reports.first()).copied()
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

fn print_wrong(seed: u64, h: &Happened, analysis: &Analysis) {
    println!("  seed {seed} {:?} {} to {:?}", h.what, h.from, h.to);
    for c in analysis.changes.iter().filter(|c| near(h, c)) {
        println!(
            "    {} confirmed {} {:?} {:?}",
            c.from, c.confirmed, c.causes, c.evidence
        );
    }
}

fn print(row: &Row, named: &[Named]) {
    let mut taken_for: BTreeMap<String, usize> = BTreeMap::new();
    for one in named {
        let name = one
            .reported
            .map_or("nothing".to_owned(), |s| format!("{:?}", s.cause));
        *taken_for.entry(name).or_default() += 1;
    }
    let reported: Vec<&Named> = named.iter().filter(|n| n.reported.is_some()).collect();
    println!(
        "{:16} {:6} {:>12} {:8.2} {:9.2} {:7.1} {:7.1}  {taken_for:?}",
        row.name,
        named.len(),
        at_least(share(named, |n| n.is_right), row.target),
        mean_probability(&reported),
        share(&reported, |n| n.is_right) / 100.0,
        share(named, |n| n.reported.is_none()),
        share(named, |n| n.blames_ship),
    );
}

fn mean_probability(reported: &[&Named]) -> f64 {
    let stated = reported.iter().filter_map(|n| n.reported);
    stated.map(|s| s.probability).sum::<f64>() / reported.len() as f64
}

/// Prints how often the causes of all rows were right, by their stated probabilities.
fn calibration(named: &[Named]) {
    println!(
        "\n{:16} {:>6} {:>8} {:>9}",
        "stated p", "events", "mean", "right"
    );
    for (k, from) in BINS.into_iter().enumerate() {
        let to = BINS.get(k + 1).copied().unwrap_or(f64::INFINITY);
        let within = |n: &&Named| {
            n.reported
                .is_some_and(|s| (from..to).contains(&s.probability))
        };
        let bin: Vec<&Named> = named.iter().filter(within).collect();
        if !bin.is_empty() {
            println!(
                "{:16} {:6} {:8.3} {:9.3}",
                format!("from {from}"),
                bin.len(),
                mean_probability(&bin),
                share(&bin, |n| n.is_right) / 100.0
            );
        }
    }
}
