//! Settled hours from a step of the ship's magnetism to its detection.

use crate::arguments::Arguments;
use crate::detector::{self, leave_gyro_alone, plan};
use crate::score::{DAY_S, FalseReports, HOUR_S};
use crate::table::{at_most, quantile, share};
use crate::voyages::fleet::{Event, Log, Name, sail_log};
use binnacle_compass::time::Timestamp;

const SEEDS: u64 = 3_000_000;
/// Length of a voyage: the step is in the week after the sixtieth day.
const DAYS: f64 = 85.0;
/// Difference in time at which a report can be the step.
const NEAR_S: f64 = 3.0 * DAY_S;

pub(crate) struct Row {
    pub(crate) name: &'static str,
    step_nt: f64,
    has_satellite: bool,
    /// Settled hours to detection, median.
    target_h: f64,
}

const fn row(name: &'static str, step_nt: f64, has_satellite: bool, target_h: f64) -> Row {
    Row {
        name,
        step_nt,
        has_satellite,
        target_h,
    }
}

pub(crate) const ROWS: [Row; 4] = [
    row("step_1", 1000.0, true, 3.0),
    row("step_2", 2000.0, true, 1.5),
    row("step_1_gyro", 1000.0, false, 10.0),
    row("step_2_gyro", 2000.0, false, 5.0),
];

/// Outcome of one step; infinite hours where it was not found.
struct Found {
    settled_h: f64,
    clock_h: f64,
    date_off_min: f64,
    reports: FalseReports,
}

pub(crate) fn run(arguments: &Arguments) {
    let rows: Vec<&Row> = ROWS.iter().filter(|row| arguments.has(row.name)).collect();
    if rows.is_empty() {
        return;
    }
    println!(
        "\n{:16} {:>5} {:>12} {:>10} {:>10} {:>10} {:>12} {:>11}",
        "step", "ships", "settled h", "90 %", "clock h", "found %", "date off min", "false/ship"
    );
    for row in rows {
        let found = arguments.each(SEEDS, |seed| step(row, seed));
        print(row, &found.into_iter().flatten().collect::<Vec<_>>());
    }
}

fn step(row: &Row, seed: u64) -> Option<Found> {
    let mut plan = plan(seed, Event::Step(row.step_nt));
    plan.days = DAYS;
    if !row.has_satellite {
        leave_gyro_alone(&mut plan);
    }
    let log = sail_log(seed, &plan);
    let from = log.happened.iter().find(|h| h.what == Name::Step)?.from;
    let analysis = detector::run(&log);
    let reported = analysis.changes.iter().find(|c| {
        c.confirmed
            && c.cause.changes_deviation()
            && c.detected_at >= from
            && c.from.seconds_since(from).abs() < NEAR_S
    });
    let after_h = |at: Timestamp| at.seconds_since(from) / HOUR_S;
    Some(Found {
        settled_h: reported.map_or(f64::INFINITY, |c| settled_hours(&log, from, c.detected_at)),
        clock_h: reported.map_or(f64::INFINITY, |c| after_h(c.detected_at)),
        date_off_min: reported.map_or(f64::NAN, |c| 60.0 * after_h(c.from).abs()),
        reports: FalseReports::of(&analysis, &log),
    })
}

/// Returns the hours of settled sailing, of which a sample is ten minutes.
fn settled_hours(log: &Log, from: Timestamp, to: Timestamp) -> f64 {
    let between = log.samples.iter().filter(|s| s.time > from && s.time <= to);
    between.count() as f64 / 6.0
}

fn print(row: &Row, found: &[Found]) {
    let of = |value: fn(&Found) -> f64| -> Vec<f64> {
        found.iter().map(value).filter(|x| !x.is_nan()).collect()
    };
    let settled = of(|f| f.settled_h);
    let reports: usize = found.iter().map(|f| f.reports.ship).sum();
    println!(
        "{:16} {:5} {:>12} {:10.1} {:10.1} {:10.1} {:12.0} {:11.2}",
        row.name,
        found.len(),
        at_most(quantile(&settled, 0.5), row.target_h, 2),
        quantile(&settled, 0.9),
        quantile(&of(|f| f.clock_h), 0.5),
        share(&settled, |hours| hours.is_finite()),
        quantile(&of(|f| f.date_off_min), 0.5),
        reports as f64 / found.len() as f64,
    );
}
