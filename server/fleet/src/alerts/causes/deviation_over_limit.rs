//! Deviation over the vessel's limit on some heading.

use super::facts::Situation;
use super::hysteresis::{compare, hysteresis_deg};
use super::row::{CardEffect, CauseRow, Condition, Ending, Finder, PlanEffect, Size};
use crate::alerts::cause::Cause;
use binnacle_platform::severity::Severity;
use binnacle_platform::time::Time;

/// Critical at twice the limit, a warning where the whole band is over it.
pub(super) const DEVIATION_OVER_LIMIT: CauseRow = CauseRow {
    cause: Cause::DeviationOverLimit,
    title: "deviation over the limit",
    finders: &[Finder::Findings(over_limit)],
    severity,
    advice: |_| {
        "Steer by the corrected heading or the gyro, check the compass error by azimuth once a \
         watch, and have the compass adjusted."
    },
    on_card: CardEffect::Note,
    // An adjustment removes its cause.
    on_plan: PlanEffect::None,
    ending: Ending::NotMeasured(|findings| findings.worst.is_some()),
    ends_with_adjustment: true,
    is_redated: false,
};

fn over_limit(situation: &Situation<'_>) -> Option<Condition> {
    let Situation {
        findings,
        limits,
        data_until,
        ..
    } = situation;
    let cause = Cause::DeviationOverLimit;
    let limit_deg = situation.limit_deg(cause, limits.deviation_deg);
    let worst = findings.worst?;
    let size_deg = Some(worst.deviation_deg.abs()).filter(|size_deg| *size_deg > limit_deg)?;
    let side = if worst.deviation_deg < 0.0 { "W" } else { "E" };
    let heading = format!("{:03.0}°", worst.compass_deg);
    let comparison = compare(size_deg, limits.deviation_deg);
    let mut evidence = vec![format!(
        "By the model of the samples up to {}, at the place of the last one.",
        Time(*data_until).to_the_minute()
    )];
    evidence.extend(
        worst
            .band95_deg
            .map(|band_deg| format!("Its 95 % band there is ±{band_deg:.1}°.")),
    );
    Some(Condition {
        size: Size {
            magnitude_deg: size_deg,
            at_least_deg: size_deg - worst.band95_deg.unwrap_or(0.0),
            limit_deg: limits.deviation_deg,
            was: situation.open_severity(cause),
            ..Size::default()
        },
        evidence,
        ..Condition::new(
            (*data_until).into(),
            format!("Deviation is {size_deg:.1}° {side} on compass heading {heading}{comparison}."),
        )
    })
}

fn severity(size: &Size) -> Severity {
    let over = |figure_deg, limit_deg, severity| {
        figure_deg > limit_deg - hysteresis_deg(size.was, severity)
    };
    if over(size.magnitude_deg, 2.0 * size.limit_deg, Severity::Critical) {
        Severity::Critical
    } else if over(size.at_least_deg, size.limit_deg, Severity::Warning) {
        Severity::Warning
    } else {
        Severity::Notice
    }
}
