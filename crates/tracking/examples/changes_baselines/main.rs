//! Delays of detection of the product, of simpler detectors, and of the theoretical
//! bound, as the tables of BENCHMARKS.md.
//!
//! All detectors see the same ships. The threshold of each but the product's is set, on
//! ships of their own, to the same rate of false alarms. Delays and false alarms of all
//! are counted by the same code on ships that none was set on.
//!
//! `make bench-changes`, or `cargo run --release -p binnacle-tracking --example
//! changes_baselines [SHIPS [PYTHON]]` with the number of ships of each kind and a
//! Python that has `ruptures`, without which PELT is left out.

#![allow(clippy::unwrap_used)] // a study, run by hand

mod bocpd;
mod cusum;
mod hours;
mod pelt;
mod score;
mod ship;
#[cfg(test)]
mod tests;
#[allow(dead_code)]
#[path = "../../../analysis/tests/voyages/mod.rs"]
mod voyages;

use score::{Delays, false_alarms, threshold};
use ship::Ship;
use voyages::fleet::Event;

/// One in five years.
const FALSE_ALARMS_A_YEAR: f64 = 0.2;
/// Ships that thresholds are set on, for each one that is judged.
const SET_ON: u64 = 2;
/// No other study sails these.
const SET_ON_SEEDS: u64 = 600_000;
const QUIET_SEEDS: u64 = 700_000;
const EVENT_SEEDS: u64 = 900_000;

const EVENTS: [(&str, Event); 4] = [
    ("0.5 µT in (bx, by)", Event::Step(500.0)),
    ("1 µT in (bx, by)", Event::Step(1000.0)),
    ("2 µT in (bx, by)", Event::Step(2000.0)),
    ("steel cargo", Event::Cargo),
];

/// Rows at which a detector alarms, of those that are watched, by its threshold.
type Detector = fn(&Ship, f64) -> Vec<usize>;

const DETECTORS: [(&str, Detector); 3] = [
    ("threshold on hourly means", hours::alarms),
    ("CUSUM on innovations", cusum::alarms),
    ("BOCPD", bocpd::alarms),
];

/// One detector's alarms: of quiet ships, and of each fleet to which something happens.
struct Entry {
    name: String,
    quiet: Vec<Vec<usize>>,
    events: Vec<Vec<Vec<usize>>>,
}

fn main() {
    let mut args = std::env::args().skip(1);
    let ships = args.next();
    let ships = ships.map_or(20, |n| n.parse().expect("the number of ships"));
    let set_on = each(SET_ON_SEEDS, SET_ON * ships, Ship::quiet);
    let quiet = each(QUIET_SEEDS, ships, Ship::quiet);
    let fleets =
        EVENTS.map(|(_, event)| each(EVENT_SEEDS, ships, |seed| Ship::that_changes(seed, event)));

    let mut entries = Vec::new();
    for (name, detector) in DETECTORS {
        let threshold = threshold(&set_on, detector);
        let alarms = |ships: &[Ship]| ships.iter().map(|s| detector(s, threshold)).collect();
        entries.push(Entry {
            name: format!("{name}, {threshold:.1}"),
            quiet: alarms(&quiet),
            events: fleets.iter().map(|fleet| alarms(fleet)).collect(),
        });
    }
    if let Some(python) = args.next() {
        let mut all: Vec<&[Ship]> = vec![&set_on, &quiet];
        all.extend(fleets.iter().map(Vec::as_slice));
        let (penalty, found) = pelt::alarms(&python, &all);
        let mut found = found.into_iter().skip(1);
        entries.push(Entry {
            name: format!("PELT, {penalty:.1}"),
            quiet: found.next().expect("quiet ships"),
            events: found.collect(),
        });
    }
    let product = |ships: &[Ship]| ships.iter().map(Ship::product_alarms).collect();
    entries.push(Entry {
        name: "**Binnacle**".to_owned(),
        quiet: product(&quiet),
        events: fleets.iter().map(|fleet| product(fleet)).collect(),
    });
    print(&entries, &quiet, &fleets);
}

fn each(first: u64, ships: u64, sail: impl Fn(u64) -> Ship) -> Vec<Ship> {
    (first..first + ships).map(sail).collect()
}

fn print(entries: &[Entry], quiet: &[Ship], fleets: &[Vec<Ship>]) {
    let years: f64 = quiet.iter().map(Ship::years).sum();
    println!("| {years:.0} vessel-years without an event | false alarms a vessel-year |");
    println!("|---|---|");
    for entry in entries {
        let (rate, error) = false_alarms(quiet, &entry.quiet);
        println!("| {} | {rate:.2} ± {error:.2} |", entry.name);
    }
    for (k, (fleet, (event, _))) in fleets.iter().zip(EVENTS).enumerate() {
        let delays: Vec<Delays> = entries
            .iter()
            .map(|entry| Delays::from_alarms(fleet, &entry.events[k]))
            .collect();
        let bound = hours(delays[0].median_bound_hours());
        println!(
            "\n| {event}, {} ships; bound {bound} | within 1 day | 7 days | median | over the bound |",
            fleet.len()
        );
        println!("|---|---|---|---|---|");
        for (entry, delays) in entries.iter().zip(&delays) {
            let over = delays.median_over_bound();
            println!(
                "| {} | {:.0} % | {:.0} % | {} | {} |",
                entry.name,
                delays.found_within(1.0),
                delays.found_within(7.0),
                hours(delays.median_hours()),
                if over.is_finite() {
                    format!("{over:.0} ×")
                } else {
                    "–".to_owned()
                },
            );
        }
    }
}

/// Hours of settled sailing in words; a dash where most ships have none.
fn hours(hours: f64) -> String {
    if !hours.is_finite() {
        "–".to_owned()
    } else if hours < 1.5 {
        format!("{:.0} min", 60.0 * hours)
    } else if hours < 9.5 {
        format!("{hours:.1} h")
    } else {
        format!("{hours:.0} h")
    }
}
