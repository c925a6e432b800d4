//! Faults of a compass: a card that jams, an alignment change, a needle that oscillates.
//! None of them is a strike, and each is one fault.

use crate::voyages::fleet::{Event, Log, Plan, sail_log};
use crate::voyages::{Truth, gauss, predicted, true_deviation};
use crate::{DAY_S, HOUR_S, each, run, seeds, share, variety};
use binnacle_compass::angle::{CompassHeading, wrap_180};
use binnacle_compass::result::{Analysis, Cause, Change};
use binnacle_compass::time::Timestamp;
use rand::{RngExt, SeedableRng};
use rand_chacha::ChaCha8Rng;
use std::f64::consts::TAU;

/// Day of the fault, and the time sailed after it.
const FAILS_DAY: f64 = 30.0;
const DAYS: f64 = 45.0;

#[derive(Clone, Copy)]
enum Fault {
    /// The card stands still, but for a small oscillation.
    Stuck,
    /// It has a constant error in degrees.
    Zero(f64),
    /// It oscillates by so many degrees.
    Swings(f64),
}

/// Each for so many hours.
const FAULTS: [(&str, Fault, f64); 17] = [
    ("stuck", Fault::Stuck, 6.0),
    ("stuck", Fault::Stuck, 24.0),
    ("stuck", Fault::Stuck, 72.0),
    ("zero off by 5", Fault::Zero(5.0), 10.0),
    ("zero off by 12", Fault::Zero(12.0), 10.0),
    ("zero off by 8", Fault::Zero(8.0), 30.0),
    ("zero off by 20", Fault::Zero(20.0), 30.0),
    ("zero off by 5", Fault::Zero(5.0), f64::INFINITY),
    ("zero off by 8", Fault::Zero(8.0), f64::INFINITY),
    ("zero off by 12", Fault::Zero(12.0), f64::INFINITY),
    ("zero off by 20", Fault::Zero(20.0), f64::INFINITY),
    ("swings by 10", Fault::Swings(10.0), 2.0),
    ("swings by 10", Fault::Swings(10.0), 12.0),
    ("swings by 20", Fault::Swings(20.0), 2.0),
    ("swings by 20", Fault::Swings(20.0), 6.0),
    ("swings by 30", Fault::Swings(30.0), 2.0),
    ("swings by 30", Fault::Swings(30.0), 12.0),
];

/// Report to a ship at one time.
struct Report {
    /// Number of certain changes.
    times: usize,
    a_fault: bool,
    a_strike: bool,
    /// Numbers of headings on which the band holds the compass's reading, and on which it
    /// is narrow and wrong; none while it shows nothing, or without a model.
    held: Option<(usize, usize)>,
}

/// Width and error of a band that runs a ship aground.
const NARROW_DEG: f64 = 5.0;
const LARGE_ERROR_DEG: f64 = 10.0;

/// With gyro and satellite compass, nothing else happening.
pub(crate) fn jams(ships: u64) {
    let only = std::env::var("FAULT").ok();
    let wanted = |name: &str| only.as_ref().is_none_or(|only| name.starts_with(only));
    for (name, fault, hours) in FAULTS.into_iter().filter(|fault| wanted(fault.0)) {
        let found = each(seeds(870_000, ships), |seed| reported(seed, fault, hours));
        let lasts = if hours.is_finite() {
            format!("for {hours} h")
        } else {
            "for good".to_owned()
        };
        println!("{name} {lasts}, {ships} ships:");
        for (look, when) in ["3 h in", "as it ends", "a day after", "at last"]
            .iter()
            .enumerate()
        {
            let all: Vec<&Report> = found.iter().map(|looks| &looks[look]).collect();
            let times: usize = all.iter().map(|reported| reported.times).sum();
            let held: Vec<(usize, usize)> =
                all.iter().filter_map(|reported| reported.held).collect();
            let of_headings = |part: fn(&(usize, usize)) -> usize| {
                100.0 * held.iter().map(part).sum::<usize>() as f64 / (36 * held.len()) as f64
            };
            let band = if held.is_empty() {
                String::new()
            } else {
                let (held, wrong) = (of_headings(|h| h.0), of_headings(|h| h.1));
                format!("; band holds {held:.0} %, narrow and wrong {wrong:.0} %")
            };
            println!(
                "  {when:11} a fault {:3.0} %, a strike {:3.0} %, nothing {:3.0} %; reported {:.2} \
                 times a ship, {} at most{band}",
                share(&all, |reported| reported.a_fault && !reported.a_strike),
                share(&all, |reported| reported.a_strike),
                share(&all, |reported| reported.times == 0),
                times as f64 / ships as f64,
                all.iter().map(|reported| reported.times).max().unwrap_or(0),
            );
        }
    }
}

