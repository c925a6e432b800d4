//! Comparison of the compass card with the measured field.
//!
//! With the bowl out, the magnetometer measures the card's field except for the induction
//! of the needles in the spheres. The field alone therefore determines the compass heading,
//! independent of model and given heading.

use super::card_precision::heading_sd_deg;
use crate::berth::{Alignment, BerthReading};
use crate::binnacle::Binnacle;
use crate::corrector::effect;
use binnacle_compass::angle::{MagneticHeading, wrap_180, wrap_360};
use binnacle_compass::deviation::NORMAL_99;
use binnacle_compass::ship::{EarthField, compass_rad};
use serde::{Deserialize, Serialize};
use std::fmt;

/// Least difference that is refused, degrees.
const LEAST_REFUSED_DEG: f64 = 4.0;
/// Least difference that is refused, in tolerances.
const REFUSED_TOLERANCES: f64 = 1.5;

/// Compass heading compared with the heading implied by the measured field.
#[derive(Clone, Copy, Debug, PartialEq, Serialize, Deserialize)]
pub struct CardCheck {
    /// Compass heading read, degrees.
    pub read_deg: f64,
    /// Compass heading implied by the measured field, degrees.
    pub implied_deg: f64,
    /// Read less implied, degrees, without the part that the model's constant explains.
    pub off_deg: f64,
    /// Tolerance, degrees: exceeded by one correct reading in a hundred.
    pub tolerance_deg: f64,
}

impl CardCheck {
    /// Compares a compass reading, with the correctors in the magnetometer's setting.
    pub(crate) fn new(
        read_deg: f64,
        reading: &BerthReading,
        earth: EarthField,
        binnacle: &Binnacle,
        constant_deg: f64,
    ) -> CardCheck {
        let magnetic = reading.magnetic();
        let [x, y] = with_needles(reading.field_nt(), magnetic, earth, binnacle);
        let implied_deg = wrap_360(compass_rad(x, y).to_degrees());
        let off_deg = wrap_180(read_deg - implied_deg);
        // The magnetometer is aligned with the keel, the card is read at the lubber line:
        // the constant may be between them, or belong to the reference.
        let between_deg = match reading.alignment() {
            Alignment::Keel => -constant_deg,
            Alignment::AsFitted => 0.0,
        };
        let explained_deg = off_deg.clamp(between_deg.min(0.0), between_deg.max(0.0));
        let errors = reading.errors();
        let leaked_nt = earth.z_nt * errors.tilt_sd_deg.to_radians();
        let of_field_deg = (errors.field_sd_nt.hypot(leaked_nt) / x.hypot(y)).to_degrees();
        let sd_deg = of_field_deg
            .hypot(errors.alignment_sd_deg)
            .hypot(heading_sd_deg(earth.h_nt));
        CardCheck {
            read_deg,
            implied_deg,
            off_deg: off_deg - explained_deg,
            tolerance_deg: NORMAL_99 * sd_deg,
        }
    }

    /// Returns true when the errors explain the difference.
    pub fn agrees(&self) -> bool {
        self.off_deg.abs() <= self.tolerance_deg
    }

    /// Returns true when the readings contradict each other.
    pub fn is_refused(&self) -> bool {
        let most_deg = LEAST_REFUSED_DEG.max(REFUSED_TOLERANCES * self.tolerance_deg);
        self.off_deg.abs() > most_deg
    }

    /// Summarises the difference.
    pub fn summary(&self) -> String {
        format!(
            "the compass reads {:.1} degrees, but the measured field implies {:.1} (within {:.1})",
            self.read_deg, self.implied_deg, self.tolerance_deg
        )
    }

    /// Lists the possible errors.
    pub fn suspects(&self) -> Vec<String> {
        let off_deg = self.off_deg.abs();
        let mut suspects = Vec::new();
        if off_deg > 150.0 {
            suspects.push("the card was read on the wrong side of the bowl".to_owned());
        }
        let side = if self.off_deg < 0.0 {
            "starboard"
        } else {
            "port"
        };
        suspects.extend([
            "the compass was misread, or its heading mistyped".to_owned(),
            "the card sticks".to_owned(),
            format!("the lubber line is {off_deg:.1} degrees out"),
            format!("the magnetometer is turned {off_deg:.1} degrees to {side}"),
            "the magnetometer was not where the card is".to_owned(),
        ]);
        suspects
    }
}

impl fmt::Display for CardCheck {
    /// Writes the summary and the suspects in one line.
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        write!(
            f,
            "{}; it could be that {}",
            self.summary(),
            self.suspects().join(", or that ")
        )
    }
}

/// Returns the card's field: the magnetometer does not measure the needles' induction.
fn with_needles(
    [x, y]: [f64; 2],
    magnetic: MagneticHeading,
    earth: EarthField,
    binnacle: &Binnacle,
) -> [f64; 2] {
    let needle_nt = effect(binnacle, &binnacle.setting).needle_nt;
    let [hx, hy, _] = earth.in_ship_axes(magnetic.radians());
    let of = |row: [f64; 2]| (row[0] * hx + row[1] * hy) / earth.h_nt;
    [x + of(needle_nt[0]), y + of(needle_nt[1])]
}
