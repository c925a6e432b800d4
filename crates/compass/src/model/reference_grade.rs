//! Grade of a model by the source of its true headings.

use crate::sample::Sample;
use serde::{Deserialize, Serialize};

/// Source of the true headings behind a model.
///
/// A vessel has one grade: a single heading by gyro or satellite compass is worth more than any
/// number of courses over ground.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq, Serialize, Deserialize)]
#[cfg_attr(feature = "openapi", derive(utoipa::ToSchema))]
#[serde(rename_all = "snake_case")]
pub enum ReferenceGrade {
    /// Gyro or satellite compass.
    #[default]
    Heading,
    /// Course over ground on straight runs, less an estimated drift by current and wind. The
    /// band is several degrees wide.
    CourseOverGround,
}

impl ReferenceGrade {
    /// Returns the grade of a vessel by all samples of a compass: that of course over ground if
    /// none has a heading by gyro or satellite compass, and some have a course.
    pub fn of(samples: &[Sample]) -> ReferenceGrade {
        let mut directions = Directions::default();
        directions.note(samples);
        directions.grade()
    }

    /// Returns true for gyro or satellite compass.
    // By reference, as serde calls it.
    #[allow(clippy::trivially_copy_pass_by_ref)]
    pub fn is_heading(&self) -> bool {
        *self == ReferenceGrade::Heading
    }
}

/// Kinds of directions that samples have.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq, Serialize, Deserialize)]
pub struct Directions {
    heading: bool,
    course: bool,
}

impl Directions {
    /// Notes those of samples.
    pub fn note(&mut self, samples: &[Sample]) {
        for sample in samples {
            self.heading |= sample.gyro.or(sample.satellite).is_some();
            self.course |= sample.cog.is_some();
        }
    }

    /// Returns the grade of a vessel by all of them.
    pub fn grade(self) -> ReferenceGrade {
        if self.heading || !self.course {
            ReferenceGrade::Heading
        } else {
            ReferenceGrade::CourseOverGround
        }
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::angle::{CompassHeading, CourseOverGround, TrueHeading};
    use crate::position::Position;
    use crate::time::Timestamp;

    fn bare() -> Sample {
        let time = Timestamp::parse("2026-11-21T07:00:00Z").unwrap();
        let position = Position::new(43.0, -3.0).unwrap();
        Sample::new(time, position, CompassHeading::new(91.0).unwrap())
    }

    #[test]
    fn one_heading_among_courses_makes_the_grade_heading() {
        let course = Sample {
            cog: CourseOverGround::new(92.5),
            ..bare()
        };
        let gyro = Sample {
            gyro: TrueHeading::new(90.0),
            ..course
        };
        let grade = ReferenceGrade::of;
        assert_eq!(grade(&[course, course]), ReferenceGrade::CourseOverGround);
        assert_eq!(grade(&[course, gyro, course]), ReferenceGrade::Heading);
        assert_eq!(grade(&[bare()]), ReferenceGrade::Heading);
    }
}
