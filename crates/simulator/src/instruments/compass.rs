//! A magnetic compass in its bowl, which follows the field slowly and with
//! friction.
//!
//! Noise: a swing of the card of 0.35° in a mean of one minute, a wander of
//! 0.2° over twenty minutes, friction of (3/H)° with H in µT (ISO 25862), and
//! the Gaussian error that a turn leaves for two to three minutes.

use crate::instruments::display::Display;
use crate::poisson::{Field, Magnetism};
use crate::random::Random;
use crate::random::process::Wander;
use crate::scenario::ShipPlan;
use binnacle_compass::angle::wrap_180;

/// Delay with which the card follows the field's direction.
const CARD_S: f64 = 5.0;
/// Standard deviation of the swing; correlated over 15 s, the mean of a minute
/// has 0.35°.
const SWING_DEG: f64 = 0.57;
const SWING_S: f64 = 15.0;
const WANDER_DEG: f64 = 0.2;
const WANDER_S: f64 = 1200.0;
/// Time constant: the error falls to a twentieth in two and a half minutes.
const GAUSSIAN_S: f64 = 50.0;
/// Reference turn of the Gaussian error, degrees a second.
const GAUSSIAN_TURN_DEG_S: f64 = 0.3;
const FRICTION_DEG_UT: f64 = 3.0;

#[derive(Clone, Debug)]
pub(crate) struct Compass {
    alignment_deg: f64,
    gaussian_gain_s: f64,
    deviation_deg: Option<f64>,
    gaussian_deg: f64,
    swing: Wander,
    wander: Wander,
    /// Offset at which friction holds the card, degrees from its free position.
    held_deg: f64,
    display: Display,
    random: Random,
}

/// The compass's surroundings in one step.
pub(crate) struct Exposure<'a> {
    pub(crate) magnetism: &'a Magnetism,
    pub(crate) field: Field,
    /// Heading from the magnetic north of the needle, degrees.
    pub(crate) magnetic_deg: f64,
    pub(crate) roll_deg: f64,
    /// Degrees turned in this step.
    pub(crate) turned_deg: f64,
    pub(crate) sea: f64,
}

impl Compass {
    pub(crate) fn new(plan: &ShipPlan, seed: u64) -> Compass {
        let mut random = Random::new(seed, &plan.name, "compass");
        Compass {
            alignment_deg: plan.alignment_deg,
            gaussian_gain_s: plan.gaussian_error_deg / GAUSSIAN_TURN_DEG_S,
            deviation_deg: None,
            gaussian_deg: 0.0,
            swing: Wander::new(SWING_DEG, SWING_S, &mut random),
            wander: Wander::new(WANDER_DEG, WANDER_S, &mut random),
            held_deg: 0.0,
            display: Display::new(plan.compass),
            random,
        }
    }

    /// Returns the compass reading after `dt` seconds, degrees, not wrapped.
    pub(crate) fn read(&mut self, dt: f64, on: &Exposure<'_>) -> f64 {
        let settled = on
            .magnetism
            .deviation_deg(on.field, on.magnetic_deg, on.roll_deg);
        let deviation = match self.deviation_deg {
            Some(shown) => shown + wrap_180(settled - shown) * (1.0 - (-dt / CARD_S).exp()),
            None => settled,
        };
        self.deviation_deg = Some(deviation);
        let decay = (-dt / GAUSSIAN_S).exp();
        self.gaussian_deg =
            decay * self.gaussian_deg + self.gaussian_gain_s * on.turned_deg * (1.0 - decay) / dt;
        let swing = self.swing.step(dt, &mut self.random) * (0.6 + 0.4 * on.sea);
        let wander = self.wander.step(dt, &mut self.random);
        // The card is dragged along in a turn: the reading lags behind.
        let free = swing + wander - self.gaussian_deg;
        let friction = FRICTION_DEG_UT / (on.field.h_nt / 1000.0);
        self.held_deg = self.held_deg.clamp(free - friction, free + friction);
        let card_deg = on.magnetic_deg - deviation + self.alignment_deg + self.held_deg;
        self.display.show(dt, card_deg)
    }
}
