//! Tally of many voyages: how often the band held the truth, and the error of the
//! prediction.

use super::{Faults, Truth, Variety, Voyage, dipole, predicted, sail, true_deviation};
use binnacle_analysis::fit::{RobustOptions, fit_robust};
use binnacle_compass::angle::wrap_180;
use binnacle_compass::model::Model;
use binnacle_compass::settings::REFERENCE_CONSTANT_SD_DEG;

/// Other places at which the band is tested: latitude and longitude.
const ELSEWHERE: [(f64, f64); 5] = [
    (60.0, 0.0),
    (30.0, -40.0),
    (0.0, -30.0),
    (-35.0, 20.0),
    (-20.0, 100.0),
];

/// Predictions compared with the truth.
#[derive(Clone, Copy, Debug, Default)]
pub(crate) struct Held {
    pub(crate) headings: u32,
    pub(crate) covered: u32,
    pub(crate) squares: f64,
    pub(crate) variances: f64,
}

impl Held {
    fn add(&mut self, error: f64, se: f64) {
        self.headings += 1;
        self.covered += u32::from(error.abs() <= 1.96 * se);
        self.squares += error * error;
        self.variances += se * se;
    }

    fn merge(&mut self, other: Held) {
        self.headings += other.headings;
        self.covered += other.covered;
        self.squares += other.squares;
        self.variances += other.variances;
    }

    /// Part of the headings whose band held the truth.
    pub(crate) fn share(&self) -> f64 {
        f64::from(self.covered) / f64::from(self.headings.max(1))
    }

    /// Root mean square error, degrees.
    pub(crate) fn rms(&self) -> f64 {
        (self.squares / f64::from(self.headings.max(1))).sqrt()
    }

    /// Root mean square standard error, degrees.
    #[allow(dead_code, reason = "only the study prints")]
    pub(crate) fn se(&self) -> f64 {
        (self.variances / f64::from(self.headings.max(1))).sqrt()
    }
}

/// Tally of a set of voyages.
#[derive(Clone, Copy, Debug, Default)]
pub(crate) struct Tally {
    pub(crate) ships: u32,
    pub(crate) refused: u32,
    /// Ships whose band holds the truth on at least nine headings in ten.
    pub(crate) passed: u32,
    /// At the ship's own place, and at other magnetic latitudes.
    pub(crate) own: Held,
    pub(crate) away: Held,
    /// Predictions compared with the truth plus the reference's constant, without the
    /// constant's part in the band.
    pub(crate) own_shape: Held,
    pub(crate) away_shape: Held,
}

impl Tally {
    /// Sails a ship and fits her.
    pub(crate) fn from_voyage(seed: u64, variety: Variety, days: f64, faults: &Faults) -> Tally {
        let voyage = sail(seed, variety, days, faults);
        let mut tally = Tally {
            ships: 1,
            ..Tally::default()
        };
        match fit_robust(&voyage.observations, &options(faults)) {
            Ok(fitted) => tally.judge(&voyage, &fitted.model),
            Err(_) => tally.refused = 1,
        }
        tally
    }

    pub(crate) fn merge(&mut self, other: &Tally) {
        self.ships += other.ships;
        self.refused += other.refused;
        self.passed += other.passed;
        self.own.merge(other.own);
        self.away.merge(other.away);
        self.own_shape.merge(other.own_shape);
        self.away_shape.merge(other.away_shape);
    }

    fn judge(&mut self, voyage: &Voyage, model: &Model) {
        let mut shape = model.clone();
        let constant_sd = options(&voyage.sizes).reference_constant_sd_deg;
        shape.covariance.as_mut().unwrap()[7][7] -= constant_sd.powi(2);
        let Truth { h_nt, z_nt, .. } = voyage.truth;
        let own = (h_nt, z_nt);
        look(voyage, model, own, 0.0, &mut self.own);
        let constant = voyage.reference_constant_deg();
        look(voyage, &shape, own, constant, &mut self.own_shape);
        self.passed = u32::from(self.own.covered * 10 >= self.own.headings * 9);
        for (lat, lon) in ELSEWHERE {
            let (_, h, z) = dipole(lat, lon);
            look(voyage, model, (h, z), 0.0, &mut self.away);
            look(voyage, &shape, (h, z), constant, &mut self.away_shape);
        }
    }
}

/// Returns options with the prior of the reference's constant.
pub(crate) fn options(faults: &Faults) -> RobustOptions {
    let one = REFERENCE_CONSTANT_SD_DEG;
    RobustOptions::for_unknown_vessel(if faults.satellite {
        one / 2.0_f64.sqrt()
    } else {
        one
    })
}

fn look(voyage: &Voyage, model: &Model, field: (f64, f64), constant: f64, held: &mut Held) {
    let (h, z) = field;
    for heading in 0..36 {
        let compass = f64::from(heading) * 10.0;
        let truth = true_deviation(&voyage.truth, compass, h, z) + constant;
        let (deviation, se) = predicted(model, compass, h, z);
        held.add(wrap_180(deviation - truth), se);
    }
}
