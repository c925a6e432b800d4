//! Consistency of the field's direction at the berth with the model.
//!
//! The field's strength gives λ. Its direction is left over, and tests all assumptions.

use super::reading_errors::ReadingErrors;
use binnacle_compass::deviation::NORMAL_99;
use serde::{Deserialize, Serialize};
use std::fmt;

/// Standard error of the angle at a good berth, degrees. An angle beyond its 99 % is not
/// attributed to errors only because the given errors are wider.
const GOOD_ERROR_DEG: f64 = 1.0;
/// Standard deviation of an ordinary berth heading, degrees.
const GOOD_HEADING_DEG: f64 = 2.0;
/// Alignment of a telephone, degrees; purpose-made instruments are better.
const GOOD_ALIGNMENT_DEG: f64 = 2.0;
/// Greatest turn by nearby steel, degrees: a magnetometer is never set up closer to steel.
const STEEL_DEG: f64 = 20.0;

/// Angle between measured and expected field, with its verdict.
#[derive(Clone, Copy, Debug, PartialEq, Serialize, Deserialize)]
pub struct Consistency {
    /// Compass heading in the measured field less that in the expected field, degrees in
    /// (−180, 180].
    pub angle_deg: f64,
    /// Standard error of the angle, degrees; `None` for a model without a covariance.
    pub standard_error_deg: Option<f64>,
    /// Field across the needle that would turn it by the angle, nT.
    pub across_nt: f64,
    /// Verdict on the angle.
    pub verdict: Verdict,
}

/// Verdict on the angle at the berth.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Serialize, Deserialize)]
#[serde(rename_all = "snake_case")]
pub enum Verdict {
    /// Within one degree and within its errors.
    Consistent,
    /// Beyond one degree, but within the given errors: λ is valid with its standard error,
    /// and the berth has verified little else.
    Loose,
    /// Beyond the given errors, or beyond one degree where they are unknown.
    Inconsistent,
}

/// A single error that would explain the angle.
#[derive(Clone, Copy, Debug, PartialEq)]
pub enum Suspect {
    /// The given heading is too small by this, degrees (too great if negative).
    Heading {
        /// Correction to add, degrees.
        too_small_deg: f64,
    },
    /// The magnetometer is turned to starboard of its line (to port if negative).
    Magnetometer {
        /// Turn, degrees clockwise.
        turned_deg: f64,
    },
    /// Position or date is wrong, and with it the variation: too far east (west if
    /// negative).
    Variation {
        /// Error of the variation, degrees.
        too_far_east_deg: f64,
    },
    /// Steel of the quay, a crane or a ship alongside adds a field across the needle.
    NearbySteel {
        /// Field across the needle, nT.
        across_nt: f64,
    },
    /// The ship's magnetism has changed across the needle since the model.
    ShipsMagnetism {
        /// Field across the needle, nT.
        across_nt: f64,
    },
}

impl Consistency {
    /// Lists the possible errors with their sizes. Steel and the ship's magnetism are
    /// listed only for angles within their reach.
    pub fn suspects(&self) -> Vec<Suspect> {
        let across_nt = self.across_nt;
        let mut suspects = vec![
            Suspect::Heading {
                too_small_deg: self.angle_deg,
            },
            Suspect::Magnetometer {
                turned_deg: self.angle_deg,
            },
            Suspect::Variation {
                too_far_east_deg: self.angle_deg,
            },
        ];
        if self.angle_deg.abs() <= STEEL_DEG {
            suspects.push(Suspect::NearbySteel { across_nt });
            suspects.push(Suspect::ShipsMagnetism { across_nt });
        }
        suspects
    }

    /// Undetected turn of the ship's field since the model, degrees, one standard
    /// deviation: the part that a good berth's check would have shown. An angle explained
    /// only by wide errors may be a real turn, and so may the excess of heading and
    /// alignment errors over good ones. Zero at a good berth.
    pub fn unchecked_deg(&self, errors: ReadingErrors) -> f64 {
        beyond(self.angle_deg, NORMAL_99 * GOOD_ERROR_DEG)
            .hypot(beyond(errors.heading_sd_deg, GOOD_HEADING_DEG))
            .hypot(beyond(errors.alignment_sd_deg, GOOD_ALIGNMENT_DEG))
    }

    /// Smallest turn of the ship's field that the check detects in 99 of 100 berths,
    /// degrees.
    pub fn detectable_turn_deg(&self) -> Option<f64> {
        self.standard_error_deg.map(|error| NORMAL_99 * error)
    }

    /// Summarises the angle and its error.
    pub fn angle_summary(&self) -> String {
        let error = self
            .standard_error_deg
            .map_or("unknown".to_owned(), |error| format!("{error:.1} degrees"));
        format!(
            "the measured field is {:.1} degrees from the model's (standard error {error})",
            self.angle_deg.abs()
        )
    }
}

impl fmt::Display for Consistency {
    /// Writes the angle, its error, and the suspects in one line.
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        let suspects = self.suspects();
        let suspects: Vec<String> = suspects.iter().map(ToString::to_string).collect();
        write!(f, "{}; {}", self.angle_summary(), suspects.join(", or "))
    }
}

/// Returns the excess of a standard deviation over a good one, in quadrature.
fn beyond(value: f64, good: f64) -> f64 {
    (value.powi(2) - good.powi(2)).max(0.0).sqrt()
}

impl fmt::Display for Verdict {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        f.write_str(match self {
            Verdict::Consistent => "consistent",
            Verdict::Loose => "more than a degree apart, within wide errors",
            Verdict::Inconsistent => "inconsistent",
        })
    }
}

impl fmt::Display for Suspect {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        match *self {
            Suspect::Heading { too_small_deg } => {
                let sense = if too_small_deg < 0.0 {
                    "great"
                } else {
                    "small"
                };
                write!(
                    f,
                    "the heading is {:.1} degrees too {sense}",
                    too_small_deg.abs()
                )
            }
            Suspect::Magnetometer { turned_deg } => {
                let side = if turned_deg < 0.0 {
                    "port"
                } else {
                    "starboard"
                };
                write!(
                    f,
                    "the magnetometer is turned {:.1} degrees to {side}",
                    turned_deg.abs()
                )
            }
            Suspect::Variation { too_far_east_deg } => {
                let side = if too_far_east_deg < 0.0 {
                    "west"
                } else {
                    "east"
                };
                write!(
                    f,
                    "position or date is wrong, and so the variation {:.1} degrees too far {side}",
                    too_far_east_deg.abs()
                )
            }
            Suspect::NearbySteel { across_nt } => {
                write!(
                    f,
                    "steel near the berth adds {across_nt:.0} nT across the needle"
                )
            }
            Suspect::ShipsMagnetism { across_nt } => {
                write!(
                    f,
                    "the ship's magnetism has changed by {across_nt:.0} nT across the needle"
                )
            }
        }
    }
}
