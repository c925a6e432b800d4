//! The tables of `docs/science.md` and BENCHMARKS.md: how near the error comes to
//! the best that any estimator could do, how often the band holds the truth, and
//! what becomes of both when ships or instruments are not as usual.
//!
//! Takes minutes: `make study`, or
//! `cargo run --release -p binnacle-analysis --example study [SHIPS]`, with the
//! number of ships of each kind.

#![allow(clippy::unwrap_used)] // a study, run by hand

#[allow(dead_code)]
#[path = "../tests/voyages/mod.rs"]
mod voyages;

use binnacle_analysis::fit::fit_robust;
use binnacle_compass::angle::{Deviation, wrap_180};
use binnacle_compass::model::Model;
use voyages::bound::{HEADINGS, bound, fair};
use voyages::tally::{Held, Tally, options};
use voyages::{Faults, Truth, Variety, predicted, sail, true_deviation};

const VARIETIES: [Variety; 3] = [Variety::Rich, Variety::Medium, Variety::Poor];

fn main() {
    let ships = std::env::args().nth(1);
    let ships: u64 = ships.map_or(70, |n| n.parse().expect("the number of ships"));
    table_of_efficiency(ships);
    table_of_coverage(ships);
    table_of_the_unusual(ships);
    table_of_what_is_wrong(ships);
}

