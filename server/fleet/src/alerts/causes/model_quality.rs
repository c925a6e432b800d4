//! Models that are missing, or less certain than the vessel's limit requires.

use super::facts::Situation;
use super::hysteresis::compare;
use super::row::{CardEffect, CauseRow, Condition, Ending, Finder, PlanEffect};
use crate::alerts::cause::Cause;
use binnacle_compass::time::Timestamp;
use binnacle_platform::severity::Severity;
use binnacle_platform::time::Time;

/// Time in which a ship steers the headings that a model needs, seconds.
const PATIENCE_S: f64 = 7.0 * 86_400.0;

/// No model after a week of samples.
pub(super) const NO_MODEL: CauseRow = CauseRow {
    cause: Cause::NoModel,
    title: "no model of the compass yet",
    finders: &[Finder::Findings(no_model)],
    severity: |_| Severity::Notice,
    advice: |_| {
        "Use no earlier deviation card. Take azimuths, and steer the headings that are missing \
         where the passage allows."
    },
    on_card: CardEffect::None,
    on_plan: PlanEffect::None,
    ending: Ending::NotFound,
    ends_with_adjustment: true,
    is_redated: false,
};

/// A wide band after a week of samples, unless an alert about a change covers it.
pub(super) const WIDE_BAND: CauseRow = CauseRow {
    cause: Cause::WideBand,
    title: "the model is too uncertain",
    finders: &[Finder::Findings(wide_band)],
    severity: |_| Severity::Notice,
    advice: |_| {
        "Take an azimuth before relying on the card on a heading that the vessel seldom steers. \
         The vessel's page shows which headings would help most."
    },
    on_card: CardEffect::None,
    on_plan: PlanEffect::None,
    ending: Ending::NotMeasured(|findings| findings.widest_band95_deg.is_some()),
    ends_with_adjustment: true,
    is_redated: false,
};

fn no_model(situation: &Situation<'_>) -> Option<Condition> {
    let from = sampled_since(situation)?;
    let refusal = situation.findings.refusal.as_ref()?;
    let left_out = situation.findings.left_out;
    Some(Condition {
        evidence: vec![format!("What is missing: {refusal}{left_out}.")],
        ..Condition::new(
            from.into(),
            "There have been samples for more than a week, but no model could be fitted to them."
                .to_owned(),
        )
    })
}

fn wide_band(situation: &Situation<'_>) -> Option<Condition> {
    let Situation {
        findings, limits, ..
    } = situation;
    let from = sampled_since(situation)?;
    let is_open = situation.open_severity(Cause::WideBand).is_some();
    if findings.refusal.is_some() || (situation.has_change && !is_open) {
        return None;
    }
    let limit_deg = situation.limit_deg(Cause::WideBand, limits.band95_deg);
    let band_deg = findings
        .widest_band95_deg
        .filter(|band_deg| *band_deg > limit_deg)?;
    let comparison = compare(band_deg, limits.band95_deg);
    Some(Condition {
        evidence: vec![format!(
            "There have been samples since {}.",
            Time(from).to_the_minute()
        )],
        ..Condition::new(
            from.into(),
            format!("On some heading the deviation is known only to ±{band_deg:.1}°{comparison}."),
        )
    })
}

/// Returns the first sample of the epoch, if that is long ago.
fn sampled_since(situation: &Situation<'_>) -> Option<Timestamp> {
    let from = situation.findings.epoch_data_from?;
    (situation.data_until.seconds_since(from) >= PATIENCE_S).then_some(from)
}
