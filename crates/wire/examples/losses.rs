//! Precision that the estimator loses to a frame's rounding and to thinned
//! samples: the tables of BENCHMARKS.md.
//!
//! `cargo run --release -p binnacle-wire --example losses [SHIPS]`, with the number of
//! ships of each kind. Ships and their errors are those of the estimator's own studies,
//! which share no code with it.

#![allow(clippy::unwrap_used)] // a study, run by hand

#[allow(dead_code)]
#[path = "../../analysis/tests/voyages/mod.rs"]
mod voyages;

use binnacle_analysis::fleet_prior::ShipPrior;
use binnacle_compass::angle::{CompassHeading, TrueHeading, wrap_180};
use binnacle_compass::position::Position;
use binnacle_compass::sample::Sample;
use binnacle_compass::settings::{AnalysisSettings, REFERENCE_CONSTANT_SD_DEG};
use binnacle_wire::batch::{Batch, StreamId};
use binnacle_wire::{decode, encode};
use std::collections::BTreeMap;
use uuid::Uuid;
use voyages::fleet::{Event, Log, Plan, sail_log};
use voyages::{Faults, Variety, predicted, true_deviation};

const HEADINGS: usize = 36;
const DAYS: f64 = 30.0;
/// A curve that moves by this fraction of its standard error has tipped to
/// another fit.
const TIPPED: f64 = 0.25;
const VARIETIES: [Variety; 3] = [Variety::Rich, Variety::Medium, Variety::Poor];

/// The analysed deviation of a ship at its last position, by heading.
#[derive(Clone, Copy)]
struct Curve {
    deviations_deg: [f64; HEADINGS],
    /// Mean variance, without the part inseparable from the reference's
    /// constant.
    variance: f64,
}

/// Chooses the rows of a voyage to analyse.
type Rows = dyn Fn(&Log) -> Vec<Sample> + Sync;

/// A named choice of rows.
struct Variant {
    name: String,
    rows: Box<Rows>,
}

fn variant(
    name: impl Into<String>,
    rows: impl Fn(&Log) -> Vec<Sample> + Sync + 'static,
) -> Variant {
    Variant {
        name: name.into(),
        rows: Box::new(rows),
    }
}

fn main() {
    let ships = std::env::args().nth(1);
    let ships: u64 = ships.map_or(24, |n| n.parse().expect("the number of ships"));
    compare(
        "every minute's reading",
        ships,
        |log| log.minutes.clone(),
        &thinned(),
    );
    compare(
        "every sample as it was",
        ships,
        |log| log.samples.clone(),
        &rounded(),
    );
}

/// Samples as each profile sends them, in batches of other sizes, and the
/// remainder after thinning when the link does not keep up.
fn thinned() -> Vec<Variant> {
    let mut variants = vec![variant("ten minutes' means, unrounded", |log| {
        log.samples.clone()
    })];
    for (profile, seal_h) in [("vsat", 1), ("standard", 6), ("metered", 24)] {
        variants.push(variant(profile, move |log| framed(&log.samples, seal_h)));
    }
    for (name, seconds, most) in [
        ("thinned to two an hour", 3_600, 2),
        ("to one an hour", 3_600, 1),
        ("to one in six hours", 6 * 3_600, 1),
        ("to one a day", 24 * 3_600, 1),
    ] {
        variants.push(variant(name, move |log| {
            framed(&thin(&log.samples, seconds, most), 24)
        }));
    }
    variants
}

/// Keeps the first `most` samples per 10° of heading and time window, as the
/// agent thins samples with equal numbers of windows.
fn thin(samples: &[Sample], seconds: i64, most: usize) -> Vec<Sample> {
    let mut kept: BTreeMap<(i64, i64), usize> = BTreeMap::new();
    let samples = samples.iter().filter(|s| {
        let time = s.time.micros().div_euclid(seconds * 1_000_000);
        let bin = (s.gyro.unwrap().degrees() / 10.0) as i64;
        let count = kept.entry((time, bin)).or_default();
        *count += 1;
        *count <= most
    });
    samples.copied().collect()
}

