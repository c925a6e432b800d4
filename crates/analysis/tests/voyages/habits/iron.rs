//! Habits of the ship's iron: retention, load and list.

use super::super::fleet::Moment;
use super::super::gauss;
use super::{Habits, Wander};
use rand::RngExt;
use rand_chacha::ChaCha8Rng;

/// Steps of all seven parameters for one of a nanotesla in bx, as of a cargo.
const LOAD: [f64; 7] = [1.0, 8e-6, 1.0, 4e-6, 1.3e-5, 5e-6, 5e-6];
/// Minutes over which a list is forgotten: three days.
const LIST_MINUTES: f64 = 4320.0;
/// Shortest time constant of the retained field, hours, and the longest over it.
const LAG_HOURS: f64 = 4.0;
const LAG_RANGE: f64 = 3.0;

pub(super) struct Iron {
    /// Retained field for a share of one, nT: forward and starboard.
    retained: Option<[f64; 2]>,
    lag_minutes: f64,
    /// Heading alongside, from magnetic north.
    berth_deg: f64,
    /// Steps of the load, summed up, and the present condition; both for one of 1 nT.
    steps: [f64; 7],
    condition: [f64; 7],
    list: Wander,
    /// Side to which a list moves the field: 1 or −1.
    side: f64,
}

impl Iron {
    pub(super) fn new(rng: &mut ChaCha8Rng) -> Iron {
        Iron {
            retained: None,
            lag_minutes: 60.0 * LAG_HOURS * LAG_RANGE.powf(rng.random::<f64>()),
            berth_deg: 0.0,
            steps: [0.0; 7],
            condition: draw(rng),
            list: Wander::new(LIST_MINUTES, rng),
            side: if rng.random::<bool>() { 1.0 } else { -1.0 },
        }
    }

    pub(super) fn minute(&mut self, sizes: &Habits, now: &Moment, rng: &mut ChaCha8Rng) {
        self.list.minute(rng);
        if now.arrived {
            self.berth_deg = 360.0 * rng.random::<f64>();
            let (step, condition) = (draw(rng), draw(rng));
            for (sum, step) in self.steps.iter_mut().zip(step) {
                *sum += step;
            }
            self.condition = condition;
        }
        if sizes.retentive_share > 0.0 {
            self.retain(now);
        }
    }

    /// Follows the field that the earth induces on this heading.
    fn retain(&mut self, now: &Moment) {
        let heading = if now.is_alongside {
            self.berth_deg
        } else {
            now.magnetic_deg
        };
        let (sin, cos) = heading.to_radians().sin_cos();
        let induced = [now.h_nt * cos, -now.h_nt * sin];
        let follows = 1.0 - (-1.0 / self.lag_minutes).exp();
        let retained = self.retained.get_or_insert(induced);
        for (retained, induced) in retained.iter_mut().zip(induced) {
            *retained += follows * (induced - *retained);
        }
    }

    /// Returns the additions to the seven parameters.
    pub(super) fn added(&self, sizes: &Habits) -> [f64; 7] {
        let mut added = [0.0; 7];
        // A change between two conditions is as large as a step.
        let condition_nt = sizes.load_condition_nt / 2.0_f64.sqrt();
        for (j, added) in added.iter_mut().enumerate() {
            *added = sizes.load_step_nt * self.steps[j] + condition_nt * self.condition[j];
        }
        let [forward, starboard] = self.retained.unwrap_or_default();
        added[0] += sizes.retentive_share * forward;
        added[2] += sizes.retentive_share * starboard
            + self.side * sizes.heeling_nt * self.list_deg(sizes).to_radians();
        added
    }

    pub(super) fn list_deg(&self, sizes: &Habits) -> f64 {
        sizes.list_deg * self.list.value
    }
}

/// Draws a load's field and soft iron.
fn draw(rng: &mut ChaCha8Rng) -> [f64; 7] {
    LOAD.map(|size| size * gauss(rng))
}
