//! Observation as it is written: in requests, messages and storage.

use crate::time::Timestamp;
use serde::{Deserialize, Serialize};

/// Observation of a compass error, field by field, before it is checked.
///
/// A bearing is taken with the compass or with a gyro repeater, or with both. Fields that
/// the kind does not use are absent.
#[derive(Clone, Debug, PartialEq, Serialize, Deserialize)]
#[cfg_attr(feature = "openapi", derive(utoipa::ToSchema))]
#[cfg_attr(feature = "openapi", schema(as = AzimuthObservation))]
pub struct AzimuthForm {
    /// Time of the bearing, to the second.
    pub time: Timestamp,
    /// Degrees north.
    #[cfg_attr(feature = "openapi", schema(minimum = -90, maximum = 90, example = 43.4))]
    pub lat: f64,
    /// Degrees east.
    #[cfg_attr(feature = "openapi", schema(minimum = -180, maximum = 180, example = -3.1))]
    pub lon: f64,
    /// Object of the bearing.
    pub kind: AzimuthKind,
    /// Raw heading of the magnetic compass in that moment, degrees.
    #[cfg_attr(
        feature = "openapi",
        schema(minimum = 0, maximum = 360, example = 92.4)
    )]
    pub compass_heading_deg: f64,
    /// Bearing by the magnetic compass, degrees.
    #[serde(default)]
    #[cfg_attr(
        feature = "openapi",
        schema(minimum = 0, maximum = 360, example = 118.5)
    )]
    pub compass_bearing_deg: Option<f64>,
    /// Heading of the gyro in that moment, degrees.
    #[serde(default)]
    #[cfg_attr(
        feature = "openapi",
        schema(minimum = 0, maximum = 360, example = 95.0)
    )]
    pub gyro_heading_deg: Option<f64>,
    /// Bearing by a gyro repeater, degrees.
    #[serde(default)]
    #[cfg_attr(feature = "openapi", schema(minimum = 0, maximum = 360))]
    pub gyro_bearing_deg: Option<f64>,
    /// Part of the sun on the horizon, for the sun by amplitude.
    #[serde(default)]
    pub horizon: Option<HorizonSight>,
    /// Height of eye above the water, metres, for the sun on the visible horizon.
    #[serde(default)]
    #[cfg_attr(feature = "openapi", schema(minimum = 0, maximum = 100, example = 24))]
    pub height_of_eye_m: Option<f64>,
    /// Name of the body, the transit or the quay.
    #[serde(default)]
    #[cfg_attr(feature = "openapi", schema(max_length = 100, example = "Vega"))]
    pub name: Option<String>,
    /// True bearing of the body or the transit; for a quay, true heading of the vessel
    /// alongside.
    #[serde(default)]
    #[cfg_attr(feature = "openapi", schema(minimum = 0, maximum = 360))]
    pub true_bearing_deg: Option<f64>,
    /// Altitude of the body, degrees, if known.
    #[serde(default)]
    #[cfg_attr(feature = "openapi", schema(minimum = 0, maximum = 90))]
    pub altitude_deg: Option<f64>,
    /// Confirmation of values that were questioned.
    #[serde(default)]
    #[cfg_attr(feature = "openapi", schema(default = false))]
    pub confirmed: bool,
}

/// Object of a bearing.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Hash, Serialize, Deserialize)]
#[cfg_attr(feature = "openapi", derive(utoipa::ToSchema))]
#[serde(rename_all = "snake_case")]
pub enum AzimuthKind {
    /// The sun at any altitude: its true bearing is computed from time and place.
    SunAzimuth,
    /// The sun at the horizon: its true bearing is computed from latitude and date.
    SunAmplitude,
    /// Another body, by a true bearing from an almanac.
    Body,
    /// Two charted marks in line, by the chart's true bearing.
    Transit,
    /// Alongside a charted quay: the vessel's true heading by the chart.
    Quay,
}

/// Part of the sun on the horizon in the moment of the bearing.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Hash, Serialize, Deserialize)]
#[cfg_attr(feature = "openapi", derive(utoipa::ToSchema))]
#[serde(rename_all = "snake_case")]
pub enum HorizonSight {
    /// The centre on the celestial horizon: the lower limb two thirds of a diameter above
    /// the visible one.
    Celestial,
    /// The upper limb on the visible horizon.
    UpperLimb,
    /// The lower limb on the visible horizon.
    LowerLimb,
    /// The centre on the visible horizon.
    Centre,
}

impl AzimuthKind {
    /// True when the true bearing is typed, not computed.
    pub fn is_typed(self) -> bool {
        !matches!(self, AzimuthKind::SunAzimuth | AzimuthKind::SunAmplitude)
    }

    /// Description of the object within a sentence.
    pub fn description(self) -> &'static str {
        match self {
            AzimuthKind::SunAzimuth => "sun by azimuth",
            AzimuthKind::SunAmplitude => "sun by amplitude",
            AzimuthKind::Body => "body",
            AzimuthKind::Transit => "transit",
            AzimuthKind::Quay => "quay",
        }
    }
}
