//! Motion of a ship: limited rate of turn, yaw and roll in the sea, slow
//! changes of speed, and drift by the current.

use crate::navigation::passage::Order;
use crate::random::Random;
use crate::random::process::{Swing, Wander};
use crate::scenario::ShipPlan;
use binnacle_compass::angle::{wrap_180, wrap_360};
use binnacle_compass::position::Position;

/// A completed turn, with its change of course, starboard positive.
#[derive(Clone, Copy, Debug, PartialEq)]
pub(crate) struct Turned {
    pub(crate) by_deg: f64,
}

#[derive(Clone, Debug)]
pub(crate) struct Motion {
    pub(crate) position: Position,
    /// True heading with yaw, degrees in [0, 360).
    pub(crate) heading_deg: f64,
    /// Roll, starboard down positive, degrees.
    pub(crate) roll_deg: f64,
    /// As a rate-of-turn indicator shows it, degrees a minute.
    pub(crate) rate_deg_min: f64,
    pub(crate) sog_kn: f64,
    pub(crate) cog_deg: f64,
    /// Sea state, 1 being usual.
    pub(crate) sea: f64,
    course_deg: f64,
    turn_deg_s: f64,
    water_kn: f64,
    turned_deg: f64,
    greatest_turn_deg_s: f64,
    usual_sea: f64,
    list_deg: f64,
    log_sea: Wander,
    yaw: Swing,
    wave_yaw: Swing,
    roll: Swing,
    current_kn: [Wander; 2],
    cos_latitude: f64,
    random: Random,
}

impl Motion {
    pub(crate) fn new(plan: &ShipPlan, seed: u64) -> Motion {
        let mut random = Random::new(seed, &plan.name, "motion");
        let position = plan.route[plan.start_point].position;
        // Autopilots swing in 70 to 130 s, seas meet the ship every 7 to 11 s,
        // and ships roll in 9 to 16 s.
        let yaw_s = random.between(70.0, 130.0);
        let wave_s = random.between(7.0, 11.0);
        let roll_s = random.between(9.0, 16.0);
        Motion {
            position,
            heading_deg: 0.0,
            roll_deg: 0.0,
            rate_deg_min: 0.0,
            sog_kn: 0.0,
            cog_deg: 0.0,
            sea: plan.sea,
            course_deg: 0.0,
            turn_deg_s: 0.0,
            water_kn: 0.0,
            turned_deg: 0.0,
            greatest_turn_deg_s: plan.turn_deg_min / 60.0,
            usual_sea: plan.sea,
            list_deg: plan.list_deg,
            log_sea: Wander::new(0.5, 18.0 * 3600.0, &mut random),
            yaw: Swing::new(0.5, yaw_s, 2.0 * yaw_s, &mut random),
            wave_yaw: Swing::new(0.2, wave_s, 5.0 * wave_s, &mut random),
            roll: Swing::new(2.2, roll_s, 6.0 * roll_s, &mut random),
            current_kn: [
                Wander::new(0.4, 12.0 * 3600.0, &mut random),
                Wander::new(0.4, 12.0 * 3600.0, &mut random),
            ],
            cos_latitude: position.lat_deg().to_radians().cos(),
            random,
        }
    }

    /// Starts in the ordered state, without a transient.
    pub(crate) fn begin(&mut self, order: Order) {
        self.course_deg = match order {
            Order::Steer { course_deg, .. } => course_deg,
            Order::Alongside { heading_deg } => heading_deg,
        };
        self.heading_deg = self.course_deg;
    }

    /// Updates the slow quantities, once a minute.
    pub(crate) fn step_slow(&mut self, elapsed_s: f64) {
        let log_sea = self.log_sea.step(elapsed_s, &mut self.random);
        self.sea = self.usual_sea * (log_sea - 0.125).exp();
        for current in &mut self.current_kn {
            current.step(elapsed_s, &mut self.random);
        }
        self.cos_latitude = self.position.lat_deg().to_radians().cos();
    }

    pub(crate) fn step(&mut self, dt: f64, order: Order) -> Option<Turned> {
        match order {
            Order::Alongside { heading_deg } => {
                self.lie_alongside(heading_deg, dt);
                None
            }
            Order::Steer {
                course_deg,
                speed_kn,
            } => {
                let turned = self.turn(dt, course_deg);
                self.sway(dt, self.sea);
                self.make_way(dt, speed_kn);
                turned
            }
        }
    }

    fn lie_alongside(&mut self, heading_deg: f64, dt: f64) {
        self.course_deg = heading_deg;
        (self.turn_deg_s, self.turned_deg, self.water_kn) = (0.0, 0.0, 0.0);
        self.sway(dt, 0.05);
        self.sog_kn = 0.0;
    }

    /// Turns towards the ordered course; returns the turn when it is complete.
    fn turn(&mut self, dt: f64, order_deg: f64) -> Option<Turned> {
        let left_deg = wrap_180(order_deg - self.course_deg);
        let most = self.greatest_turn_deg_s;
        let wanted = (left_deg / 40.0).clamp(-most, most);
        self.turn_deg_s += (wanted - self.turn_deg_s) * (dt / 12.0).min(1.0);
        let step_deg = self.turn_deg_s * dt;
        self.course_deg = wrap_360(self.course_deg + step_deg);
        self.turned_deg += step_deg;
        if self.turn_deg_s.abs() > 0.02 {
            return None;
        }
        let by_deg = std::mem::take(&mut self.turned_deg);
        (by_deg.abs() > 5.0).then_some(Turned { by_deg })
    }

    fn sway(&mut self, dt: f64, sea: f64) {
        let yaw = self.yaw.step(dt, &mut self.random) + self.wave_yaw.step(dt, &mut self.random);
        let before = self.heading_deg;
        self.heading_deg = wrap_360(self.course_deg + sea * yaw);
        self.roll_deg = self.list_deg + sea * self.roll.step(dt, &mut self.random);
        // Indicators smooth over some ten seconds.
        let rate = wrap_180(self.heading_deg - before) / dt * 60.0;
        self.rate_deg_min += (rate - self.rate_deg_min) * (dt / 10.0).min(1.0);
    }

    fn make_way(&mut self, dt: f64, speed_kn: f64) {
        self.water_kn += (speed_kn - self.water_kn) * (dt / 240.0).min(1.0);
        let (sin, cos) = self.heading_deg.to_radians().sin_cos();
        let north_kn = self.water_kn * cos + self.current_kn[0].value();
        let east_kn = self.water_kn * sin + self.current_kn[1].value();
        self.sog_kn = north_kn.hypot(east_kn);
        self.cog_deg = wrap_360(east_kn.atan2(north_kn).to_degrees());
        let degrees_per_kn = dt / 3600.0 / 60.0;
        let lat = self.position.lat_deg() + north_kn * degrees_per_kn;
        let lon = self.position.lon_deg() + east_kn * degrees_per_kn / self.cos_latitude;
        self.position = Position::new(lat.clamp(-89.0, 89.0), wrap_180(lon))
            .expect("a ship's step from a place at sea is a place");
    }
}
