//! Cures of refusals.

use super::refusal::{Coefficient, Refusal};
use serde::{Deserialize, Serialize};

/// A refusal with its cures.
#[derive(Clone, Debug, PartialEq, Serialize, Deserialize)]
pub struct Refused {
    /// Reason for the refusal.
    #[serde(flatten)]
    pub refusal: Refusal,
    /// Description of the refusal.
    pub words: String,
    /// Cures, the easiest first.
    pub cures: Vec<Cure>,
}

/// Cure of a refusal.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Serialize, Deserialize)]
#[cfg_attr(feature = "openapi", derive(utoipa::ToSchema))]
#[cfg_attr(feature = "openapi", schema(as = AdjustmentCure))]
#[serde(rename_all = "snake_case")]
pub enum Cure {
    /// Another reading: check heading, axes and unit, away from steel.
    ReadAgain,
    /// A few settled headings at sea, for an up-to-date model.
    HeadingsAtSea,
    /// Headings in waters with another dip.
    OtherWaters,
    /// Waiting until the cargo is discharged.
    AfterDischarge,
    /// A magnetometer with less error.
    BetterMagnetometer,
    /// Another berth, or a larger distance from steel.
    AnotherBerth,
    /// Magnets, spheres or pieces of bar that are not on board.
    OtherCorrectors,
    /// A check of the lubber line and of the reference's alignment.
    Alignment,
    /// A swing of the vessel.
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
            Refusal::ForeignField { .. } => {
                vec![Cure::AnotherBerth, Cure::ReadAgain, Cure::HeadingsAtSea]
            }
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
            // A narrower band would not make the residual smaller.
            Refusal::ResidualTooLarge {
                worst_deg,
                limit_deg,
                ..
            } if worst_deg > limit_deg => vec![Cure::OtherCorrectors],
            Refusal::ResidualTooLarge { .. } => {
                vec![Cure::OtherCorrectors, Cure::HeadingsAtSea, Cure::Swing]
            }
            // Heel also makes a magnetometer imprecise.
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
