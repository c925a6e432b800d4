//! Rules common to all causes that the change detector finds.
//!
//! Invariants:
//!
//! - A change of the ship is an alert for a week, and until the model is as certain as the vessel's
//!   limit requires, unless the change is over.
//! - A disturbance or a reference's fault is an alert while it lasts.
//! - Work on correctors, compass or ship that the logbook reports is no alert.

use super::facts::{DetectedChange, Stage};
use super::hysteresis::hysteresis_deg;
use super::row::{Case, Condition, Size};
use crate::alerts::cause::Cause;
use crate::alerts::desired::EventWindow;
use crate::analysis::{ChangeFinding, Findings};
use binnacle_compass::result;
use binnacle_compass::time::Timestamp;
use binnacle_platform::severity::Severity;
use binnacle_platform::time::Time;
use std::fmt::Write as _;

/// Change of deviation that needs action, degrees.
const WARN_DEG: f64 = 2.0;
/// Excess of the size elsewhere over that here that is worth a mention, degrees.
const MENTION_DEG: f64 = 0.5;
/// Time for which a change is an alert even if the model has learned it, seconds.
const ALERT_S: f64 = 7.0 * 86_400.0;
/// Time for which a model after a change may yet turn out wrong, seconds.
const SETTLED_S: f64 = 86_400.0;
/// Probability below which a cause is not mentioned.
const UNLIKELY: f64 = 0.01;

/// End of the change that an alert was about, where it did not simply pass.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub(super) enum Outcome {
    /// There was no change.
    Withdrawn,
    /// It stays, and the model includes it.
    Learned,
    /// Another cause is the likeliest now.
    Renamed,
}

/// Returns the outcome of the change that an alert dated `since` was about.
pub(super) fn outcome(cause: Cause, since: Time, findings: &Findings) -> Option<Outcome> {
    let at_that_time = findings
        .changes
        .iter()
        .filter(|found| window(found, findings).includes(since));
    let (own, others): (Vec<_>, Vec<_>) =
        at_that_time.partition(|found| alert_cause(found.change.cause) == cause);
    let stays = |found: &&&ChangeFinding| {
        let change = &found.change;
        change.confirmed && !change.withdrawn && change.ended.is_none()
    };
    if own.iter().any(|found| found.change.withdrawn) {
        return Some(Outcome::Withdrawn);
    }
    if own
        .iter()
        .filter(stays)
        .any(|found| found.change.cause.changes_deviation())
    {
        return Some(Outcome::Learned);
    }
    (own.is_empty() && others.iter().any(|found| stays(&found))).then_some(Outcome::Renamed)
}

/// Returns the cause of the alert about a change.
pub(super) fn alert_cause(cause: result::Cause) -> Cause {
    match cause {
        result::Cause::LightningOrShock => Cause::LightningOrShock,
        result::Cause::MagneticCargo => Cause::MagneticCargo,
        result::Cause::Drift => Cause::Drift,
        result::Cause::CompassFault => Cause::CompassFault,
        result::Cause::ReferenceFault => Cause::ReferenceFault,
        result::Cause::Alignment => Cause::Alignment,
        result::Cause::LocalAnomaly => Cause::LocalAnomaly,
        result::Cause::MagneticStorm => Cause::MagneticStorm,
        result::Cause::BerthSteel => Cause::BerthSteel,
        result::Cause::GnssInterference => Cause::GnssInterference,
        // Unreported work cannot be distinguished from other changes.
        result::Cause::AdjustmentOrRepair | result::Cause::Unknown => Cause::UnknownChange,
    }
}

/// Makes the condition of a change that calls for an alert.
pub(super) fn condition(detected: &DetectedChange<'_>) -> Option<Condition> {
    let DetectedChange {
        found, findings, ..
    } = detected;
    let stage = stage(detected);
    if found.expected || !holds(detected, stage) {
        return None;
    }
    let change = &found.change;
    let mut evidence = change.evidence.clone();
    let likely = change.causes.iter().filter(|c| c.probability >= UNLIKELY);
    let likely: Vec<String> = likely
        .map(|c| format!("{} {:.0} %", name(c.cause), 100.0 * c.probability))
        .collect();
    if !likely.is_empty() {
        evidence.push(format!("How likely each cause is: {}.", likely.join(", ")));
    }
    Some(Condition {
        since: change.from.into(),
        window: window(found, findings),
        size: size(detected, stage),
        case: Case::Change(stage),
        summary: summary(found, stage),
        evidence,
    })
}

/// Returns the state of the model after a change.
pub(super) fn stage(detected: &DetectedChange<'_>) -> Stage {
    let DetectedChange {
        found,
        findings,
        limits,
        ..
    } = detected;
    if !found.change.confirmed {
        return Stage::Unconfirmed;
    }
    if !found.change.cause.changes_deviation() {
        return Stage::NotTheShips;
    }
    let Some(band_deg) = findings.widest_band95_deg else {
        return Stage::NoModel;
    };
    let is_settled = findings
        .data_until
        .is_some_and(|until| until.seconds_since(found.change.from) >= SETTLED_S);
    if is_settled && band_deg <= limits.band95_deg {
        Stage::Learned
    } else {
        Stage::Interim
    }
}

fn holds(detected: &DetectedChange<'_>, stage: Stage) -> bool {
    let DetectedChange {
        found, findings, ..
    } = detected;
    let change = &found.change;
    if change.ended.is_some() {
        return false;
    }
    if !change.cause.changes_deviation() {
        return true;
    }
    let is_recent = findings
        .data_until
        .is_some_and(|until| until.seconds_since(change.detected_at) < ALERT_S);
    let is_of_this_epoch = findings.epoch_from.is_none_or(|from| change.from >= from);
    is_recent || (is_of_this_epoch && stage != Stage::Learned)
}

