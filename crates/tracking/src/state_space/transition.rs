//! Transition of the states from one row to the next.

use super::levels::{Level, Levels};
use super::row::Row;
use super::states::{
    ANOMALY, BERTH, BX, BY, CURRENT, FRICTION, GROWTH, GYRO, GYRO_SLOW, LEEWAY, LIST, LIST_NT,
    REFLECTION, SATELLITE, SCHULER, SETTLING, STATES, STEADY, SWING, VARIATION,
};
use binnacle_analysis::estimate::{
    COMPASS_SWING_S, POPULATION_SD, SATELLITE_S, SLOW_GYRO_S, VARIATION_NM, swing_over,
};
use binnacle_compass::ship::PARAMETERS;

/// Time for which the drift level holds, seconds: the unit of that level.
pub(crate) const DRIFT_S: f64 = 30.0 * 86_400.0;
/// Memory of an unmeasured list, seconds. Assumed: tanks are trimmed every other day.
const LIST_S: f64 = 2.0 * 86_400.0;
/// Memory of a gyro that settles, seconds. Assumed: it is right again within a watch.
pub(crate) const SETTLING_S: f64 = 5400.0;
/// Memory of friction on one course, seconds. Assumed: the sea works the card loose.
const FRICTION_S: f64 = 6.0 * 3600.0;
/// Change of course from which the card's friction is another, degrees. Assumed: many times the
/// friction itself.
const RESEATED_DEG: f64 = 5.0;
/// Change of course that kicks the gyro, degrees, and the kick over the swing's level. Assumed: a
/// ballistic error of a degree after a manoeuvre, some times that of a steady course.
const KICK_DEG: f64 = 20.0;
const KICK: f64 = 2.0;
/// Greatest time since a turn when the ship has settled again, seconds. Assumed: a sample is ten
/// minutes on a steady course, after some minutes of turn.
const SETTLED_S: f64 = 900.0;
/// Drift of the induced parameters over the population, for a drift of (bx, by) of the
/// population's size. Assumed: soft iron changes less than permanent magnetism.
const INDUCED_SHARE: f64 = 0.3;
/// Memory of the current, which is smooth: tidal streams turn in six hours (Bowditch, The
/// American Practical Navigator, "Tides and tidal currents"), streams and eddies change within
/// tens of miles.
const CURRENT_S: f64 = 6.0 * 3600.0;
const CURRENT_NM: f64 = 60.0;
/// Memory of the drift by the wind. Assumed: weather systems pass in days.
const LEEWAY_S: f64 = 36.0 * 3600.0;
/// Memory of the drift by prevailing winds and residual currents, a season, and its size: general
/// currents of the oceans run at 0.3 to 1 knot (Bowditch, "Ocean currents"), on some routes with
/// the ship and on some against her.
const STEADY_S: f64 = 60.0 * 86_400.0;
pub(crate) const STEADY_KN: f64 = 0.3;
/// Constant error of one reference against another of its kind, degrees: 0.75° of each (IMO
/// A.424(XI)), √2 of it.
const NEW_REFERENCE_DEG: f64 = 1.0;

/// Transition over one step.
#[derive(Clone, Debug)]
pub(crate) struct Transition {
    /// Remaining share of each state.
    pub(crate) keep: [f64; STATES],
    /// Variance added to each state.
    pub(crate) added: [f64; STATES],
    /// The gyro's swing with its rate; none without a gyro's states.
    pub(crate) schuler: Option<Pair>,
    /// The current to the east and to the north, each with its rate; none without its states.
    pub(crate) current: Option<[Pair; 2]>,
    /// An anomaly with its rate, while one is passed.
    pub(crate) anomaly: Option<Pair>,
    /// Shares of states that other states gain.
    pub(crate) gains: [Option<Gain>; 2],
}

/// Share of one state that another gains.
#[derive(Clone, Copy, Debug)]
pub(crate) struct Gain {
    pub(crate) of: usize,
    pub(crate) by: usize,
    pub(crate) share: f64,
}

/// Transition of a state and its rate, which follows it.
#[derive(Clone, Copy, Debug)]
pub(crate) struct Pair {
    pub(crate) state: usize,
    pub(crate) matrix: [[f64; 2]; 2],
    pub(crate) added: [[f64; 2]; 2],
}

