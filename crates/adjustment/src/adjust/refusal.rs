//! Why there is no plan, and what would cure it.

use super::card::Card;
use super::mistakes::{Mistake, mistakes};
use super::read::Unit;
use super::since::Compared;
use super::vertical::swapped;
use super::{AdjustError, Adjustment, Refused};
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
        mistakes: Vec<Mistake>,
    },
    /// The field at the berth is not as strong as any ship's.
    ImplausibleLambda {
        /// What it would make λ.
        lambda: f64,
        /// Mistakes that alone would explain it.
        mistakes: Vec<Mistake>,
    },
    /// What was read is no field that a ship lies in.
    NoSuchField {
        /// What it would be.
        what: String,
        /// Mistakes that alone would explain it.
        mistakes: Vec<Mistake>,
    },
    /// The compass did not read what the field read would turn it to.
    CardDisagrees(Card),
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
        compared: Compared,
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
        mostly: Coefficient,
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

/// What would cure a refusal.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Serialize, Deserialize)]
#[serde(rename_all = "snake_case")]
pub enum Cure {
    /// Read again: heading, axes, unit, away from steel.
    ReadAgain,
    /// A few settled headings at sea, so that the model is of today.
    HeadingsAtSea,
    /// Headings in waters with another dip.
    OtherWaters,
    /// Wait until the cargo is ashore.
    AfterDischarge,
    /// A magnetometer with less error.
    BetterMagnetometer,
    /// Another berth, or farther from steel.
    AnotherBerth,
    /// Magnets, spheres or pieces of bar that are not on board.
    OtherCorrectors,
    /// Look after the lubber line and how the reference stands.
    Alignment,
    /// Swing the ship.
    Swing,
}

impl Refusal {
    /// Why a reading is not taken, and what alone would explain it.
    pub(super) fn of_reading(error: &BerthError, mistakes: Vec<Mistake>) -> Refusal {
        let what = error.to_string();
        match error {
            BerthError::Inconsistent(consistency) => Refusal::InconsistentBerth {
                consistency: *consistency,
                mistakes,
            },
            BerthError::Implausible(lambda) => Refusal::ImplausibleLambda {
                lambda: *lambda,
                mistakes,
            },
            BerthError::Reading {
                name,
                value,
                greatest,
                ..
            } => Refusal::NoSuchField {
                what: too_strong(name, *value, *greatest).unwrap_or(what),
                mistakes,
            },
            BerthError::NothingRead => Refusal::NoSuchField { what, mistakes },
            BerthError::NoDirectiveForce { .. } | BerthError::Model(_) | BerthError::Field(_) => {
                Refusal::AmbiguousHeadings { what }
            }
        }
    }

    /// The mistakes each of which alone would explain it.
    pub fn mistakes(&self) -> &[Mistake] {
        match self {
            Refusal::InconsistentBerth { mistakes, .. }
            | Refusal::ImplausibleLambda { mistakes, .. }
            | Refusal::NoSuchField { mistakes, .. } => mistakes,
            _ => &[],
        }
    }

    /// What alone would explain it, in words, mistakes first.
    pub fn could_be(&self) -> Vec<String> {
        let mistakes = self.mistakes().iter().map(ToString::to_string);
        let suspects = match self {
            // A mistake that explains all of it leaves nothing to suspect the steel of.
            Refusal::InconsistentBerth {
                consistency,
                mistakes,
            } if mistakes.is_empty() => consistency
                .suspects()
                .iter()
                .map(ToString::to_string)
                .collect(),
            Refusal::CardDisagrees(card) => card.suspects(),
            _ => Vec::new(),
        };
        mistakes.chain(suspects).collect()
    }

    /// What is wrong, without what could explain it.
    pub fn found(&self) -> String {
        match self {
            Refusal::InconsistentBerth { consistency, .. } => {
                format!("the berth is inconsistent: {}", consistency.apart())
            }
            Refusal::ImplausibleLambda { lambda, .. } => {
                format!("the field read would make lambda {lambda:.3}")
            }
            Refusal::CardDisagrees(card) => card.found(),
            Refusal::NoSuchField { what, .. } => format!("no ship lies in such a field: {what}"),
            other => other.to_string(),
        }
    }

