//! Cures of refusals.

use super::refusal::{Coefficient, Refusal};
use serde::{Deserialize, Serialize};

/// A refusal with what would cure it.
#[derive(Clone, Debug, PartialEq, Serialize, Deserialize)]
pub struct Refused {
    /// What is wrong.
    #[serde(flatten)]
    pub refusal: Refusal,
    /// The same in words.
    pub words: String,
    /// What would cure it, the easiest first.
    pub cures: Vec<Cure>,
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
    pub(crate) fn with_cures(self) -> Refused {
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
                dominant: Coefficient::A,
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
