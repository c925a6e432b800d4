//! Habits of compass and references.

use super::super::fleet::Moment;
use super::super::gauss;
use super::{Habits, Wander};
use binnacle_compass::angle::{CompassHeading, TrueHeading};
use binnacle_compass::sample::Sample;
use rand::RngExt;
use rand_chacha::ChaCha8Rng;
use std::f64::consts::TAU;

/// A spell of weather lasts as long as this, and up to twice.
const SPELL_MINUTES: f64 = 1440.0;
/// Angle of drift, standard deviation, and the minutes over which it is forgotten.
const DRIFT_DEG: f64 = 2.5;
const DRIFT_MINUTES: f64 = 360.0;
/// Scatter of a sample's windows in usual weather, and the number of those that are independent:
/// the card swings over several.
const SPREAD_DEG: f64 = 0.4;
const SPREAD_WINDOWS: u32 = 20;
/// Nanotesla in a microtesla.
const NT_IN_UT: f64 = 1000.0;

pub(super) struct Instruments {
    /// Place at which the card sticks on this course, from −1 to 1.
    stuck_at: f64,
    /// Logarithm of the card's noise for a standard deviation of one.
    weather: f64,
    spell_minutes: f64,
    /// Constant errors of gyro and satellite compass, for a standard deviation of one.
    constants: [f64; 2],
    /// Angle by which the gyro still lags.
    lag_deg: f64,
    /// Heading on which the error by heading is greatest, radians.
    phase: f64,
    drift: Wander,
}

impl Instruments {
    pub(super) fn new(rng: &mut ChaCha8Rng) -> Instruments {
        Instruments {
            stuck_at: 0.0,
            weather: 0.0,
            spell_minutes: 0.0,
            constants: [gauss(rng), gauss(rng)],
            lag_deg: 0.0,
            phase: TAU * rng.random::<f64>(),
            drift: Wander::new(DRIFT_MINUTES, rng),
        }
    }

    pub(super) fn minute(&mut self, sizes: &Habits, now: &Moment, rng: &mut ChaCha8Rng) {
        self.drift.minute(rng);
        if now.turned_deg != 0.0 {
            self.stuck_at = 2.0 * rng.random::<f64>() - 1.0;
        }
        self.spell_minutes -= 1.0;
        if self.spell_minutes <= 0.0 {
            self.weather = gauss(rng);
            self.spell_minutes = SPELL_MINUTES * (1.0 + rng.random::<f64>());
        }
        if sizes.lag_minutes > 0.0 {
            self.lag_deg = (self.lag_deg - now.turned_deg) * (-1.0 / sizes.lag_minutes).exp();
        }
    }

    /// Returns the angle between heading and course over ground.
    pub(super) fn drift_deg(&self) -> f64 {
        DRIFT_DEG * self.drift.value
    }

    pub(super) fn card_noise(&self, sizes: &Habits) -> f64 {
        (sizes.weather * self.weather).exp()
    }

    pub(super) fn spread_deg(&self, sizes: &Habits, rng: &mut ChaCha8Rng) -> f64 {
        if sizes.weather == 0.0 {
            return SPREAD_DEG;
        }
        let squares: f64 = (0..SPREAD_WINDOWS).map(|_| gauss(rng).powi(2)).sum();
        SPREAD_DEG * self.card_noise(sizes) * (squares / f64::from(SPREAD_WINDOWS)).sqrt()
    }

    pub(super) fn read(&self, sizes: &Habits, now: &Moment, read: [f64; 3]) -> [f64; 3] {
        let [compass, gyro, satellite] = read;
        let course = now.course_deg.to_radians();
        let cos_lat = now.lat_deg.to_radians().cos();
        let northerly = now.speed_kn * course.cos() / (902.5 * cos_lat);
        let [of_gyro, of_satellite] = self.constants.map(|c| sizes.constant_deg * c);
        let friction_deg = sizes.friction_deg_ut / (now.h_nt / NT_IN_UT);
        [
            compass + friction_deg * self.stuck_at,
            gyro + of_gyro / cos_lat
                + sizes.speed_error_share * northerly.to_degrees()
                + sizes.heading_error_deg * (course - self.phase).cos()
                + self.lag_deg,
            satellite + of_satellite,
        ]
    }
}

/// Adds the error of a whole sample, and rounds it.
pub(super) fn finish(sizes: &Habits, sample: &mut Sample, rng: &mut ChaCha8Rng) {
    let off = sizes.tails_deg * student(rng);
    let compass = rounded(sample.compass.degrees() + off, sizes.sample_digit_deg);
    sample.compass = CompassHeading::new(compass).unwrap_or(sample.compass);
    for reference in [&mut sample.gyro, &mut sample.satellite] {
        let read = reference.map(|read| rounded(read.degrees(), sizes.sample_digit_deg));
        *reference = read.and_then(TrueHeading::new);
    }
}

pub(super) fn rounded(degrees: f64, digit_deg: f64) -> f64 {
    if digit_deg > 0.0 {
        (degrees / digit_deg).round() * digit_deg
    } else {
        degrees
    }
}

/// Student's t with three degrees of freedom.
fn student(rng: &mut ChaCha8Rng) -> f64 {
    let squares: f64 = (0..3).map(|_| gauss(rng).powi(2)).sum();
    gauss(rng) / (squares / 3.0).sqrt()
}
