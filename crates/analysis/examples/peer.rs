//! The product's side of `make bench-peer`: sails a voyage of some 52,000
//! observations, writes them as CSV for the peer to fit, and prints as JSON what
//! the product makes of them and how long it takes.
//!
//! `peer VOYAGE.csv usual|calm`, calm being without storms and wild readings; with
//! Linux's count of processor time in `/proc`.

#![allow(clippy::unwrap_used)] // a benchmark, run by hand

#[allow(dead_code)]
#[path = "../tests/voyages/mod.rs"]
mod voyages;

use binnacle_analysis::fit::{Observation, RobustFit, RobustOptions, fit_robust};
use binnacle_compass::settings::REFERENCE_CONSTANT_SD_DEG;
use serde::Serialize;
use std::fmt::Write;
use std::time::Instant;
use voyages::{Faults, Variety, sail};

/// Ten-minute samples of 423 days, 14 months, are some 52,000.
const DAYS: f64 = 423.0;
const SEED: u64 = 3;
/// Fits of which the median time counts.
const FITS: usize = 5;

/// Output of both sides of the benchmark.
#[derive(Serialize)]
struct Answer {
    observations: usize,
    /// Wall clock, and the processor's time, of a fit.
    seconds: f64,
    processor_seconds: f64,
    /// The seven ratios and the constant.
    unknowns: [f64; 8],
    covariance: [[f64; 8]; 8],
    /// White, Schuler, turn, slow gyro, compass swing, variation, drift.
    levels: [f64; 7],
    /// The field at the last place.
    h_nt: f64,
    z_nt: f64,
}

fn main() {
    let path = std::env::args().nth(1).expect("the CSV to write");
    let voyage = sail(SEED, Variety::Medium, DAYS, &faults());
    std::fs::write(&path, csv(&voyage.observations)).unwrap();
    let mut seconds = Vec::new();
    let mut processor_seconds = Vec::new();
    let mut fits = Vec::new();
    for _ in 0..FITS {
        let (clock, processor) = (Instant::now(), processor_s());
        let options = RobustOptions::for_unknown_vessel(REFERENCE_CONSTANT_SD_DEG);
        fits.push(fit_robust(&voyage.observations, &options).unwrap());
        seconds.push(clock.elapsed().as_secs_f64());
        processor_seconds.push(processor_s() - processor);
    }
    let fit = fits.remove(0);
    let answer = Answer {
        observations: voyage.observations.len(),
        seconds: median(seconds),
        processor_seconds: median(processor_seconds),
        unknowns: unknowns(&fit),
        covariance: fit.model.covariance.unwrap(),
        levels: levels(&fit),
        h_nt: voyage.truth.h_nt,
        z_nt: voyage.truth.z_nt,
    };
    println!("{}", serde_json::to_string(&answer).unwrap());
}

fn faults() -> Faults {
    match std::env::args().nth(2).as_deref() {
        Some("usual") => Faults::USUAL,
        Some("calm") => Faults {
            outliers: 0.0,
            storms_per_month: 0.0,
            ..Faults::USUAL
        },
        other => panic!("{other:?}: expected usual or calm"),
    }
}

fn csv(observations: &[Observation]) -> String {
    let mut out = String::from(
        "time_micros,lat,lon,compass_deg,deviation_deg,variation_deg,h_nt,z_nt,sog_kn,windows\n",
    );
    for o in observations {
        let position = o.position.unwrap();
        writeln!(
            out,
            "{},{},{},{},{},{},{},{},{},{}",
            o.time.unwrap().micros(),
            position.lat_deg(),
            position.lon_deg(),
            o.compass.degrees(),
            o.deviation.degrees_east(),
            o.variation.degrees_east(),
            o.h_nt,
            o.z_nt,
            o.sog_kn.unwrap(),
            o.windows,
        )
        .unwrap();
    }
    out
}

fn unknowns(fit: &RobustFit) -> [f64; 8] {
    let mut unknowns = [fit.model.constant_deg; 8];
    unknowns[..7].copy_from_slice(&fit.model.parameters_over_lambda.to_array());
    unknowns
}

fn levels(fit: &RobustFit) -> [f64; 7] {
    let noise = &fit.noise;
    [
        noise.white_deg,
        noise.schuler_deg,
        noise.turn_deg,
        noise.slow_gyro_deg,
        noise.compass_swing_deg,
        noise.variation_deg,
        noise.drift_nt,
    ]
}

/// This process's time on the processor, seconds.
fn processor_s() -> f64 {
    let scheduled = std::fs::read_to_string("/proc/self/schedstat").unwrap();
    let nanoseconds = scheduled.split(' ').next().unwrap();
    nanoseconds.parse::<f64>().unwrap() * 1e-9
}

fn median(mut sizes: Vec<f64>) -> f64 {
    sizes.sort_by(f64::total_cmp);
    sizes[sizes.len() / 2]
}
