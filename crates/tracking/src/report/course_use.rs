//! Use of the course over ground on a ship without gyro and satellite compass.

use crate::state_space::ship_state::ShipState;
use crate::state_space::states::{BX, BY};
use binnacle_analysis::analyse::reading::Reading;
use binnacle_analysis::analyse::steady_course::LEAST_SOG_KN;
use binnacle_compass::model::ReferenceGrade;
use binnacle_compass::result::{FitError, SampleReason};

/// Component of a set that lasts for months beside the season's in the model, knots: of trade
/// winds and coastal streams on a ship's one route.
const LASTING_SET_KN: f64 = 0.25;

/// Numbers of samples by the use of their course over ground.
#[derive(Clone, Copy, Debug)]
pub(super) struct CourseUse {
    readings: u64,
    too_slow: u64,
    turning: u64,
    /// Mean reciprocal of the speed over ground of the rows that are used, hours a mile.
    hours_per_nm: f64,
}

impl CourseUse {
    /// Counts the readings of a grade; none where the ship has a heading reference.
    pub(super) fn count(grade: ReferenceGrade, readings: &[Reading]) -> Option<CourseUse> {
        let of = |reason: SampleReason| {
            let same = readings
                .iter()
                .filter(|r| r.diagnostic.reason == Some(reason));
            same.count() as u64
        };
        (grade == ReferenceGrade::CourseOverGround).then(|| CourseUse {
            readings: readings.len() as u64,
            too_slow: of(SampleReason::TooSlowForCourse),
            turning: of(SampleReason::TurningCourse),
            hours_per_nm: hours_per_nm(readings),
        })
    }

    /// Returns the ship with the uncertainty of a set that lasts as long as her samples: it shows
    /// as deviation by permanent magnetism, and nothing tells the two apart.
    pub(super) fn widen(self, ship: &ShipState, h_nt: f64) -> ShipState {
        let mut ship = ship.clone();
        let variance_nt2 = (LASTING_SET_KN * self.hours_per_nm * h_nt).powi(2);
        for permanent in [BX, BY] {
            ship.covariance[permanent][permanent] += variance_nt2;
        }
        ship
    }

    /// Returns the refusal of a model from too few readings.
    pub(super) fn refusal(self, found: u64, needed: u64) -> FitError {
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
    pub(super) fn notice(self) -> String {
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
