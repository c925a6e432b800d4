//! Comparison of the measured vertical field with the earth's and the correctors'.
//!
//! Nothing else at the berth verifies its sign or its unit: a compass on an even keel does
//! not show it, and heeling magnets set in the wrong direction are noticed only in a swell.
//! Invariants: a reading that no ship produces is refused. A reading that few ships produce
//! and a misreading would explain sets no magnets.

use super::misreadings::Misreading;
use super::refusal::Refusal;
use crate::adjust::inputs::{Unit, VerticalReading};
use crate::berth::{BerthReading, lambda_at_berth};
use crate::binnacle::Binnacle;
use crate::corrector::effect;
use binnacle_compass::model::Model;
use binnacle_compass::ship::EarthField;

/// Usual permanent vertical field of a ship, nT: half a degree of heeling error per degree
/// of heel, and more.
const USUAL_NT: f64 = 12_000.0;
/// Greatest permanent vertical field of a ship, nT.
const GREATEST_NT: f64 = 25_000.0;
/// Induced vertical field of a ship, as a share of the earth's.
const INDUCED_SHARE: f64 = 0.15;

/// Vertical reading compared with earth and correctors.
pub(crate) struct VerticalCheck {
    read_nt: f64,
    /// Field of earth and correctors alone, nT.
    without_ship_nt: f64,
    induced_nt: f64,
    misreadings: Vec<Misreading>,
}

impl VerticalCheck {
    pub(crate) fn new(reading: VerticalReading, earth: EarthField, binnacle: &Binnacle) -> Self {
        let of_correctors = effect(binnacle, &binnacle.setting);
        let mut vertical = VerticalCheck {
            read_nt: reading.down_nt,
            without_ship_nt: (1.0 + of_correctors.chi[2][2]) * earth.z_nt + of_correctors.b_nt[2],
            induced_nt: INDUCED_SHARE * earth.z_nt.abs(),
            misreadings: Vec::new(),
        };
        if !vertical.is_usual(vertical.read_nt) {
            vertical.misreadings = vertical.find_misreadings();
        }
        vertical
    }

    /// Returns true when most ships produce such a field.
    fn is_usual(&self, down_nt: f64) -> bool {
        self.added_nt(down_nt).abs() <= USUAL_NT + self.induced_nt
    }

    /// Returns the ship's part of the field, nT.
    fn added_nt(&self, down_nt: f64) -> f64 {
        down_nt - self.without_ship_nt
    }

    fn find_misreadings(&self) -> Vec<Misreading> {
        let mut misreadings = Vec::new();
        if self.is_usual(-self.read_nt) {
            misreadings.push(Misreading::DownReversed);
        }
        let units = Unit::ALL.map(Unit::nt);
        let ratios = units.iter().flat_map(|one| units.map(|other| one / other));
        let mut others = ratios.filter(|ratio| (ratio - 1.0).abs() > 1e-9);
        if others.any(|ratio| self.is_usual(ratio * self.read_nt)) {
            misreadings.push(Misreading::DownInAnotherUnit);
        }
        misreadings
    }

    /// Returns true when heeling magnets may be set by the reading.
    pub(crate) fn is_credible(&self) -> bool {
        self.refusal().is_none() && self.misreadings.is_empty()
    }

    /// Returns the refusal of an impossible reading.
    pub(crate) fn refusal(&self) -> Option<Refusal> {
        let added_nt = self.added_nt(self.read_nt);
        if added_nt.abs() <= GREATEST_NT + self.induced_nt {
            return None;
        }
        let what = format!(
            "{}; omit the vertical part (down) to leave the heeling magnets as found and plan the \
             rest",
            self.summary()
        );
        let misreadings = self.misreadings.clone();
        Some(Refusal::NoSuchField { what, misreadings })
    }

    fn summary(&self) -> String {
        format!(
            "{:.1} microtesla down, while the earth and the correctors produce {:.1}",
            self.read_nt / 1e3,
            self.without_ship_nt / 1e3
        )
    }

    /// Explains heeling magnets that are left, though the rest is planned.
    pub(crate) fn note(&self) -> Option<String> {
        if self.misreadings.is_empty() {
            return None;
        }
        let each: Vec<String> = self.misreadings.iter().map(ToString::to_string).collect();
        Some(format!(
            "the heeling magnets are left as found: the magnetometer read {}, a difference that \
             few ships have; it could be that {}: read again, or set them with a heeling-error \
             instrument",
            self.summary(),
            each.join(", or that ")
        ))
    }
}

/// Finds swaps of forward or starboard with down that make the reading fit.
pub(crate) fn find_swapped_axes(
    model: &Model,
    earth: EarthField,
    reading: &BerthReading,
    vertical: VerticalReading,
    binnacle: &Binnacle,
) -> Vec<Misreading> {
    let [x, y] = reading.field_nt();
    let down_nt = vertical.down_nt;
    let fits = |field_nt: [f64; 2], down_nt: f64| {
        let (errors, alignment) = (reading.errors(), reading.alignment());
        let undone = BerthReading::new(reading.magnetic(), field_nt, errors, alignment);
        let found = undone.and_then(|undone| lambda_at_berth(model, earth, &undone));
        let vertical = VerticalCheck::new(VerticalReading { down_nt }, earth, binnacle);
        found.is_ok() && vertical.is_usual(down_nt)
    };
    let mut misreadings = Vec::new();
    if fits([down_nt, y], x) {
        misreadings.push(Misreading::ForwardDownSwapped);
    }
    if fits([x, down_nt], y) {
        misreadings.push(Misreading::StarboardDownSwapped);
    }
    misreadings
}
