//! Is the estimator's band honest, and is it narrow? Judged on voyages it has
//! never seen, by a generator that shares nothing with it.

#![allow(clippy::unwrap_used)] // all of this is tests

mod voyages;

use binnacle_magnetics::angle::wrap_180;
use binnacle_magnetics::fit::{RobustOptions, fit_robust};
use voyages::{Faults, Truth, Variety, predicted, sail, true_deviation};

/// What a set of voyages came to.
#[derive(Default)]
struct Tally {
    ships: u32,
    refused: u32,
    /// Ships whose band holds the truth on at least nine headings in ten.
    passed: u32,
    headings: u32,
    covered: u32,
    squares: f64,
    /// The same against the truth plus the gyro's constant, with the constant's
    /// own part left out of the band.
    shape_covered: u32,
    shape_squares: f64,
    shape_band_squares: f64,
    bands: f64,
}

impl Tally {
    fn add(&mut self, seed: u64, variety: Variety, days: f64, faults: &Faults) {
        let voyage = sail(seed, variety, days, faults);
        self.ships += 1;
        let fitted = match fit_robust(&voyage.observations, &RobustOptions::default()) {
            Ok(fitted) => fitted,
            Err(error) => {
                self.refused += 1;
                println!("{seed}: {error}");
                return;
            }
        };
        let mut without = fitted.model.clone();
        without.covariance.as_mut().unwrap()[7][7] -= 0.25;
        let Truth {
            h_nt,
            z_nt,
            gyro_constant_deg,
            ..
        } = voyage.truth;
        let mut held = 0;
        for heading in 0..36 {
            let compass = f64::from(heading) * 10.0;
            let truth = true_deviation(&voyage.truth, compass, h_nt, z_nt);
            let (deviation, se) = predicted(&fitted.model, compass, h_nt, z_nt);
            let error = wrap_180(deviation - truth);
            held += u32::from(error.abs() <= 1.96 * se);
            self.squares += error * error;
            self.bands += 1.96 * se;
            let (_, se) = predicted(&without, compass, h_nt, z_nt);
            let error = error - gyro_constant_deg;
            self.shape_covered += u32::from(error.abs() <= 1.96 * se);
            self.shape_squares += error * error;
            self.shape_band_squares += se * se;
        }
        self.headings += 36;
        self.covered += held;
        self.passed += u32::from(held >= 33);
    }

    fn print(&self, name: &str) {
        let n = f64::from(self.headings.max(1));
        println!(
            "{name:28} ships {:4} refused {} passed {:6.2} % covered {:5.1} % rms {:.3} band {:.2} | \
             shape: covered {:5.1} % rms {:.3} se {:.3}",
            self.ships,
            self.refused,
            100.0 * f64::from(self.passed) / f64::from(self.ships),
            100.0 * f64::from(self.covered) / n,
            (self.squares / n).sqrt(),
            self.bands / n,
            100.0 * f64::from(self.shape_covered) / n,
            (self.shape_squares / n).sqrt(),
            (self.shape_band_squares / n).sqrt(),
        );
    }
}

/// A small fleet of each kind, sixty days at sea.
#[test]
fn the_band_holds_the_truth_on_nine_headings_in_ten() {
    for variety in [Variety::Rich, Variety::Medium, Variety::Poor] {
        let mut tally = Tally::default();
        for seed in 1000..1004 {
            tally.add(seed, variety, 60.0, &Faults::USUAL);
        }
        assert_eq!(
            (tally.refused, tally.passed),
            (0, tally.ships),
            "{variety:?}"
        );
        // Honest, and narrow beside the reference's own constant.
        let error = (tally.shape_squares / f64::from(tally.headings)).sqrt();
        assert!(error < 0.4, "{variety:?}: {error}");
    }
}

#[test]
fn one_wild_reading_in_thirty_does_no_harm() {
    let mut tally = Tally::default();
    for seed in 2000..2003 {
        tally.add(
            seed,
            Variety::Medium,
            60.0,
            &Faults {
                outliers: 0.015,
                ..Faults::USUAL
            },
        );
    }
    assert_eq!((tally.refused, tally.passed), (0, tally.ships));
}

#[test]
fn a_ship_of_one_sea_says_what_she_cannot_know() {
    for seed in 3000..3004 {
        let mut voyage = sail(seed, Variety::Poor, 60.0, &Faults::USUAL);
        let home = voyage.observations[0].z_nt / voyage.observations[0].h_nt;
        voyage
            .observations
            .retain(|o| (o.z_nt / o.h_nt / home - 1.0).abs() < 0.04);
        let model = fit_robust(&voyage.observations, &RobustOptions::default())
            .unwrap()
            .model;
        let told = model.identifiable.unwrap();
        assert!(
            !(told.bx_nt || told.chi13 || told.by_nt || told.chi23),
            "{told:?}"
        );
        assert!(told.chi11_minus_chi22, "{told:?}");

        // At home the band is narrow; off the Cape it is wide, and holds.
        let Truth { h_nt, z_nt, .. } = voyage.truth;
        let (_, at_home) = predicted(&model, 90.0, h_nt, z_nt);
        let (_, far_away) = predicted(&model, 90.0, 12_000.0, -25_000.0);
        assert!(far_away > 2.0 * at_home, "{far_away} and {at_home}");
        for compass in [0.0, 90.0, 180.0, 270.0] {
            let (deviation, se) = predicted(&model, compass, 12_000.0, -25_000.0);
            let truth = true_deviation(&voyage.truth, compass, 12_000.0, -25_000.0);
            assert!(
                wrap_180(deviation - truth).abs() < 3.5 * se,
                "{seed} {compass}"
            );
        }
    }
}

#[test]
fn both_hemispheres_tell_all_but_what_mixes_with_the_constant() {
    let voyage = sail(4000, Variety::Rich, 60.0, &Faults::USUAL);
    let model = fit_robust(&voyage.observations, &RobustOptions::default())
        .unwrap()
        .model;
    let told = model.identifiable.unwrap();
    assert!(
        told.bx_nt && told.chi13 && told.by_nt && told.chi23,
        "{told:?}"
    );
    assert!(told.chi11_minus_chi22, "{told:?}");
    // A mixes with the constant: of these two only the sum is known.
    assert!(
        !told.chi12 && !told.chi21 && !told.constant_deg,
        "{told:?}"
    );
}

#[test]
fn a_year_of_drift_is_followed() {
    let mut tally = Tally::default();
    for seed in 5000..5002 {
        tally.add(
            seed,
            Variety::Medium,
            200.0,
            &Faults {
                drift_nt: 150.0,
                ..Faults::USUAL
            },
        );
    }
    assert_eq!((tally.refused, tally.passed), (0, tally.ships));
}

/// Not for every run: prints the table in `docs/science.md`.
#[test]
#[ignore = "minutes long; run with --ignored --nocapture"]
fn table_of_coverage() {
    let ships: u64 = std::env::var("SHIPS").map_or(100, |n| n.parse().unwrap());
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

/// Not for every run: what happens when ships or instruments are not as usual.
#[test]
#[ignore = "minutes long; run with --ignored --nocapture"]
fn table_of_the_unusual() {
    let ships: u64 = std::env::var("SHIPS").map_or(30, |n| n.parse().unwrap());
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
