//! Positions on the earth.

use crate::number::CompactNumber;
use serde::{Deserialize, Serialize};

/// A geodetic position (WGS 84): latitude in [−90°, 90°], north positive, and
/// longitude in [−180°, 180°), east positive.
#[derive(Clone, Copy, Debug, PartialEq, Serialize, Deserialize)]
#[cfg_attr(feature = "openapi", derive(utoipa::ToSchema))]
#[serde(try_from = "RawPosition", into = "RawPosition")]
pub struct Position {
    /// Latitude, degrees, north positive.
    #[cfg_attr(feature = "openapi", schema(rename = "lat"))]
    lat_deg: f64,
    /// Longitude, degrees, east positive.
    #[cfg_attr(feature = "openapi", schema(rename = "lon"))]
    lon_deg: f64,
}

/// Error of two numbers that are not a position.
#[derive(Clone, Copy, Debug, PartialEq, thiserror::Error)]
pub enum PositionError {
    /// Latitude is NaN, infinite or beyond a pole.
    #[error("latitude {} is not within -90 to 90 degrees", CompactNumber(*.0))]
    Latitude(f64),
    /// Longitude is NaN, infinite or beyond half a turn.
    #[error("longitude {} is not within -180 to 180 degrees", CompactNumber(*.0))]
    Longitude(f64),
}

#[derive(Serialize, Deserialize)]
struct RawPosition {
    lat: f64,
    lon: f64,
}

impl Position {
    /// Makes a position from degrees north and degrees east (−180 to 180; 180 becomes
    /// −180).
    ///
    /// # Errors
    /// Fails when either number is not finite or out of range.
    pub fn new(lat_deg: f64, lon_deg: f64) -> Result<Position, PositionError> {
        if !(-90.0..=90.0).contains(&lat_deg) {
            return Err(PositionError::Latitude(lat_deg));
        }
        if !(-180.0..=180.0).contains(&lon_deg) {
            return Err(PositionError::Longitude(lon_deg));
        }
        let lon_deg = if lon_deg < 180.0 { lon_deg } else { -180.0 };
        Ok(Position { lat_deg, lon_deg })
    }

    /// Degrees north of the equator.
    pub fn lat_deg(self) -> f64 {
        self.lat_deg
    }

    /// Degrees east of Greenwich.
    pub fn lon_deg(self) -> f64 {
        self.lon_deg
    }
}

impl TryFrom<RawPosition> for Position {
    type Error = PositionError;
    fn try_from(raw: RawPosition) -> Result<Position, PositionError> {
        Position::new(raw.lat, raw.lon)
    }
}

impl From<Position> for RawPosition {
    fn from(position: Position) -> RawPosition {
        RawPosition {
            lat: position.lat_deg,
            lon: position.lon_deg,
        }
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn a_latitude_of_95_is_refused_by_name() {
        assert_eq!(Position::new(95.0, 0.0), Err(PositionError::Latitude(95.0)));
        assert!(matches!(
            Position::new(0.0, f64::NAN),
            Err(PositionError::Longitude(_))
        ));
        assert!(matches!(
            Position::new(f64::NAN, 0.0),
            Err(PositionError::Latitude(_))
        ));
    }

    #[test]
    fn the_antimeridian_has_one_name() {
        assert_eq!(
            Position::new(10.0, 180.0).unwrap(),
            Position::new(10.0, -180.0).unwrap()
        );
    }
}
