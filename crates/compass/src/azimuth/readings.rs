//! Values of an observation by their types, read from its form.

use super::error::{AzimuthError, AzimuthProblem};
use super::form::{AzimuthForm, AzimuthKind, HorizonSight};
use crate::angle::{
    AngleError, CompassBearing, CompassHeading, GyroBearing, GyroHeading, TrueBearing,
};
use crate::position::Position;
use crate::time::Timestamp;

/// Greatest height of eye, metres: above the bridge of the largest ships.
const MAX_HEIGHT_OF_EYE_M: f64 = 100.0;

/// Values of an observation by their types.
#[derive(Clone, Debug, PartialEq)]
pub(super) struct Readings {
    pub(super) time: Timestamp,
    pub(super) position: Position,
    pub(super) target: Target,
    pub(super) compass_heading: CompassHeading,
    pub(super) gyro_heading: Option<GyroHeading>,
    pub(super) bearing: Bearing,
}

/// Source of the true bearing.
#[derive(Clone, Debug, PartialEq)]
pub(super) enum Target {
    SunAzimuth,
    SunAmplitude {
        sight: HorizonSight,
        height_of_eye_m: f64,
    },
    Body {
        bearing: TrueBearing,
        altitude_deg: Option<f64>,
    },
    Transit(TrueBearing),
    Quay(TrueBearing),
}

/// Bearing as it was read.
#[derive(Clone, Copy, Debug, PartialEq)]
pub(super) enum Bearing {
    Compass(CompassBearing),
    Gyro(GyroBearing, GyroHeading),
    Both(CompassBearing, GyroBearing),
    /// Alongside: the bow is the object.
    Ahead,
}

impl Readings {
    pub(super) fn read(form: &AzimuthForm) -> Result<Readings, AzimuthError> {
        let position = Position::new(form.lat, form.lon).map_err(|error| {
            let field = if Position::new(form.lat, 0.0).is_ok() {
                "lon"
            } else {
                "lat"
            };
            AzimuthError::new(field, error)
        })?;
        let compass_heading = form.compass_heading_deg;
        Ok(Readings {
            time: form.time,
            position,
            target: Target::read(form)?,
            compass_heading: angle("compass_heading_deg", compass_heading)?,
            gyro_heading: optional_angle("gyro_heading_deg", form.gyro_heading_deg)?,
            bearing: Bearing::read(form)?,
        })
    }
}

impl Target {
    fn read(form: &AzimuthForm) -> Result<Target, AzimuthError> {
        refuse_unused(form)?;
        match form.kind {
            AzimuthKind::SunAzimuth => Ok(Target::SunAzimuth),
            AzimuthKind::SunAmplitude => {
                let sight = form.horizon;
                let sight = sight.ok_or_else(|| missing("horizon", "the part of the sun on it"))?;
                let height_of_eye_m = height_of_eye(sight, form.height_of_eye_m)?;
                Ok(Target::SunAmplitude {
                    sight,
                    height_of_eye_m,
                })
            }
            AzimuthKind::Body => Ok(Target::Body {
                bearing: typed_bearing(form)?,
                altitude_deg: form
                    .altitude_deg
                    .map(|altitude| in_range("altitude_deg", "degrees", altitude, 90.0))
                    .transpose()?,
            }),
            AzimuthKind::Transit => Ok(Target::Transit(typed_bearing(form)?)),
            AzimuthKind::Quay => Ok(Target::Quay(typed_bearing(form)?)),
        }
    }
}

