//! Wording of refusals.

use super::misreadings::Misreading;
use super::refusal::Refusal;
use std::fmt;

impl Refusal {
    /// Describes the single explanations, misreadings first.
    pub fn explanations(&self) -> Vec<String> {
        let misreadings = self.misreadings().iter().map(ToString::to_string);
        let suspects = match self {
            // A misreading that explains everything leaves no reason to suspect steel.
            Refusal::InconsistentBerth {
                consistency,
                misreadings,
            } if misreadings.is_empty() => consistency
                .suspects()
                .iter()
                .map(ToString::to_string)
                .collect(),
            Refusal::CardDisagrees(card) => card.suspects(),
            _ => Vec::new(),
        };
        misreadings.chain(suspects).collect()
    }

    /// Summarises the refusal without its explanations.
    pub fn summary(&self) -> String {
        match self {
            Refusal::InconsistentBerth { consistency, .. } => {
                format!("the berth is inconsistent: {}", consistency.angle_summary())
            }
            Refusal::ImplausibleLambda { lambda, .. } => {
                format!("the measured field implies lambda {lambda:.3}")
            }
            Refusal::CardDisagrees(card) => card.summary(),
            Refusal::NoSuchField { what, .. } => format!("impossible field for a ship: {what}"),
            other => other.to_string(),
        }
    }
}

/// Returns the text for a place: the berth has no name of its own.
pub(crate) fn place_text(place: &str) -> &str {
    match place {
        "berth" => "the berth",
        named => named,
    }
}

impl fmt::Display for Refusal {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        let explained = |f: &mut fmt::Formatter<'_>, misreadings: &[Misreading]| {
            misreadings
                .iter()
                .try_for_each(|m| write!(f, "; it would fit if {m}"))
        };
        match self {
            Refusal::ForeignField { left_nt } => write!(
                f,
                "one lambda leaves {:.1} microtesla of the readings on two headings unexplained: \
                 steel on the quay, a change of the ship since the model, or a wrong reading",
                left_nt / 1e3
            ),
            Refusal::NoCovariance => {
                f.write_str("the model has no covariance, so its band is unknown")
            }
            Refusal::ModelTooOld { days, limit_days } => write!(
                f,
                "the model's last sample is {days:.0} days old, more than the limit of \
                 {limit_days:.0}"
            ),
            Refusal::CargoOnBoard => {
                f.write_str("magnetic cargo is on board that the model does not include")
            }
            Refusal::InconsistentBerth {
                consistency,
                misreadings,
            } => {
                let words = if misreadings.is_empty() {
                    consistency.to_string()
                } else {
                    consistency.angle_summary()
                };
                write!(f, "the berth is inconsistent: {words}")?;
                explained(f, misreadings)
            }
            Refusal::ImplausibleLambda { misreadings, .. }
            | Refusal::NoSuchField { misreadings, .. } => {
                f.write_str(&self.summary())?;
                explained(f, misreadings)
            }
            Refusal::CardDisagrees(card) => card.fmt(f),
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
                comparison,
            } => write!(
                f,
                "{}: the ship's magnetism has changed by {:.1} microtesla along the needle since \
                 the model, the scale or place of a magnetometer differed, or iron near the \
                 compass was altered; a repair entry in the logbook since then ends the comparison",
                comparison.summary(*lambda),
                along_nt / 1e3
            ),
            Refusal::BandTooWide {
                place,
                band_deg,
                limit_deg,
            } => write!(
                f,
                "at {} the residual is uncertain by {band_deg:.1} degrees, more than the limit of \
                 {limit_deg:.1}",
                place_text(place)
            ),
            Refusal::ResidualTooLarge {
                place,
                reach_deg,
                worst_deg,
                limit_deg,
                dominant,
            } => write!(
                f,
                "at {} the best setting found for the correctors on board leaves {worst_deg:.1} \
                 degrees, {reach_deg:.1} with the band, more than the limit of {limit_deg:.1}; the \
                 largest part is {dominant}",
                place_text(place)
            ),
            Refusal::MagnetometerTooPoor { lambda_sd, limit } => write!(
                f,
                "lambda is uncertain by {:.1} per cent, more than the limit of {:.1}, and spheres \
                 would have to be moved",
                100.0 * lambda_sd,
                100.0 * limit
            ),
        }
    }
}
