//! Values beside the headings of a window: course over ground, roll, temperature.
//!
//! Implausible values are ignored. A value without a reading is absent, never zero.

use binnacle_compass::angle::CourseOverGround;
use std::ops::RangeInclusive;

/// Plausible ranges.
const ROLL_DEG: RangeInclusive<f64> = -90.0..=90.0;
const TEMPERATURE_C: RangeInclusive<f64> = -60.0..=90.0;

/// Values beside the headings of one window.
#[derive(Clone, Copy, Debug, Default, PartialEq)]
pub(crate) struct Details {
    pub(super) cog: Option<CourseOverGround>,
    pub(super) roll: Option<Roll>,
    pub(super) temperature_c: Option<f64>,
}

impl Details {
    pub(super) fn has_course(&self) -> bool {
        self.cog.is_some()
    }
}

/// Roll in one window. The mean square gives the spread over several windows.
#[derive(Clone, Copy, Debug, PartialEq)]
pub(super) struct Roll {
    pub(super) mean_deg: f64,
    pub(super) mean_square_deg2: f64,
}

/// Readings of the open window.
#[derive(Clone, Copy, Debug, Default)]
pub(super) struct DetailReadings {
    course: DirectionMean,
    roll: Mean,
    roll_square: Mean,
    temperature: Mean,
}

impl DetailReadings {
    /// Adds a course over ground.
    pub(super) fn add_course(&mut self, course: CourseOverGround) {
        self.course.add(course);
    }

    /// Adds a roll in degrees.
    pub(super) fn add_roll(&mut self, degrees: f64) {
        if ROLL_DEG.contains(&degrees) {
            self.roll.add(degrees);
            self.roll_square.add(degrees * degrees);
        }
    }

    /// Adds a temperature in degrees Celsius.
    pub(super) fn add_temperature(&mut self, celsius: f64) {
        if TEMPERATURE_C.contains(&celsius) {
            self.temperature.add(celsius);
        }
    }

    /// Returns the means so far.
    pub(super) fn means(&self) -> Details {
        let roll = self.roll.mean().zip(self.roll_square.mean());
        Details {
            cog: self.course.mean(),
            roll: roll.map(|(mean_deg, mean_square_deg2)| Roll {
                mean_deg,
                mean_square_deg2,
            }),
            temperature_c: self.temperature.mean(),
        }
    }
}

/// Mean of numbers.
#[derive(Clone, Copy, Debug, Default)]
pub(super) struct Mean {
    sum: f64,
    count: u32,
}

impl Mean {
    /// Adds a number.
    pub(super) fn add(&mut self, value: f64) {
        self.sum += value;
        self.count += 1;
    }

    /// Returns the mean; `None` of no numbers.
    pub(super) fn mean(&self) -> Option<f64> {
        (self.count > 0).then(|| self.sum / f64::from(self.count))
    }
}

/// Direction of the sum of unit vectors: the mean of directions anywhere on the circle.
#[derive(Clone, Copy, Debug, Default)]
pub(super) struct DirectionMean {
    north: f64,
    east: f64,
    count: u32,
}

impl DirectionMean {
    /// Adds a direction.
    pub(super) fn add(&mut self, course: CourseOverGround) {
        let (east, north) = course.radians().sin_cos();
        self.east += east;
        self.north += north;
        self.count += 1;
    }

    /// Returns the mean; `None` of no directions, and of directions that cancel out.
    pub(super) fn mean(&self) -> Option<CourseOverGround> {
        // Rounding leaves some 1e-16 of each vector.
        if self.north.hypot(self.east) <= 1e-9 * f64::from(self.count) {
            return None;
        }
        CourseOverGround::new(self.east.atan2(self.north).to_degrees())
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    fn course(degrees: f64) -> CourseOverGround {
        CourseOverGround::new(degrees).unwrap()
    }

    #[test]
    fn courses_on_either_side_of_north_have_a_northerly_mean() {
        let mut readings = DetailReadings::default();
        for degrees in [358.0, 0.0, 359.0, 7.0] {
            readings.add_course(course(degrees));
        }
        let mean = readings.means().cog.unwrap().degrees();
        assert!((mean - 1.0).abs() < 0.01, "{mean}");
    }

    #[test]
    fn opposite_courses_have_no_mean() {
        let mut readings = DetailReadings::default();
        readings.add_course(course(90.0));
        readings.add_course(course(270.0));
        assert_eq!(readings.means().cog, None);
    }

    #[test]
    fn implausible_values_are_ignored_and_nothing_is_nothing() {
        let mut readings = DetailReadings::default();
        for wrong in [f64::NAN, f64::INFINITY, -91.0, 91.0] {
            readings.add_roll(wrong);
            readings.add_temperature(wrong);
        }
        assert_eq!(readings.means(), Details::default());
    }
}
