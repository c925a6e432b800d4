//! Learning of a ship's levels by the slope of the likelihood.

use crate::hypotheses::hypothesis::Hypothesis;
use crate::state_space::levels::{LEVELS, Level, Levels};
use crate::state_space::row::Row;
use crate::state_space::transition::Transition;
use binnacle_compass::azimuth::Azimuth;

/// Change of a level's logarithm by which the slope is taken.
const NUDGE: f64 = 0.25;
/// Greatest knowledge of a level's logarithm, one over its variance: habits change.
const MOST_KNOWN: f64 = 400.0;
/// Greatest step of a level's logarithm at one row.
const LARGEST_STEP: f64 = 0.05;

/// Levels with what is known of them.
#[derive(Clone, Debug)]
pub(crate) struct Learning {
    log_factors: [f64; LEVELS],
    information: [f64; LEVELS],
    nudged: Vec<Hypothesis>,
    levels: Levels,
}

impl Learning {
    pub(crate) fn new() -> Learning {
        Learning {
            log_factors: [0.0; LEVELS],
            information: Level::ALL.map(|level| level.prior().spread.powi(-2)),
            nudged: Vec::new(),
            levels: Levels::usual(),
        }
    }

    pub(crate) fn levels(&self) -> &Levels {
        &self.levels
    }

    /// Begins anew from another filter.
    pub(crate) fn restart(&mut self, lead: &Hypothesis) {
        self.nudged = vec![lead.clone(); LEVELS];
    }

    /// Reads an azimuth that the lead has read.
    pub(crate) fn read_azimuth(&mut self, azimuth: &Azimuth, row: &Row) {
        for hypothesis in &mut self.nudged {
            hypothesis.read_azimuth(azimuth, row);
        }
    }

    /// Reads the row by which the lead gained some log likelihood.
    pub(crate) fn read(&mut self, row: &Row, gained: f64, learns: bool) {
        let mut factors = self.log_factors;
        for (i, (hypothesis, level)) in self.nudged.iter_mut().zip(Level::ALL).enumerate() {
            let levels = self.levels.scaled(level, NUDGE.exp());
            let before = hypothesis.filter.log_likelihood;
            let transition = Transition::to(row, &levels);
            hypothesis.read(row, &levels, &transition);
            let slope = (hypothesis.filter.log_likelihood - before - gained) / NUDGE;
            if !learns || !slope.is_finite() {
                continue;
            }
            self.information[i] = (self.information[i] + slope * slope).min(MOST_KNOWN);
            let step = slope / self.information[i];
            factors[i] += step.clamp(-LARGEST_STEP, LARGEST_STEP);
        }
        self.log_factors = factors;
        let mut levels = Levels::usual();
        for (level, factor) in Level::ALL.into_iter().zip(factors) {
            levels = levels.scaled(level, factor.exp());
        }
        self.levels = levels;
    }
}
