//! Numbers of samples by the use of their course over ground, and what is said of them.

use binnacle_analysis::readings::reading::Reading;
use binnacle_analysis::readings::steady_course::{LEAST_SOG_KN, mark_unsteady_courses};
use binnacle_compass::model::ReferenceGrade;
use binnacle_compass::result::{FitError, SampleReason};

/// Numbers of samples by the use of their course over ground.
#[derive(Clone, Copy, Debug)]
pub(crate) struct CourseUse {
    readings: u64,
    too_slow: u64,
    turning: u64,
    /// Mean reciprocal of the speed over ground of the rows that are used, hours a mile.
    pub(super) hours_per_nm: f64,
}

impl CourseUse {
    /// Marks the readings of a grade whose course over ground shows no heading, and counts them;
    /// none where the ship has a heading reference.
    pub(crate) fn mark(grade: ReferenceGrade, readings: &mut [Reading]) -> Option<CourseUse> {
        if grade == ReferenceGrade::Heading {
            return None;
        }
        mark_unsteady_courses(readings);
        let of = |reason: SampleReason| {
            let same = readings
                .iter()
                .filter(|r| r.diagnostic.reason == Some(reason));
            same.count() as u64
        };
        Some(CourseUse {
            readings: readings.len() as u64,
            too_slow: of(SampleReason::TooSlowForCourse),
            turning: of(SampleReason::TurningCourse),
            hours_per_nm: hours_per_nm(readings),
        })
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

fn hours_per_nm(readings: &[Reading]) -> f64 {
    let used = readings.iter().filter(|r| r.diagnostic.reason.is_none());
    let hours: Vec<f64> = used
        .filter_map(|r| Some(1.0 / r.sample().sog_kn?.max(LEAST_SOG_KN)))
        .collect();
    hours.iter().sum::<f64>() / hours.len().max(1) as f64
}
