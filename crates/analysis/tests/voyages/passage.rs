//! Passage of a ship: from port to port, in legs on courses that are about right.

use super::{Variety, gauss};
use binnacle_compass::angle::wrap_180;
use rand::RngExt;
use rand_chacha::ChaCha8Rng;

/// Place and motion of the ship.
pub(crate) struct Passage {
    variety: Variety,
    ports: Vec<(f64, f64)>,
    bound_for: usize,
    pub(super) lat: f64,
    pub(super) lon: f64,
    pub(super) speed_kn: f64,
    pub(super) course: f64,
    leg_minutes: f64,
    pub(super) berth_minutes: f64,
    pub(super) turning_minutes: f64,
}

impl Passage {
    pub(crate) fn new(variety: Variety, rng: &mut ChaCha8Rng) -> Passage {
        let ports = ports(variety, rng);
        Passage {
            variety,
            bound_for: 1,
            lat: ports[0].0,
            lon: ports[0].1,
            ports,
            speed_kn: 12.0 + 4.0 * rng.random::<f64>(),
            course: 0.0,
            leg_minutes: 0.0,
            berth_minutes: 0.0,
            turning_minutes: 0.0,
        }
    }

    /// Moves on by a minute, and returns the turn to a new leg.
    pub(crate) fn minute(&mut self, rng: &mut ChaCha8Rng) -> f64 {
        if self.berth_minutes > 0.0 {
            self.berth_minutes -= 1.0;
            return 0.0;
        }
        self.turning_minutes -= 1.0;
        self.leg_minutes -= 1.0;
        let course = self.course.to_radians();
        self.lat += self.speed_kn / 3600.0 * course.cos();
        let east = self.speed_kn / 3600.0 * course.sin() / self.lat.to_radians().cos();
        self.lon = wrap_180(self.lon + east);
        if self.leg_minutes > 0.0 {
            return 0.0;
        }
        let (to_lat, to_lon) = self.ports[self.bound_for];
        let east = wrap_180(to_lon - self.lon) * self.lat.to_radians().cos();
        let north = to_lat - self.lat;
        if east.hypot(north) < 2.0 {
            self.bound_for = (self.bound_for + 1) % self.ports.len();
            self.berth_minutes = 720.0 + 1440.0 * rng.random::<f64>();
        }
        let wanted = east.atan2(north).to_degrees() + 30.0 * gauss(rng);
        let usual = if self.variety == Variety::Poor {
            150.0
        } else {
            360.0
        };
        self.leg_minutes = (usual * (0.8 * gauss(rng)).exp()).clamp(20.0, 2000.0);
        let turn = wrap_180(wanted - self.course);
        self.course = wanted.rem_euclid(360.0);
        self.turning_minutes = 6.0;
        turn
    }
}

fn ports(variety: Variety, rng: &mut ChaCha8Rng) -> Vec<(f64, f64)> {
    let at = |rng: &mut ChaCha8Rng, lat: f64, lon: f64, spread: f64| {
        (
            lat + spread * gauss(rng) / 2.0,
            lon + spread * gauss(rng) / 2.0,
        )
    };
    match variety {
        Variety::Rich => vec![
            at(rng, 48.0, -8.0, 5.0),
            at(rng, 10.0, -20.0, 5.0),
            at(rng, -34.0, 15.0, 3.0),
            at(rng, -23.0, -40.0, 5.0),
        ],
        Variety::Medium => vec![
            at(rng, 50.0, -10.0, 4.0),
            at(rng, 25.0, -30.0, 6.0),
            at(rng, 40.0, -60.0, 4.0),
        ],
        Variety::Poor => {
            let (lat, lon) = if rng.random::<bool>() {
                (56.0, 4.0)
            } else {
                (16.0, -68.0)
            };
            (0..6).map(|_| at(rng, lat, lon, 6.0)).collect()
        }
    }
}
