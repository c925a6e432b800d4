//! Observation that is possible in itself.
//!
//! Invariants of an [`Azimuth`]: its numbers are in range, it has the values that its kind
//! needs and no others, the sun was where it says, and values that are unlikely were
//! confirmed.

use super::error::AzimuthError;
use super::form::{AzimuthForm, AzimuthKind};
use super::plausibility;
use super::readings::Readings;
use super::result::{AzimuthResult, work_out};
use crate::angle::{CompassHeading, GyroHeading};
use crate::position::Position;
use crate::time::Timestamp;
use serde::{Deserialize, Serialize};

/// Checked observation of a compass error, with its result. In JSON it is its form.
#[derive(Clone, Debug, PartialEq, Serialize, Deserialize)]
#[serde(try_from = "AzimuthForm", into = "AzimuthForm")]
pub struct Azimuth {
    form: AzimuthForm,
    readings: Readings,
    result: AzimuthResult,
}

impl Azimuth {
    /// Checks an observation and works out its errors.
    ///
    /// # Errors
    /// Fails with the first field at fault, or with a question that `confirmed` answers.
    pub fn new(form: AzimuthForm) -> Result<Azimuth, AzimuthError> {
        let readings = Readings::read(&form)?;
        let result = work_out(&readings)?;
        if !form.confirmed {
            plausibility::check(&readings, &result)?;
        }
        Ok(Azimuth {
            form,
            readings,
            result,
        })
    }

    /// Compass error, gyro error and all that leads to them.
    pub fn result(&self) -> &AzimuthResult {
        &self.result
    }

    /// Observation as it was written.
    pub fn form(&self) -> &AzimuthForm {
        &self.form
    }

    /// Time of the bearing.
    pub fn time(&self) -> Timestamp {
        self.readings.time
    }

    /// Position of the vessel.
    pub fn position(&self) -> Position {
        self.readings.position
    }

    /// Object of the bearing.
    pub fn kind(&self) -> AzimuthKind {
        self.form.kind
    }

    /// Raw heading of the magnetic compass.
    pub fn compass_heading(&self) -> CompassHeading {
        self.readings.compass_heading
    }

    /// Heading of the gyro, if it was noted.
    pub fn gyro_heading(&self) -> Option<GyroHeading> {
        self.readings.gyro_heading
    }
}

impl TryFrom<AzimuthForm> for Azimuth {
    type Error = AzimuthError;

    fn try_from(form: AzimuthForm) -> Result<Azimuth, AzimuthError> {
        Azimuth::new(form)
    }
}

impl From<Azimuth> for AzimuthForm {
    fn from(azimuth: Azimuth) -> AzimuthForm {
        azimuth.form
    }
}