    pub(super) fn with_cures(self) -> Refused {
        let cures = match &self {
            Refusal::NoCovariance | Refusal::ModelTooOld { .. } => {
                vec![Cure::HeadingsAtSea, Cure::Swing]
            }
            Refusal::CargoOnBoard => vec![Cure::AfterDischarge, Cure::Swing],
            Refusal::InconsistentBerth { .. } => {
                vec![Cure::ReadAgain, Cure::AnotherBerth, Cure::HeadingsAtSea]
            }
            Refusal::ImplausibleLambda { .. } | Refusal::NoSuchField { .. } => {
                vec![Cure::ReadAgain, Cure::BetterMagnetometer]
            }
            Refusal::CardDisagrees(_) => vec![Cure::ReadAgain],
            Refusal::FieldTooWeak { .. } => vec![Cure::AnotherBerth],
            Refusal::AmbiguousHeadings { .. } => vec![Cure::Swing],
            Refusal::OtherLambda { .. } => {
                vec![Cure::ReadAgain, Cure::HeadingsAtSea, Cure::Swing]
            }
            Refusal::UncheckedBerth { .. } => vec![
                Cure::ReadAgain,
                Cure::AnotherBerth,
                Cure::BetterMagnetometer,
                Cure::HeadingsAtSea,
                Cure::Swing,
            ],
            Refusal::BandTooWide { .. } => {
                vec![
                    Cure::HeadingsAtSea,
                    Cure::OtherWaters,
                    Cure::BetterMagnetometer,
                    Cure::Swing,
                ]
            }
            // No corrector cures A.
            Refusal::ResidualTooLarge {
                mostly: Coefficient::A,
                ..
            } => vec![Cure::Alignment, Cure::HeadingsAtSea, Cure::Swing],
            // Known better it would be as large.
            Refusal::ResidualTooLarge {
                worst_deg,
                limit_deg,
                ..
            } if worst_deg > limit_deg => vec![Cure::OtherCorrectors],
            Refusal::ResidualTooLarge { .. } => {
                vec![Cure::OtherCorrectors, Cure::HeadingsAtSea, Cure::Swing]
            }
            // A heeled ship's magnetometer is a poor one too.
            Refusal::MagnetometerTooPoor { .. } => {
                vec![Cure::BetterMagnetometer, Cure::ReadAgain, Cure::Swing]
            }
        };
        Refused {
            words: self.to_string(),
            refusal: self,
            cures,
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

/// What is known to be wrong before anything is calculated.
pub(super) fn beforehand(adjustment: &Adjustment<'_>) -> Vec<Refusal> {
    let mut refusals = Vec::new();
    if adjustment.model.covariance.is_none() {
        refusals.push(Refusal::NoCovariance);
    }
    let limit_days = adjustment.limits.model_age_days;
    if let Some(days) = adjustment.circumstances.model_age_days
        && days > limit_days
    {
        refusals.push(Refusal::ModelTooOld { days, limit_days });
    }
    if adjustment.circumstances.cargo_on_board {
        refusals.push(Refusal::CargoOnBoard);
    }
    refusals
}

/// A berth that fails its check is refused; one that cannot be is an error.
pub(super) fn of_berth(
    adjustment: &Adjustment<'_>,
    error: BerthError,
) -> Result<Refusal, AdjustError> {
    let reading = adjustment.reading;
    let mistakes = || {
        let (model, earth) = (adjustment.model, adjustment.earth);
        let mut found = mistakes(
            model,
            earth,
            reading.magnetic(),
            reading.field_nt(),
            Unit::Nanotesla,
            reading.errors(),
            reading.alignment(),
        );
        let with = |vertical| swapped(model, earth, reading, vertical, adjustment.binnacle);
        found.extend(adjustment.vertical.map(with).unwrap_or_default());
        found
    };
    match error {
        BerthError::Inconsistent(_) | BerthError::Implausible(_) => {
            Ok(Refusal::of_reading(&error, mistakes()))
        }
        BerthError::NoDirectiveForce { .. } => Ok(Refusal::of_reading(&error, Vec::new())),
        error => Err(error.into()),
    }
}

/// A place in a sentence: the berth has no name of its own.
pub(super) fn said(place: &str) -> &str {
    match place {
        "berth" => "the berth",
        named => named,
    }
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

impl fmt::Display for Refusal {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        let explained = |f: &mut fmt::Formatter<'_>, mistakes: &[Mistake]| {
            mistakes
                .iter()
                .try_for_each(|m| write!(f, "; it would fit if {m}"))
        };
        match self {
            Refusal::NoCovariance => {
                f.write_str("the model came without a covariance: nothing is known of the band")
            }
            Refusal::ModelTooOld { days, limit_days } => write!(
                f,
                "the model's last sample is {days:.0} days old, of {limit_days:.0} at most"
            ),
            Refusal::CargoOnBoard => {
                f.write_str("magnetic cargo is on board that the model does not know")
            }
            Refusal::InconsistentBerth {
                consistency,
                mistakes,
            } => {
                let words = if mistakes.is_empty() {
                    consistency.in_words()
                } else {
                    consistency.apart()
                };
                write!(f, "the berth is inconsistent: {words}")?;
                explained(f, mistakes)
            }
            Refusal::ImplausibleLambda { mistakes, .. } | Refusal::NoSuchField { mistakes, .. } => {
                f.write_str(&self.found())?;
                explained(f, mistakes)
            }
            Refusal::CardDisagrees(card) => f.write_str(&card.in_words()),
            Refusal::FieldTooWeak { h_nt } => write!(
                f,
                "the earth's horizontal field at the berth, {h_nt:.0} nT, is too weak for a compass"
            ),
            Refusal::AmbiguousHeadings { what } | Refusal::UncheckedBerth { what } => {
                f.write_str(what)
            }
            Refusal::OtherLambda {
                lambda,
                along_nt,
                compared,
            } => write!(
                f,
                "{}: the ship's magnetism has changed by {:.1} microtesla along the needle since \
                 the model, or a magnetometer's scale or place was another, or iron near the \
                 compass was altered: an entry of repair in the logbook since then, that says \
                 so, ends the comparison",
                compared.apart(*lambda),
                along_nt / 1e3
            ),
            Refusal::BandTooWide {
                place,
                band_deg,
                limit_deg,
            } => write!(
                f,
                "at {} the residual is known to {band_deg:.1} degrees only, of \
                 {limit_deg:.1} at most",
                said(place)
            ),
            Refusal::ResidualTooLarge {
                place,
                reach_deg,
                worst_deg,
                limit_deg,
                mostly,
            } => write!(
                f,
                "at {} the best setting found of the correctors on board leaves {worst_deg:.1} \
                 degrees, {reach_deg:.1} with the band, of {limit_deg:.1} at most; most of it is {mostly}",
                said(place)
            ),
            Refusal::MagnetometerTooPoor { lambda_sd, limit } => write!(
                f,
                "lambda is sure only to {:.1} per cent, of {:.1} at most, and spheres would have \
                 to be moved",
                100.0 * lambda_sd,
                100.0 * limit
            ),
        }
    }
}
