//! A gyro compass and its errors.
//!
//! The errors are: a constant; the Schuler swing of 84.4 minutes, damped by a
//! fifth and excited by turns; a bias that wanders over three days; the
//! uncorrected part of the speed error; the remainder of a turn until it has
//! settled; and the scenario's faults. Swing and bias grow with
//! 1/cos(latitude).

use crate::instruments::display::Display;
use crate::navigation::motion::{Motion, Turned};
use crate::random::Random;
use crate::random::process::{Swing, Wander};
use crate::scenario::{Event, GyroPlan, ShipPlan};

const SCHULER_S: f64 = 84.4 * 60.0;
/// Decay by e with a damping ratio of 0.2.
const SCHULER_DECAY_S: f64 = SCHULER_S / std::f64::consts::TAU / 0.2;
const SLOW_S: f64 = 3.0 * 86_400.0;
/// The smallest turn that excites the swing.
const KICKING_TURN_DEG: f64 = 20.0;
const SETTLING_S: f64 = 480.0;
const SETTLING_DEG: f64 = 0.4;
const NOISE_DEG: f64 = 0.08;

#[derive(Clone, Debug)]
pub(crate) struct Gyro {
    plan: GyroPlan,
    schuler: Swing,
    slow: Wander,
    settling_deg: f64,
    faults: Vec<Event>,
    error_deg: f64,
    display: Display,
    random: Random,
}

impl Gyro {
    pub(crate) fn new(plan: &ShipPlan, seed: u64) -> Gyro {
        let mut random = Random::new(seed, &plan.name, "gyro");
        let faults = plan.events.iter();
        Gyro {
            plan: plan.gyro,
            schuler: Swing::new(
                plan.gyro.schuler_deg,
                SCHULER_S,
                SCHULER_DECAY_S,
                &mut random,
            ),
            slow: Wander::new(plan.gyro.slow_deg, SLOW_S, &mut random),
            settling_deg: 0.0,
            faults: faults
                .filter(|event| matches!(event, Event::GyroFault { .. }))
                .cloned()
                .collect(),
            error_deg: 0.0,
            display: Display::new(plan.gyro.display),
            random,
        }
    }

    pub(crate) fn turned(&mut self, turn: Turned) {
        let size = (turn.by_deg.abs() / 90.0).min(1.0);
        if turn.by_deg.abs() > KICKING_TURN_DEG {
            self.schuler
                .kick(self.plan.schuler_deg * size, &mut self.random);
        }
        self.settling_deg += SETTLING_DEG * size * self.random.gaussian();
    }

    /// Updates the slow errors, once a minute.
    pub(crate) fn step_slow(&mut self, elapsed_s: f64, day: f64, motion: &Motion) {
        let cos_latitude = motion.position.lat_deg().to_radians().cos();
        let schuler = self.schuler.step(elapsed_s, &mut self.random);
        let slow = self.slow.step(elapsed_s, &mut self.random);
        self.settling_deg *= (-elapsed_s / SETTLING_S).exp();
        self.error_deg = self.plan.constant_deg
            + (schuler + slow) / cos_latitude
            + self.plan.speed_error_left * speed_error_deg(motion, cos_latitude)
            + self.settling_deg
            + self.fault_deg(day);
    }

    /// Returns the gyro reading after `dt` seconds, degrees, not wrapped.
    pub(crate) fn read(&mut self, dt: f64, heading_deg: f64) -> f64 {
        let sensor_deg = heading_deg + self.error_deg + NOISE_DEG * self.random.gaussian();
        self.display.show(dt, sensor_deg)
    }

    fn fault_deg(&self, day: f64) -> f64 {
        let at = |event: &Event| match event {
            Event::GyroFault {
                from_day,
                to_day,
                offset_deg,
                drift_deg_per_h,
            } if (*from_day..*to_day).contains(&day) => {
                offset_deg + drift_deg_per_h * (day - from_day) * 24.0
            }
            _ => 0.0,
        };
        self.faults.iter().map(at).sum()
    }
}

/// Speed error of a gyro without a corrector, positive on northerly courses:
/// sin error = V cos C / (902.5 cos latitude), V in knots (the earth's equator
/// turns at 902.5 kn).
fn speed_error_deg(motion: &Motion, cos_latitude: f64) -> f64 {
    let northward_kn = motion.sog_kn * motion.cog_deg.to_radians().cos();
    (northward_kn / (902.5 * cos_latitude))
        .clamp(-1.0, 1.0)
        .asin()
        .to_degrees()
}
