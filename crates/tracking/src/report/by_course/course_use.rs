//! Numbers of samples by the use of their course over ground, and what is said of them.

use binnacle_analysis::readings::reading::Reading;
use binnacle_analysis::readings::steady_course::{LEAST_SOG_KN, mark_unsteady_courses};
use binnacle_compass::model::ReferenceGrade;
use binnacle_compass::result::{FitError, SampleReason};
use serde::{Deserialize, Serialize};

/// Numbers of samples by the use of their course over ground.
#[derive(Clone, Copy, Debug, Default, PartialEq, Serialize, Deserialize)]
pub(crate) struct CourseUse {
    readings: u64,
    too_slow: u64,
    turning: u64,
    /// Readings that are used, and the sum of the reciprocals of their speed over ground, hours a
    /// mile.
    used: u64,
    hours: f64,
}

impl CourseUse {
    /// Marks the readings of a grade whose course over ground shows no heading, and counts them;
    /// none where the ship has a heading reference.
    pub(crate) fn mark(grade: ReferenceGrade, readings: &mut [Reading]) -> Option<CourseUse> {
        if grade == ReferenceGrade::Heading {
            return None;
        }
        mark_unsteady_courses(readings);
        Some(CourseUse::of(readings))
    }

    /// Counts marked readings.
    pub(crate) fn of(readings: &[Reading]) -> CourseUse {
        let mut counted = CourseUse::default();
        for reading in readings {
            counted.readings += 1;
            match reading.diagnostic.reason {
                Some(SampleReason::TooSlowForCourse) => counted.too_slow += 1,
                Some(SampleReason::TurningCourse) => counted.turning += 1,
                Some(_) => {}
                None => {
                    if let Some(sog_kn) = reading.sample().sog_kn {
                        counted.used += 1;
                        counted.hours += 1.0 / sog_kn.max(LEAST_SOG_KN);
                    }
                }
            }
        }
        counted
    }

    /// Adds later readings.
    pub(crate) fn append(&mut self, later: &CourseUse) {
        self.readings += later.readings;
        self.too_slow += later.too_slow;
        self.turning += later.turning;
        self.used += later.used;
        self.hours += later.hours;
    }

    /// Returns the mean reciprocal of the speed over ground of the readings that are used, hours
    /// a mile.
    pub(super) fn hours_per_nm(self) -> f64 {
        self.hours / self.used.max(1) as f64
    }

    /// Returns the refusal of a model from too few readings.
    pub(crate) fn refusal(self, found: u64, needed: u64) -> FitError {
        FitError::NoSteadyCourse {
            readings: self.readings,
            found,
            needed,
            too_slow: self.too_slow,
            turning: self.turning,
            least_sog_kn: LEAST_SOG_KN,
        }
    }

    /// Returns the notice of the grade.
    pub(crate) fn notice(self) -> String {
        format!(
            "no sample has a heading by gyro or satellite compass: the course over ground on \
             straight runs stands for it, and the band allows for current and leeway. Of {} \
             samples {} are slower than {LEAST_SOG_KN} knots and {} lie in a turn or just after \
             one: they are not used",
            self.readings, self.too_slow, self.turning
        )
    }
}
