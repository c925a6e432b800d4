//! The vertical field read, held against the earth's with the correctors as they stood.
//!
//! Nothing else at the berth tells its sign or its unit: the compass on an even keel does
//! not show it, and heeling magnets set by it the wrong way are found in the first swell.
//! What always holds: a reading that no ship makes is refused; one that few ships make, and
//! a mistake would make usual, sets no magnets.

use super::misreadings::Misreading;
use super::refusal::Refusal;
use crate::adjust::inputs::{Unit, VerticalReading};
use crate::berth::{BerthReading, lambda_at_berth};
use crate::binnacle::Binnacle;
use crate::corrector::effect;
use binnacle_compass::model::Model;
use binnacle_compass::ship::EarthField;

/// What most ships add to the vertical field for good, nT: half a degree for each degree
/// of heel, and more.
const USUAL_NT: f64 = 12_000.0;
/// What hardly any ship adds for good, nT.
const GREATEST_NT: f64 = 25_000.0;
/// What a ship adds by induction, as a share of the earth's.
const INDUCED_SHARE: f64 = 0.15;

/// What a vertical reading makes of the ship.
pub(crate) struct VerticalCheck {
    read_nt: f64,
    /// The earth's and the correctors' alone, nT.
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

    /// Whether most ships make it so.
    fn is_usual(&self, down_nt: f64) -> bool {
        self.added_nt(down_nt).abs() <= USUAL_NT + self.induced_nt
    }

    /// What the ship adds, nT.
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

    /// Whether heeling magnets may be set by it.
    pub(crate) fn is_credible(&self) -> bool {
        self.refusal().is_none() && self.misreadings.is_empty()
    }

    /// Why no plan rests on it.
    pub(crate) fn refusal(&self) -> Option<Refusal> {
        let added_nt = self.added_nt(self.read_nt);
        if added_nt.abs() <= GREATEST_NT + self.induced_nt {
            return None;
        }
        let what = format!(
            "{}; without a vertical part (down) the heeling magnets stay as found, and the rest \
             is planned",
            self.summary()
        );
        let misreadings = self.misreadings.clone();
        Some(Refusal::NoSuchField { what, misreadings })
    }

    fn summary(&self) -> String {
        format!(
            "{:.1} microtesla down, where the earth and the correctors make {:.1}",
            self.read_nt / 1e3,
            self.without_ship_nt / 1e3
        )
    }

    /// Why heeling magnets are not set by it, though the rest is planned.
    pub(crate) fn note(&self) -> Option<String> {
        if self.misreadings.is_empty() {
            return None;
        }
        let each: Vec<String> = self.misreadings.iter().map(ToString::to_string).collect();
        Some(format!(
            "the heeling magnets are left as found: the magnetometer read {}, which few ships \
             add to; it could be that {}: read again, or set them with a heeling-error instrument",
            self.summary(),
            each.join(", or that ")
        ))
    }
}

/// Which of forward and starboard, with down in its place, makes a reading that fits.
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
