//! Whether the field at the berth points where the model says.
//!
//! Strength gives λ; direction is left over, and tests everything that was
//! taken for granted.

use super::reading_errors::ReadingErrors;
use binnacle_compass::deviation::NORMAL_99;
use serde::{Deserialize, Serialize};
use std::fmt;

/// The standard error of a good berth's angle: what one beyond its 99 % would have shown is
/// not taken for an error because the errors are wider.
const GOOD_ERROR_DEG: f64 = 1.0;
/// As well as this a heading at a berth is known without ado.
const GOOD_HEADING_DEG: f64 = 2.0;
/// So lies a telephone; anything made for it lies better.
const GOOD_ALIGNMENT_DEG: f64 = 2.0;
/// Steel that turned the field farther would be nearer than a magnetometer is ever set up.
const STEEL_DEG: f64 = 20.0;

/// The angle between the field read and the field expected, with its verdict.
#[derive(Clone, Copy, Debug, PartialEq, Serialize, Deserialize)]
pub struct Consistency {
    /// How much more a compass in the field read would show than one in the
    /// field expected, degrees in (−180, 180].
    pub angle_deg: f64,
    /// Its standard error, degrees; `None` when the model came without a
    /// covariance.
    pub standard_error_deg: Option<f64>,
    /// What it takes across the needle to turn it so far, nT.
    pub across_nt: f64,
    /// What to make of it.
    pub verdict: Verdict,
}

/// What an angle at the berth says.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Serialize, Deserialize)]
#[serde(rename_all = "snake_case")]
pub enum Verdict {
    /// Within a degree and within its errors.
    Consistent,
    /// Beyond a degree, but the errors given explain it: λ stands with its
    /// standard error, and the berth has checked little else.
    Loose,
    /// Beyond what the errors explain; beyond a degree where they are unknown.
    Inconsistent,
}

/// Something that would explain the angle if it alone were wrong.
#[derive(Clone, Copy, Debug, PartialEq)]
pub enum Suspect {
    /// The heading given is too small by this, degrees (too great if negative).
    Heading {
        /// Degrees to add to it.
        too_small_deg: f64,
    },
    /// The magnetometer is turned to starboard of its line (to port if negative).
    Magnetometer {
        /// Degrees clockwise.
        turned_deg: f64,
    },
    /// The position is off, or the date, and with it the variation: too far east by this
    /// (west if negative).
    Variation {
        /// Degrees.
        too_far_east_deg: f64,
    },
    /// Steel of the quay, a crane or a ship alongside adds this across the needle.
    NearbySteel {
        /// nT.
        across_nt: f64,
    },
    /// The ship's own magnetism is no longer the model's, by this across the needle.
    ShipsMagnetism {
        /// nT.
        across_nt: f64,
    },
}

impl Consistency {
    /// What could be wrong, and by how much each would have to be: steel and the ship's
    /// own magnetism only of an angle that they could bring about.
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

    /// How far the ship's own field may have turned since the model, degrees, one standard
    /// deviation, that a good berth's check would have shown and this one has not: an angle
    /// that only wide errors explain may as well be hers, and so may as much as heading and
    /// alignment are less sure than they can be. Nil at a good berth.
    pub fn unchecked_deg(&self, errors: ReadingErrors) -> f64 {
        beyond(self.angle_deg, NORMAL_99 * GOOD_ERROR_DEG)
            .hypot(beyond(errors.heading_sd_deg, GOOD_HEADING_DEG))
            .hypot(beyond(errors.alignment_sd_deg, GOOD_ALIGNMENT_DEG))
    }

    /// What no more than one in a hundred such berths would have hidden, degrees: a turn of the
    /// ship's field by less may have passed its check.
    pub fn detectable_turn_deg(&self) -> Option<f64> {
        self.standard_error_deg.map(|error| NORMAL_99 * error)
    }

    /// The angle and its error.
    pub fn angle_summary(&self) -> String {
        let error = self
            .standard_error_deg
            .map_or("unknown".to_owned(), |error| format!("{error:.1} degrees"));
        format!(
            "the field read is {:.1} degrees from the model's (standard error {error})",
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

/// What there is of a standard deviation beside a good one.
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
