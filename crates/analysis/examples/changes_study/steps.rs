//! Delay and date of steps.

use crate::voyages::fleet::{Event, Name, Plan, sail_log};
use crate::{
    DAY_S, HOUR_S, alarms, each, planned, quantile, run, seeds, settled_hours, share, variety,
};

use binnacle_compass::time::Timestamp;

/// Outcome of one step.
struct Found {
    /// By the clock; infinite where it was not found.
    delay_s: f64,
    /// Hours of settled sailing.
    settled_h: f64,
    date_off_s: f64,
    was_called_off: bool,
    was_withdrawn: bool,
}

pub(crate) fn steps(name: &str, event: Event, ships: u64) {
    let found = each(seeds(200_000, ships), |seed| {
        let log = sail_log(seed, &Plan::new(event, variety(seed)));
        let from = planned(&log, Name::Step)?.from;
        let analysis = run(&log.samples);
        let reported = alarms(&analysis)
            .find(|c| c.detected_at >= from && c.from.seconds_since(from).abs() < 3.0 * DAY_S);
        let near = |at: Timestamp| at.seconds_since(from).abs() < 3.0 * DAY_S;
        let mut changes = analysis.changes.iter();
        let was_withdrawn = changes.any(|c| c.withdrawn && near(c.from));
        let Some(reported) = reported else {
            let since = analysis.changes.iter().filter(|c| c.detected_at >= from);
            println!(
                "  seed {seed} missed {from}: {:?}",
                since
                    .map(|c| (c.cause, c.confirmed, c.from.to_string()))
                    .collect::<Vec<_>>()
            );
            return Some(Found {
                delay_s: f64::INFINITY,
                settled_h: f64::INFINITY,
                date_off_s: f64::NAN,
                was_called_off: false,
                was_withdrawn,
            });
        };
        Some(Found {
            delay_s: reported.detected_at.seconds_since(from),
            settled_h: settled_hours(&log, from, reported.detected_at),
            date_off_s: reported.from.seconds_since(from).abs(),
            was_called_off: reported.ended.is_some(),
            was_withdrawn,
        })
    });
    let found: Vec<Found> = found.into_iter().flatten().collect();
    let of = |value: fn(&Found) -> f64| -> Vec<f64> {
        found.iter().map(value).filter(|x| !x.is_nan()).collect()
    };
    let (mut delays, mut settled) = (of(|f| f.delay_s), of(|f| f.settled_h));
    let mut dates = of(|f| f.date_off_s);
    let within = |days: f64| share(&found, |f| f.delay_s <= days * DAY_S);
    println!(
        "{name}: {} ships, found after {:.2} h of settled sailing (median; 90 % {:.1} h), by the \
         clock {:.2} h (95 % {:.2} d); within 1 d {:.0} %, 3 d {:.0} %; date off median {:.0} min, \
         90 % {:.1} h; called off {:.1} %, withdrawn {:.1} %",
        found.len(),
        quantile(&mut settled, 0.5),
        quantile(&mut settled, 0.9),
        quantile(&mut delays, 0.5) / HOUR_S,
        quantile(&mut delays, 0.95) / DAY_S,
        within(1.0),
        within(3.0),
        quantile(&mut dates, 0.5) / 60.0,
        quantile(&mut dates, 0.9) / HOUR_S,
        share(&found, |f| f.was_called_off),
        share(&found, |f| f.was_withdrawn),
    );
}

/// One reference only: harder.
pub(crate) fn gyro_alone(ships: u64) {
    let sail = |seed: u64, event: Event| {
        let mut plan = Plan::new(event, variety(seed));
        plan.faults.satellite = false;
        plan.gyro_faults = 0.0;
        sail_log(seed, &plan)
    };
    let found = each(seeds(500_000, ships), |seed| {
        let log = sail(seed, Event::Step(2000.0));
        let from = planned(&log, Name::Step)?.from;
        let analysis = run(&log.samples);
        let before = alarms(&analysis).filter(|c| c.detected_at < from).count();
        let reported = alarms(&analysis).find(|c| c.detected_at >= from);
        let settled_h =
            reported.map_or(f64::INFINITY, |c| settled_hours(&log, from, c.detected_at));
        Some((settled_h, before))
    });
    let found: Vec<_> = found.into_iter().flatten().collect();
    let mut delays: Vec<f64> = found.iter().map(|f| f.0).collect();
    println!(
        "2 uT by gyro alone, {} ships: found after {:.1} h of settled sailing (median; 90 % {:.1} h); \
         false alarms in 60 days {}",
        found.len(),
        quantile(&mut delays, 0.5),
        quantile(&mut delays, 0.9),
        found.iter().map(|f| f.1).sum::<usize>(),
    );
    let found = each(seeds(510_000, ships), |seed| {
        let log = sail(seed, Event::GyroFault(4.0));
        let fault = planned(&log, Name::GyroFault)?;
        let analysis = run(&log.samples);
        let false_alarms: Vec<_> = alarms(&analysis)
            .map(|c| {
                let after_h = c.from.seconds_since(fault.from) / HOUR_S;
                let before_end_h = fault.to.map(|to| to.seconds_since(c.from) / HOUR_S);
                let reported_h = c.detected_at.seconds_since(c.from) / HOUR_S;
                format!(
                    "{:?} {after_h:.1} h after it began, {before_end_h:.1?} before it ended, reported after \
                     {reported_h:.1}, ended {:?}",
                    c.cause,
                    c.ended.map(|e| e.to_string())
                )
            })
            .collect();
        if !false_alarms.is_empty() {
            println!("  seed {seed}: {false_alarms:?}");
        }
        let named = analysis.changes.iter().any(|c| {
            c.confirmed
                && c.cause == binnacle_compass::result::Cause::ReferenceFault
                && crate::near(&fault, c)
        });
        Some((!false_alarms.is_empty(), named))
    });
    let found: Vec<_> = found.into_iter().flatten().collect();
    println!(
        "gyro off by 4 degrees, alone, {} ships: a false change of the ship in {:.0} %, named in {:.0} %",
        found.len(),
        share(&found, |f| f.0),
        share(&found, |f| f.1),
    );
}