/// Each column rounded alone, in the frame's step and in coarser ones; then all
/// columns, through frames.
fn rounded() -> Vec<Variant> {
    let mut variants = Vec::new();
    for step in [0.02, 0.05, 0.1, 0.2, 0.5] {
        variants.push(variant(
            format!("compass less reference {step}°"),
            for_each_sample(move |s| {
                s.compass = with_difference(s, |difference| round(difference, step));
            }),
        ));
    }
    for step in [0.05, 0.2, 0.5, 1.0] {
        variants.push(variant(
            format!("gyro {step}°"),
            for_each_sample(move |s| {
                let difference = with_difference(s, |difference| difference);
                let gyro = s.gyro.unwrap().degrees();
                s.gyro = TrueHeading::new(round(gyro, step));
                let shift = s.gyro.unwrap().degrees() - gyro;
                s.compass = CompassHeading::new(difference.degrees() + shift).unwrap();
            }),
        ));
    }
    for step in [0.001, 0.01, 0.1] {
        variants.push(variant(
            format!("latitude, longitude {step}°"),
            for_each_sample(move |s| {
                let (lat, lon) = (s.position.lat_deg(), s.position.lon_deg());
                s.position = Position::new(round(lat, step), wrap_180(round(lon, step))).unwrap();
            }),
        ));
    }
    for step in [0.2, 1.0] {
        variants.push(variant(
            format!("speed {step} kn"),
            for_each_sample(move |s| s.sog_kn = s.sog_kn.map(|sog| round(sog, step))),
        ));
    }
    variants.push(variant("all, as frames do", |log| framed(&log.samples, 24)));
    variants
}

fn for_each_sample(change: impl Fn(&mut Sample) + Sync) -> impl Fn(&Log) -> Vec<Sample> + Sync {
    move |log| {
        let mut samples = log.samples.clone();
        samples.iter_mut().for_each(&change);
        samples
    }
}

fn round(value: f64, step: f64) -> f64 {
    (value / step).round() * step
}

/// The compass heading after `change` of its difference from the gyro.
fn with_difference(s: &Sample, change: impl Fn(f64) -> f64) -> CompassHeading {
    let gyro = s.gyro.unwrap().degrees();
    CompassHeading::new(gyro + change(wrap_180(s.compass.degrees() - gyro))).unwrap()
}

/// Samples after encoding and decoding in frames of `hours` hours each.
fn framed(samples: &[Sample], hours: i64) -> Vec<Sample> {
    let batches = samples.chunk_by(|a, b| {
        let batch = |s: &Sample| s.time.micros().div_euclid(hours * 3_600_000_000);
        batch(a) == batch(b)
    });
    let through = |samples: &[Sample]| {
        let batch = Batch {
            stream: StreamId(Uuid::from_u128(7)),
            seq: 1,
            samples: samples.to_vec(),
            tally: BTreeMap::new(),
            alerts: Vec::new(),
            thinned: None,
        };
        decode(&encode(&batch).unwrap()).unwrap().samples
    };
    batches.flat_map(through).collect()
}

/// One voyage, analysed with the usual rows and with others.
struct Pair {
    /// Mean squares over headings: both against the truth, and one against the
    /// other.
    usual_error: f64,
    error: f64,
    change: f64,
    /// Mean variances stated by the analysis.
    usual_variance: f64,
    variance: f64,
}

/// Analyses each ship with the `usual` rows and with each variant, and prints
/// the differences.
fn compare(usual_name: &str, ships: u64, usual: fn(&Log) -> Vec<Sample>, variants: &[Variant]) {
    let found = each_ship(ships, |seed| {
        let log = sail(seed);
        let usual = curve(&log, &usual(&log));
        let truth = truth(&log);
        let pair = |other: Curve| {
            usual.map(|usual| Pair {
                usual_error: mean_square_difference(&usual.deviations_deg, &truth),
                error: mean_square_difference(&other.deviations_deg, &truth),
                change: mean_square_difference(&other.deviations_deg, &usual.deviations_deg),
                usual_variance: usual.variance,
                variance: other.variance,
            })
        };
        let curves = variants
            .iter()
            .map(|variant| curve(&log, &(variant.rows)(&log)));
        curves.map(|curve| curve.and_then(pair)).collect::<Vec<_>>()
    });
    println!("\nagainst {usual_name}, {DAYS} days:");
    for (number, variant) in variants.iter().enumerate() {
        let pairs: Vec<&Pair> = found
            .iter()
            .filter_map(|voyage| voyage[number].as_ref())
            .collect();
        print(&variant.name, &pairs);
    }
}

