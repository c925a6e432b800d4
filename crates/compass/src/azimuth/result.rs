//! Compass error and gyro error of an observation.

use super::error::{AzimuthError, AzimuthProblem};
use super::form::HorizonSight;
use super::horizon::{amplitude, centre_altitude_deg};
use super::readings::{Bearing, Readings, Target};
use super::sun::{Sun, sun_at};
use crate::angle::{CompassError, Deviation, GyroError, TrueBearing, TrueHeading, Variation};
use crate::field::{FieldModel, field};
use serde::Serialize;

/// Standard error of a bearing by azimuth circle, degrees: a practised observer reads to
/// half a degree or a little more.
const READING_DEG: f64 = 0.6;
/// Tilt of the azimuth circle across the line of sight, degrees, standard deviation. It
/// turns the bearing by its product with tan(altitude).
const CIRCLE_TILT_DEG: f64 = 0.6;
/// Standard error of a heading by a quay's charted direction, degrees.
const QUAY_DEG: f64 = 0.5;
/// Lowest altitude of the sun's centre, degrees, at which a part of it can be seen: 16′ of
/// semi-diameter, 34′ of refraction and 14′ of dip, with room for unusual refraction.
const LOWEST_ALTITUDE_DEG: f64 = -1.5;
/// Greatest distance of the sun from the horizon, degrees, in a sight by amplitude: some
/// twelve minutes of time in the tropics.
const NEAR_HORIZON_DEG: f64 = 3.0;

/// Result of an observation. Errors are true less indicated, degrees, east positive.
#[derive(Clone, Debug, PartialEq, Serialize)]
#[cfg_attr(feature = "openapi", derive(utoipa::ToSchema))]
pub struct AzimuthResult {
    /// True bearing of the object; for a quay, true heading of the vessel.
    #[cfg_attr(feature = "openapi", schema(value_type = f64, example = 121.3))]
    pub true_bearing_deg: TrueBearing,
    /// Altitude of the body's centre without refraction; none for a mark on land.
    #[cfg_attr(feature = "openapi", schema(required, example = 18.2))]
    pub altitude_deg: Option<f64>,
    /// Compass error: true less compass.
    #[cfg_attr(feature = "openapi", schema(value_type = f64, example = 2.8))]
    pub compass_error_deg: CompassError,
    /// Variation at that place and time, by IGRF-14.
    #[cfg_attr(feature = "openapi", schema(value_type = f64, example = 0.4))]
    pub variation_deg: Variation,
    /// Deviation: compass error less variation.
    #[cfg_attr(feature = "openapi", schema(value_type = f64, example = 2.4))]
    pub deviation_deg: Deviation,
    /// Gyro error: true less gyro; none when no reading of the gyro is given.
    #[cfg_attr(feature = "openapi", schema(required, value_type = Option<f64>, example = 0.2))]
    pub gyro_error_deg: Option<GyroError>,
    /// True heading of the vessel: compass heading plus compass error.
    #[cfg_attr(feature = "openapi", schema(value_type = f64, example = 95.2))]
    pub true_heading_deg: TrueHeading,
    /// Standard error of these errors, degrees.
    #[cfg_attr(feature = "openapi", schema(example = 0.6))]
    pub standard_error_deg: f64,
    /// Reasons for caution.
    pub cautions: Vec<AzimuthCaution>,
}

/// Reason for caution with an observation.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Serialize)]
#[cfg_attr(feature = "openapi", derive(utoipa::ToSchema))]
#[serde(rename_all = "snake_case")]
pub enum AzimuthCaution {
    /// The body is so high that the azimuth circle's tilt spoils the bearing more than its
    /// reading does.
    HighAltitude,
    /// The sun moves so nearly along the horizon that its amplitude depends on the
    /// refraction.
    GrazingHorizon,
    /// Steel of the berth may deflect the compass: the gyro is checked, not the compass.
    Alongside,
}

/// Bearing of the object and its quality.
struct Sighted {
    bearing: TrueBearing,
    altitude_deg: Option<f64>,
    standard_error_deg: f64,
    caution: Option<AzimuthCaution>,
}

/// Errors of both instruments, and the heading that they agree on.
struct Errors {
    compass: CompassError,
    gyro: Option<GyroError>,
    heading: TrueHeading,
}