/// Returns the reports three hours after the fault, as it ends or a day after it began, a
/// day after that, and in the end.
fn reported(seed: u64, fault: Fault, hours: f64) -> [Report; 4] {
    let mut plan = Plan::new(Event::Nothing, variety(seed));
    (plan.days, plan.gyro_faults, plan.anomalies) = (DAYS, 0.0, 0.0);
    plan.faults.storms_per_month = 0.0;
    let mut log = sail_log(seed, &plan);
    let (from, side) = fail(&mut log, seed, fault, hours);
    let end = from.plus_seconds(hours.min(24.0) * HOUR_S);
    let last = log.samples.last().unwrap().time;
    let looks = [
        from.plus_seconds(3.0 * HOUR_S),
        end,
        end.plus_seconds(DAY_S),
        last,
    ];
    looks.map(|until| {
        let samples = log.samples.partition_point(|s| s.time <= until);
        let analysis = run(&log.samples[..samples]);
        let since: Vec<&Change> = analysis
            .changes
            .iter()
            .filter(|c| c.confirmed && c.detected_at >= from)
            .collect();
        if since.len() > 1 && until == last {
            let words = since.iter().map(|c| {
                let after_h = c.from.seconds_since(from) / HOUR_S;
                let ended_h = c.ended.map(|t| t.seconds_since(from) / HOUR_S);
                format!("{:?} at {after_h:.1} h until {ended_h:.1?}", c.cause)
            });
            println!("  seed {seed}: {:?}", words.collect::<Vec<_>>());
        }
        let off_deg = match fault {
            Fault::Zero(degrees) if until.seconds_since(from) <= hours * HOUR_S => side * degrees,
            _ => 0.0,
        };
        let is_zero = matches!(fault, Fault::Zero(_));
        Report {
            held: is_zero
                .then(|| held(&analysis, &log.truth, off_deg))
                .flatten(),
            times: since.len(),
            a_fault: since
                .iter()
                .any(|c| matches!(c.cause, Cause::CompassFault | Cause::Alignment)),
            a_strike: since
                .iter()
                .any(|c| c.cause.changes_deviation() && c.cause != Cause::Alignment),
        }
    })
}

/// Returns the number of headings of 36 on which the band holds a compass with this error,
/// and on which it is narrow and wrong. The drift to the end is negligible beside it.
fn held(analysis: &Analysis, truth: &Truth, off_deg: f64) -> Option<(usize, usize)> {
    let place = analysis.last_place?;
    let model = analysis.current_epoch()?.model.as_ref()?;
    let (mut held, mut wrong) = (0, 0);
    for k in 0..36 {
        let compass_deg = 10.0 * f64::from(k);
        let sound_deg = true_deviation(truth, compass_deg - off_deg, place.h_nt, place.z_nt);
        let (predicted_deg, se_deg) = predicted(model, compass_deg, place.h_nt, place.z_nt);
        let error_deg = wrap_180(sound_deg - off_deg - predicted_deg).abs();
        held += usize::from(error_deg < 1.96 * se_deg);
        wrong += usize::from(error_deg > LARGE_ERROR_DEG && 1.96 * se_deg < NARROW_DEG);
    }
    Some((held, wrong))
}

/// Makes the compass fail at sea, and returns the time and the side.
fn fail(log: &mut Log, seed: u64, fault: Fault, hours: f64) -> (Timestamp, f64) {
    let mut rng = ChaCha8Rng::seed_from_u64(seed ^ 0x1A3);
    let day = FAILS_DAY + 2.0 * rng.random::<f64>();
    let first = log
        .samples
        .partition_point(|s| s.time.seconds_since(log.start) < day * DAY_S);
    let from = log.samples[first].time;
    let side = if rng.random::<bool>() { 1.0 } else { -1.0 };
    // Two oscillations with unrelated periods: of 35 to 70 min, and of 90 to 180.
    let octave = 1.0 + rng.random::<f64>();
    let [quick, slow] = [35.0, 90.0].map(|minutes| (minutes * octave, TAU * rng.random::<f64>()));
    let jammed = log.samples[first].compass.degrees();
    for sample in &mut log.samples[first..] {
        let since_min = sample.time.seconds_since(from) / 60.0;
        if since_min >= 60.0 * hours {
            break;
        }
        let sine = |(period, phase): (f64, f64)| (TAU * since_min / period + phase).sin();
        let compass_deg = sample.compass.degrees();
        let compass_deg = match fault {
            Fault::Stuck => jammed + 0.2 * gauss(&mut rng),
            Fault::Zero(degrees) => compass_deg + side * degrees,
            Fault::Swings(degrees) => {
                compass_deg + degrees * (0.6 * sine(quick) + 0.4 * sine(slow))
            }
        };
        sample.compass = CompassHeading::new(compass_deg).unwrap();
    }
    (from, side)
}