fn print(name: &str, pairs: &[&Pair]) {
    let ratio = |pairs: &[&Pair]| {
        let sum = |of: fn(&Pair) -> f64| pairs.iter().map(|p| of(p)).sum::<f64>();
        (sum(|p| p.error) / sum(|p| p.usual_error)).sqrt()
    };
    // Jackknife over the ships: the ratio's dependence on the ships drawn.
    let n = pairs.len() as f64;
    let all = ratio(pairs);
    let spread: f64 = (0..pairs.len())
        .map(|left_out| {
            let mut others = pairs.to_vec();
            others.remove(left_out);
            (ratio(&others) - all).powi(2)
        })
        .sum();
    let error = pairs.iter().map(|p| p.error).sum::<f64>() / n;
    // A search for noise levels or changes may be a close decision: a tiny
    // difference then tips it to another fit.
    let (kept, tipped): (Vec<&Pair>, Vec<&Pair>) = pairs
        .iter()
        .partition(|p| p.change < TIPPED.powi(2) * p.usual_variance);
    let mean =
        |of: fn(&Pair) -> f64| 100.0 * kept.iter().map(|p| of(p)).sum::<f64>() / kept.len() as f64;
    println!(
        "{name:30} voyages {} error {:.4} over the usual's {all:.4} +- {:.4} | tipped {} | others: \
         change^2 over the variance {:.3} % | variance over the usual's {:.2} % | change rms {:.4}",
        pairs.len(),
        error.sqrt(),
        (spread * (n - 1.0) / n).sqrt(),
        tipped.len(),
        mean(|p| p.change / p.usual_variance),
        mean(|p| p.variance / p.usual_variance),
        (mean(|p| p.change) / 100.0).sqrt(),
    );
}

/// Mean square difference.
fn mean_square_difference(a: &[f64; HEADINGS], b: &[f64; HEADINGS]) -> f64 {
    a.iter()
        .zip(b)
        .map(|(a, b)| wrap_180(a - b).powi(2))
        .sum::<f64>()
        / HEADINGS as f64
}

fn sail(seed: u64) -> Log {
    let plan = Plan {
        days: DAYS,
        anomalies: 0.0,
        gyro_faults: 0.0,
        faults: Faults {
            storms_per_month: 0.0,
            ..Faults::USUAL
        },
        ..Plan::new(Event::Nothing, VARIETIES[(seed % 3) as usize])
    };
    sail_log(9_000 + seed, &plan)
}

/// The true deviation plus the gyro's constant: no heading can separate them.
fn truth(log: &Log) -> [f64; HEADINGS] {
    std::array::from_fn(|k| {
        let compass = 10.0 * k as f64;
        true_deviation(&log.truth, compass, log.truth.h_nt, log.truth.z_nt)
            + log.truth.gyro_constant_deg
    })
}

/// `None` where the analysis gives no model or several epochs.
fn curve(log: &Log, samples: &[Sample]) -> Option<Curve> {
    let analysis = binnacle_tracking::analyse(&binnacle_tracking::Input {
        samples,
        logbook: &[],
        azimuths: &[],
        prior: &ShipPrior::population(),
        settings: AnalysisSettings::default(),
    });
    let [epoch] = &analysis.epochs[..] else {
        return None;
    };
    let mut model = epoch.model.clone()?;
    model.covariance.as_mut()?[7][7] -= REFERENCE_CONSTANT_SD_DEG.powi(2);
    let (h, z) = (log.truth.h_nt, log.truth.z_nt);
    let at: [(f64, f64); HEADINGS] =
        std::array::from_fn(|k| predicted(&model, 10.0 * k as f64, h, z));
    Some(Curve {
        deviations_deg: at.map(|(deviation, _)| deviation),
        variance: at.iter().map(|(_, se)| se * se).sum::<f64>() / HEADINGS as f64,
    })
}

/// Runs `work` for ships of each kind on all cores; results in order.
fn each_ship<T: Send>(ships: u64, work: impl Fn(u64) -> T + Sync) -> Vec<T> {
    let threads = std::thread::available_parallelism().map_or(1, usize::from) as u64;
    let seeds = 3 * ships;
    let mut results: Vec<(u64, T)> = std::thread::scope(|scope| {
        let work = &work;
        let started: Vec<_> = (0..threads)
            .map(|first| {
                let own = (first..seeds).step_by(threads as usize);
                scope.spawn(move || own.map(|seed| (seed, work(seed))).collect::<Vec<_>>())
            })
            .collect();
        started
            .into_iter()
            .flat_map(|thread| thread.join().unwrap())
            .collect()
    });
    results.sort_by_key(|(seed, _)| *seed);
    results.into_iter().map(|(_, result)| result).collect()
}
