//! Why there is no plan, and what would cure it.

use super::card_check::CardCheck;
use super::lambda_comparison::LambdaComparison;
use super::misreadings::Misreading;
use crate::berth::{BerthError, Consistency};
use serde::{Deserialize, Serialize};
use std::fmt;

/// What keeps a plan from being given.
#[derive(Clone, Debug, PartialEq, Serialize, Deserialize)]
#[serde(tag = "refusal", rename_all = "snake_case")]
pub enum Refusal {
    /// The model has no covariance, so that no band can be given.
    NoCovariance,
    /// The model's last sample is too old.
    ModelTooOld {
        /// Its age.
        days: f64,
        /// The oldest that is taken.
        limit_days: f64,
    },
    /// There is magnetic cargo on board that the model does not know.
    CargoOnBoard,
    /// The field at the berth is not where the model says.
    InconsistentBerth {
        /// By how much.
        consistency: Consistency,
        /// Mistakes that alone would explain it.
        #[serde(rename = "mistakes")]
        misreadings: Vec<Misreading>,
    },
    /// The field at the berth is not as strong as any ship's.
    ImplausibleLambda {
        /// What it would make λ.
        lambda: f64,
        /// Mistakes that alone would explain it.
        #[serde(rename = "mistakes")]
        misreadings: Vec<Misreading>,
    },
    /// What was read is no field that a ship lies in.
    NoSuchField {
        /// What it would be.
        what: String,
        /// Mistakes that alone would explain it.
        #[serde(rename = "mistakes")]
        misreadings: Vec<Misreading>,
    },
    /// The compass did not read what the field read would turn it to.
    CardDisagrees(CardCheck),
    /// The earth's field at the berth is too weak to steer by.
    FieldTooWeak {
        /// Its horizontal part, nT.
        h_nt: f64,
    },
    /// As she is, some compass headings stand for several magnetic ones.
    AmbiguousHeadings {
        /// What the model says.
        what: String,
    },
    /// λ is not what an earlier berth of the compass told.
    OtherLambda {
        /// What it would be now.
        lambda: f64,
        /// What changes of the ship along the needle would do that, nT.
        along_nt: f64,
        /// Beside the earlier one.
        #[serde(rename = "compared")]
        comparison: LambdaComparison,
    },
    /// The berth has not shown whether the ship's magnetism is still the model's, and what that
    /// leaves open is too much.
    UncheckedBerth {
        /// What it is, in words.
        what: String,
    },
    /// The residual is known too badly.
    BandTooWide {
        /// Where.
        place: String,
        /// Half the widest 95 % band there.
        band_deg: f64,
        /// The widest that is taken.
        limit_deg: f64,
    },
    /// The correctors there are do not bring the residual down far enough.
    ResidualTooLarge {
        /// Where.
        place: String,
        /// The greatest residual there, band included.
        reach_deg: f64,
        /// The greatest residual alone.
        worst_deg: f64,
        /// The greatest that is taken, band included.
        limit_deg: f64,
        /// The coefficient that most of it is.
        #[serde(rename = "mostly")]
        dominant: Coefficient,
    },
    /// Spheres would have to be moved, and λ is too unsure to tell how far.
    MagnetometerTooPoor {
        /// Standard error of λ as a share of it.
        lambda_sd: f64,
        /// The greatest with which soft iron is moved.
        limit: f64,
    },
}

/// A coefficient of the deviation, and so what would correct it.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Serialize, Deserialize)]
#[serde(rename_all = "snake_case")]
pub enum Coefficient {
    /// The same on all headings: lubber line and reference, which no corrector cures.
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
    /// Why a reading is not taken, and what alone would explain it.
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

    /// The mistakes each of which alone would explain it.
    pub fn misreadings(&self) -> &[Misreading] {
        match self {
            Refusal::InconsistentBerth { misreadings, .. }
            | Refusal::ImplausibleLambda { misreadings, .. }
            | Refusal::NoSuchField { misreadings, .. } => misreadings,
            _ => &[],
        }
    }
}

/// A part of the field that cannot be, as a person calls it.
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
        "{value} microtesla {part}, where more than {greatest_ut:.0} cannot be"
    ))
}

impl fmt::Display for Coefficient {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        f.write_str(match self {
            Coefficient::A => "A, which is alignment and no corrector's",
            Coefficient::B => "B, of fore-and-aft magnets and Flinders bar",
            Coefficient::C => "C, of athwartship magnets",
            Coefficient::D => "D, of spheres",
            Coefficient::E => "E, of slewed spheres",
        })
    }
}
