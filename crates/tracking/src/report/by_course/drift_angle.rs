//! Uncertainty of the course over ground as a heading: the drift angle by current and wind.

use super::course_use::CourseUse;
use crate::hypotheses::starts::CRAB_DEG;
use crate::state_space::levels::{Level, Levels};
use crate::state_space::ship_state::ShipState;
use crate::state_space::states::{BX, BY};
use crate::state_space::transition::STEADY_KN;

/// Component of a set that lasts for months beside the season's in the model, knots: of trade
/// winds and coastal streams on a ship's one route.
const LASTING_SET_KN: f64 = 0.25;

impl CourseUse {
    /// Returns the ship with the uncertainty of a set that lasts as long as her samples: it shows
    /// as deviation by permanent magnetism, and nothing tells the two apart.
    pub(crate) fn widen(self, ship: &ShipState, h_nt: f64) -> ShipState {
        let mut ship = ship.clone();
        let variance_nt2 = (LASTING_SET_KN * self.hours_per_nm() * h_nt).powi(2);
        for permanent in [BX, BY] {
            ship.covariance[permanent][permanent] += variance_nt2;
        }
        ship
    }

    /// Returns the standard deviation of the drift angle about its constant, degrees.
    pub(crate) fn drift_angle_deg(self, levels: &Levels) -> f64 {
        let [current, leeway] = [Level::Current, Level::Leeway].map(|level| levels.at(level));
        (current.hypot(leeway).hypot(STEADY_KN) * self.hours_per_nm()).to_degrees()
    }
}

/// Returns the standard deviation of the constant error of a course as a heading, degrees, from
/// that of a reference.
pub(crate) fn constant_sd_deg(reference_sd_deg: f64) -> f64 {
    CRAB_DEG.hypot(reference_sd_deg)
}
