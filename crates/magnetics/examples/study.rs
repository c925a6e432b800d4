//! The tables of `docs/science.md`: how often the band holds the truth, and how
//! near the error comes to the best that any estimator could do, the Cramér–Rao
//! bound, from the true covariance of the noise as a dense matrix.
//!
//! Takes minutes: `cargo run --release -p binnacle-magnetics --example study [SHIPS]`.

#![allow(clippy::unwrap_used)] // a study, run by hand

#[allow(dead_code)]
#[path = "../tests/voyages/mod.rs"]
mod voyages;

use binnacle_magnetics::angle::wrap_180;
use binnacle_magnetics::fit::{Observation, RobustOptions, fit_robust};
use binnacle_magnetics::ship::EarthField;
use nalgebra::{DMatrix, DVector};
use voyages::tally::Tally;
use voyages::{Errors, Faults, Passage, Truth, Variety, Voyage, predicted, sail, true_deviation};

const HEADINGS: usize = 36;

fn main() {
    let ships = std::env::args().nth(1);
    let ships = ships.map_or(30, |n| n.parse().expect("the number of ships"));
    table_of_efficiency(ships);
    table_of_coverage(ships);
    table_of_the_unusual(ships);
}

/// Autocovariance of the Schuler swing at lags of ten minutes, from the
/// generator itself: turns kick it at random.
fn swing_covariance(faults: &Faults, variety: Variety) -> Vec<f64> {
    use rand::SeedableRng;
    let mut rng = rand_chacha::ChaCha8Rng::seed_from_u64(99);
    let mut passage = Passage::new(variety, &mut rng);
    let mut errors = Errors::new(faults, &mut rng);
    let mut series = Vec::new();
    for minute in 0..1440 * 600 {
        let turned = passage.minute(&mut rng);
        errors.minute(faults, &passage, turned, &mut rng);
        if minute % 10 == 0 {
            series.push(errors.swing);
        }
    }
    (0..100)
        .map(|lag| {
            let pairs = series.iter().zip(&series[lag..]);
            pairs.map(|(a, b)| a * b).sum::<f64>() / (series.len() - lag) as f64
        })
        .collect()
}

/// What the generator's noise has in common between two observations.
fn covariance(a: &Observation, b: &Observation, faults: &Faults, swing: &[f64]) -> f64 {
    let seconds = a.time.unwrap().seconds_since(b.time.unwrap()).abs();
    let cos_lat = |o: &Observation| o.position.unwrap().lat_deg().to_radians().cos();
    let gyro = swing
        .get((seconds / 600.0).round() as usize)
        .unwrap_or(&0.0)
        + faults.slow_gyro_deg.powi(2) * (-seconds / (3.0 * 86_400.0)).exp();
    let miles = seconds / 3600.0 * a.sog_kn.unwrap();
    let crust =
        faults.variation_deg.powi(2) * (-miles / 60.0).exp() * 24e3 * 24e3 / (a.h_nt * b.h_nt);
    let northerly = |o: &Observation| {
        let heading = o.compass.degrees() + o.deviation.degrees_east() + o.variation.degrees_east();
        let share = o.sog_kn.unwrap() / 902.5 / cos_lat(o);
        (share * heading.to_radians().cos()).to_degrees()
    };
    let white = if seconds == 0.0 {
        (0.35_f64.powi(2) + 0.15_f64.powi(2)) / 10.0
    } else {
        0.0
    };
    gyro / (cos_lat(a) * cos_lat(b))
        + faults.swing_deg.powi(2) * (-seconds / 1200.0).exp()
        + crust
        + faults.speed_error.powi(2) * northerly(a) * northerly(b)
        + white
}

/// The bound on the curve's variance at the last place, averaged over headings.
fn bound(voyage: &Voyage, faults: &Faults, swing: &[f64]) -> f64 {
    let rows = &voyage.observations;
    let n = rows.len();
    let v = DMatrix::from_fn(n, n, |i, j| covariance(&rows[i], &rows[j], faults, swing));
    let slopes = |magnetic_deg: f64, h_nt: f64, z_nt: f64| {
        let earth = EarthField { h_nt, z_nt };
        let at = voyage
            .truth
            .parameters
            .linearised_at_magnetic(magnetic_deg.to_radians(), earth);
        let mut slopes = [1.0; 8];
        for (slope, radians) in slopes.iter_mut().zip(at.gradient) {
            *slope = radians.to_degrees();
        }
        slopes
    };
    let x = DMatrix::from_fn(n, 8, |i, j| {
        let o = &rows[i];
        slopes(
            o.compass.degrees() + o.deviation.degrees_east(),
            o.h_nt,
            o.z_nt,
        )[j]
    });
    let population = [1500.0, 0.012, 1500.0, 0.006, 0.02, 0.008, 0.008, 0.6];
    let mut information = DMatrix::from_diagonal(&DVector::from_iterator(
        8,
        population.map(|sd: f64| 1.0 / (sd * sd)),
    ));
    information += x.transpose() * v.cholesky().unwrap().solve(&x);
    let left = information.cholesky().unwrap().inverse();
    let Truth { h_nt, z_nt, .. } = voyage.truth;
    let headings = (0..HEADINGS).map(|k| {
        let row = DVector::from_row_slice(&slopes(k as f64 * 10.0, h_nt, z_nt));
        row.dot(&(&left * &row))
    });
    headings.sum::<f64>() / HEADINGS as f64
}