/// Runs a piece of work for every seed, on all cores, with the results in order.
fn each<T: Send>(seeds: std::ops::Range<u64>, work: impl Fn(u64) -> T + Sync) -> Vec<T> {
    let threads = std::thread::available_parallelism().map_or(1, usize::from);
    let seeds: Vec<u64> = seeds.collect();
    let mut results: Vec<(u64, T)> = std::thread::scope(|scope| {
        let work = &work;
        let started: Vec<_> = (0..threads)
            .map(|t| {
                let own: Vec<u64> = seeds.iter().copied().skip(t).step_by(threads).collect();
                scope.spawn(move || own.into_iter().map(|s| (s, work(s))).collect::<Vec<_>>())
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

/// The error over the bound.
fn table_of_efficiency(ships: u64) {
    println!("error over the Cramer-Rao bound, 14 days, own place, reference's constant aside:");
    for variety in VARIETIES {
        let squares = each(7000..7000 + ships, |seed| error_and_bound(seed, variety));
        let found: Vec<(f64, f64)> = squares.into_iter().flatten().collect();
        let ratio_of = |ships: &mut dyn Iterator<Item = &(f64, f64)>| {
            let (error, bound) = ships.fold((0.0, 0.0), |sum, s| (sum.0 + s.0, sum.1 + s.1));
            (error / bound).sqrt()
        };
        let ratio = ratio_of(&mut found.iter());
        // Jackknife over the ships: each left out in turn.
        let n = found.len() as f64;
        let spread: f64 = (0..found.len())
            .map(|left_out| {
                let others = found.iter().enumerate().filter(|(i, _)| *i != left_out);
                (ratio_of(&mut others.map(|(_, s)| s)) - ratio).powi(2)
            })
            .sum();
        let error = (found.iter().map(|s| s.0).sum::<f64>() / n).sqrt();
        println!(
            "{:8} ships {} error {error:.3} times the bound {ratio:.3} +- {:.3}",
            format!("{variety:?}"),
            found.len(),
            (spread * (n - 1.0) / n).sqrt(),
        );
    }
}

/// Mean square error of the fitted curve, the gyro's constant counted to the
/// truth, and its bound; none when the fit is refused.
fn error_and_bound(seed: u64, variety: Variety) -> Option<(f64, f64)> {
    let voyage = fair(seed, variety, 14.0, &Faults::USUAL);
    let fitted = fit_robust(&voyage.observations, &options(&voyage.sizes)).ok()?;
    let Truth { h_nt, z_nt, .. } = voyage.truth;
    let squares: f64 = (0..HEADINGS)
        .map(|k| {
            let compass = k as f64 * 10.0;
            let truth = true_deviation(&voyage.truth, compass, h_nt, z_nt);
            let predicted = predicted(&fitted.model, compass, h_nt, z_nt).0;
            wrap_180(predicted - truth - voyage.reference_constant_deg()).powi(2)
        })
        .sum();
    Some((squares / HEADINGS as f64, bound(&voyage, h_nt, z_nt)))
}

fn tally(seeds: std::ops::Range<u64>, sail: impl Fn(u64) -> Tally + Sync) -> Tally {
    let mut sum = Tally::default();
    for one in each(seeds, sail) {
        sum.merge(&one);
    }
    sum
}

/// Prints how often the band holds the truth.
fn table_of_coverage(ships: u64) {
    for satellite in [false, true] {
        println!("\ncoverage, satellite compass beside the gyro: {satellite}");
        let faults = Faults {
            satellite,
            ..Faults::USUAL
        };
        for days in [14.0, 60.0] {
            for variety in VARIETIES {
                let tally = tally(0..ships, |seed| {
                    Tally::from_voyage(seed, variety, days, &faults)
                });
                print(&format!("{variety:?} {days} days"), &tally);
            }
        }
    }
}

fn print(name: &str, tally: &Tally) {
    let held = |held: &Held| {
        format!(
            "{:4.1} % rms {:.3} se {:.3}",
            100.0 * held.share(),
            held.rms(),
            held.se()
        )
    };
    println!(
        "{name:24} ships {} refused {} passed {:5.1} % | own {} | away {} | shape own {} | away {}",
        tally.ships,
        tally.refused,
        100.0 * f64::from(tally.passed) / f64::from(tally.ships),
        held(&tally.own),
        held(&tally.away),
        held(&tally.own_shape),
        held(&tally.away_shape),
    );
}

/// Prints the results for unusual ships or instruments.
fn table_of_the_unusual(ships: u64) {
    println!("\nunusual ships and instruments:");
    let usual = Faults::USUAL;
    let quiet = Faults {
        slow_gyro_deg: 0.05,
        schuler_deg: 0.1,
        variation_deg: 0.05,
        swing_deg: 0.05,
        ..usual
    };
    let of = |change: fn(&mut Faults)| {
        let mut faults = usual;
        change(&mut faults);
        faults
    };
    let cases = [
        ("ship twice as magnetic", 60.0, of(|f| f.ship = 2.0)),
        ("gyro swings 0.8", 60.0, of(|f| f.schuler_deg = 0.8)),
        ("gyro wanders 0.8", 60.0, of(|f| f.slow_gyro_deg = 0.8)),
        ("speed error left 0.3", 60.0, of(|f| f.speed_error = 0.3)),
        ("quiet instruments", 60.0, quiet),
        ("outliers 3 %", 60.0, of(|f| f.outliers = 0.03)),
        ("six storms a month", 60.0, of(|f| f.storms_per_month = 6.0)),
        ("no drift, 200 days", 200.0, of(|f| f.drift_nt = 0.0)),
        ("drift 150 nT, 200 days", 200.0, of(|f| f.drift_nt = 150.0)),
        ("drift 300 nT, 200 days", 200.0, of(|f| f.drift_nt = 300.0)),
    ];
    for (name, days, faults) in cases {
        let tally = tally(5000..5000 + ships, |seed| {
            let variety = VARIETIES[(seed % 3) as usize];
            Tally::from_voyage(seed, variety, days, &faults)
        });
        print(name, &tally);
    }
}

/// Prints the effects of wild readings and a gyro's constant error on the fit of a voyage
/// of 30 days.
fn table_of_what_is_wrong(ships: u64) {
    println!("\nthe same voyages with something wrong, 30 days:");
    for variety in VARIETIES {
        let moved = each(8000..8000 + ships, |seed| moved(seed, variety));
        let found: Vec<(f64, f64)> = moved.into_iter().flatten().collect();
        let most = |of: fn(&(f64, f64)) -> f64| found.iter().map(of).fold(0.0, f64::max);
        println!(
            "{:8} ships {} of {ships}; 10 % wild by 20 degrees move the curve by {:.3} degrees at \
             most, by over 0.3 in {}; gyro off by 1.5 degrees moves bx, by, chi by {:.3} standard errors at most",
            format!("{variety:?}"),
            found.len(),
            most(|m| m.0),
            found.iter().filter(|m| m.0 >= 0.3).count(),
            most(|m| m.1),
        );
    }
}

/// Returns the largest move of the curve, degrees, when every tenth reading is 20° off; and
/// that of a parameter, in standard errors, when the gyro is 1.5° off.
fn moved(seed: u64, variety: Variety) -> Option<(f64, f64)> {
    let voyage = sail(seed, variety, 30.0, &Faults::USUAL);
    let options = options(&voyage.sizes);
    let fitted = |wrong: &dyn Fn(usize) -> f64| {
        let mut observations = voyage.observations.clone();
        for (row, observation) in observations.iter_mut().enumerate() {
            let deviation = observation.deviation.degrees_east() + wrong(row);
            observation.deviation = Deviation::new(deviation).unwrap();
        }
        fit_robust(&observations, &options)
            .ok()
            .map(|fit| fit.model)
    };
    let right = fitted(&|_| 0.0)?;
    let wild = fitted(&|row| if row.is_multiple_of(10) { 20.0 } else { 0.0 })?;
    let off = fitted(&|_| 1.5)?;
    let Truth { h_nt, z_nt, .. } = voyage.truth;
    let curve = |model: &Model, k: usize| predicted(model, k as f64 * 10.0, h_nt, z_nt).0;
    let by_wild = (0..HEADINGS).map(|k| (curve(&wild, k) - curve(&right, k)).abs());
    let (a, b) = (
        right.parameters_over_lambda.to_array(),
        off.parameters_over_lambda.to_array(),
    );
    let covariance = right.covariance?;
    let by_constant = (0..7).map(|j| (a[j] - b[j]).abs() / covariance[j][j].sqrt());
    Some((by_wild.fold(0.0, f64::max), by_constant.fold(0.0, f64::max)))
}
