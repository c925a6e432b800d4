//! What becomes of the base model after cargo is discharged, and of what stays.

use crate::voyages::fleet::{Event, Log, Name, Plan, START, sail_log};
use crate::voyages::{predicted, true_deviation};
use crate::{DAY_S, alarms, each, near, planned, run, seeds, share, variety};
use binnacle_magnetics::analyse::Analysis;
use binnacle_magnetics::angle::wrap_180;
use binnacle_magnetics::change::Cause;
use binnacle_magnetics::time::Timestamp;

/// How often what stays is looked at for being taken for a return, days after it.
const LOOKS_DAYS: [f64; 4] = [1.0, 4.0, 10.0, 30.0];

/// What becomes of the base model after cargo is discharged.
pub(crate) fn returns(ships: u64) {
    let found = each(seeds(400_000, ships), |seed| {
        let mut plan = Plan::of(Event::Cargo, variety(seed));
        plan.days = 130.0;
        let log = sail_log(seed, &plan);
        let discharged = planned(&log, Name::Cargo)?.to?;
        let then = after(seed, &plan, &log, discharged, 1.0)?;
        let noticed = then
            .analysis
            .changes
            .iter()
            .any(|c| c.cause == Cause::MagneticCargo);
        if then.of == Of::Another {
            println!(
                "  seed {seed}: on board {} to {discharged}, not back: {:?}",
                planned(&log, Name::Cargo)?.from,
                then.told()
            );
        }
        Some((then.of, then.held, noticed))
    });
    let found: Vec<_> = found.into_iter().flatten().collect();
    let is_base = |of: Of| of != Of::Another;
    let left: Vec<_> = found.iter().filter(|f| f.0 != Of::NeverLeft).collect();
    println!(
        "cargo, {} ships: noticed {:.0} %; a day after sailing from discharge the base model is in \
         force or the likelier of two {:.0} % (of the {} that had left it {:.0} %, for certain {:.0} %), and holds the truth on 9 headings in 10 \
         {:.0} %; the band in force holds it on {:.1} % of all headings",
        found.len(),
        share(&found, |f| f.2),
        share(&found, |f| is_base(f.0)),
        left.len(),
        share(&left, |f| is_base(f.0)),
        share(&left, |f| f.0 == Of::Resumed),
        share(&found, |f| is_base(f.0) && f.1 >= 33),
        100.0 * found.iter().map(|f| f.1).sum::<usize>() as f64 / (36 * found.len()) as f64,
    );
}

/// Which model is in force.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
enum Of {
    /// That of the base, which a return resumed.
    Resumed,
    /// That of the base, no change having been found.
    NeverLeft,
    /// That of either, the base's being the likelier.
    Likely,
    Another,
}

/// What was known some time after the ship sailed from a port.
struct Then {
    of: Of,
    /// On how many headings of 36 the band held the truth.
    held: usize,
    analysis: Analysis,
}

impl Then {
    fn told(&self) -> Vec<String> {
        let of_ship = self
            .analysis
            .changes
            .iter()
            .filter(|c| c.cause.is_the_ships());
        of_ship
            .map(|c| {
                format!(
                    "{:?} {} to {:?}: {:?}",
                    c.cause,
                    c.from,
                    c.ended.map(|t| t.to_string()),
                    c.evidence
                )
            })
            .collect()
    }
}

