//! Ship read once a second: steered courses, a card that swings, and a satellite compass.

use super::kinds::Kind;
use binnacle_compass::angle::{CompassHeading, TrueHeading};
use binnacle_compass::field::{FieldAt, FieldModel};
use binnacle_compass::position::Position;
use binnacle_compass::sample::Sample;
use binnacle_compass::time::Timestamp;
use rand::{RngExt, SeedableRng};
use rand_chacha::ChaCha8Rng;
use std::f64::consts::TAU;

const HOURS: f64 = 30.0;
const SPEED_KN: f64 = 11.0;

/// State of the sea, and how well the compass is adjusted.
pub(crate) struct Weather {
    pub(crate) name: &'static str,
    /// Standard deviation of yaw, and of the card's swing with the roll, degrees.
    yaw_deg: f64,
    swing_deg: f64,
    /// White noise of the compass and of the satellite compass in a second, degrees.
    compass_deg: f64,
    satellite_deg: f64,
    /// Slow errors of the satellite compass and of the variation, degrees.
    slow_deg: f64,
    /// Semicircular deviation, degrees.
    deviation_deg: f64,
}

pub(crate) const WEATHERS: [Weather; 3] = [
    Weather {
        name: "usual",
        yaw_deg: 1.0,
        swing_deg: 0.5,
        compass_deg: 0.1,
        satellite_deg: 0.1,
        slow_deg: 0.2,
        deviation_deg: 5.0,
    },
    Weather {
        name: "calm",
        yaw_deg: 0.2,
        swing_deg: 0.1,
        compass_deg: 0.05,
        satellite_deg: 0.05,
        slow_deg: 0.1,
        deviation_deg: 5.0,
    },
    Weather {
        name: "adjusted",
        yaw_deg: 0.5,
        swing_deg: 0.2,
        compass_deg: 0.1,
        satellite_deg: 0.1,
        slow_deg: 0.1,
        deviation_deg: 0.3,
    },
];

/// Readings of a second, degrees.
#[derive(Clone, Copy)]
pub(crate) struct Reading {
    pub(crate) raw: f64,
    pub(crate) shown: f64,
    pub(crate) satellite_deg: f64,
    pub(crate) variation_deg: f64,
}

/// Motion about zero with a usual period and a standard deviation of one.
struct Swing {
    at: f64,
    rate: f64,
    period_s: f64,
}

impl Swing {
    fn second(&mut self, rng: &mut ChaCha8Rng) {
        let omega = TAU / self.period_s;
        let damping = 0.3;
        self.at += self.rate;
        let force = gauss(rng) * 2.0 * (damping * omega.powi(3)).sqrt();
        self.rate += -omega * omega * self.at - 2.0 * damping * omega * self.rate + force;
    }
}

pub(crate) struct Ship<'a> {
    rng: ChaCha8Rng,
    weather: &'a Weather,
    course_deg: f64,
    until_s: i64,
    yaw: Swing,
    swing: Swing,
    slow: f64,
    position: (f64, f64),
    phase: f64,
    card_deg: f64,
    friction_deg: f64,
}

