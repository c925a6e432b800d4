//! Base model after cargo is discharged, and lasting changes.

use crate::voyages::fleet::{Event, Happened, Log, Name, Plan, START, sail_log};
use crate::voyages::lorden::information_of_discharge;
use crate::voyages::{gauss, predicted, true_deviation};
use crate::{DAY_S, HOUR_S, alarms, each, near, planned, run, seeds, share, variety};
use binnacle_analysis::analyse::analyse;
use binnacle_compass::angle::wrap_180;
use binnacle_compass::logbook::{LogbookEntry, LogbookKind};
use binnacle_compass::result::{Analysis, Cause};
use binnacle_compass::settings::AnalysisSettings;
use binnacle_compass::time::Timestamp;
use rand::SeedableRng;
use rand_chacha::ChaCha8Rng;

/// Days after a lasting change at which it is tested for being taken for a return.
const LOOKS_DAYS: [f64; 4] = [1.0, 4.0, 10.0, 30.0];

/// Standard deviation of the times in officers' entries of cargo, hours.
const WRITTEN_H: f64 = 3.0;

/// Prints the base model after cargo is discharged, by samples alone and with the officers'
/// report.
pub(crate) fn returns(ships: u64) {
    returned("nobody having reported it", ships, |_, _| Vec::new());
    returned("reported", ships, |seed, cargo| {
        let mut rng = ChaCha8Rng::seed_from_u64(seed ^ 0x10C);
        let mut about = |time: Timestamp| time.plus_seconds(WRITTEN_H * HOUR_S * gauss(&mut rng));
        let (from, to) = (about(cargo.from), cargo.to.map(about));
        vec![LogbookEntry {
            from,
            to: to.map(|to| to.max(from)),
            kind: LogbookKind::MagneticCargo,
            cargo: None,
            note: String::new(),
        }]
    });
    ideal(ships);
}

/// Prints how often a day's samples would show the discharge to an observer who knew the
/// ship with cargo and without, and all noise levels, but not the present state.
fn ideal(ships: u64) {
    let ratio = each(seeds(400_000, ships), |seed| {
        let mut plan = Plan::new(Event::Cargo, variety(seed));
        plan.days = 130.0;
        information_of_discharge(&sail_log(seed, &plan))
    });
    let ratio: Vec<f64> = ratio.into_iter().flatten().collect();
    let mean = |of: fn(f64) -> f64| {
        100.0 * ratio.iter().map(|ratio| of(*ratio)).sum::<f64>() / ratio.len() as f64
    };
    // The log of the likelihoods' ratio is Gaussian about the information, with twice
    // that as its variance.
    println!(
        "an observer who knows both ships and all noise: rather without cargo than with, a day          after sailing, {:.0} % of {} ships; nine times likelier {:.0} %; a log-likelihood ratio below 3          on {:.0} %",
        mean(|ratio| normal((ratio / 2.0).sqrt())),
        ratio.len(),
        mean(|ratio| normal((ratio - 9.0_f64.ln()) / (2.0 * ratio).sqrt())),
        share(&ratio, |ratio| *ratio < 3.0),
    );
}

/// The normal distribution [Abramowitz & Stegun 1964, 26.2.17].
fn normal(x: f64) -> f64 {
    let t = 1.0 / (1.0 + 0.231_641_9 * x.abs());
    let series = [
        0.319_381_530,
        -0.356_563_782,
        1.781_477_937,
        -1.821_255_978,
        1.330_274_429,
    ];
    let tail = series.iter().rev().fold(0.0, |sum, b| t * (b + sum));
    let tail = tail * (-x * x / 2.0).exp() / std::f64::consts::TAU.sqrt();
    if x < 0.0 { tail } else { 1.0 - tail }
}

