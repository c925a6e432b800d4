//! First weeks of a compass whose zero is off, on one sea: days until its model is right,
//! beside those of the same ship with a true zero. Until she has shown enough headings,
//! there may be no model at all; a wrong one is worse.

use crate::arguments::Arguments;
use crate::band_check::look;
use crate::detector::{self, leave_gyro_alone, plan, run_until};
use crate::score::{DAY_S, FalseReports, print_false_reports};
use crate::table::{at_least, at_most, quantile, share};
use crate::voyages::Variety;
use crate::voyages::fleet::{Event, Log, sail_log};

const SEEDS: u64 = 2_000_000;
/// Days of the looks; the last one is the length of the voyage.
const LOOKS: [f64; 10] = [0.5, 1.0, 2.0, 3.0, 5.0, 7.0, 10.0, 14.0, 21.0, 30.0];
/// Number of headings that the band of a right model holds.
const RIGHT: u32 = 33;
/// Days after the model of a true zero.
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

/// Models of a ship, look by look.
#[derive(Default)]
struct Models {
    /// First day from which the model stays right; infinite if there is none.
    right_day: f64,
    /// Number of looks with a model, and of those whose band did not hold the truth.
    looks: usize,
    wrong: usize,
}

/// Results of one ship.
struct Ship {
    models: Models,
    /// Days after the model of the same ship with a true zero.
    late_days: f64,
    reports: FalseReports,
}

pub(crate) fn run(arguments: &Arguments) {
    let rows: Vec<&Row> = ROWS.iter().filter(|row| arguments.has(row.name)).collect();
    if rows.is_empty() {
        return;
    }
    println!(
        "\n{:16} {:>5} {:>6} {:>6} {:>10} {:>13} {:>8} {:>9} {:>11}",
        "starting",
        "ships",
        "days",
        "90 %",
        "days late",
        "2 d late %",
        "never %",
        "wrong %",
        "false/ship"
    );
    for row in rows {
        let ships = arguments.each(SEEDS, |seed| ship(arguments, row, seed));
        print(row, &ships);
    }
}

fn ship(arguments: &Arguments, row: &Row, seed: u64) -> Ship {
    // To port on every other ship of each kind.
    let side = if seed % 4 < 2 { 1.0 } else { -1.0 };
    let log = sail(seed, side * row.zero_off_deg);
    let models = models(arguments, seed, &log);
    let sound_day = self::models(arguments, seed, &sail(seed, 0.0)).right_day;
    let analysis = detector::run(&log);
    if arguments.words {
        print_false_reports(seed, &analysis, &log);
    }
    Ship {
        late_days: if models.right_day.is_finite() {
            (models.right_day - sound_day).max(0.0)
        } else {
            f64::INFINITY
        },
        models,
        reports: FalseReports::of(&analysis, &log),
    }
}

fn sail(seed: u64, zero_off_deg: f64) -> Log {
    let mut plan = plan(seed, Event::Nothing);
    plan.variety = Variety::Poor;
    plan.days = LOOKS[LOOKS.len() - 1];
    if seed % 2 == 1 {
        leave_gyro_alone(&mut plan);
    }
    plan.habits.zero_off_deg = zero_off_deg;
    sail_log(seed, &plan)
}

fn models(arguments: &Arguments, seed: u64, log: &Log) -> Models {
    let mut models = Models {
        right_day: f64::INFINITY,
        ..Models::default()
    };
    for day in LOOKS {
        let until = log.start.plus_seconds(day * DAY_S);
        let state = log.states.partition_point(|s| s.time <= until) - 1;
        let analysis = run_until(log, until);
        let look = look(&analysis, &log.states[state]);
        if arguments.words {
            let refusal = analysis.current_epoch().and_then(|e| e.refusal.clone());
            println!("  seed {seed} day {day}: {look:?} {refusal:?}");
        }
        let is_right = look.is_some_and(|look| look.own.covered >= RIGHT);
        models.looks += usize::from(look.is_some());
        models.wrong += usize::from(look.is_some() && !is_right);
        if !is_right {
            models.right_day = f64::INFINITY;
        } else if models.right_day.is_infinite() {
            models.right_day = day;
        }
    }
    models
}

fn print(row: &Row, ships: &[Ship]) {
    let days: Vec<f64> = ships.iter().map(|ship| ship.models.right_day).collect();
    let late: Vec<f64> = ships.iter().map(|ship| ship.late_days).collect();
    let sum = |of: fn(&Ship) -> usize| ships.iter().map(of).sum::<usize>() as f64;
    println!(
        "{:16} {:5} {:6.1} {:6.1} {:>10} {:>13} {:8.1} {:>9} {:11.2}",
        row.name,
        ships.len(),
        quantile(&days, 0.5),
        quantile(&days, 0.9),
        at_most(quantile(&late, 0.5), TARGET_DAYS, 1),
        at_least(share(&late, |days| *days <= TARGET_DAYS), 90.0),
        share(&days, |day| day.is_infinite()),
        at_most(
            100.0 * sum(|s| s.models.wrong) / sum(|s| s.models.looks),
            5.0,
            1
        ),
        sum(|s| s.reports.ship) / ships.len() as f64,
    );
}
