//! What was read at the berth, and what it is held against.
//!
//! What always holds: the unit is named, never guessed; a reading that is refused is
//! kept with the reason; and one that is taken keeps with it everything that a plan
//! from it depends on, so that the same plan can be made again from the log alone.

use super::basis::Basis;
use super::refusal::{Cure, Refusal};
use crate::error::{Error, Result};
use crate::time::Time;
use binnacle_magnetics::adjust::{Mistake, mistakes};
use binnacle_magnetics::angle::{MagneticHeading, TrueHeading};
use binnacle_magnetics::berth::{
    Alignment, BerthError, BerthReading, Consistency, Estimated, ReadingErrors, lambda_at_berth,
};
use serde::{Deserialize, Serialize};
use utoipa::ToSchema;

/// What was read at the berth.
#[derive(Clone, Debug, PartialEq, Serialize, Deserialize, ToSchema)]
#[serde(deny_unknown_fields)]
#[schema(as = BerthReading, example = json!({
    "at": "2026-11-22T08:20:00Z", "lat": 43.35, "lon": -3.04,
    "heading_true_deg": 312.0, "heading_from": "model_reference",
    "forward": 17.2, "starboard": 14.9, "unit": "microtesla",
    "magnetometer": "fluxgate", "compass_deg": 310.5
}))]
pub struct Given {
    /// When it was read.
    pub at: Time,
    /// The berth, degrees north.
    #[schema(minimum = -90, maximum = 90)]
    pub lat: f64,
    /// The berth, degrees east.
    #[schema(minimum = -180, maximum = 180)]
    pub lon: f64,
    /// The ship's true heading at the berth.
    #[schema(minimum = 0, maximum = 360)]
    pub heading_true_deg: f64,
    /// What that heading is from.
    pub heading_from: HeadingFrom,
    /// Its standard deviation, degrees; 0.5 where it is not said.
    #[serde(default, skip_serializing_if = "Option::is_none")]
    pub heading_sd_deg: Option<f64>,
    /// Horizontal field at the card's centre, bowl out, forward positive.
    pub forward: f64,
    /// The same, starboard positive.
    pub starboard: f64,
    /// Vertical field there, down positive; without it the heeling magnets stay.
    #[serde(default, skip_serializing_if = "Option::is_none")]
    pub down: Option<f64>,
    /// What all three are in.
    pub unit: Unit,
    /// What they were read with.
    pub magnetometer: Magnetometer,
    /// Its maker, type and number.
    #[serde(default, skip_serializing_if = "Option::is_none")]
    #[schema(max_length = 200)]
    pub magnetometer_serial: Option<String>,
    /// Its standard deviation, nT; its kind's where it is not said.
    #[serde(default, skip_serializing_if = "Option::is_none")]
    pub field_sd_nt: Option<f64>,
    /// Relative standard deviation of its scale; its kind's where it is not said.
    #[serde(default, skip_serializing_if = "Option::is_none")]
    pub scale_sd: Option<f64>,
    /// What the compass read before the bowl was taken out, degrees.
    #[serde(default, skip_serializing_if = "Option::is_none")]
    pub compass_deg: Option<f64>,
    /// The ship's heel, degrees to starboard.
    #[serde(default)]
    pub heel_deg: f64,
    /// Whether there is steel near: a crane, a ship alongside, a quay of steel piles.
    #[serde(default)]
    pub steel_nearby: bool,
    /// Whether magnetic cargo is on board.
    #[serde(default)]
    pub cargo_on_board: bool,
}

/// A unit of the magnetic field.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Serialize, Deserialize, ToSchema)]
#[serde(rename_all = "snake_case")]
#[schema(as = FieldUnit)]
pub enum Unit {
    /// nT.
    Nanotesla,
    /// µT.
    Microtesla,
    /// G.
    Gauss,
    /// mG.
    Milligauss,
}

/// What a heading at the berth is from.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Serialize, Deserialize, ToSchema)]
#[serde(rename_all = "snake_case")]
pub enum HeadingFrom {
    /// The gyro or satellite compass that the model was fitted with.
    ModelReference,
    /// A surveyed quay, leading marks, the sun.
    Ashore,
}

/// Kinds of magnetometer, by how well they read.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Serialize, Deserialize, ToSchema)]
#[serde(rename_all = "snake_case")]
pub enum Magnetometer {
    /// 0.1 µT.
    Fluxgate,
    /// 0.3 µT.
    Magnetoresistive,
    /// 1.5 µT: enough for magnets, too poor for spheres.
    Phone,
    /// 0.5 µT.
    Other,
}

