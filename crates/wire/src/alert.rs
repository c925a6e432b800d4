//! The alert that a ship raises herself: compass and reference have parted.
//!
//! What always holds: an alert keeps its id for life, and its revision rises with
//! each change. Whoever gets revisions in another order keeps the highest.

use binnacle_compass::time::Timestamp;
use serde::{Deserialize, Serialize};
use uuid::Uuid;

/// What the ship says of her own alert, whole, in each revision.
///
/// A departure is the heading that the compass gives by its model less that of the
/// reference, both true, as the mean of some settled minutes; none where the
/// reference gave nothing. Times are whole seconds, angles tenths of a degree.
#[derive(Clone, Copy, Debug, PartialEq, Serialize, Deserialize)]
pub struct ShipAlert {
    /// Made on board.
    pub id: Uuid,
    /// From 1.
    pub revision: u32,
    /// Whether it goes on.
    pub state: ShipAlertState,
    /// When they parted, by the ship's time.
    pub since: Timestamp,
    /// When this revision was made, by the ship's time.
    pub at: Timestamp,
    /// The gyro's.
    pub gyro_departure_deg: Option<f64>,
    /// The satellite compass's.
    pub satellite_departure_deg: Option<f64>,
    /// A departure beyond this raised it.
    pub limit_deg: f64,
    /// The model that corrected the compass.
    pub model_version: u32,
}

/// Whether a ship's alert goes on.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Serialize, Deserialize)]
#[serde(rename_all = "snake_case")]
pub enum ShipAlertState {
    /// They are apart.
    Open,
    /// They agree again.
    Agree,
    /// Nobody can tell any more: the card was withdrawn, or there is another.
    NotJudged,
}

/// Which instrument the two others speak against.
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
    /// The departure that both ends speak of: from the gyro, or from the satellite compass
    /// where the gyro gave nothing, or bears out the compass.
    pub fn departure_deg(&self) -> f64 {
        let (first, second) = if self.is_of_satellite() {
            (self.satellite_departure_deg, self.gyro_departure_deg)
        } else {
            (self.gyro_departure_deg, self.satellite_departure_deg)
        };
        first.or(second).unwrap_or_default()
    }

    /// What the compass departed from by that.
    pub fn reference(&self) -> &'static str {
        if self.is_of_satellite() {
            "satellite compass"
        } else {
            "gyro"
        }
    }

    fn is_of_satellite(&self) -> bool {
        self.gyro_departure_deg.is_none() || self.suspect() == Suspect::Satellite
    }

    /// What the references say of each other: the two that lie nearest bear each other out, if
    /// the third is far from both.
    pub fn suspect(&self) -> Suspect {
        let Some([gyro, satellite, between]) = self.sides_deg() else {
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

    /// How far compass and gyro, compass and satellite compass, and both references lie apart.
    fn sides_deg(&self) -> Option<[f64; 3]> {
        let (gyro, satellite) = (self.gyro_departure_deg?, self.satellite_departure_deg?);
        // Headings may be apart either way round.
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
    fn two_that_agree_speak_against_the_third() {
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
        let said = |gyro, satellite| {
            let alert = alert(gyro, satellite);
            (alert.departure_deg(), alert.reference())
        };
        assert_eq!(said(Some(-6.2), Some(-7.2)), (-6.2, "gyro"));
        assert_eq!(said(None, Some(-7.2)), (-7.2, "satellite compass"));
        assert_eq!(said(Some(0.2), Some(-7.2)), (-7.2, "satellite compass"));
    }
}
