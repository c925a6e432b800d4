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
        if std::env::var("SHOW").is_ok() {
            println!("{seed} {} {:?}", voyage.observations.len(), fitted.noise);
        }
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
