//! What many voyages came to: how often the band held the truth, and how far off
//! the prediction was.

use super::{Faults, Truth, Variety, predicted, sail, true_deviation};
use binnacle_magnetics::angle::wrap_180;
use binnacle_magnetics::fit::{RobustOptions, fit_robust};

/// What a set of voyages came to.
#[derive(Default)]
pub(crate) struct Tally {
    pub(crate) ships: u32,
    pub(crate) refused: u32,
    /// Ships whose band holds the truth on at least nine headings in ten.
    pub(crate) passed: u32,
    pub(crate) headings: u32,
    pub(crate) covered: u32,
    pub(crate) squares: f64,
    /// The same against the truth plus the gyro's constant, with the constant's
    /// own part left out of the band.
    pub(crate) shape_covered: u32,
    pub(crate) shape_squares: f64,
    pub(crate) shape_band_squares: f64,
    pub(crate) bands: f64,
}

impl Tally {
    pub(crate) fn add(&mut self, seed: u64, variety: Variety, days: f64, faults: &Faults) {
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

    #[allow(dead_code, reason = "only the study prints")]
    pub(crate) fn print(&self, name: &str) {
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
