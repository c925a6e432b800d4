//! Band in the first hours after a step, on one course or two: none of them shows the step
//! along the needle.

use crate::voyages::fleet::{Event, Log, Name, Plan, START, sail_log};
use crate::voyages::{deviation_by_compass, predicted, true_deviation};
use crate::{DAY_S, HOUR_S, each, planned, quantile, run, seeds, share, variety};
use binnacle_compass::angle::wrap_180;
use binnacle_compass::sample::Sample;
use binnacle_compass::time::Timestamp;

/// Sizes, nT.
const SIZES: [f64; 4] = [2000.0, 4000.0, 8000.0, 12_000.0];
/// Hours after the first sample since the step at which the band is looked at.
const LOOKS_H: [f64; 4] = [1.0, 6.0, 12.0, 24.0];
/// Width of a band that, with an error above [`LARGE_ERROR_DEG`], runs a ship aground.
const NARROW_DEG: f64 = 5.0;
const LARGE_ERROR_DEG: f64 = 10.0;
/// Samples, and their change in degrees, from which a step has shown.
const SHOWN_SAMPLES: usize = 6;
const SHOWN_DEG: f64 = 2.5;

/// Knowledge of one ship at one time.
#[derive(Clone, Default)]
struct Look {
    reported: bool,
    /// True if the courses since have shown the step.
    shown: bool,
    /// Error of the deviation and its standard error, on every tenth degree of the
    /// compass that she can show; none where there is no model.
    off_deg: Vec<(f64, f64)>,
}

impl Look {
    fn held(&self) -> usize {
        let held = |(off, se): &&(f64, f64)| off.abs() <= 1.96 * se;
        self.off_deg.iter().filter(held).count()
    }

    fn se_deg(&self) -> f64 {
        self.off_deg.iter().map(|off| off.1).sum::<f64>() / self.off_deg.len() as f64
    }

    fn is_wrong(&self) -> bool {
        let wrong = |(off, se): &(f64, f64)| off.abs() > LARGE_ERROR_DEG && 1.96 * se < NARROW_DEG;
        self.off_deg.iter().any(wrong)
    }
}

/// With gyro and satellite compass: steps along the needle, across it and in any direction.
pub(crate) fn bands(ships: u64) {
    let only: Option<f64> = std::env::var("NT").ok().map(|nt| nt.parse().unwrap());
    let way: Option<String> = std::env::var("WAY").ok();
    for nt in SIZES
        .into_iter()
        .filter(|nt| only.is_none_or(|only| (only - nt).abs() < 1.0))
    {
        for name in ["along", "across", "random"] {
            if way.as_ref().is_none_or(|way| way == name) {
                steps(name, nt, ships);
            }
        }
    }
}

/// Prints width and coverage of the band on ships without events but storms and anomalies:
/// every so many hours of ten days.
pub(crate) fn undisturbed(ships: u64) {
    const EVERY_H: f64 = 7.0;
    let found = each(seeds(860_000, ships), |seed| {
        let mut plan = Plan::new(Event::Nothing, variety(seed));
        plan.days = 34.0;
        let log = sail_log(seed, &plan);
        let begun = Timestamp::parse(START).unwrap();
        let settled = |s: &Sample| s.time.seconds_since(begun) < 24.0 * DAY_S;
        let first = log.samples.partition_point(settled);
        let mut looks = Vec::new();
        let mut last = first;
        for until in first..log.samples.len() {
            let since_s = log.samples[until]
                .time
                .seconds_since(log.samples[last].time);
            if since_s > EVERY_H * HOUR_S {
                looks.push(look(seed, &plan, &log, begun, until));
                last = until;
            }
        }
        looks
    });
    let looks: Vec<Look> = found.into_iter().flatten().collect();
    let with: Vec<&Look> = looks.iter().filter(|l| !l.off_deg.is_empty()).collect();
    let mean = with.iter().map(|l| l.se_deg()).sum::<f64>() / with.len() as f64;
    println!(
        "nothing happened: {}; mean se {mean:.2}; reported {:.2} %; se over 2 degrees {:.2} %",
        summary(&looks),
        share(&with, |l| l.reported),
        share(&with, |l| l.se_deg() > 2.0)
    );
}