impl Ship<'_> {
    pub(crate) fn new(seed: u64, weather: &Weather) -> Ship<'_> {
        let mut rng = ChaCha8Rng::seed_from_u64(0x5eed_0000 + seed);
        let (lat, lon) = (
            -40.0 + 90.0 * rng.random::<f64>(),
            360.0 * rng.random::<f64>() - 180.0,
        );
        let period_s = 15.0 + 25.0 * rng.random::<f64>();
        Ship {
            weather,
            course_deg: 360.0 * rng.random::<f64>(),
            until_s: 0,
            yaw: Swing {
                at: 0.0,
                rate: 0.0,
                period_s,
            },
            swing: Swing {
                at: 0.0,
                rate: 0.0,
                period_s: 8.0,
            },
            slow: gauss(&mut rng),
            position: (lat, lon),
            phase: TAU * rng.random::<f64>(),
            card_deg: 0.0,
            friction_deg: 0.0,
            rng,
        }
    }

    /// Sails for hours with a reference of some kind.
    pub(crate) fn sail(mut self, kind: &Kind) -> Vec<Sample> {
        let start = Timestamp::parse("2026-03-01T00:00:00Z").unwrap();
        let field = FieldAt::from_time(FieldModel::Igrf14, start).unwrap();
        let mut made = ChaCha8Rng::seed_from_u64(77);
        let mut readings: Vec<Reading> = Vec::new();
        let mut samples = Vec::new();
        let mut variation_deg = 0.0;
        let (mut heading_deg, mut ordered_deg) = (self.course_deg, self.course_deg);
        for second in 0..(HOURS * 3600.0) as i64 {
            if second >= self.until_s {
                ordered_deg = 360.0 * self.rng.random::<f64>();
                self.until_s = second + 600 + (1800.0 * self.rng.random::<f64>()) as i64;
                self.friction_deg = 0.12 * (self.rng.random::<f64>() - 0.5) * 2.0;
            }
            let turn = binnacle_compass::angle::wrap_180(ordered_deg - heading_deg);
            heading_deg += turn.clamp(-0.5, 0.5);
            if second % 60 == 0 {
                self.step(heading_deg);
                let position = Position::new(self.position.0, self.position.1).unwrap();
                variation_deg = field
                    .at(position, 0.0)
                    .unwrap()
                    .declination()
                    .degrees_east();
            }
            let reading = self.read(heading_deg, variation_deg, kind);
            readings.push(reading);
            let reference_deg = (kind.reference)(&readings, &mut made);
            let position = Position::new(self.position.0, self.position.1).unwrap();
            samples.push(Sample {
                satellite: TrueHeading::new(reference_deg),
                sog_kn: Some(SPEED_KN),
                ..Sample::new(
                    start.plus_seconds(second as f64),
                    position,
                    CompassHeading::new(reading.shown).unwrap(),
                )
            });
        }
        samples
    }

    /// Moves on by a minute.
    fn step(&mut self, heading_deg: f64) {
        let (sin, cos) = heading_deg.to_radians().sin_cos();
        let miles = SPEED_KN / 60.0;
        self.position.0 += miles * cos / 60.0;
        self.position.1 += miles * sin / 60.0 / self.position.0.to_radians().cos();
        self.position.1 = binnacle_compass::angle::wrap_180(self.position.1);
        let keep = (-1.0_f64 / 60.0).exp();
        self.slow = keep * self.slow + (1.0 - keep * keep).sqrt() * gauss(&mut self.rng);
    }

    fn read(&mut self, heading_deg: f64, variation_deg: f64, kind: &Kind) -> Reading {
        let weather = self.weather;
        self.yaw.second(&mut self.rng);
        self.swing.second(&mut self.rng);
        let true_deg = heading_deg + weather.yaw_deg * self.yaw.at;
        let magnetic_deg = true_deg - variation_deg;
        let angle = magnetic_deg.to_radians() + self.phase;
        let deviation_deg = weather.deviation_deg * (angle.sin() + 0.2 * (2.0 * angle).cos());
        // The card follows within some seconds.
        let aim_deg = magnetic_deg - deviation_deg;
        self.card_deg += 0.4 * (aim_deg - self.card_deg);
        let raw = self.card_deg
            + self.friction_deg
            + weather.swing_deg * self.swing.at
            + weather.compass_deg * gauss(&mut self.rng);
        let satellite_deg =
            true_deg + weather.slow_deg * self.slow + weather.satellite_deg * gauss(&mut self.rng);
        Reading {
            raw,
            shown: rounded(raw, kind.compass_digit_deg),
            satellite_deg,
            variation_deg,
        }
    }
}

pub(crate) fn gauss(rng: &mut ChaCha8Rng) -> f64 {
    let (u, v): (f64, f64) = (rng.random(), rng.random());
    (-2.0 * (1.0 - u).ln()).sqrt() * (TAU * v).cos()
}

pub(crate) fn rounded(degrees: f64, digit_deg: f64) -> f64 {
    if digit_deg > 0.0 {
        (degrees / digit_deg).round() * digit_deg
    } else {
        degrees
    }
}