fn returned(how: &str, ships: u64, logbook: impl Fn(u64, &Happened) -> Vec<LogbookEntry> + Sync) {
    let found = each(seeds(400_000, ships), |seed| {
        let mut plan = Plan::new(Event::Cargo, variety(seed));
        plan.days = 130.0;
        let log = sail_log(seed, &plan);
        let cargo = planned(&log, Name::Cargo)?;
        let discharged = cargo.to?;
        let known = logbook(seed, &cargo);
        let then = after(seed, &plan, &log, &known, discharged, 1.0)?;
        let noticed = then
            .analysis
            .changes
            .iter()
            .any(|c| c.cause == Cause::MagneticCargo);
        if then.of == Of::Another {
            println!(
                "  seed {seed}: on board {} to {discharged}, log-likelihood ratio {:.1}, not back: {:?}",
                planned(&log, Name::Cargo)?.from,
                information_of_discharge(&log).unwrap_or(f64::NAN),
                then.reports()
            );
        }
        Some((then.of, then.held, noticed))
    });
    let found: Vec<_> = found.into_iter().flatten().collect();
    let is_base = |of: Of| of != Of::Another;
    let left: Vec<_> = found.iter().filter(|f| f.0 != Of::NeverLeft).collect();
    println!(
        "cargo, {how}, {} ships: noticed {:.0} %; a day after sailing from discharge the base model is in \
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

/// Model in force.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
enum Of {
    /// Model of the base, which a return resumed.
    Resumed,
    /// Model of the base, without any change found.
    NeverLeft,
    /// Mixture in which the base is the likelier.
    Likely,
    Another,
}

/// Knowledge some time after the ship sailed from a port.
pub(crate) struct Then {
    of: Of,
    /// Number of headings of 36 on which the band held the truth.
    pub(crate) held: usize,
    /// The mean of the band's standard error over the headings, degrees.
    pub(crate) se_deg: f64,
    pub(crate) analysis: Analysis,
}

impl Then {
    fn reports(&self) -> Vec<String> {
        let of_ship = self
            .analysis
            .changes
            .iter()
            .filter(|c| c.cause.changes_deviation());
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

pub(crate) fn after(
    seed: u64,
    plan: &Plan,
    log: &Log,
    logbook: &[LogbookEntry],
    port: Timestamp,
    days: f64,
) -> Option<Then> {
    let sailed = log.samples.iter().find(|s| s.time > port)?.time;
    let until = log
        .samples
        .partition_point(|s| s.time.seconds_since(sailed) < days * DAY_S);
    let analysis = analyse(&log.samples[..until], logbook, &AnalysisSettings::default());
    // The state of the ship at that time.
    let begun = Timestamp::parse(START).unwrap();
    let last = log.samples[until - 1].time;
    let days = last.seconds_since(begun) / DAY_S + 0.001;
    let truth = sail_log(seed, &Plan { days, ..*plan }).truth;
    let epoch = analysis.current_epoch()?;
    let (mut held, mut se_deg) = (0, 0.0);
    for k in 0..36 {
        let (Some(model), Some(place)) = (epoch.model.as_ref(), analysis.last_place) else {
            break;
        };
        let compass = f64::from(k) * 10.0;
        let truth = true_deviation(&truth, compass, place.h_nt, place.z_nt);
        let (predicted, se) = predicted(model, compass, place.h_nt, place.z_nt);
        se_deg += se / 36.0;
        held += usize::from(wrap_180(predicted - truth).abs() <= 1.96 * se);
    }
    let of = if epoch.resumes.is_some() {
        Of::Resumed
    } else if epoch.begun_by_change.is_none() {
        Of::NeverLeft
    } else if may_have_ended(&analysis) {
        Of::Likely
    } else {
        Of::Another
    };
    Some(Then {
        of,
        held,
        se_deg,
        analysis,
    })
}

/// Returns true if the last change is rather over than not.
fn may_have_ended(analysis: &Analysis) -> bool {
    let evidence = analysis.changes.iter().flat_map(|c| &c.evidence);
    let mut likely = evidence.filter_map(|line| {
        let (_, per_cent) = line.strip_prefix("it may have ended")?.rsplit_once(": ")?;
        per_cent.trim_end_matches(" %").parse::<f64>().ok()
    });
    likely.next_back().is_some_and(|per_cent| per_cent >= 50.0)
}

/// Prints changes that look like cargo and stay: they must not pass for discharged at port
/// calls.
pub(crate) fn permanent(ships: u64) {
    let found = each(seeds(410_000, ships), |seed| {
        let mut plan = Plan::new(Event::Refit, variety(seed));
        plan.days = 130.0;
        let log = sail_log(seed, &plan);
        let refit = planned(&log, Name::Refit)?;
        let analysis = run(&log.samples);
        let reports = alarms(&analysis).find(|c| near(&refit, c));
        let looks: Vec<Then> = LOOKS_DAYS
            .iter()
            .filter_map(|days| after(seed, &plan, &log, &[], refit.from, *days))
            .collect();
        let ever = looks.iter().any(|then| then.of == Of::Resumed);
        let at_last = reports.is_some_and(|c| c.ended.is_some());
        if ever || at_last {
            println!(
                "  seed {seed} changed {}, taken for ended: at last {at_last}",
                refit.from
            );
            for look in &looks {
                println!("    {:?} {:?}", look.of, look.reports());
            }
            println!(
                "    {:?}",
                alarms(&analysis).map(|c| &c.evidence).collect::<Vec<_>>()
            );
        }
        Some((
            reports.is_some(),
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

/// Prints width and coverage of the band hours after sailing from a port call without any
/// event.
pub(crate) fn calm(ships: u64) {
    for hours in [3.0, 12.0, 24.0] {
        let found = each(seeds(430_000, ships), |seed| {
            let mut plan = Plan::new(Event::Nothing, variety(seed));
            plan.days = 90.0;
            let log = sail_log(seed, &plan);
            let begun = log.samples.first()?.time;
            let mut legs = log.samples.windows(2);
            let port = legs.find(|leg| {
                leg[0].time.seconds_since(begun) > 60.0 * DAY_S
                    && leg[1].time.seconds_since(leg[0].time) > 12.0 * HOUR_S
            })?;
            after(seed, &plan, &log, &[], port[0].time, hours / 24.0)
        });
        let found: Vec<_> = found.into_iter().flatten().collect();
        let held = found.iter().map(|then| then.held).sum::<usize>();
        let se = found.iter().map(|then| then.se_deg).sum::<f64>();
        println!(
            "{hours} hours after a call at which nothing happened, {} ships: standard error {:.3} \
             degrees, the band holds the truth on {:.1} % of all headings",
            found.len(),
            se / found.len() as f64,
            100.0 * held as f64 / (36 * found.len()) as f64,
        );
    }
}

/// Prints the band after lightning, which partly decays.
pub(crate) fn lightning(ships: u64) {
    for weeks in [1.0, 4.0] {
        let found = each(seeds(420_000, ships), |seed| {
            let plan = Plan::new(Event::Lightning(4000.0), variety(seed));
            let log = sail_log(seed, &plan);
            let struck = planned(&log, Name::Lightning)?.from;
            after(
                seed,
                &plan,
                &log,
                &[],
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
