//! Misreadings at the berth that explain an inconsistent reading.

use crate::adjust::inputs::{Unit, VerticalReading};
use crate::berth::{Alignment, BerthReading, ReadingErrors, lambda_at_berth};
use binnacle_compass::angle::MagneticHeading;
use binnacle_compass::model::Model;
use binnacle_compass::ship::EarthField;
use serde::{Deserialize, Serialize};
use std::fmt;

/// A single misreading that makes a reading fit the model.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Serialize, Deserialize)]
#[serde(rename_all = "snake_case")]
pub enum Misreading {
    /// Figures in nT, entered with another unit.
    Nanotesla,
    /// Figures in µT, entered with another unit.
    Microtesla,
    /// Figures in gauss, entered with another unit.
    Gauss,
    /// Figures in milligauss, entered with another unit.
    Milligauss,
    /// Forward and starboard swapped.
    SwappedAxes,
    /// Port counted as positive.
    StarboardReversed,
    /// Aft counted as positive.
    ForwardReversed,
    /// Heading of the stern, or reversed magnetometer.
    HeadingReversed,
    /// Up counted as positive.
    DownReversed,
    /// Vertical part in another unit than the other two.
    DownInAnotherUnit,
    /// Forward and down swapped.
    ForwardDownSwapped,
    /// Starboard and down swapped.
    StarboardDownSwapped,
}

impl Misreading {
    /// Misreadings of the horizontal field.
    pub(crate) const ALL: [Misreading; 8] = [
        // The commonest comes first and is reported first.
        Misreading::HeadingReversed,
        Misreading::Nanotesla,
        Misreading::Microtesla,
        Misreading::Gauss,
        Misreading::Milligauss,
        Misreading::SwappedAxes,
        Misreading::StarboardReversed,
        Misreading::ForwardReversed,
    ];

    /// Returns the affected field of the form.
    pub fn field(self) -> &'static str {
        match self {
            Misreading::Nanotesla
            | Misreading::Microtesla
            | Misreading::Gauss
            | Misreading::Milligauss
            | Misreading::SwappedAxes => "forward, starboard",
            Misreading::StarboardReversed => "starboard",
            Misreading::ForwardReversed => "forward",
            Misreading::HeadingReversed => "heading_true_deg",
            Misreading::DownReversed | Misreading::DownInAnotherUnit => "down",
            Misreading::ForwardDownSwapped => "forward, down",
            Misreading::StarboardDownSwapped => "starboard, down",
        }
    }

    /// Returns the actual unit of the figures, for a misread unit.
    fn unit(self) -> Option<Unit> {
        match self {
            Misreading::Nanotesla => Some(Unit::Nanotesla),
            Misreading::Microtesla => Some(Unit::Microtesla),
            Misreading::Gauss => Some(Unit::Gauss),
            Misreading::Milligauss => Some(Unit::Milligauss),
            _ => None,
        }
    }

    /// Returns the corrected heading and field; `named` is the entered unit.
    fn undone(self, degrees: f64, [x, y]: [f64; 2], named: Unit) -> (f64, [f64; 2]) {
        match self {
            Misreading::SwappedAxes => (degrees, [y, x]),
            Misreading::StarboardReversed => (degrees, [x, -y]),
            Misreading::ForwardReversed => (degrees, [-x, y]),
            Misreading::HeadingReversed => (degrees + 180.0, [x, y]),
            _ => {
                let times = self.times(named);
                (degrees, [x * times, y * times])
            }
        }
    }

    /// Returns the ratio of the actual to the entered unit.
    fn times(self, named: Unit) -> f64 {
        self.unit().map_or(1.0, |unit| unit.nt() / named.nt())
    }

    /// Corrects a complete reading; `None` when no ship has such a field.
    pub(crate) fn undone_reading(
        self,
        reading: &BerthReading,
        vertical: Option<VerticalReading>,
        named: Unit,
    ) -> Option<(BerthReading, Option<VerticalReading>)> {
        let (degrees, field_nt) =
            self.undone(reading.magnetic().degrees(), reading.field_nt(), named);
        let heading = MagneticHeading::new(degrees)?;
        let undone = BerthReading::new(heading, field_nt, reading.errors(), reading.alignment());
        let vertical = vertical.map(|vertical| VerticalReading {
            down_nt: vertical.down_nt * self.times(named),
        });
        Some((undone.ok()?, vertical))
    }
}

/// Finds the misreadings that each explain this reading alone; none where it fits already.
/// `named` is the entered unit.
pub fn find_misreadings(
    model: &Model,
    earth: EarthField,
    magnetic: MagneticHeading,
    field_nt: [f64; 2],
    named: Unit,
    errors: ReadingErrors,
    alignment: Alignment,
) -> Vec<Misreading> {
    let fits = |degrees: f64, field_nt: [f64; 2]| {
        let Some(magnetic) = MagneticHeading::new(degrees) else {
            return false;
        };
        let reading = BerthReading::new(magnetic, field_nt, errors, alignment);
        let found = reading.and_then(|reading| lambda_at_berth(model, earth, &reading));
        found.is_ok()
    };
    if fits(magnetic.degrees(), field_nt) {
        return Vec::new();
    }
    let explains = |misreading: &Misreading| {
        let (degrees, field_nt) = misreading.undone(magnetic.degrees(), field_nt, named);
        fits(degrees, field_nt)
    };
    Misreading::ALL.into_iter().filter(explains).collect()
}

/// Finds misreadings of the axes that this heading cannot reveal: the reading fits the
/// model with and without them.
pub(crate) fn undetectable_misreadings(
    model: &Model,
    earth: EarthField,
    reading: &BerthReading,
) -> Vec<Misreading> {
    let fits = |misreading: &Misreading| {
        let degrees = reading.magnetic().degrees();
        let (_, field_nt) = misreading.undone(degrees, reading.field_nt(), Unit::Nanotesla);
        let (errors, alignment) = (reading.errors(), reading.alignment());
        let undone = BerthReading::new(reading.magnetic(), field_nt, errors, alignment);
        undone.is_ok_and(|undone| lambda_at_berth(model, earth, &undone).is_ok())
    };
    let axes = [
        Misreading::SwappedAxes,
        Misreading::StarboardReversed,
        Misreading::ForwardReversed,
    ];
    axes.into_iter().filter(fits).collect()
}

impl fmt::Display for Misreading {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        f.write_str(match self {
            Misreading::Nanotesla => "the figures are in nanotesla",
            Misreading::Microtesla => "the figures are in microtesla (1 microtesla is 1000 nT)",
            Misreading::Gauss => "the figures are in gauss (1 gauss is 100000 nT)",
            Misreading::Milligauss => "the figures are in milligauss (1 milligauss is 100 nT)",
            Misreading::SwappedAxes => "the magnetometer's axes are swapped",
            Misreading::StarboardReversed => "the magnetometer's athwartship axis points to port",
            Misreading::ForwardReversed => "the magnetometer's fore-and-aft axis points aft",
            Misreading::HeadingReversed => "the heading is 180 degrees off",
            Misreading::DownReversed => "the magnetometer's vertical axis points up",
            Misreading::DownInAnotherUnit => {
                "the vertical figure is in another unit than the other two"
            }
            Misreading::ForwardDownSwapped => {
                "the magnetometer's fore-and-aft and vertical axes are swapped"
            }
            Misreading::StarboardDownSwapped => {
                "the magnetometer's athwartship and vertical axes are swapped"
            }
        })
    }
}
