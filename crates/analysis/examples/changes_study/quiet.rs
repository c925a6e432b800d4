//! False alarms where nothing happens but storms, anomalies, gyro faults and outliers.

use crate::voyages::fleet::{Event, Happened, Name, Plan, sail_log};
use crate::{HOUR_S, each, near, run, seeds, variety, was_withdrawn};
use binnacle_compass::result::{Cause, Change};

pub(crate) fn quiet(ships: u64) {
    let found = each(seeds(100_000, ships), |seed| {
        let plan = Plan {
            days: 365.0,
            ..Plan::new(Event::Nothing, variety(seed))
        };
        let log = sail_log(seed, &plan);
        let analysis = run(&log.samples);
        // A withdrawn report was a report.
        let reported = || {
            let changes = analysis.changes.iter();
            changes.filter(|c| (c.confirmed || c.withdrawn) && c.cause.changes_deviation())
        };
        for c in reported() {
            println!(
                "  seed {seed} {:?}{} {} +{:.1} h {:?}",
                c.cause,
                if c.withdrawn { ", withdrawn," } else { "" },
                c.from,
                c.detected_at.seconds_since(c.from) / HOUR_S,
                c.evidence
            );
        }
        for c in reported() {
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
        for c in references.clone() {
            println!(
                "  seed {seed} a fault from {} to {:?} {:?}",
                c.from, c.ended, c.evidence
            );
        }
        let compass = analysis.changes.iter();
        let compass = compass.filter(|c| c.cause == Cause::CompassFault && c.confirmed);
        let passing = |c: &&Change| {
            c.confirmed
                && matches!(
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
            reported().count(),
            references.count(),
            passed.len(),
            false_passing,
            passed.iter().filter(|c| was_withdrawn(c)).count(),
            reported().filter(|c| c.withdrawn).count(),
            compass.count(),
        ]
    });
    let sum = |i: usize| found.iter().map(|f| f[i]).sum::<usize>();
    let years = ships as f64;
    println!("no event, {ships} vessel-years, false alarms a vessel-year:");
    println!("  change of magnetism {:.2}", sum(0) as f64 / years);
    println!(
        "    of these, withdrawn by what came after {:.2}",
        sum(5) as f64 / years
    );
    println!(
        "  the same, gone again within a day {:.2}",
        sum(4) as f64 / years
    );
    println!("  reference fault     {:.2}", sum(1) as f64 / years);
    println!("  compass fault       {:.2}", sum(6) as f64 / years);
    println!(
        "  passing disturbance {:.2} (and {:.2} that were)",
        sum(3) as f64 / years,
        (sum(2) - sum(3)) as f64 / years
    );
}
