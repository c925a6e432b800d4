//! Severe lightning strikes of 4 to 20 µT.

use crate::returns::{Then, after};
use crate::voyages::fleet::{Event, Name, Plan, sail_log};
use crate::{DAY_S, HOUR_S, alarms, each, planned, quantile, seeds, share, variety};
use binnacle_compass::result::Cause;

/// Sizes, nT.
const SIZES: [f64; 5] = [4000.0, 6000.0, 8000.0, 12_000.0, 20_000.0];
/// Days after the strike at which the ship is evaluated.
const LOOKS_DAYS: [f64; 3] = [0.5, 1.0, 2.0];
const SOON_DAYS: f64 = 0.5 / 24.0;

struct Struck {
    delay_s: f64,
    /// True if it was reported, certain or not, half an hour after, and the number of
    /// headings of 36 on which the band held the truth then, if there was one.
    soon: (bool, Option<usize>),
    /// True if the cause is right, a day after.
    named: bool,
    /// Lasting changes reported within two days, beside the first.
    more: usize,
    looks: Vec<(usize, f64)>,
}

/// With gyro and satellite compass, on few courses and many, wherever she is.
pub(crate) fn large(ships: u64) {
    let only: Option<f64> = std::env::var("NT").ok().map(|nt| nt.parse().unwrap());
    for nt in SIZES
        .into_iter()
        .filter(|nt| only.is_none_or(|only| (only - nt).abs() < 1.0))
    {
        let found = each(seeds(800_000, ships), |seed| {
            let mut plan = Plan::new(Event::Step(nt), variety(seed));
            (plan.days, plan.event_day) = (46.0, 33.0);
            plan.gyro_faults = 0.0;
            let log = sail_log(seed, &plan);
            let from = planned(&log, Name::Step)?.from;
            let looks: Vec<Then> = LOOKS_DAYS
                .iter()
                .map_while(|days| after(seed, &plan, &log, &[], from, *days))
                .collect();
            let [_, day, last] = &looks[..] else {
                return None;
            };
            let reports: Vec<_> = alarms(&last.analysis)
                .filter(|c| c.detected_at >= from)
                .collect();
            let delay_s = reports
                .first()
                .map_or(f64::INFINITY, |c| c.detected_at.seconds_since(from));
            let near = |c: &&binnacle_compass::result::Change| {
                c.confirmed && c.from.seconds_since(from).abs() < 3.0 * HOUR_S
            };
            let a_day_after = day.analysis.changes.iter().find(near);
            let named = a_day_after.is_some_and(|c| c.cause == Cause::LightningOrShock);
            let then = after(seed, &plan, &log, &[], from, SOON_DAYS)?;
            let mut soon = then.analysis.changes.iter();
            let soon = soon.any(|c| from.seconds_since(c.from) < HOUR_S);
            let struck = Struck {
                delay_s,
                soon: (soon, (then.se_deg > 0.0).then_some(then.held)),
                named,
                more: reports.len().saturating_sub(1),
                looks: looks.iter().map(|then| (then.held, then.se_deg)).collect(),
            };
            if !named
                || struck.more > 0
                || struck.looks.iter().any(|look| look.0 < 34 && look.1 > 0.0)
            {
                let all = looks.iter().map(|then| {
                    let changes = then.analysis.changes.iter();
                    let since = changes.filter(|c| c.detected_at >= from);
                    let words = since.map(|c| {
                        let sure = if c.confirmed { "" } else { "?" };
                        let after_h = c.from.seconds_since(from) / HOUR_S;
                        format!("{:?}{sure} at {after_h:.1} h", c.cause)
                    });
                    words.collect::<Vec<_>>()
                });
                println!(
                    "  seed {seed} ({:?}): soon {:?}, found after {:.1} h, held and error {:.1?}: {:?}",
                    variety(seed),
                    struck.soon,
                    delay_s / HOUR_S,
                    struck.looks,
                    all.collect::<Vec<_>>()
                );
            }
            Some(struck)
        });
        let found: Vec<Struck> = found.into_iter().flatten().collect();
        let mut delays: Vec<f64> = found.iter().map(|f| f.delay_s).collect();
        // Where there is no model there is no band.
        let held = |look: usize| {
            let with = found
                .iter()
                .map(|f| f.looks[look])
                .filter(|look| look.1 > 0.0);
            let with: Vec<usize> = with.map(|look| look.0).collect();
            let held = 100.0 * with.iter().sum::<usize>() as f64 / (36 * with.len()) as f64;
            format!("{held:.1} % of all headings of {} with a model", with.len())
        };
        let se = |look: usize| {
            let mut each: Vec<f64> = found.iter().map(|f| f.looks[look].1).collect();
            quantile(&mut each, 0.5)
        };
        let soon: Vec<usize> = found.iter().filter_map(|f| f.soon.1).collect();
        println!(
            "{} uT, {} ships: reported as possible half an hour after {:.0} % (the band holds the truth on {:.0} %); \
             certain after {:.0} min (median; 90 % {:.1} h), within a day {:.0} %; cause right \
             a day after {:.0} %; other changes reported {}; the band holds the truth on {} \
             half a day after (standard error {:.1} degrees, median), on {} two days after ({:.1})",
            nt / 1000.0,
            found.len(),
            share(&found, |f| f.soon.0),
            100.0 * soon.iter().sum::<usize>() as f64 / (36 * soon.len()) as f64,
            quantile(&mut delays, 0.5) / 60.0,
            quantile(&mut delays, 0.9) / HOUR_S,
            share(&found, |f| f.delay_s < DAY_S),
            share(&found, |f| f.named),
            found.iter().map(|f| f.more).sum::<usize>(),
            held(0),
            se(0),
            held(2),
            se(2),
        );
    }
}
