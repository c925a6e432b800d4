//! A satellite compass: independent of magnetism and speed, with 0.5° of noise,
//! and without a heading while it has lost its satellites.

use crate::instruments::display::Display;
use crate::random::Random;
use crate::random::process::Wander;
use crate::scenario::{SatellitePlan, ShipPlan};

const NOISE_DEG: f64 = 0.3;
const NOISE_S: f64 = 30.0;
/// Reflections from the ship's own superstructure.
const REFLECTION_DEG: f64 = 0.4;
const REFLECTION_S: f64 = 400.0;

#[derive(Clone, Debug)]
pub(crate) struct Satellite {
    plan: SatellitePlan,
    noise: Wander,
    reflection: Wander,
    until_dropout_s: f64,
    dropout_s: f64,
    display: Display,
    random: Random,
}

impl Satellite {
    pub(crate) fn new(plan: &ShipPlan, satellite: SatellitePlan, seed: u64) -> Satellite {
        let mut random = Random::new(seed, &plan.name, "satellite");
        Satellite {
            plan: satellite,
            noise: Wander::new(NOISE_DEG, NOISE_S, &mut random),
            reflection: Wander::new(REFLECTION_DEG, REFLECTION_S, &mut random),
            until_dropout_s: until_dropout_s(satellite, &mut random),
            dropout_s: 0.0,
            display: Display::new(satellite.display),
            random,
        }
    }

    /// Returns the reading, degrees, not wrapped; `None` without satellites.
    pub(crate) fn read(&mut self, dt: f64, heading_deg: f64) -> Option<f64> {
        let noise = self.noise.step(dt, &mut self.random);
        let reflection = self.reflection.step(dt, &mut self.random);
        self.until_dropout_s -= dt;
        if self.until_dropout_s <= 0.0 {
            self.until_dropout_s = until_dropout_s(self.plan, &mut self.random);
            self.dropout_s = self.random.waiting(600.0);
        }
        self.dropout_s -= dt;
        let sees = self.dropout_s <= 0.0;
        let sensor_deg = heading_deg + self.plan.alignment_deg + noise + reflection;
        let shown_deg = self.display.show(dt, sensor_deg);
        sees.then_some(shown_deg)
    }
}

fn until_dropout_s(plan: SatellitePlan, random: &mut Random) -> f64 {
    if plan.dropouts_per_day > 0.0 {
        random.waiting(86_400.0 / plan.dropouts_per_day)
    } else {
        f64::INFINITY
    }
}
