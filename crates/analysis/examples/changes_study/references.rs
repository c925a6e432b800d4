//! Band and reports while one of two references is wrong for long, evaluated every ten
//! days, as at the server.

use crate::voyages::fleet::{Event, Plan, sail_log};
use crate::voyages::{Truth, predicted, true_deviation};
use crate::{DAY_S, each, run, seeds, variety};
use binnacle_compass::angle::{TrueHeading, wrap_180};
use binnacle_compass::result::{Analysis, Cause};
use binnacle_compass::sample::Sample;

/// Day of the last evaluation, and days between evaluations.
const DAYS: u32 = 120;
const EVERY: u32 = 10;
/// Number of headings of 36 held by the band below which an evaluation is bad.
const HELD: usize = 33;

/// The constant error of a sound reference, standard deviation in degrees.
const SOUND_DEG: f64 = 0.2;

/// The wrong reference, its error in degrees, the first day of the error, and the factor on
/// the slow wander of the gyro.
struct Case {
    which: Which,
    off_deg: f64,
    from_day: f64,
    wander: f64,
}

#[derive(Clone, Copy, Debug, PartialEq)]
enum Which {
    Gyro,
    Satellite,
}

const fn case(which: Which, off_deg: f64, from_day: f64, wander: f64) -> Case {
    Case {
        which,
        off_deg,
        from_day,
        wander,
    }
}

const CASES: [Case; 16] = [
    case(Which::Gyro, 0.0, 0.0, 1.0),
    case(Which::Satellite, -3.0, 0.0, 1.0),
    case(Which::Satellite, -2.0, 0.0, 1.0),
    case(Which::Satellite, 2.0, 0.0, 1.0),
    case(Which::Satellite, 3.0, 0.0, 1.0),
    case(Which::Gyro, 3.0, 0.0, 1.0),
    case(Which::Satellite, -3.0, 40.0, 1.0),
    case(Which::Satellite, -2.0, 40.0, 1.0),
    case(Which::Satellite, 2.0, 40.0, 1.0),
    case(Which::Satellite, 3.0, 40.0, 1.0),
    case(Which::Gyro, 3.0, 60.0, 1.0),
    case(Which::Gyro, -2.0, 40.0, 1.0),
    case(Which::Gyro, 0.0, 0.0, 2.0),
    case(Which::Satellite, -2.0, 40.0, 2.0),
    case(Which::Satellite, 3.0, 40.0, 2.0),
    case(Which::Gyro, 3.0, 40.0, 2.0),
];

/// Knowledge of one ship on one day.
struct Look {
    day: u32,
    seed: u64,
    /// Of 36 headings, the worst error and the usual standard error, degrees; none without
    /// a model.
    band: Option<(usize, f64, f64)>,
    /// Certain changes, and of these the faults of the wrong reference.
    reported: Vec<Cause>,
    faults: Vec<String>,
}

pub(crate) fn references(ships: u64) {
    let only = std::env::var("CASE").ok().map(|n| n.parse().unwrap());
    for (number, case) in CASES.iter().enumerate() {
        if only.is_some_and(|only: usize| only != number) {
            continue;
        }
        let found = each(seeds(880_000, ships), |seed| looks(seed, case));
        let looks: Vec<Look> = found.into_iter().flatten().collect();
        let bad = |look: &&Look| look.band.is_none_or(|band| band.0 < HELD);
        let with = looks.iter().filter_map(|look| look.band);
        let held: usize = with.clone().map(|band| band.0).sum();
        let worst = with.clone().map(|band| band.1).fold(0.0, f64::max);
        let se = with.clone().map(|band| band.2).sum::<f64>() / with.clone().count() as f64;
        let reported = |such: fn(&Cause) -> bool| {
            let last = looks.iter().filter(|look| look.day == DAYS);
            last.flat_map(|look| &look.reported)
                .filter(|c| such(c))
                .count()
        };
        println!(
            "{number:2} {:?} off by {:+.0} from day {:.0}, gyro's wander x {:.0}: {} of {} looks below \
             90 %, headings held {:.1} %, worst error {worst:.1}, se {se:.2}; reported at last: {} \
             reference faults, {} of the ship",
            case.which,
            case.off_deg,
            case.from_day,
            case.wander,
            looks.iter().filter(bad).count(),
            looks.len(),
            100.0 * held as f64 / (36 * with.count()) as f64,
            reported(|c| *c == Cause::ReferenceFault),
            reported(|c| c.changes_deviation()),
        );
        if std::env::var("WORDS").is_ok() {
            for look in &looks {
                println!(
                    "   {} day {:3}: {:.2?} {:?} {:?}",
                    look.seed, look.day, look.band, look.reported, look.faults
                );
            }
        }
    }
}

fn looks(seed: u64, case: &Case) -> Vec<Look> {
    let days = (1..).map(|n| n * EVERY).take_while(|day| *day <= DAYS);
    let days = days.filter(|day| f64::from(*day) > case.from_day);
    days.map(|day| look(seed, case, day)).collect()
}

/// Returns the voyage up to a day.
fn look(seed: u64, case: &Case, day: u32) -> Look {
    let mut plan = Plan::new(Event::Nothing, variety(seed));
    (plan.days, plan.gyro_faults) = (f64::from(day), 0.0);
    plan.faults.slow_gyro_deg *= case.wander;
    // The references' own constants are another question, of many ships.
    plan.faults.gyro_constant_deg = SOUND_DEG;
    let mut log = sail_log(seed, &plan);
    let fails = log.start.plus_seconds(case.from_day * DAY_S);
    for sample in log.samples.iter_mut().filter(|s| s.time >= fails) {
        turn(sample, case);
    }
    let analysis = run(&log.samples);
    let certain = || analysis.changes.iter().filter(|c| c.confirmed);
    let faults = certain().filter(|c| c.cause == Cause::ReferenceFault);
    Look {
        day,
        seed,
        band: band(&analysis, &log.truth),
        reported: certain().map(|c| c.cause).collect(),
        faults: faults
            .map(|c| {
                let at = |t: binnacle_compass::time::Timestamp| t.seconds_since(log.start) / DAY_S;
                format!(
                    "{:.1}..{:.1?} {:?}",
                    at(c.from),
                    c.ended.map(at),
                    c.evidence
                )
            })
            .collect(),
    }
}

fn turn(sample: &mut Sample, case: &Case) {
    let turned = |heading: Option<TrueHeading>| {
        heading.and_then(|heading| TrueHeading::new(heading.degrees() + case.off_deg))
    };
    match case.which {
        Which::Gyro => sample.gyro = turned(sample.gyro),
        Which::Satellite => sample.satellite = turned(sample.satellite),
    }
}

/// Returns the number of headings of 36 that the band holds, the worst error, and the usual
/// standard error.
fn band(analysis: &Analysis, truth: &Truth) -> Option<(usize, f64, f64)> {
    let place = analysis.last_place?;
    let model = analysis.current_epoch()?.model.as_ref()?;
    let (mut held, mut worst, mut sum) = (0, 0.0_f64, 0.0);
    for k in 0..36 {
        let compass_deg = 10.0 * f64::from(k);
        let true_deg = true_deviation(truth, compass_deg, place.h_nt, place.z_nt);
        let (predicted_deg, se_deg) = predicted(model, compass_deg, place.h_nt, place.z_nt);
        let off_deg = wrap_180(true_deg - predicted_deg).abs();
        held += usize::from(off_deg < 1.96 * se_deg);
        worst = worst.max(off_deg);
        sum += se_deg / 36.0;
    }
    Some((held, worst, sum))
}