/// Works out the errors.
pub(super) fn work_out(readings: &Readings) -> Result<AzimuthResult, AzimuthError> {
    let model = FieldModel::Igrf14;
    let variation = field(model, readings.position, 0.0, readings.time)
        .map_err(|error| AzimuthError::new("time", error))?
        .declination();
    let sighted = sight(readings)?;
    let errors = errors(readings, sighted.bearing);
    Ok(AzimuthResult {
        true_bearing_deg: sighted.bearing,
        altitude_deg: sighted.altitude_deg,
        compass_error_deg: errors.compass,
        variation_deg: variation,
        deviation_deg: errors.compass - variation,
        gyro_error_deg: errors.gyro,
        true_heading_deg: errors.heading,
        standard_error_deg: sighted.standard_error_deg,
        cautions: sighted.caution.into_iter().collect(),
    })
}

fn sight(readings: &Readings) -> Result<Sighted, AzimuthError> {
    match readings.target {
        Target::SunAzimuth => {
            let sun = sun(readings)?;
            if sun.altitude_deg < LOWEST_ALTITUDE_DEG {
                let altitude_deg = sun.altitude_deg;
                let problem = AzimuthProblem::BelowHorizon { altitude_deg };
                return Err(AzimuthError::new("time", problem));
            }
            Ok(by_circle(sun.bearing, Some(sun.altitude_deg)))
        }
        Target::SunAmplitude {
            sight,
            height_of_eye_m,
        } => by_amplitude(readings, sight, height_of_eye_m),
        Target::Body {
            bearing,
            altitude_deg,
        } => Ok(by_circle(bearing, altitude_deg)),
        Target::Transit(bearing) => Ok(by_circle(bearing, None)),
        Target::Quay(bearing) => Ok(Sighted {
            bearing,
            altitude_deg: None,
            standard_error_deg: QUAY_DEG,
            caution: Some(AzimuthCaution::Alongside),
        }),
    }
}

fn sun(readings: &Readings) -> Result<Sun, AzimuthError> {
    let sun = sun_at(readings.time, readings.position);
    sun.ok_or_else(|| {
        let problem = AzimuthProblem::Missing("the sun's place is not known in that year");
        AzimuthError::new("time", problem)
    })
}

fn by_circle(bearing: TrueBearing, altitude_deg: Option<f64>) -> Sighted {
    let altitude_deg_or_low = altitude_deg.unwrap_or(0.0);
    let tilt_deg = CIRCLE_TILT_DEG * altitude_deg_or_low.to_radians().tan();
    Sighted {
        bearing,
        altitude_deg,
        standard_error_deg: READING_DEG.hypot(tilt_deg),
        caution: (tilt_deg > READING_DEG).then_some(AzimuthCaution::HighAltitude),
    }
}

fn by_amplitude(
    readings: &Readings,
    sight: HorizonSight,
    height_of_eye_m: f64,
) -> Result<Sighted, AzimuthError> {
    let sun = sun(readings)?;
    let altitude_deg = centre_altitude_deg(sight, height_of_eye_m, sun.distance_au);
    let lat_deg = readings.position.lat_deg();
    let amplitude = amplitude(lat_deg, sun.declination_deg, altitude_deg)
        .ok_or_else(|| AzimuthError::new("lat", AzimuthProblem::NeverOnHorizon))?;
    if (sun.altitude_deg - altitude_deg).abs() > NEAR_HORIZON_DEG {
        let altitude_deg = sun.altitude_deg;
        let problem = AzimuthProblem::NotOnHorizon { altitude_deg };
        return Err(AzimuthError::new("time", problem));
    }
    let is_rising = sun.bearing.degrees() < 180.0;
    let side = if is_rising { 1.0 } else { -1.0 };
    let refraction_deg = amplitude.standard_error_deg;
    Ok(Sighted {
        bearing: TrueBearing::new(side * amplitude.from_north_deg).expect("it is finite"),
        altitude_deg: Some(altitude_deg),
        standard_error_deg: READING_DEG.hypot(refraction_deg),
        caution: (refraction_deg > READING_DEG).then_some(AzimuthCaution::GrazingHorizon),
    })
}

/// Derives the errors from the bearing, or from the heading that the other instrument's
/// error makes true.
fn errors(readings: &Readings, bearing: TrueBearing) -> Errors {
    let compass_heading = readings.compass_heading;
    let by_heading = |heading: TrueHeading| Errors {
        compass: heading - compass_heading,
        gyro: readings.gyro_heading.map(|gyro| heading - gyro),
        heading,
    };
    match readings.bearing {
        Bearing::Compass(compass) => by_heading(compass_heading + (bearing - compass)),
        Bearing::Gyro(gyro, gyro_heading) => by_heading(gyro_heading + (bearing - gyro)),
        Bearing::Both(compass, gyro) => Errors {
            gyro: Some(bearing - gyro),
            ..by_heading(compass_heading + (bearing - compass))
        },
        Bearing::Ahead => by_heading(bearing.ahead()),
    }
}
