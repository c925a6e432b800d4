//! Learning of a ship's levels by the slope of the likelihood.

use crate::hypotheses::hypothesis::Hypothesis;
use crate::state_space::levels::{LEVELS, Level, Levels};
use crate::state_space::row::Row;
use crate::state_space::transition::Transition;
use binnacle_compass::azimuth::Azimuth;

/// Change of a level's logarithm by which the slope is taken.
const NUDGE: f64 = 0.05;
/// Greatest knowledge of a level's logarithm, one over its variance: habits change.
const MOST_KNOWN: f64 = 400.0;
/// Greatest step of a level's logarithm at one row.
const LARGEST_STEP: f64 = 0.05;

/// Rows of a turn, and the number of turns among which the brief levels are shared once a ship
/// is known.
const TURN_ROWS: usize = 144;
const TURNS: usize = 4;
const KNOWN_ROWS: usize = 30 * TURN_ROWS;

/// Levels with what is known of them.
#[derive(Clone, Debug)]
pub(crate) struct Learning {
    log_factors: [f64; LEVELS],
    information: [f64; LEVELS],
    nudged: Vec<Hypothesis>,
    levels: Levels,
    rows: usize,
}

impl Learning {
    pub(crate) fn new() -> Learning {
        Learning {
            log_factors: [0.0; LEVELS],
            information: Level::ALL.map(|level| level.prior().spread.powi(-2)),
            nudged: Vec::new(),
            levels: Levels::usual(),
            rows: 0,
        }
    }

    pub(crate) fn levels(&self) -> &Levels {
        &self.levels
    }

    /// Begins anew from another filter.
    pub(crate) fn restart(&mut self, lead: &Hypothesis) {
        self.nudged = vec![lead.clone(); LEVELS];
    }

    /// Returns true if a level is looked at in this row: after a month the brief ones take turns.
    fn is_on(&self, nth: usize, level: Level) -> bool {
        self.rows < KNOWN_ROWS || !level.is_brief() || nth % TURNS == self.rows / TURN_ROWS % TURNS
    }

    /// Makes ready for the next row, which `lead` has not read yet: a level whose turn begins
    /// starts from it.
    pub(crate) fn prepare(&mut self, lead: &Hypothesis) {
        if !self.rows.is_multiple_of(TURN_ROWS) || self.rows < KNOWN_ROWS {
            return;
        }
        for (nth, level) in Level::ALL.into_iter().enumerate() {
            if level.is_brief() && self.is_on(nth, level) {
                self.nudged[nth] = lead.clone();
            }
        }
    }

    /// Reads an azimuth that the lead has read.
    pub(crate) fn read_azimuth(&mut self, azimuth: &Azimuth, row: &Row) {
        for hypothesis in &mut self.nudged {
            hypothesis.read_azimuth(azimuth, row);
        }
    }

    /// Reads the row by which the lead gained some log likelihood.
    pub(crate) fn read(&mut self, row: &Row, usual: &Transition, gained: f64, learns: bool) {
        let mut factors = self.log_factors;
        for (i, level) in Level::ALL.into_iter().enumerate() {
            if level.is_silent(row) || !self.is_on(i, level) {
                continue;
            }
            let hypothesis = &mut self.nudged[i];
            let levels = self.levels.scaled(level, NUDGE.exp());
            let before = hypothesis.filter.log_likelihood;
            let transition = usual.with_scaled(level, NUDGE.exp(), row, &self.levels);
            hypothesis.read(row, &levels, &transition);
            let slope = (hypothesis.filter.log_likelihood - before - gained) / NUDGE;
            if !learns || !slope.is_finite() {
                continue;
            }
            self.information[i] = (self.information[i] + slope * slope).min(MOST_KNOWN);
            let step = slope / self.information[i];
            factors[i] += step.clamp(-LARGEST_STEP, LARGEST_STEP);
        }
        self.rows += 1;
        self.log_factors = factors;
        let mut levels = Levels::usual();
        for (level, factor) in Level::ALL.into_iter().zip(factors) {
            levels = levels.scaled(level, factor.exp());
        }
        self.levels = levels;
    }
}