/// Returns the dates that an alert about this change may carry.
///
/// Later samples date a change better, by days if they fill a gap, and may name another cause.
/// An alert was about the change nearest to its date, among those of the ship, those of its
/// references, or the others.
fn window(found: &ChangeFinding, findings: &Findings) -> EventWindow {
    let at = found.change.from;
    let kind = |cause: result::Cause| {
        (
            cause.changes_deviation(),
            cause == result::Cause::ReferenceFault,
        )
    };
    let others = findings.changes.iter().map(|other| &other.change);
    let others = others.filter(|other| kind(other.cause) == kind(found.change.cause));
    let (before, after): (Vec<Timestamp>, Vec<Timestamp>) = others
        .map(|other| other.from)
        .filter(|other| *other != at)
        .partition(|other| *other < at);
    let midway = |other: Timestamp| at.plus_seconds(other.seconds_since(at) / 2.0).into();
    EventWindow {
        from: before.into_iter().max().map(midway),
        to: after.into_iter().min().map(midway),
    }
}

/// Returns the deviation that a change causes, here or on the waters ahead.
fn size(detected: &DetectedChange<'_>, stage: Stage) -> Size {
    let found = detected.found;
    let ahead_deg = found.size_ahead_deg.unwrap_or(0.0);
    let size_deg = found.size_deg.unwrap_or(0.0).max(ahead_deg);
    Size {
        magnitude_deg: size_deg,
        at_least_deg: size_deg,
        limit_deg: detected.limits.deviation_deg,
        was: detected.was,
        ceiling: match stage {
            // An unconfirmed change may be no change. With a new model the compass is reliable
            // again, and a disturbance affects no model.
            Stage::Unconfirmed | Stage::Learned | Stage::NotTheShips => Severity::Warning,
            Stage::NoModel | Stage::Interim => Severity::Critical,
        },
    }
}

/// Grades a change by the deviation that it causes, with hysteresis.
pub(super) fn by_size(size: &Size) -> Severity {
    let reaches =
        |limit_deg, severity| size.magnitude_deg >= limit_deg - hysteresis_deg(size.was, severity);
    let severity = if reaches(size.limit_deg, Severity::Critical) {
        Severity::Critical
    } else if reaches(WARN_DEG, Severity::Warning) {
        Severity::Warning
    } else {
        Severity::Notice
    };
    severity.min(size.ceiling)
}

fn name(cause: result::Cause) -> &'static str {
    match cause {
        result::Cause::AdjustmentOrRepair => "work on ship or compass that nobody reported",
        result::Cause::Unknown => "an unknown cause",
        result::Cause::ReferenceFault => "a fault of gyro or satellite compass",
        known => alert_cause(known).title(),
    }
}

/// Returns the size on the waters ahead, where it exceeds that here enough to mention.
fn ahead_deg(found: &ChangeFinding) -> Option<f64> {
    let (here, ahead) = found.size_deg.zip(found.size_ahead_deg)?;
    (ahead > here + MENTION_DEG).then_some(ahead)
}

fn summary(found: &ChangeFinding, stage: Stage) -> String {
    let change = &found.change;
    let since = Time(change.from).to_the_minute();
    let cause = name(change.cause);
    let mut size = found
        .size_deg
        .map_or(String::new(), |degrees| format!(" by up to {degrees:.1}°"));
    if let Some(ahead_deg) = ahead_deg(found) {
        // Writing to a string cannot fail.
        let _ = write!(
            size,
            " here, {ahead_deg:.1}° on the waters of the last weeks"
        );
    }
    match stage {
        Stage::Unconfirmed => format!(
            "Since about {since} the compass may be in error{size}; possibly {cause}. It is not \
             certain yet."
        ),
        Stage::NotTheShips => format!(
            "Since about {since} the measured deviation is in error{size}; most likely {cause}, \
             not the ship."
        ),
        Stage::NoModel | Stage::Interim | Stage::Learned => {
            format!("Since about {since} the deviation has changed{size}; most likely {cause}.")
        }
    }
}

/// Returns advice according to the state of the model after a change.
pub(super) fn advice(case: Case) -> &'static str {
    match case {
        Case::Change(Stage::Unconfirmed) => {
            "Steer by gyro or satellite compass until the next samples tell whether the card still \
             holds. Take an azimuth now and once a watch, and report in the logbook what may have \
             happened."
        }
        Case::Change(Stage::NotTheShips) => {
            "Steer by gyro or satellite compass until it is over. Nothing needs to be adjusted: \
             the samples taken meanwhile are left out of the model."
        }
        Case::Change(Stage::NoModel) => {
            "No card holds. Steer by gyro or satellite compass, take an azimuth once a watch and \
             on each new course, and report what happened in the logbook. Steady courses on other \
             headings give a new model soonest; expect an adjustment."
        }
        Case::Change(Stage::Interim) => {
            "Do not use the card from before. Steer by gyro, satellite compass or the corrected \
             heading, whose band is wider for now, take an azimuth once a watch and on each new \
             course, and report what happened in the logbook. Expect an adjustment if the \
             deviation stays large."
        }
        _ => {
            "Print and post a new card; the old one is no longer valid. The corrected heading \
             takes the change into account. Check it by an azimuth, report what happened in the \
             logbook, and expect an adjustment if the deviation is over the limit."
        }
    }
}
