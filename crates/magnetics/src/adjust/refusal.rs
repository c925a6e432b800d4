//! Why there is no plan, and what would cure it.

use super::card::Card;
use super::condition::Condition;
use super::mistakes::{Mistake, mistakes};
use super::read::Unit;
use super::{AdjustError, Adjustment, Limits, Plan, PredictedTable, Refused, Water, spheres};
use crate::berth::{BerthError, Consistency};
use crate::deviation::Coefficients;
use crate::model::Model;
use crate::ship::EarthField;
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
        mistakes(
            adjustment.model,
            adjustment.earth,
            reading.magnetic(),
            reading.field_nt(),
            Unit::Nanotesla,
            reading.errors(),
            reading.alignment(),
        )
    };
    match error {
        BerthError::Inconsistent(_) | BerthError::Implausible(_) => {
            Ok(Refusal::of_reading(&error, mistakes()))
        }
        BerthError::NoDirectiveForce { .. } => Ok(Refusal::of_reading(&error, Vec::new())),
        error => Err(error.into()),
    }
}

/// What is wrong with a plan.
pub(super) fn afterwards(
    adjustment: &Adjustment<'_>,
    condition: &Condition<'_>,
    plan: &Plan,
) -> Vec<Refusal> {
    beyond_limits(adjustment, condition, &plan.after, &plan.model_after)
}

/// What is wrong with residuals foretold by a model.
pub(super) fn beyond_limits(
    adjustment: &Adjustment<'_>,
    condition: &Condition<'_>,
    after: &[PredictedTable],
    model: &Model,
) -> Vec<Refusal> {
    match beyond(after, model, &adjustment.limits, adjustment.waters) {
        Some(too_large @ Refusal::ResidualTooLarge { .. }) => {
            spheres::residual_too_large(adjustment, condition, after, too_large)
        }
        found => found.into_iter().collect(),
    }
}

impl Plan {
    /// Which of these limits it breaks in these waters, with what would cure that; nothing
    /// that [`super::plan`] offers breaks those it was asked for.
    #[must_use]
    pub fn beyond(&self, limits: &Limits, waters: &[Water]) -> Option<Refused> {
        beyond(&self.after, &self.model_after, limits, waters).map(Refusal::with_cures)
    }
}

fn beyond(
    after: &[PredictedTable],
    model: &Model,
    limits: &Limits,
    waters: &[Water],
) -> Option<Refusal> {
    let counted = after.iter().enumerate().filter(|(index, _)| {
        // The berth stands first, and is not where she trades.
        index
            .checked_sub(1)
            .and_then(|water| waters.get(water))
            .is_none_or(|water| water.weight > 0.0)
    });
    let mut worst = None;
    for (_, table) in counted {
        let place = table.place.clone();
        let (Some(reach_deg), Some(worst_deg)) = (table.reach_deg, table.worst_deg) else {
            let what = format!("compass headings are ambiguous at {}", said(&place));
            return Some(Refusal::AmbiguousHeadings { what });
        };
        let band_deg = table.widest_band_deg.unwrap_or(f64::INFINITY);
        let too_large = |place| Refusal::ResidualTooLarge {
            place,
            reach_deg,
            worst_deg,
            limit_deg: limits.residual_deg,
            mostly: mostly(model, table),
        };
        if worst_deg > limits.residual_deg {
            // No band is narrow enough for that.
            return Some(too_large(place));
        }
        if band_deg > limits.band_deg {
            worst = Some(Refusal::BandTooWide {
                place,
                band_deg,
                limit_deg: limits.band_deg,
            });
        } else if reach_deg > limits.residual_deg && worst.is_none() {
            worst = Some(too_large(place));
        }
    }
    worst
}

/// The greatest of the exact coefficients, the model's constant with A.
fn mostly(model: &Model, table: &PredictedTable) -> Coefficient {
    let earth = EarthField {
        h_nt: table.h_nt,
        z_nt: table.z_nt,
    };
    let Ok(found) = Coefficients::new(&model.parameters_over_lambda, earth) else {
        return Coefficient::A;
    };
    let a = found.a + model.constant_deg.to_radians();
    let sizes = [
        (a, Coefficient::A),
        (found.b, Coefficient::B),
        (found.c, Coefficient::C),
        (found.d, Coefficient::D),
        (found.e, Coefficient::E),
    ];
    let largest = sizes
        .into_iter()
        .max_by(|x, y| x.0.abs().total_cmp(&y.0.abs()));
    largest.map_or(Coefficient::A, |(_, which)| which)
}

/// A place in a sentence: the berth has no name of its own.
fn said(place: &str) -> &str {
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
            Refusal::AmbiguousHeadings { what } => f.write_str(what),
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
                "at {} the correctors on board leave {worst_deg:.1} degrees, {reach_deg:.1} \
                 with the band, of {limit_deg:.1} at most; most of it is {mostly}",
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