impl Bearing {
    fn read(form: &AzimuthForm) -> Result<Bearing, AzimuthError> {
        let compass = optional_angle("compass_bearing_deg", form.compass_bearing_deg)?;
        let gyro = optional_angle("gyro_bearing_deg", form.gyro_bearing_deg)?;
        let heading = optional_angle("gyro_heading_deg", form.gyro_heading_deg)?;
        if form.kind == AzimuthKind::Quay {
            return Ok(Bearing::Ahead);
        }
        match (compass, gyro) {
            (Some(compass), Some(gyro)) => Ok(Bearing::Both(compass, gyro)),
            (Some(compass), None) => Ok(Bearing::Compass(compass)),
            (None, Some(gyro)) => {
                let heading = heading.ok_or_else(|| {
                    missing(
                        "gyro_heading_deg",
                        "a bearing by gyro needs its heading too",
                    )
                });
                Ok(Bearing::Gyro(gyro, heading?))
            }
            (None, None) => Err(missing(
                "compass_bearing_deg",
                "a bearing by compass or by gyro is needed",
            )),
        }
    }
}

/// Refuses values that the kind does not use: they were meant for something.
fn refuse_unused(form: &AzimuthForm) -> Result<(), AzimuthError> {
    let kind = form.kind;
    let is_amplitude = kind == AzimuthKind::SunAmplitude;
    let is_quay = kind == AzimuthKind::Quay;
    let fields = [
        ("horizon", form.horizon.is_some(), is_amplitude),
        (
            "height_of_eye_m",
            form.height_of_eye_m.is_some(),
            is_amplitude,
        ),
        ("name", form.name.is_some(), kind.is_typed()),
        (
            "true_bearing_deg",
            form.true_bearing_deg.is_some(),
            kind.is_typed(),
        ),
        (
            "altitude_deg",
            form.altitude_deg.is_some(),
            kind == AzimuthKind::Body,
        ),
        (
            "compass_bearing_deg",
            form.compass_bearing_deg.is_some(),
            !is_quay,
        ),
        (
            "gyro_bearing_deg",
            form.gyro_bearing_deg.is_some(),
            !is_quay,
        ),
    ];
    for (field, is_given, is_used) in fields {
        if is_given && !is_used {
            return Err(AzimuthError::new(
                field,
                AzimuthProblem::Unused(kind.description()),
            ));
        }
    }
    Ok(())
}

fn typed_bearing(form: &AzimuthForm) -> Result<TrueBearing, AzimuthError> {
    let name = form.name.as_deref().unwrap_or_default();
    if name.trim().is_empty() {
        return Err(missing("name", "the body, the transit or the quay"));
    }
    let bearing = optional_angle("true_bearing_deg", form.true_bearing_deg)?;
    bearing.ok_or_else(|| missing("true_bearing_deg", "it is computed for the sun alone"))
}

fn height_of_eye(sight: HorizonSight, given: Option<f64>) -> Result<f64, AzimuthError> {
    let field = "height_of_eye_m";
    match (sight, given) {
        (HorizonSight::Celestial, None) => Ok(0.0),
        (_, None) => Err(missing(
            field,
            "the visible horizon dips below the celestial one",
        )),
        (_, Some(height_m)) => in_range(field, "m", height_m, MAX_HEIGHT_OF_EYE_M),
    }
}

fn in_range(
    field: &'static str,
    unit: &'static str,
    value: f64,
    high: f64,
) -> Result<f64, AzimuthError> {
    if (0.0..=high).contains(&value) {
        return Ok(value);
    }
    let problem = AzimuthProblem::OutOfRange {
        value,
        unit,
        low: 0.0,
        high,
    };
    Err(AzimuthError::new(field, problem))
}

fn angle<T: TryFrom<f64, Error = AngleError>>(
    field: &'static str,
    degrees: f64,
) -> Result<T, AzimuthError> {
    T::try_from(degrees).map_err(|error| AzimuthError::new(field, error))
}

fn optional_angle<T: TryFrom<f64, Error = AngleError>>(
    field: &'static str,
    degrees: Option<f64>,
) -> Result<Option<T>, AzimuthError> {
    degrees.map(|degrees| angle(field, degrees)).transpose()
}

fn missing(field: &'static str, purpose: &'static str) -> AzimuthError {
    AzimuthError::new(field, AzimuthProblem::Missing(purpose))
}