impl Transition {
    /// Returns the transition that changes nothing.
    fn none() -> Transition {
        Transition {
            keep: [1.0; STATES],
            added: [0.0; STATES],
            schuler: None,
            current: None,
            anomaly: None,
            gains: [None; 2],
        }
    }

    /// Returns the transition by a port call in no time.
    pub(crate) fn by_call(levels: &Levels) -> Transition {
        let mut t = Transition::none();
        t.step(levels.at(Level::PortStep).powi(2), 1.0);
        t
    }

    /// Returns the transition to a row.
    pub(crate) fn to(row: &Row, levels: &Levels) -> Transition {
        let mut t = Transition::none();
        let seconds = row.seconds;
        let turned = row.turned_deg.abs();
        if row.course.is_some() {
            t.drift_of_ship(row, levels);
        } else {
            t.instruments(row, levels);
        }
        t.fade(
            SWING,
            seconds / COMPASS_SWING_S,
            levels.at(Level::Swing) * row.sea,
        );
        t.fade(
            VARIATION,
            row.miles / VARIATION_NM,
            levels.at(Level::Variation),
        );
        t.fade(LIST, seconds / LIST_S, levels.at(Level::List) / LIST_NT);
        let friction = if turned > RESEATED_DEG {
            f64::INFINITY
        } else {
            seconds / FRICTION_S
        };
        t.fade(FRICTION, friction, levels.at(Level::Friction));
        t.drift(levels.at(Level::Drift).powi(2) * seconds / DRIFT_S);
        if row.after_port {
            // On any heading alike.
            t.fade(BERTH, f64::INFINITY, 0.5_f64.sqrt());
            t.fade(BERTH + 1, f64::INFINITY, 0.5_f64.sqrt());
            t.step(levels.at(Level::PortStep).powi(2), 1.0);
        }
        t
    }

    /// Moves the errors of gyro and satellite compass.
    fn instruments(&mut self, row: &Row, levels: &Levels) {
        let seconds = row.seconds;
        let kicked = row.turned_deg.abs() > KICK_DEG;
        self.schuler = Some(swing(seconds, kicked, levels.at(Level::Schuler)));
        self.fade(GYRO_SLOW, seconds / SLOW_GYRO_S, levels.at(Level::GyroSlow));
        let reflection = levels.at(Level::Reflection);
        self.fade(REFLECTION, seconds / SATELLITE_S, reflection);
        self.fade(SETTLING, seconds / SETTLING_S, 0.0);
        for (state, is_new) in [(GYRO, row.new_gyro), (SATELLITE, row.new_satellite)] {
            if is_new {
                self.added[state] += NEW_REFERENCE_DEG * NEW_REFERENCE_DEG;
            }
        }
    }

    /// Moves the current and the drift by the wind.
    fn drift_of_ship(&mut self, row: &Row, levels: &Levels) {
        let memories = row.seconds / CURRENT_S + row.miles / CURRENT_NM;
        let current = levels.at(Level::Current);
        self.current = Some([CURRENT, CURRENT + 2].map(|state| smooth(state, memories, current)));
        for part in 0..2 {
            let leeway = levels.at(Level::Leeway);
            self.fade(LEEWAY + part, row.seconds / LEEWAY_S, leeway);
            self.fade(STEADY + part, row.seconds / STEADY_S, STEADY_KN);
        }
    }

    /// Returns the transitions of states with their rates.
    pub(crate) fn pairs(&self) -> impl Iterator<Item = &Pair> {
        let current = self.current.iter().flatten();
        self.schuler.iter().chain(current).chain(&self.anomaly)
    }