/// Mean square error of the fitted curve, the gyro's constant aside.
fn square_error(voyage: &Voyage) -> Option<f64> {
    let model = fit_robust(&voyage.observations, &RobustOptions::default())
        .ok()?
        .model;
    let Truth {
        h_nt,
        z_nt,
        gyro_constant_deg,
        ..
    } = voyage.truth;
    let squares = (0..HEADINGS).map(|k| {
        let compass = k as f64 * 10.0;
        let truth = true_deviation(&voyage.truth, compass, h_nt, z_nt) + gyro_constant_deg;
        wrap_180(predicted(&model, compass, h_nt, z_nt).0 - truth).powi(2)
    });
    Some(squares.sum::<f64>() / HEADINGS as f64)
}

fn ratio(variety: Variety, days: f64, ships: u64, faults: &Faults) -> f64 {
    let swing = swing_covariance(faults, variety);
    let (mut errors, mut bounds) = (0.0, 0.0);
    for seed in 0..ships {
        let voyage = sail(7000 + seed, variety, days, faults);
        if let Some(error) = square_error(&voyage) {
            errors += error;
            bounds += bound(&voyage, faults, &swing);
        }
    }
    (errors / bounds).sqrt()
}

/// The error over the bound.
fn table_of_efficiency(ships: u64) {
    let faults = Faults {
        storms_per_month: 0.0,
        ..Faults::USUAL
    };
    for variety in [Variety::Rich, Variety::Medium, Variety::Poor] {
        let ratio = ratio(variety, 14.0, ships, &faults);
        println!("{variety:?}, 14 days: error {ratio:.2} times the bound");
    }
}

/// How often the band holds the truth.
fn table_of_coverage(ships: u64) {
    for days in [10.0, 60.0] {
        for variety in [Variety::Rich, Variety::Medium, Variety::Poor] {
            let mut tally = Tally::default();
            for seed in 0..ships {
                tally.add(seed, variety, days, &Faults::USUAL);
            }
            tally.print(&format!("{variety:?} {days} days"));
        }
    }
}

/// What happens when ships or instruments are not as usual.
fn table_of_the_unusual(ships: u64) {
    let usual = Faults::USUAL;
    let quiet = Faults {
        slow_gyro_deg: 0.05,
        schuler_deg: 0.1,
        variation_deg: 0.05,
        swing_deg: 0.05,
        ..usual
    };
    let cases = [
        (
            "ship twice as magnetic",
            60.0,
            Faults { ship: 2.0, ..usual },
        ),
        (
            "gyro swings 0.8",
            60.0,
            Faults {
                schuler_deg: 0.8,
                ..usual
            },
        ),
        (
            "gyro wanders 0.8",
            60.0,
            Faults {
                slow_gyro_deg: 0.8,
                ..usual
            },
        ),
        (
            "gyro constant 0.5",
            60.0,
            Faults {
                gyro_constant_deg: 0.5,
                ..usual
            },
        ),
        (
            "speed error left 0.3",
            60.0,
            Faults {
                speed_error: 0.3,
                ..usual
            },
        ),
        ("quiet instruments", 60.0, quiet),
        (
            "outliers 3 %",
            60.0,
            Faults {
                outliers: 0.03,
                ..usual
            },
        ),
        (
            "six storms a month",
            60.0,
            Faults {
                storms_per_month: 6.0,
                ..usual
            },
        ),
        ("no drift, 200 days", 200.0, usual),
        (
            "drift 150 nT, 200 days",
            200.0,
            Faults {
                drift_nt: 150.0,
                ..usual
            },
        ),
        (
            "drift 300 nT, 200 days",
            200.0,
            Faults {
                drift_nt: 300.0,
                ..usual
            },
        ),
    ];
    for (name, days, faults) in cases {
        let mut tally = Tally::default();
        for seed in 0..ships {
            let variety = [Variety::Rich, Variety::Medium, Variety::Poor][seed as usize % 3];
            tally.add(seed + 5000, variety, days, &faults);
        }
        tally.print(name);
    }
}
