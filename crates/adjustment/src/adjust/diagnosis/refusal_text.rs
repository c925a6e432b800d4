//! Wording of refusals.

use super::misreadings::Mistake;
use super::refusal::Refusal;
use std::fmt;

impl Refusal {
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
}

/// A place in a sentence: the berth has no name of its own.
pub(crate) fn said(place: &str) -> &str {
    match place {
        "berth" => "the berth",
        named => named,
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
