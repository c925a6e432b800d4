//! The shipboard alert: compass and reference differ by more than the limit.
//!
//! Invariants: an alert keeps its id for life, and its revision rises with each
//! change. A receiver of revisions out of order keeps the highest.

use binnacle_compass::time::Timestamp;
use serde::{Deserialize, Serialize};
use uuid::Uuid;

/// The vessel's own alert, complete in each revision.
///
/// A departure is the true heading from the compass by its model, less the
/// reference's true heading. It is the mean of some settled minutes, and `None`
/// where the reference gave no data. Times are whole seconds, angles tenths of
/// a degree.
#[derive(Clone, Copy, Debug, PartialEq, Serialize, Deserialize)]
pub struct ShipAlert {
    /// Id, made on board.
    pub id: Uuid,
    /// Revision, from 1.
    pub revision: u32,
    /// State of the alert in this revision.
    pub state: ShipAlertState,
    /// Start of the departure, by the ship's time.
    pub since: Timestamp,
    /// Time of this revision, by the ship's time.
    pub at: Timestamp,
    /// Departure from the gyro.
    pub gyro_departure_deg: Option<f64>,
    /// Departure from the satellite compass.
    pub satellite_departure_deg: Option<f64>,
    /// Limit that the departure exceeded.
    pub limit_deg: f64,
    /// Version of the model that corrected the compass.
    pub model_version: u32,
}

/// State of a shipboard alert.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Serialize, Deserialize)]
#[serde(rename_all = "snake_case")]
pub enum ShipAlertState {
    /// The departure lasts.
    Open,
    /// Compass and reference agree again.
    Agree,
    /// No longer judged: the card was withdrawn or replaced.
    NotJudged,
}

/// The instrument that disagrees with the two others.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Suspect {
    /// Gyro and satellite compass agree with each other.
    Compass,
    /// Compass and satellite compass agree.
    Gyro,
    /// Compass and gyro agree.
    Satellite,
    /// There is one reference only, or all three are apart.
    Unknown,
}

impl ShipAlert {
    /// The departure to report: from the gyro, or from the satellite compass
    /// where the gyro gave no data or the satellite compass is the suspect.
    pub fn departure_deg(&self) -> f64 {
        let (first, second) = if self.reports_satellite() {
            (self.satellite_departure_deg, self.gyro_departure_deg)
        } else {
            (self.gyro_departure_deg, self.satellite_departure_deg)
        };
        first.or(second).unwrap_or_default()
    }

    /// The reference of [`ShipAlert::departure_deg`].
    pub fn reference(&self) -> &'static str {
        if self.reports_satellite() {
            "satellite compass"
        } else {
            "gyro"
        }
    }

    fn reports_satellite(&self) -> bool {
        self.gyro_departure_deg.is_none() || self.suspect() == Suspect::Satellite
    }

    /// The instrument that the two others contradict: those two must lie near
    /// each other, and the third far from both.
    pub fn suspect(&self) -> Suspect {
        let Some([gyro, satellite, between]) = self.differences_deg() else {
            return Suspect::Unknown;
        };
        let is_pair = |near: f64, [one, other]: [f64; 2]| {
            let nearer = one.min(other);
            near <= self.limit_deg
                && one.max(other) > self.limit_deg
                && nearer > self.limit_deg / 2.0
                && nearer >= 2.0 * near
        };
        if is_pair(between, [gyro, satellite]) {
            Suspect::Compass
        } else if is_pair(satellite, [gyro, between]) {
            Suspect::Gyro
        } else if is_pair(gyro, [satellite, between]) {
            Suspect::Satellite
        } else {
            Suspect::Unknown
        }
    }

    /// Absolute differences: compass and gyro, compass and satellite compass,
    /// gyro and satellite compass.
    fn differences_deg(&self) -> Option<[f64; 3]> {
        let (gyro, satellite) = (self.gyro_departure_deg?, self.satellite_departure_deg?);
        // Differences of headings wrap round the circle.
        let between = (gyro - satellite + 180.0).rem_euclid(360.0) - 180.0;
        Some([gyro, satellite, between].map(f64::abs))
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    fn alert(gyro: Option<f64>, satellite: Option<f64>) -> ShipAlert {
        let at = Timestamp::parse("2026-11-21T07:00:00Z").unwrap();
        ShipAlert {
            id: Uuid::from_u128(1),
            revision: 1,
            state: ShipAlertState::Open,
            since: at,
            at,
            gyro_departure_deg: gyro,
            satellite_departure_deg: satellite,
            limit_deg: 3.0,
            model_version: 1,
        }
    }

    #[test]
    fn two_that_agree_contradict_the_third() {
        for (gyro, satellite, suspect) in [
            (Some(8.0), Some(7.0), Suspect::Compass),
            (Some(8.0), Some(0.5), Suspect::Gyro),
            (Some(-0.5), Some(-8.0), Suspect::Satellite),
            (Some(8.0), Some(-8.0), Suspect::Unknown),
            (Some(179.5), Some(-179.5), Suspect::Compass),
            // The third lies about the limit from the second.
            (Some(3.1), Some(0.3), Suspect::Gyro),
            (Some(3.1), Some(2.8), Suspect::Compass),
            (Some(3.1), Some(1.6), Suspect::Unknown),
            (Some(8.0), None, Suspect::Unknown),
            (None, None, Suspect::Unknown),
        ] {
            let alert = alert(gyro, satellite);
            assert_eq!(alert.suspect(), suspect, "{gyro:?} {satellite:?}");
        }
    }

    #[test]
    fn the_departure_is_from_the_gyro_where_there_is_one() {
        let reported = |gyro, satellite| {
            let alert = alert(gyro, satellite);
            (alert.departure_deg(), alert.reference())
        };
        assert_eq!(reported(Some(-6.2), Some(-7.2)), (-6.2, "gyro"));
        assert_eq!(reported(None, Some(-7.2)), (-7.2, "satellite compass"));
        assert_eq!(reported(Some(0.2), Some(-7.2)), (-7.2, "satellite compass"));
    }
}
