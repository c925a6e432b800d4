//! Learning of a ship's levels by the slope of the likelihood.

use crate::constants::{DAY_ROWS, MOST_KNOWN, MOST_TAUGHT, NUDGE, TURNS, WEEK_ROWS};
use crate::hypotheses::hypothesis::Hypothesis;
use crate::state_space::filter::Filter;
use crate::state_space::levels::{LEVELS, Level, Levels};
use crate::state_space::row::Row;
use crate::state_space::transition::Transition;
use binnacle_compass::azimuth::Azimuth;
use serde::{Deserialize, Serialize};

/// Levels with what is known of them.
#[derive(Clone, Debug, Serialize, Deserialize)]
pub(crate) struct Learning {
    log_factors: [f64; LEVELS],
    information: [f64; LEVELS],
    nudged: Vec<Hypothesis>,
    /// Slopes of each level over rows that another hypothesis may explain yet.
    pending: [Pending; LEVELS],
    levels: Levels,
    rows: usize,
}

/// Slopes of the likelihood by a level's logarithm over some rows.
#[derive(Clone, Copy, Debug, Default, Serialize, Deserialize)]
struct Pending {
    slope: f64,
    information: f64,
    rows: f64,
}

impl Learning {
    pub(crate) fn new() -> Learning {
        Learning {
            log_factors: [0.0; LEVELS],
            information: Level::ALL.map(|level| level.prior().spread.powi(-2)),
            nudged: Vec::new(),
            pending: [Pending::default(); LEVELS],
            levels: Levels::usual(),
            rows: 0,
        }
    }

    pub(crate) fn levels(&self) -> &Levels {
        &self.levels
    }

    /// Rounds the filters beside the lead's to what is kept of them.
    pub(crate) fn round(&mut self) {
        for hypothesis in &mut self.nudged {
            hypothesis.filter.round();
        }
    }

    /// Begins anew from another filter.
    pub(crate) fn restart(&mut self, lead: &Hypothesis) {
        self.nudged = vec![lead.clone(); LEVELS];
        self.pending = [Pending::default(); LEVELS];
    }

    /// Mixes another filter into those beside the lead, as it was mixed into the lead.
    pub(crate) fn mix_with(&mut self, other: &Filter, share: f64) {
        for hypothesis in &mut self.nudged {
            let log_likelihood = hypothesis.filter.log_likelihood;
            hypothesis.filter = Filter {
                log_likelihood,
                ..hypothesis.filter.mixed_with(other, share)
            };
        }
    }

    /// Returns true if a level is looked at in this row: after four weeks the brief ones take turns.
    fn is_on(&self, nth: usize, level: Level) -> bool {
        self.rows < 4 * WEEK_ROWS
            || !level.is_brief()
            || nth % TURNS == self.rows / DAY_ROWS % TURNS
    }

    /// Makes ready for the next row, which `lead` has not read yet: a level whose turn begins
    /// starts from it.
    pub(crate) fn prepare(&mut self, lead: &Hypothesis) {
        if !self.rows.is_multiple_of(DAY_ROWS) || self.rows < 4 * WEEK_ROWS {
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

    /// Reads the row by which the lead gained some log likelihood. Rows count once it is certain
    /// that the lead is right about them: were those left out in which it is not, large habits
    /// would be taken for small ones.
    pub(crate) fn read(&mut self, row: &Row, usual: &Transition, gained: f64, is_certain: bool) {
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
            if slope.is_finite() {
                let pending = &mut self.pending[i];
                pending.slope += slope;
                pending.information += (slope * slope).min(MOST_TAUGHT);
                pending.rows += 1.0;
            }
        }
        self.rows += 1;
        if is_certain {
            self.learn();
        }
    }

    /// Moves the levels by what is pending.
    fn learn(&mut self) {
        let mut levels = Levels::usual();
        for (i, level) in Level::ALL.into_iter().enumerate() {
            let pending = std::mem::take(&mut self.pending[i]);
            if pending.rows > 0.0 {
                let known = self.information[i] + pending.information;
                self.information[i] = known.min(MOST_KNOWN);
                let largest = NUDGE * pending.rows;
                let step = pending.slope / self.information[i];
                self.log_factors[i] += step.clamp(-largest, largest);
            }
            levels = levels.scaled(level, self.log_factors[i].exp());
        }
        self.levels = levels;
    }
}
