//! Sound ships for a year: false reports, and the band from month to month.

use crate::arguments::Arguments;
use crate::band_check::{Held, look};
use crate::detector::{leave_gyro_alone, plan, run_until};
use crate::score::{FalseReports, Unstable, print_false_reports};
use crate::table::{at_most, held, quantile};
use crate::voyages::fleet::{Event, Plan, sail_log};
use crate::voyages::incidents::Incident;
use std::time::Instant;

const SEEDS: u64 = 1_000_000;
const DAYS: usize = 365;
/// Days of the dry dock.
const DOCK_DAY: f64 = 120.0;
/// False reports of references and of passing disturbances a year.
const OTHER_TARGET: f64 = 0.2;

pub(crate) struct Row {
    pub(crate) name: &'static str,
    /// False changes of the ship a year.
    target: f64,
    habit: fn(&mut Plan),
}

const fn row(name: &'static str, target: f64, habit: fn(&mut Plan)) -> Row {
    Row {
        name,
        target,
        habit,
    }
}

pub(crate) const ROWS: [Row; 24] = [
    row("plain", 0.1, |_| {}),
    row("retention_0.5", 0.3, |p| p.habits.retentive_share = 0.005),
    row("retention_1", 0.3, |p| p.habits.retentive_share = 0.01),
    row("retention_2", 1.0, |p| p.habits.retentive_share = 0.02),
    row("ballast_0.1", 0.3, |p| p.habits.load_step_nt = 100.0),
    row("ballast_0.3", 1.0, |p| p.habits.load_step_nt = 300.0),
    row("load_0.1", 0.3, |p| p.habits.load_condition_nt = 100.0),
    row("load_0.3", 1.0, |p| p.habits.load_condition_nt = 300.0),
    row("list_1.5", 0.3, |p| list(p, 1.5)),
    row("list_3", 1.0, |p| list(p, 3.0)),
    row("list_3_roll", 1.0, |p| {
        list(p, 3.0);
        p.habits.has_roll_sensor = true;
    }),
    row("friction_3", 0.3, |p| p.habits.friction_deg_ut = 3.0),
    row("friction_12", 1.0, |p| p.habits.friction_deg_ut = 12.0),
    row("half_degrees", 0.1, |p| round(p, 0.5)),
    row("whole_degrees", 0.1, |p| round(p, 1.0)),
    row("whole_calm", 0.1, |p| p.habits.sample_digit_deg = 1.0),
    row("heavy_weather", 0.1, |p| p.habits.weather = 0.5),
    row("heavy_tails", 0.1, |p| p.habits.tails_deg = 0.15),
    row("constant_0.75", 0.1, |p| {
        p.faults.gyro_constant_deg = 0.0;
        p.habits.constant_deg = 0.75;
    }),
    row("speed_error", 0.1, |p| p.habits.speed_error_share = 1.0),
    row("lag", 0.1, |p| p.habits.lag_minutes = 1.0),
    row("heading_error", 0.1, |p| p.habits.heading_error_deg = 0.3),
    row("dry_dock", 0.3, |p| {
        p.incident = Incident::DryDock(3000.0);
        p.event_day = DOCK_DAY;
    }),
    row("drift_240", 0.3, |p| p.faults.drift_nt = 240.0),
];

fn list(plan: &mut Plan, degrees: f64) {
    plan.habits.list_deg = degrees;
    plan.habits.heeling_nt = 5000.0;
}

fn round(plan: &mut Plan, digit_deg: f64) {
    plan.habits.compass_digit_deg = digit_deg;
    plan.habits.reference_digit_deg = digit_deg;
}

/// Results of one ship.
#[derive(Default)]
struct Ship {
    reports: FalseReports,
    own: Held,
    far: Held,
    /// Looks at which there was no model.
    without_model: usize,
    looks: usize,
    /// Latest watches predicted, those inside the band, and the factor that widened it.
    watches: u32,
    watches_inside: u32,
    widening: f64,
    unstable: Unstable,
    /// Time of the analysis of the whole voyage.
    seconds: f64,
}

