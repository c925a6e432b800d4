//! First weeks of a compass whose zero is off: days until its model is right.

use crate::arguments::Arguments;
use crate::detector::{self, leave_gyro_alone, plan, run_until};
use crate::look::{HEADINGS, look};
use crate::score::{DAY_S, FalseReports, print_false_reports};
use crate::table::{at_least, at_most, quantile, share};
use crate::voyages::fleet::{Event, sail_log};

const SEEDS: u64 = 2_000_000;
/// Days of the looks; the last one is the length of the voyage.
const LOOKS: [f64; 10] = [0.5, 1.0, 2.0, 3.0, 5.0, 7.0, 10.0, 14.0, 21.0, 30.0];
/// Number of headings that the band of a right model holds.
const RIGHT: u32 = 33;
const TARGET_DAYS: f64 = 2.0;

pub(crate) struct Row {
    pub(crate) name: &'static str,
    zero_off_deg: f64,
}

const fn row(name: &'static str, zero_off_deg: f64) -> Row {
    Row { name, zero_off_deg }
}

pub(crate) const ROWS: [Row; 6] = [
    row("zero_0", 0.0),
    row("zero_10", 10.0),
    row("zero_20", 20.0),
    row("zero_30", 30.0),
    row("zero_90", 90.0),
    row("zero_180", 180.0),
];

/// Results of one ship.
struct Ship {
    /// First day from which the model stays right; infinite if there is none.
    right_day: f64,
    /// Half the width of the band on the second day; none without a model.
    half_width_deg: Option<f64>,
    reports: FalseReports,
}

pub(crate) fn run(arguments: &Arguments) {
    let rows: Vec<&Row> = ROWS.iter().filter(|row| arguments.has(row.name)).collect();
    if rows.is_empty() {
        return;
    }
    println!(
        "\n{:16} {:>5} {:>12} {:>10} {:>12} {:>12} {:>12} {:>11}",
        "starting",
        "ships",
        "days, median",
        "90 %",
        "in 2 d %",
        "never %",
        "band at 2 d",
        "false/ship"
    );
    for row in rows {
        let ships = arguments.each(SEEDS, |seed| ship(arguments, row, seed));
        print(row, &ships);
    }
}

fn ship(arguments: &Arguments, row: &Row, seed: u64) -> Ship {
    let mut plan = plan(seed, Event::Nothing);
    plan.days = LOOKS[LOOKS.len() - 1];
    if seed % 2 == 1 {
        leave_gyro_alone(&mut plan);
    }
    // To port on every other ship of each kind.
    let side = if seed % 4 < 2 { 1.0 } else { -1.0 };
    plan.habits.zero_off_deg = side * row.zero_off_deg;
    let log = sail_log(seed, &plan);
    let mut right_day = f64::INFINITY;
    let mut half_width_deg = None;
    for day in LOOKS {
        let until = log.start.plus_seconds(day * DAY_S);
        let state = log.states.partition_point(|s| s.time <= until) - 1;
        let analysis = run_until(arguments.detector, &log, until);
        let look = look(&analysis, &log.states[state]);
        if look.is_none_or(|look| look.own.covered < RIGHT) {
            right_day = f64::INFINITY;
        } else if right_day.is_infinite() {
            right_day = day;
        }
        if day <= TARGET_DAYS {
            half_width_deg = look.map(|look| look.own.half_width_deg());
        }
    }
    let analysis = detector::run(arguments.detector, &log);
    if arguments.words {
        println!("  seed {seed} right from day {right_day} of {HEADINGS} headings");
        print_false_reports(seed, &analysis, &log);
    }
    Ship {
        right_day,
        half_width_deg,
        reports: FalseReports::of(&analysis, &log),
    }
}

fn print(row: &Row, ships: &[Ship]) {
    let days: Vec<f64> = ships.iter().map(|ship| ship.right_day).collect();
    let widths: Vec<f64> = ships.iter().filter_map(|s| s.half_width_deg).collect();
    let reports: usize = ships.iter().map(|ship| ship.reports.ship).sum();
    println!(
        "{:16} {:5} {:>12} {:10.1} {:>12} {:12.1} {:12.1} {:11.2}",
        row.name,
        ships.len(),
        at_most(quantile(&days, 0.5), TARGET_DAYS, 1),
        quantile(&days, 0.9),
        at_least(share(&days, |day| *day <= TARGET_DAYS), 90.0),
        share(&days, |day| day.is_infinite()),
        quantile(&widths, 0.5),
        reports as f64 / ships.len() as f64,
    );
}
