//! Refusals of a plan or a reading.

use super::card_check::CardCheck;
use super::lambda_comparison::LambdaComparison;
use super::misreadings::Misreading;
use crate::berth::{BerthError, Consistency};
use serde::{Deserialize, Serialize};
use std::fmt;

/// Reason for the absence of a plan.
#[derive(Clone, Debug, PartialEq, Serialize, Deserialize)]
#[serde(tag = "refusal", rename_all = "snake_case")]
pub enum Refusal {
    /// The model has no covariance, so there is no band.
    NoCovariance,
    /// The model's last sample is too old.
    ModelTooOld {
        /// Age of the last sample, days.
        days: f64,
        /// Greatest accepted age, days.
        limit_days: f64,
    },
    /// Magnetic cargo is on board that the model does not include.
    CargoOnBoard,
    /// The field's direction at the berth contradicts the model.
    InconsistentBerth {
        /// Size of the contradiction.
        consistency: Consistency,
        /// Single misreadings that explain it.
        #[serde(rename = "mistakes")]
        misreadings: Vec<Misreading>,
    },
    /// The field's strength at the berth is implausible.
    ImplausibleLambda {
        /// Resulting λ.
        lambda: f64,
        /// Single misreadings that explain it.
        #[serde(rename = "mistakes")]
        misreadings: Vec<Misreading>,
    },
    /// The reading is not a possible field.
    NoSuchField {
        /// Description of the reading.
        what: String,
        /// Single misreadings that explain it.
        #[serde(rename = "mistakes")]
        misreadings: Vec<Misreading>,
    },
    /// The compass heading contradicts the measured field.
    CardDisagrees(CardCheck),
    /// The earth's field at the berth is too weak for a compass.
    FieldTooWeak {
        /// Horizontal field, nT.
        h_nt: f64,
    },
    /// Some compass headings stand for several magnetic ones with the present magnetism.
    AmbiguousHeadings {
        /// Description from the model.
        what: String,
    },
    /// One λ does not explain the readings on two headings: steel on the quay, a change of the
    /// ship since the model, or a wrong reading.
    ForeignField {
        /// Field that is left unexplained, nT.
        left_nt: f64,
    },
    /// λ contradicts that of an earlier berth.
    OtherLambda {
        /// Present λ.
        lambda: f64,
        /// Change of the ship along the needle that would explain it, nT.
        along_nt: f64,
        /// Comparison with the earlier λ.
        #[serde(rename = "compared")]
        comparison: LambdaComparison,
    },
    /// The berth could not verify that the ship's magnetism is still the model's, and the
    /// resulting band is too wide.
    UncheckedBerth {
        /// Description of the uncertainty.
        what: String,
    },
    /// The band is too wide.
    BandTooWide {
        /// Name of the place.
        place: String,
        /// Half the widest 95 % band there, degrees.
        band_deg: f64,
        /// Greatest accepted band, degrees.
        limit_deg: f64,
    },
    /// The correctors on board cannot reduce the residual enough.
    ResidualTooLarge {
        /// Name of the place.
        place: String,
        /// Greatest residual there with its band, degrees.
        reach_deg: f64,
        /// Greatest residual alone, degrees.
        worst_deg: f64,
        /// Greatest accepted residual with its band, degrees.
        limit_deg: f64,
        /// Largest coefficient of the residual.
        #[serde(rename = "mostly")]
        dominant: Coefficient,
    },
    /// Spheres would have to move, but λ is too uncertain.
    MagnetometerTooPoor {
        /// Relative standard error of λ.
        lambda_sd: f64,
        /// Greatest relative standard error for moving soft iron.
        limit: f64,
    },
}

/// Coefficient of the deviation, and its corrector.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Serialize, Deserialize)]
#[serde(rename_all = "snake_case")]
pub enum Coefficient {
    /// Constant part: lubber line and reference, without a corrector.
    A,
    /// Fore-and-aft magnets and Flinders bar.
    B,
    /// Athwartship magnets.
    C,
    /// Spheres.
    D,
    /// Slewed spheres.
    E,
}

impl Refusal {
    /// Converts a refused reading, with single misreadings that explain it.
    pub(crate) fn from_berth_error(error: &BerthError, misreadings: Vec<Misreading>) -> Refusal {
        let what = error.to_string();
        match error {
            BerthError::Inconsistent(consistency) => Refusal::InconsistentBerth {
                consistency: *consistency,
                misreadings,
            },
            BerthError::Implausible(lambda) => Refusal::ImplausibleLambda {
                lambda: *lambda,
                misreadings,
            },
            BerthError::Reading {
                name,
                value,
                greatest,
                ..
            } => Refusal::NoSuchField {
                what: too_strong(name, *value, *greatest).unwrap_or(what),
                misreadings,
            },
            BerthError::NothingRead => Refusal::NoSuchField { what, misreadings },
            BerthError::NoDirectiveForce { .. } | BerthError::Model(_) | BerthError::Field(_) => {
                Refusal::AmbiguousHeadings { what }
            }
        }
    }

    /// Returns the single misreadings that explain the refusal.
    pub fn misreadings(&self) -> &[Misreading] {
        match self {
            Refusal::InconsistentBerth { misreadings, .. }
            | Refusal::ImplausibleLambda { misreadings, .. }
            | Refusal::NoSuchField { misreadings, .. } => misreadings,
            _ => &[],
        }
    }
}

/// Describes an impossible part of the field.
fn too_strong(name: &str, value_nt: f64, greatest_nt: f64) -> Option<String> {
    let part = match name {
        "forward_nt" => "forward",
        "starboard_nt" => "to starboard",
        "down_nt" => "down",
        _ => return None,
    };
    let value_ut = value_nt / 1e3;
    let value = if value_ut.abs() < 1e9 {
        format!("{value_ut:.0}")
    } else {
        format!("{value_ut:e}")
    };
    let greatest_ut = greatest_nt / 1e3;
    Some(format!(
        "{value} microtesla {part}, more than the possible {greatest_ut:.0}"
    ))
}

impl fmt::Display for Coefficient {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        f.write_str(match self {
            Coefficient::A => "A (alignment, without a corrector)",
            Coefficient::B => "B (fore-and-aft magnets and Flinders bar)",
            Coefficient::C => "C (athwartship magnets)",
            Coefficient::D => "D (spheres)",
            Coefficient::E => "E (slewed spheres)",
        })
    }
}