pub(crate) fn run(arguments: &Arguments) {
    let rows: Vec<&Row> = ROWS.iter().filter(|row| arguments.has(row.name)).collect();
    if rows.is_empty() {
        return;
    }
    println!(
        "\n{:16} {:>5} {:>6} {:>11} {:>11} {:>11} {:>6} {:>6} {:>7} {:>8} {:>9} {:>7} {:>7} {:>7} {:>5} {:>6}",
        "sound ship",
        "ships",
        "years",
        "ship/yr",
        "ref/yr",
        "passing/yr",
        "own %",
        "far %",
        "no mod.",
        "vanished",
        "withdrawn",
        "renamed",
        "redated",
        "watch %",
        "wider",
        "s/yr"
    );
    for row in rows {
        let ships = arguments.each(SEEDS, |seed| ship(arguments, row, seed));
        print(row, &ships);
    }
}

fn ship(arguments: &Arguments, row: &Row, seed: u64) -> Ship {
    let mut plan = plan(seed, Event::Nothing);
    plan.days = DAYS as f64;
    if seed % 2 == 1 {
        leave_gyro_alone(&mut plan);
    }
    (row.habit)(&mut plan);
    let log = sail_log(seed, &plan);
    let last = log.states.len() - 1;
    let every = arguments.every_days;
    let mut days: Vec<usize> = (every..last.saturating_sub(every / 2))
        .step_by(every)
        .collect();
    days.push(last);
    let mut ship = Ship::default();
    let mut before = None;
    for day in days {
        let state = &log.states[day];
        let began = Instant::now();
        let analysis = run_until(&log, state.time);
        ship.seconds = began.elapsed().as_secs_f64();
        ship.looks += 1;
        match look(&analysis, state) {
            Some(look) => {
                ship.own.merge(look.own);
                ship.far.merge(look.far);
            }
            None => ship.without_model += 1,
        }
        if let Some(before) = &before {
            ship.unstable.add(before, &analysis);
        }
        if let Some(predictions) = analysis.predictions {
            ship.watches = predictions.watches;
            ship.watches_inside = predictions.watches_inside;
            ship.widening = predictions.widening;
        }
        before = Some(analysis);
    }
    let analysis = before.unwrap();
    ship.reports = FalseReports::of(&analysis, &log);
    if arguments.words {
        print_false_reports(seed, &analysis, &log);
    }
    ship
}

fn print(row: &Row, ships: &[Ship]) {
    let years = ships.len() as f64 * DAYS as f64 / 365.0;
    let sum = |count: fn(&Ship) -> usize| ships.iter().map(count).sum::<usize>();
    let (mut own, mut far) = (Held::default(), Held::default());
    for ship in ships {
        own.merge(ship.own);
        far.merge(ship.far);
    }
    let a_year = |count: fn(&Ship) -> usize, target| at_most(sum(count) as f64 / years, target, 2);
    let watches: u32 = ships.iter().map(|ship| ship.watches).sum();
    let inside: u32 = ships.iter().map(|ship| ship.watches_inside).sum();
    let widening: Vec<f64> = ships.iter().map(|ship| ship.widening).collect();
    let seconds: Vec<f64> = ships.iter().map(|ship| ship.seconds).collect();
    println!(
        "{:16} {:5} {years:6.1} {:>11} {:>11} {:>11} {:>6} {:>6} {:7.1} {:8} {:9} {:7} {:7} {:>7} {:5.2} {:6.2}",
        row.name,
        ships.len(),
        a_year(|s| s.reports.ship, row.target),
        a_year(|s| s.reports.reference, OTHER_TARGET),
        a_year(|s| s.reports.passing, OTHER_TARGET),
        held(own.percent()),
        held(far.percent()),
        100.0 * sum(|s| s.without_model) as f64 / sum(|s| s.looks) as f64,
        sum(|s| s.unstable.vanished),
        sum(|s| s.unstable.withdrawn),
        sum(|s| s.unstable.renamed),
        sum(|s| s.unstable.redated),
        held(100.0 * f64::from(inside) / f64::from(watches)),
        quantile(&widening, 0.5),
        quantile(&seconds, 0.5),
    );
}
