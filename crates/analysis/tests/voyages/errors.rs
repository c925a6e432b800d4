//! Errors of a ship's instruments, and of the field about it.

use super::passage::Passage;
use super::{Faults, Truth, gauss, needle};
use rand::RngExt;
use rand_chacha::ChaCha8Rng;
use std::f64::consts::TAU;

/// All errors, stepped by the minute.
pub(crate) struct Errors {
    pub(crate) swing: f64,
    rate: f64,
    slow: f64,
    compass_swing: f64,
    crust: f64,
    storm: f64,
    pub(crate) storm_minutes: f64,
    speed_error: f64,
    multipath: f64,
    /// Factor on the compass card's noise.
    pub(crate) card_noise: f64,
}

impl Errors {
    pub(crate) fn new(faults: &Faults, rng: &mut ChaCha8Rng) -> Errors {
        Errors {
            swing: faults.schuler_deg * gauss(rng),
            rate: 0.0,
            slow: faults.slow_gyro_deg * gauss(rng),
            compass_swing: 0.0,
            crust: faults.variation_deg * gauss(rng),
            storm: 0.0,
            storm_minutes: 0.0,
            speed_error: faults.speed_error * gauss(rng),
            multipath: 0.0,
            card_noise: 1.0,
        }
    }

    pub(crate) fn minute(
        &mut self,
        faults: &Faults,
        on: &Passage,
        turned: f64,
        rng: &mut ChaCha8Rng,
    ) {
        let omega = TAU / 84.4;
        let kick = if turned.abs() > 20.0 {
            1.2 * faults.schuler_deg * gauss(rng)
        } else {
            0.0
        };
        let noise = faults.schuler_deg * omega * (4.0_f64 * 0.2 * omega * 0.3).sqrt();
        self.rate += kick * omega - (omega * omega * self.swing + 0.4 * omega * self.rate)
            + noise * gauss(rng);
        self.swing += self.rate;
        step(&mut self.slow, 1.0 / 4320.0, faults.slow_gyro_deg, rng);
        step(&mut self.compass_swing, 1.0 / 20.0, faults.swing_deg, rng);
        step(&mut self.multipath, 1.0 / 30.0, 0.2, rng);
        if on.berth_minutes <= 0.0 {
            step(
                &mut self.crust,
                on.speed_kn / 3600.0,
                faults.variation_deg,
                rng,
            );
        }
        if self.storm_minutes > 0.0 {
            self.storm_minutes -= 1.0;
            step(&mut self.storm, 1.0 / 60.0, 1.0, rng);
            return;
        }
        self.storm = 0.0;
        if rng.random::<f64>() < faults.storms_per_month / 43_200.0 {
            self.storm_minutes = 240.0 + 600.0 * rng.random::<f64>();
        }
    }

    /// Returns the readings of compass, gyro and satellite compass in the field (variation,
    /// H, Z) of the models.
    pub(super) fn read(
        &self,
        truth: &Truth,
        on: &Passage,
        minute: i64,
        field: (f64, f64, f64),
        rng: &mut ChaCha8Rng,
    ) -> [f64; 3] {
        let (variation, h, z) = field;
        let true_heading = on.course + gauss(rng);
        let daily = 0.12 * (TAU * (minute as f64 / 1440.0 + on.lon / 360.0)).sin();
        let magnetic = true_heading - variation - (self.crust + daily + self.storm) * 24_000.0 / h;
        let compass = needle(&truth.parameters, magnetic, h, z) - truth.alignment_deg
            + self.card_noise * self.compass_swing
            + self.card_noise * 0.35 * gauss(rng);
        let cos_lat = on.lat.to_radians().cos();
        let northerly = on.speed_kn * on.course.to_radians().cos() / (902.5 * cos_lat);
        let gyro = true_heading
            + truth.gyro_constant_deg
            + (self.swing + self.slow) / cos_lat
            + self.speed_error * northerly.to_degrees()
            + 0.15 * gauss(rng);
        let satellite =
            true_heading + truth.satellite_constant_deg + self.multipath + 0.4 * gauss(rng);
        [compass, gyro, satellite]
    }
}

/// Steps a process that forgets `share` of itself and keeps its spread.
fn step(x: &mut f64, share: f64, sd: f64, rng: &mut ChaCha8Rng) {
    let keep = (-share).exp();
    *x = *x * keep + sd * (1.0 - keep * keep).sqrt() * gauss(rng);
}
