//! Sizes of a ship's and her instruments' habits, learnt as she sails.
//!
//! Each level has a log-normal prior; its logarithm follows the slope of the likelihood, taken
//! by filters that run beside with one level nudged (recursive maximum likelihood, Ljung &
//! Söderström 1983, chapter 3).

use super::row::Row;
use serde::{Deserialize, Serialize};

/// Size of a habit on a ship that has it more than others, over the level. Assumed: twice the
/// spread of the logarithm over ships (e^1.4).
const LIVELY: f64 = 4.0;
/// Number of levels.
pub(crate) const LEVELS: usize = 13;

/// Habit with a size of its own on each ship.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Serialize, Deserialize)]
pub(crate) enum Level {
    /// Noise new in every row, degrees.
    White,
    /// Noise new in every difference of references, degrees.
    DifferenceWhite,
    /// Card's slow swing, degrees.
    Swing,
    /// Card's friction, degrees where H is usual.
    Friction,
    /// Gyro's Schuler swing, degrees; its kick by a turn goes with it.
    Schuler,
    /// Gyro's slow wander, degrees.
    GyroSlow,
    /// Error of the charted variation, degrees where H is usual.
    Variation,
    /// Satellite compass's reflections, degrees.
    Reflection,
    /// Unmeasured list's field, nT.
    List,
    /// Step of (bx, by) at a port call, nT.
    PortStep,
    /// Drift of (bx, by) in thirty days, nT.
    Drift,
    /// Component of the current, knots.
    Current,
    /// Component of the drift by the wind, knots.
    Leeway,
}

impl Level {
    /// All levels in order.
    pub(crate) const ALL: [Level; LEVELS] = [
        Level::White,
        Level::DifferenceWhite,
        Level::Swing,
        Level::Friction,
        Level::Schuler,
        Level::GyroSlow,
        Level::Variation,
        Level::Reflection,
        Level::List,
        Level::PortStep,
        Level::Drift,
        Level::Current,
        Level::Leeway,
    ];

    /// Returns true if what the level says is forgotten within a day.
    pub(crate) fn is_brief(self) -> bool {
        !matches!(
            self,
            Level::GyroSlow | Level::List | Level::PortStep | Level::Drift | Level::Leeway
        )
    }

    /// Returns true if a row shows nothing of the level: of instruments where the ship has none,
    /// and of her drift where she has one.
    pub(crate) fn is_silent(self, row: &Row) -> bool {
        let of_course = matches!(self, Level::Current | Level::Leeway);
        let of_instruments = matches!(
            self,
            Level::DifferenceWhite | Level::Schuler | Level::GyroSlow | Level::Reflection
        );
        if row.course.is_some() {
            of_instruments
        } else {
            of_course
        }
    }

    /// Returns the size on a usual ship, and the standard deviation of its logarithm over
    /// ships.
    ///
    /// Sizes are assumed: below what instruments are allowed (compass of class A 0.5° and friction
    /// of (3/H)° with H in µT; gyro 0.75° sec φ, IMO A.424(XI)), and what ballast moves, 0.1 µT in a
    /// month or at a call. The spreads let each ship teach her own.
    pub(crate) fn prior(self) -> Size {
        let (usual, spread) = match self {
            Level::White
            | Level::DifferenceWhite
            | Level::Swing
            | Level::Schuler
            | Level::Variation
            | Level::Reflection => (0.2, 0.5),
            Level::GyroSlow => (0.3, 0.5),
            Level::Friction => (0.1, 0.8),
            Level::List | Level::Drift => (60.0, 0.8),
            Level::PortStep => (60.0, 1.0),
            Level::Current => (1.2, 0.5),
            Level::Leeway => (0.25, 0.5),
        };
        Size { usual, spread }
    }
}

/// Size of a habit over ships.
#[derive(Clone, Copy, Debug)]
pub(crate) struct Size {
    pub(crate) usual: f64,
    pub(crate) spread: f64,
}

/// Levels of one ship.
#[derive(Clone, Copy, Debug, PartialEq, Serialize, Deserialize)]
pub(crate) struct Levels([f64; LEVELS]);

impl Levels {
    /// Returns the levels of a usual ship.
    pub(crate) fn usual() -> Levels {
        Levels(Level::ALL.map(|level| level.prior().usual))
    }

    pub(crate) fn at(&self, level: Level) -> f64 {
        self.0[level as usize]
    }

    /// Returns the levels of a ship on which one is much larger.
    pub(crate) fn of_lively(&self, level: Level) -> Levels {
        self.scaled(level, LIVELY)
    }

    /// Returns the levels with one scaled.
    pub(crate) fn scaled(&self, level: Level, factor: f64) -> Levels {
        let mut scaled = *self;
        scaled.0[level as usize] *= factor;
        scaled
    }
}
