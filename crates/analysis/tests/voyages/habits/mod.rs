//! Habits of a sound ship, and of sound instruments: they move the readings, but nothing
//! has happened to the ship.
//!
//! Every random number comes from a stream of its own, and the same ones are drawn whatever
//! the sizes. A ship therefore sails the same passage through the same storms with a habit
//! as without it.

mod instruments;
mod iron;

use super::fleet::Moment;
use super::{Truth, gauss};
use binnacle_compass::angle::CourseOverGround;
use binnacle_compass::model::Parameters;
use binnacle_compass::sample::Sample;
use instruments::Instruments;
use iron::Iron;
use rand::SeedableRng;
use rand_chacha::ChaCha8Rng;

/// Difference between the seeds of the passage and of the habits.
const STREAM: u64 = 0x4a8d_17c3_0000_0000;

/// Sizes of the habits; zero for none.
#[derive(Clone, Copy, Debug, Default)]
pub(crate) struct Habits {
    /// Part of the induced horizontal field that follows the heading with a lag of four to
    /// twelve hours, also alongside.
    pub(crate) retentive_share: f64,
    /// Step of bx and of by at each port call, standard deviation in nT; soft iron in
    /// proportion. The steps add up.
    pub(crate) load_step_nt: f64,
    /// Size of such steps between independent conditions, which do not add up.
    pub(crate) load_condition_nt: f64,
    /// Standard deviation of the list, which wanders over days.
    pub(crate) list_deg: f64,
    /// Athwartship field on a list of one radian.
    pub(crate) heeling_nt: f64,
    /// The samples carry the roll.
    pub(crate) has_roll_sensor: bool,
    /// The samples carry the course over ground: the heading, and the drift by wind and
    /// current.
    pub(crate) has_course_over_ground: bool,
    /// Angle times field at which the card sticks, redrawn at each turn.
    pub(crate) friction_deg_ut: f64,
    /// Standard deviation of the logarithm of the card's noise, by spells of weather.
    pub(crate) weather: f64,
    /// Scale of an error with three degrees of freedom in every sample.
    pub(crate) tails_deg: f64,
    /// Standard deviation of the references' constant errors; the gyro's grows with
    /// 1/cos(latitude).
    pub(crate) constant_deg: f64,
    /// Part of the gyro's speed error that is left in.
    pub(crate) speed_error_share: f64,
    /// Time constant with which the gyro's reading follows a turn.
    pub(crate) lag_minutes: f64,
    /// Error of the gyro that changes with the heading.
    pub(crate) heading_error_deg: f64,
    /// Error of the compass's zero from the first day.
    pub(crate) zero_off_deg: f64,
    /// Steps in which compass and references are read every minute.
    pub(crate) compass_digit_deg: f64,
    pub(crate) reference_digit_deg: f64,
    /// Steps of all samples: where a ship does not yaw, every reading of ten minutes is
    /// rounded alike.
    pub(crate) sample_digit_deg: f64,
}

/// State of the habits.
pub(super) struct HabitState {
    sizes: Habits,
    iron: Iron,
    instruments: Instruments,
    rng: ChaCha8Rng,
}

impl HabitState {
    pub(super) fn new(seed: u64, sizes: &Habits) -> HabitState {
        let mut rng = ChaCha8Rng::seed_from_u64(seed ^ STREAM);
        HabitState {
            sizes: *sizes,
            iron: Iron::new(&mut rng),
            instruments: Instruments::new(&mut rng),
            rng,
        }
    }

    pub(super) fn minute(&mut self, now: &Moment) {
        self.iron.minute(&self.sizes, now, &mut self.rng);
        self.instruments.minute(&self.sizes, now, &mut self.rng);
    }

    /// Returns the ship as her compass feels her in this minute.
    pub(super) fn felt(&self, truth: &Truth) -> Truth {
        let mut parameters = truth.parameters.to_array();
        let added = self.iron.added(&self.sizes);
        for (parameter, added) in parameters.iter_mut().zip(added) {
            *parameter += added;
        }
        Truth {
            parameters: Parameters::from_array(parameters),
            ..*truth
        }
    }

    /// Returns the factor on the card's noise.
    pub(super) fn card_noise(&self) -> f64 {
        self.instruments.card_noise(&self.sizes)
    }

    /// Returns the scatter of a sample's windows: the card's noise, and what few windows show of
    /// it.
    pub(super) fn spread_deg(&mut self) -> f64 {
        self.instruments.spread_deg(&self.sizes, &mut self.rng)
    }

    /// Returns the readings of compass, gyro and satellite compass with the habits' errors.
    pub(super) fn read(&self, now: &Moment, read: [f64; 3]) -> [f64; 3] {
        self.instruments.read(&self.sizes, now, read)
    }

    /// Returns readings in the digits of their instruments.
    pub(super) fn shown(&self, read: [f64; 3]) -> [f64; 3] {
        let [compass, gyro, satellite] = read;
        let digit_deg = self.sizes.reference_digit_deg;
        [
            instruments::rounded(compass, self.sizes.compass_digit_deg),
            instruments::rounded(gyro, digit_deg),
            instruments::rounded(satellite, digit_deg),
        ]
    }

    /// Returns the list, where it is measured.
    pub(super) fn measured_roll_deg(&self) -> Option<f64> {
        let roll_deg = self.iron.list_deg(&self.sizes);
        self.sizes.has_roll_sensor.then_some(roll_deg)
    }

    /// Returns the course over ground, where it is measured.
    pub(super) fn course_over_ground(&self, now: &Moment) -> Option<CourseOverGround> {
        let course = CourseOverGround::new(now.course_deg + self.instruments.drift_deg());
        course.filter(|_| self.sizes.has_course_over_ground)
    }

    /// Adds to whole samples what an agent's means cannot average.
    pub(super) fn finish(&mut self, samples: &mut [Sample]) {
        for sample in samples {
            instruments::finish(&self.sizes, sample, &mut self.rng);
        }
    }
}

/// A value that forgets its past over so many minutes, with a standard deviation of one.
#[derive(Clone, Copy)]
struct Wander {
    value: f64,
    minutes: f64,
}

impl Wander {
    fn new(minutes: f64, rng: &mut ChaCha8Rng) -> Wander {
        Wander {
            value: gauss(rng),
            minutes,
        }
    }

    fn minute(&mut self, rng: &mut ChaCha8Rng) {
        let keep = (-1.0 / self.minutes).exp();
        self.value = self.value * keep + (1.0 - keep * keep).sqrt() * gauss(rng);
    }
}