/// A reading as the log has it.
#[derive(Clone, Debug, Serialize, Deserialize)]
pub struct Read {
    /// What was read.
    pub given: Given,
    /// What it was held against; none when that could not be found.
    pub basis: Option<Basis>,
    /// What it told; none when it was refused.
    pub checked: Option<Checked>,
    /// Why it was refused; none when it was taken.
    pub refusal: Option<Refusal>,
}

/// What a reading told.
#[derive(Clone, Debug, PartialEq, Serialize, Deserialize, ToSchema)]
#[schema(as = BerthCheck)]
pub struct Checked {
    /// λ, the mean share of the earth's horizontal field that reaches the compass; every
    /// heading tells it equally well.
    pub lambda: f64,
    /// Its standard error.
    #[schema(required)]
    pub lambda_sd: Option<f64>,
    /// Between the field read and the field expected, degrees.
    pub consistency_deg: f64,
    /// The standard error of that, degrees.
    #[schema(required)]
    pub consistency_sd_deg: Option<f64>,
    /// What to make of it: `consistent`, or `loose` where wide errors explain it.
    pub verdict: String,
    /// Magnetic heading at the berth, degrees.
    pub magnetic_deg: f64,
}

impl Unit {
    const ALL: [Unit; 4] = [
        Unit::Nanotesla,
        Unit::Microtesla,
        Unit::Gauss,
        Unit::Milligauss,
    ];

    /// One of it, nT.
    pub fn nt(self) -> f64 {
        match self {
            Unit::Nanotesla => 1.0,
            Unit::Microtesla => 1e3,
            Unit::Gauss => 1e5,
            Unit::Milligauss => 100.0,
        }
    }

    fn word(self) -> &'static str {
        match self {
            Unit::Nanotesla => "nanotesla",
            Unit::Microtesla => "microtesla",
            Unit::Gauss => "gauss",
            Unit::Milligauss => "milligauss",
        }
    }
}

impl Magnetometer {
    /// Standard deviations of its noise, nT, of its scale, relative, and of how it lies,
    /// degrees.
    fn usual(self) -> (f64, f64, f64) {
        match self {
            Magnetometer::Fluxgate => (100.0, 0.004, 0.5),
            Magnetometer::Magnetoresistive => (300.0, 0.01, 0.5),
            Magnetometer::Phone => (1_500.0, 0.03, 2.0),
            Magnetometer::Other => (500.0, 0.02, 1.0),
        }
    }
}

/// Steel of an ordinary quay, nT.
const USUAL_STEEL_NT: f64 = 100.0;
/// Where there is steel near, nT.
const NEARBY_STEEL_NT: f64 = 500.0;
/// Of a gyro alongside, degrees.
const USUAL_HEADING_SD_DEG: f64 = 0.5;
/// λ of a ship, whose compass is not in a steel box.
const USUAL_LAMBDA: std::ops::RangeInclusive<f64> = 0.5..=1.2;

impl Given {
    /// Refuses what cannot be a number of its kind; what only cannot be true is found
    /// out later, and kept.
    pub fn must_be_numbers(&self, now: Time) -> Result<()> {
        for (field, value, least, greatest) in [
            ("lat", self.lat, -90.0, 90.0),
            ("lon", self.lon, -180.0, 180.0),
            ("heading_true_deg", self.heading_true_deg, 0.0, 360.0),
            (
                "heading_sd_deg",
                self.heading_sd_deg.unwrap_or(0.0),
                0.0,
                5.0,
            ),
            ("scale_sd", self.scale_sd.unwrap_or(0.0), 0.0, 0.5),
            (
                "field_sd_nt",
                self.field_sd_nt.unwrap_or(1.0),
                1.0,
                10_000.0,
            ),
            ("compass_deg", self.compass_deg.unwrap_or(0.0), 0.0, 360.0),
            ("heel_deg", self.heel_deg, -30.0, 30.0),
        ] {
            crate::http::degrees(field, value, least, greatest)?;
        }
        if self.at.0.seconds_since(now.0) > 300.0 {
            return Err(Error::Invalid {
                field: "at",
                detail: "lies in the future".to_owned(),
            });
        }
        Ok(())
    }

    /// Relative standard deviation of the magnetometer's scale.
    pub fn scale_sd(&self) -> f64 {
        self.scale_sd.unwrap_or(self.magnetometer.usual().1)
    }

    /// The vertical field, nT.
    pub fn down_nt(&self) -> Option<f64> {
        Some(self.down? * self.unit.nt())
    }

    fn errors(&self) -> ReadingErrors {
        let (field_sd_nt, _, turned_sd_deg) = self.magnetometer.usual();
        let steel_nt = if self.steel_nearby {
            NEARBY_STEEL_NT
        } else {
            USUAL_STEEL_NT
        };
        ReadingErrors {
            field_sd_nt: self.field_sd_nt.unwrap_or(field_sd_nt).hypot(steel_nt),
            heading_sd_deg: self.heading_sd_deg.unwrap_or(USUAL_HEADING_SD_DEG),
            alignment_sd_deg: turned_sd_deg,
            // The magnetometer stands upright on deck: heel leaks vertical field into it.
            tilt_sd_deg: (0.5 * turned_sd_deg).hypot(self.heel_deg).min(5.0),
        }
    }