fn steps(name: &str, nt: f64, ships: u64) {
    let found = each(seeds(850_000, ships), |seed| {
        // Either side of it in turns.
        let side = if seed % 2 == 0 { 0.0 } else { 180.0 };
        let event = match name {
            "along" => Event::StepBy(nt, side),
            "across" => Event::StepBy(nt, side + 90.0),
            _ => Event::Step(nt),
        };
        let mut plan = Plan::new(event, variety(seed));
        (plan.days, plan.event_day) = (34.0, 24.0);
        plan.gyro_faults = 0.0;
        looks(seed, &plan)
    });
    let found: Vec<Vec<Look>> = found.into_iter().flatten().collect();
    for (n, hours) in LOOKS_H.into_iter().enumerate() {
        let looks: Vec<Look> = found.iter().map(|looks| looks[n].clone()).collect();
        let (reported, unreported): (Vec<Look>, Vec<Look>) =
            looks.into_iter().partition(|l| l.reported);
        let (shown, hidden): (Vec<Look>, Vec<Look>) = unreported.into_iter().partition(|l| l.shown);
        let size = nt / 1000.0;
        println!(
            "{size:3.0} uT {name:6} {hours:3.0} h, reported  {}",
            summary(&reported)
        );
        println!("                   shown     {}", summary(&shown));
        println!("                   not shown {}", summary(&hidden));
    }
}

fn summary(looks: &[Look]) -> String {
    let with: Vec<&Look> = looks.iter().filter(|l| !l.off_deg.is_empty()).collect();
    let all: usize = with.iter().map(|l| l.off_deg.len()).sum();
    let held: usize = with.iter().map(|l| l.held()).sum();
    let mut se: Vec<f64> = with.iter().map(|l| l.se_deg()).collect();
    format!(
        "{:3} ships, {:3} with a model, held {:5.1} %, se {:4.1} ({:4.1}), narrow and wrong {:.0} %",
        looks.len(),
        with.len(),
        100.0 * held as f64 / all as f64,
        quantile(&mut se, 0.5),
        quantile(&mut se, 0.9),
        share(&with, |l| l.is_wrong())
    )
}

fn looks(seed: u64, plan: &Plan) -> Option<Vec<Look>> {
    let log = sail_log(seed, plan);
    let from = planned(&log, Name::Step)?.from;
    let sailed = log.samples.iter().find(|s| s.time > from)?.time;
    let looks = LOOKS_H.map(|hours| {
        let is_until = |s: &&Sample| s.time.seconds_since(sailed) < hours * HOUR_S;
        let until = log.samples.iter().take_while(is_until).count();
        look(seed, plan, &log, from, until)
    });
    Some(looks.to_vec())
}

/// Returns the knowledge by the first samples of a log.
fn look(seed: u64, plan: &Plan, log: &Log, from: Timestamp, until: usize) -> Look {
    let analysis = run(&log.samples[..until]);
    // The state at that time: the vessel drifts.
    let last = log.samples[until - 1].time;
    let days = last.seconds_since(Timestamp::parse(START).unwrap()) / DAY_S + 0.001;
    let truth = sail_log(seed, &Plan { days, ..*plan }).truth;
    let place = analysis.last_place.unwrap();
    let epoch = analysis.current_epoch().unwrap();
    let off = |model, k: i32| {
        let compass_deg = 10.0 * f64::from(k);
        let truth_deg = true_deviation(&truth, compass_deg, place.h_nt, place.z_nt);
        let (predicted_deg, se_deg) = predicted(model, compass_deg, place.h_nt, place.z_nt);
        let off_deg = wrap_180(truth_deg - predicted_deg);
        off_deg.is_finite().then_some((off_deg, se_deg))
    };
    let model = epoch.model.as_ref();
    let off_deg: Vec<_> = model.map_or(Vec::new(), |m| (0..36).filter_map(|k| off(m, k)).collect());
    let [old, new] = log
        .changed
        .unwrap_or([truth.parameters; 2])
        .map(|p| p.to_array());
    let since = log.samples[..until].iter().filter(|s| s.time > from);
    let showing = since.filter(|s| {
        let (h, z) = (place.h_nt, place.z_nt);
        let of = |p| deviation_by_compass(p, s.compass.degrees(), h, z);
        let moved_deg = of(&new) - of(&old);
        // Not a number where she cannot show that heading any more.
        moved_deg.is_nan() || moved_deg.abs() >= SHOWN_DEG
    });
    Look {
        shown: showing.count() >= SHOWN_SAMPLES,
        reported: epoch.begun_by_change.is_some(),
        off_deg,
    }
}
