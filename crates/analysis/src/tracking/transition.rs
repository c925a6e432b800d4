//! Transition of the states from one row to the next.

use super::levels::{Level, Levels};
use super::row::Row;
use super::states::{
    BX, BY, FRICTION, GYRO_SLOW, LIST, LIST_NT, REFLECTION, SETTLING, STATES, SWING, VARIATION,
};
use crate::estimate::{
    COMPASS_SWING_S, POPULATION_SD, SATELLITE_S, SLOW_GYRO_S, VARIATION_NM, swing_over,
};
use binnacle_compass::ship::PARAMETERS;

/// Time for which the drift level holds, seconds.
const DRIFT_S: f64 = 30.0 * 86_400.0;
/// Memory of an unmeasured list, seconds.
const LIST_S: f64 = 2.0 * 86_400.0;
/// Memory of a gyro that settles, seconds.
const SETTLING_S: f64 = 5400.0;
/// Memory of friction on one course, seconds: the sea works the card loose.
const FRICTION_S: f64 = 6.0 * 3600.0;
/// Change of course from which the card's friction is another, degrees.
const RESEATED_DEG: f64 = 5.0;
/// Change of course that kicks the gyro, degrees, and the kick over the swing's level.
const KICK_DEG: f64 = 20.0;
const KICK: f64 = 2.0;
/// Greatest time since a turn when the ship has settled again, seconds.
const SETTLED_S: f64 = 900.0;
/// Step and drift of the induced parameters over the population, for a step or drift of
/// (bx, by) of the population's size.
const INDUCED_SHARE: f64 = 0.5;

/// Transition over one step.
#[derive(Clone, Debug)]
pub(crate) struct Transition {
    /// Remaining share of each state.
    pub(crate) keep: [f64; STATES],
    /// Variance added to each state.
    pub(crate) added: [f64; STATES],
    /// Schuler pair's own transition and added variance.
    pub(crate) schuler: [[f64; 2]; 2],
    pub(crate) schuler_added: [[f64; 2]; 2],
}

impl Transition {
    /// Returns the transition to a row.
    pub(crate) fn to(row: &Row, levels: &Levels) -> Transition {
        let mut t = Transition {
            keep: [1.0; STATES],
            added: [0.0; STATES],
            schuler: [[1.0, 0.0], [0.0, 1.0]],
            schuler_added: [[0.0; 2]; 2],
        };
        let seconds = row.seconds;
        let turned = row.turned_deg.abs();
        t.fade(GYRO_SLOW, seconds / SLOW_GYRO_S, levels.at(Level::GyroSlow));
        t.fade(SWING, seconds / COMPASS_SWING_S, levels.at(Level::Swing));
        t.fade(VARIATION, row.miles / VARIATION_NM, levels.at(Level::Variation));
        t.fade(REFLECTION, seconds / SATELLITE_S, levels.at(Level::Reflection));
        t.fade(LIST, seconds / LIST_S, levels.at(Level::List) / LIST_NT);
        t.fade(SETTLING, seconds / SETTLING_S, 0.0);
        let friction = if turned > RESEATED_DEG {
            f64::INFINITY
        } else {
            seconds / FRICTION_S
        };
        t.fade(FRICTION, friction, levels.at(Level::Friction));
        t.drift(levels.at(Level::Drift).powi(2) * seconds / DRIFT_S);
        if row.after_port {
            t.drift(levels.at(Level::PortStep).powi(2));
        }
        t.swing(seconds, turned > KICK_DEG, levels.at(Level::Schuler));
        t
    }

    /// Replaces the variation's noise by that of a storm or an anomaly.
    pub(crate) fn disturb(&mut self, seconds: f64, memory_s: f64, sd_deg: f64) {
        self.added[VARIATION] = 0.0;
        self.fade(VARIATION, seconds / memory_s, sd_deg);
    }

    /// Adds a random step of (bx, by), nT squared, with its induced part.
    pub(crate) fn drift(&mut self, variance_nt2: f64) {
        let share = variance_nt2 / POPULATION_SD[BX].powi(2);
        for j in 0..PARAMETERS {
            let part = if j == BX || j == BY {
                1.0
            } else {
                INDUCED_SHARE * INDUCED_SHARE
            };
            self.added[j] += part * share;
        }
    }

    /// Lets a stationary state of standard deviation `sd` fade.
    fn fade(&mut self, state: usize, memories: f64, sd: f64) {
        let keep = (-memories).exp();
        self.keep[state] = keep;
        self.added[state] = sd * sd * (1.0 - keep * keep);
    }

    fn swing(&mut self, seconds: f64, kicked: bool, sd: f64) {
        let [[a, b], [c, d]] = swing_over(seconds);
        let variance = sd * sd;
        self.schuler = [[a, b], [c, d]];
        self.schuler_added = [
            [variance * (1.0 - a * a - b * b), -variance * (a * c + b * d)],
            [-variance * (a * c + b * d), variance * (1.0 - c * c - d * d)],
        ];
        if kicked {
            let [[_, swing], [_, rate]] = swing_over(seconds.min(SETTLED_S));
            let kick = KICK * KICK * variance;
            self.schuler_added[0][0] += kick * swing * swing;
            self.schuler_added[0][1] += kick * swing * rate;
            self.schuler_added[1][0] += kick * swing * rate;
            self.schuler_added[1][1] += kick * rate * rate;
        }
    }
}