fn after(seed: u64, plan: &Plan, log: &Log, port: Timestamp, days: f64) -> Option<Then> {
    let sailed = log.samples.iter().find(|s| s.time > port)?.time;
    let until = log
        .samples
        .partition_point(|s| s.time.seconds_since(sailed) < days * DAY_S);
    let analysis = run(&log.samples[..until]);
    // The same ship, as she was at that time.
    let begun = Timestamp::parse(START).unwrap();
    let last = log.samples[until - 1].time;
    let days = last.seconds_since(begun) / DAY_S + 0.001;
    let truth = sail_log(seed, &Plan { days, ..*plan }).truth;
    let epoch = analysis.current_epoch()?;
    let held = epoch.model.as_ref().map_or(0, |model| {
        let place = analysis.last_place.unwrap();
        let held = (0..36).filter(|k| {
            let compass = f64::from(*k) * 10.0;
            let truth = true_deviation(&truth, compass, place.h_nt, place.z_nt);
            let (predicted, se) = predicted(model, compass, place.h_nt, place.z_nt);
            wrap_180(predicted - truth).abs() <= 1.96 * se
        });
        held.count()
    });
    let of = if epoch.resumes.is_some() {
        Of::Resumed
    } else if epoch.begun_by_change.is_none() {
        Of::NeverLeft
    } else if may_have_ended(&analysis) {
        Of::Likely
    } else {
        Of::Another
    };
    Some(Then { of, held, analysis })
}

/// Whether the last change is rather over than not.
fn may_have_ended(analysis: &Analysis) -> bool {
    let evidence = analysis.changes.iter().flat_map(|c| &c.evidence);
    let mut likely = evidence.filter_map(|line| {
        let (_, per_cent) = line.strip_prefix("it may have ended")?.rsplit_once(": ")?;
        per_cent.trim_end_matches(" %").parse::<f64>().ok()
    });
    likely.next_back().is_some_and(|per_cent| per_cent >= 50.0)
}

/// What looks like cargo, and stays: it must not pass for discharged, though the ship
/// calls at ports.
pub(crate) fn permanent(ships: u64) {
    let found = each(seeds(410_000, ships), |seed| {
        let mut plan = Plan::of(Event::Refit, variety(seed));
        plan.days = 130.0;
        let log = sail_log(seed, &plan);
        let refit = planned(&log, Name::Refit)?;
        let analysis = run(&log.samples);
        let told = alarms(&analysis).find(|c| near(&refit, c));
        let looks: Vec<Then> = LOOKS_DAYS
            .iter()
            .filter_map(|days| after(seed, &plan, &log, refit.from, *days))
            .collect();
        let ever = looks.iter().any(|then| then.of == Of::Resumed);
        let at_last = told.is_some_and(|c| c.ended.is_some());
        if ever || at_last {
            println!(
                "  seed {seed} changed {}, taken for ended: at last {at_last}",
                refit.from
            );
            for look in &looks {
                println!("    {:?} {:?}", look.of, look.told());
            }
            println!(
                "    {:?}",
                alarms(&analysis).map(|c| &c.evidence).collect::<Vec<_>>()
            );
        }
        Some((
            told.is_some(),
            ever || at_last,
            at_last,
            looks.first()?.held,
        ))
    });
    let found: Vec<_> = found.into_iter().flatten().collect();
    println!(
        "changed for good in port, {} ships: noticed {:.0} %, taken for ended ever {:.1} % (in the \
         end {:.1} %); a day after sailing the band holds the truth on {:.1} % of all headings",
        found.len(),
        share(&found, |f| f.0),
        share(&found, |f| f.1),
        share(&found, |f| f.2),
        100.0 * found.iter().map(|f| f.3).sum::<usize>() as f64 / (36 * found.len()) as f64,
    );
}

/// How good the band is after lightning, which partly fades.
pub(crate) fn lightning(ships: u64) {
    for weeks in [1.0, 4.0] {
        let found = each(seeds(420_000, ships), |seed| {
            let plan = Plan::of(Event::Lightning(4000.0), variety(seed));
            let log = sail_log(seed, &plan);
            let struck = planned(&log, Name::Lightning)?.from;
            after(
                seed,
                &plan,
                &log,
                struck.plus_seconds(7.0 * DAY_S * weeks),
                1.0,
            )
        });
        let found: Vec<_> = found.into_iter().flatten().collect();
        let held = found.iter().map(|then| then.held).sum::<usize>();
        println!(
            "{weeks} weeks after lightning, {} ships: the band holds the truth on {:.1} % of all headings, \
             called off {}",
            found.len(),
            100.0 * held as f64 / (36 * found.len()) as f64,
            found.iter().filter(|then| then.of == Of::Resumed).count(),
        );
    }
}