    /// Returns this transition to a row for levels of which one is scaled from those that it
    /// was made for.
    pub(crate) fn with_scaled(
        &self,
        level: Level,
        factor: f64,
        row: &Row,
        levels: &Levels,
    ) -> Transition {
        let mut t = self.clone();
        let square = factor * factor;
        match level {
            Level::White | Level::DifferenceWhite => {}
            Level::Swing => t.added[SWING] *= square,
            Level::Friction => t.added[FRICTION] *= square,
            Level::GyroSlow => t.added[GYRO_SLOW] *= square,
            Level::Variation => t.added[VARIATION] *= square,
            Level::Reflection => t.added[REFLECTION] *= square,
            Level::List => t.added[LIST] *= square,
            Level::Schuler => t.schuler.iter_mut().for_each(|pair| pair.scale(square)),
            Level::Current => {
                let pairs = t.current.iter_mut().flatten();
                pairs.for_each(|pair| pair.scale(square));
            }
            Level::Leeway => {
                t.added[LEEWAY] *= square;
                t.added[LEEWAY + 1] *= square;
            }
            Level::PortStep | Level::Drift => {
                return Transition::to(row, &levels.scaled(level, factor));
            }
        }
        t
    }

    /// Replaces the variation's noise by that of a storm or an anomaly.
    pub(crate) fn disturb(&mut self, memories: f64, sd_deg: f64) {
        self.added[VARIATION] = 0.0;
        self.fade(VARIATION, memories, sd_deg);
    }

    /// Lets (bx, by) grow steadily for some days.
    pub(crate) fn grow(&mut self, days: f64) {
        self.gains = [(GROWTH, BX), (GROWTH + 1, BY)].map(|(of, by)| {
            Some(Gain {
                of,
                by,
                share: days,
            })
        });
    }

    /// Adds a random drift of (bx, by), nT squared, with a little of the induced parameters.
    pub(crate) fn drift(&mut self, variance_nt2: f64) {
        self.step(variance_nt2, INDUCED_SHARE);
    }

    /// Adds a random step of (bx, by), nT squared, and of the induced parameters as a share of
    /// that in units of the population.
    fn step(&mut self, variance_nt2: f64, induced_share: f64) {
        let share = variance_nt2 / POPULATION_SD[BX].powi(2);
        for j in 0..PARAMETERS {
            let part = if j == BX || j == BY {
                1.0
            } else {
                induced_share * induced_share
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

    /// Lets a local anomaly come and go smoothly.
    pub(crate) fn pass_anomaly(&mut self, memories: f64, sd_deg: f64) {
        self.anomaly = Some(smooth(ANOMALY, memories, sd_deg));
    }
}

impl Pair {
    fn scale(&mut self, square: f64) {
        for added in self.added.as_flattened_mut() {
            *added *= square;
        }
    }
}

/// Returns the transition of a smooth process and its rate per memory: a Gaussian process of the
/// Matérn kind, once differentiable (Rasmussen & Williams 2006, eq. 4.17).
fn smooth(state: usize, memories: f64, sd: f64) -> Pair {
    let decay = 3.0_f64.sqrt();
    let keep = (-decay * memories).exp();
    let [a, b] = [keep * (1.0 + decay * memories), keep * memories];
    let [c, d] = [
        -keep * decay * decay * memories,
        keep * (1.0 - decay * memories),
    ];
    let value = sd * sd;
    let rate = value * decay * decay;
    let across = -(a * c * value + b * d * rate);
    Pair {
        state,
        matrix: [[a, b], [c, d]],
        added: [
            [value - a * a * value - b * b * rate, across],
            [across, rate - c * c * value - d * d * rate],
        ],
    }
}

/// Returns the transition of the gyro's swing, kicked by a turn or not.
fn swing(seconds: f64, kicked: bool, sd: f64) -> Pair {
    let [[a, b], [c, d]] = swing_over(seconds);
    let variance = sd * sd;
    let across = -variance * (a * c + b * d);
    let mut added = [
        [variance * (1.0 - a * a - b * b), across],
        [across, variance * (1.0 - c * c - d * d)],
    ];
    if kicked {
        let [[_, swing], [_, rate]] = swing_over(seconds.min(SETTLED_S));
        let kick = KICK * KICK * variance;
        added[0][0] += kick * swing * swing;
        added[0][1] += kick * swing * rate;
        added[1][0] += kick * swing * rate;
        added[1][1] += kick * rate * rate;
    }
    Pair {
        state: SCHULER,
        matrix: [[a, b], [c, d]],
        added,
    }
}