    fn alignment(&self) -> Alignment {
        match self.heading_from {
            HeadingFrom::ModelReference => Alignment::AsFitted,
            HeadingFrom::Ashore => Alignment::Keel,
        }
    }

    /// The reading as the science takes it, if it were in this unit.
    fn in_unit(&self, unit: Unit, basis: &Basis) -> std::result::Result<BerthReading, BerthError> {
        let magnetic = self.magnetic(basis).ok_or(BerthError::NothingRead)?;
        let field_nt = [self.forward, self.starboard].map(|part| part * unit.nt());
        BerthReading::new(magnetic, field_nt, self.errors(), self.alignment())
    }

    fn magnetic(&self, basis: &Basis) -> Option<MagneticHeading> {
        Some(TrueHeading::new(self.heading_true_deg)? - basis.variation()?)
    }

    /// The reading as the science takes it.
    pub fn reading(&self, basis: &Basis) -> std::result::Result<BerthReading, BerthError> {
        self.in_unit(self.unit, basis)
    }

    /// λ and the berth's consistency, or why the reading is not taken.
    pub fn check(&self, basis: &Basis) -> std::result::Result<Checked, Refusal> {
        let found = self.reading(basis).and_then(|reading| {
            let estimate = lambda_at_berth(&basis.model.model, basis.earth(), &reading)?;
            Ok((reading, estimate))
        });
        match found {
            Ok((reading, estimate)) => Ok(Checked::new(
                reading,
                estimate.lambda,
                &estimate.consistency,
            )),
            Err(error) => Err(self.refused(&error, basis)),
        }
    }

    fn refused(&self, error: &BerthError, basis: &Basis) -> Refusal {
        let refusal = match error {
            BerthError::Inconsistent(_) => "inconsistent_berth",
            BerthError::Implausible(_) => "implausible_lambda",
            BerthError::NoDirectiveForce { .. } => "ambiguous_headings",
            BerthError::Model(_) | BerthError::Field(_) => "no_model_to_hold_it_against",
            BerthError::Reading { .. } | BerthError::NothingRead => "no_such_field",
        };
        let mut could_be = self.other_units(basis);
        could_be.extend(self.other_ways(basis));
        if let BerthError::Inconsistent(consistency) = error {
            could_be.extend(consistency.suspects().map(|suspect| suspect.to_string()));
        }
        Refusal {
            refusal: refusal.to_owned(),
            words: error.to_string(),
            could_be,
            cures: vec![Cure::ReadAgain, Cure::AnotherBerth, Cure::HeadingsAtSea],
        }
    }

    /// Units in which the same figures would be the field that is expected.
    fn other_units(&self, basis: &Basis) -> Vec<String> {
        let fits = |unit: &Unit| {
            let reading = self.in_unit(*unit, basis);
            let found =
                reading.and_then(|r| lambda_at_berth(&basis.model.model, basis.earth(), &r));
            *unit != self.unit
                && found.is_ok_and(|found| USUAL_LAMBDA.contains(&found.lambda.value))
        };
        let words = |unit: Unit| {
            format!(
                "the figures are in {}, not in {}",
                unit.word(),
                self.unit.word()
            )
        };
        Unit::ALL.into_iter().filter(fits).map(words).collect()
    }

    /// Axes and headings with which it would fit.
    fn other_ways(&self, basis: &Basis) -> Vec<String> {
        let Some(magnetic) = self.magnetic(basis) else {
            return Vec::new();
        };
        let found = mistakes(
            &basis.model.model,
            basis.earth(),
            magnetic,
            [self.forward, self.starboard].map(|part| part * self.unit.nt()),
            self.errors(),
            self.alignment(),
        );
        // Those of units are told with the unit that was named.
        let units = [Mistake::Gauss, Mistake::Milligauss, Mistake::Microtesla];
        let ways = found.into_iter().filter(|mistake| !units.contains(mistake));
        ways.map(|mistake| mistake.to_string()).collect()
    }
}

impl Checked {
    fn new(reading: BerthReading, lambda: Estimated, consistency: &Consistency) -> Checked {
        Checked {
            lambda: lambda.value,
            lambda_sd: lambda.standard_error,
            consistency_deg: consistency.angle_deg,
            consistency_sd_deg: consistency.standard_error_deg,
            verdict: consistency.verdict.to_string(),
            magnetic_deg: reading.magnetic().degrees(),
        }
    }
}
