//! Alerts for what the analysis found to have changed.
//!
//! What always holds: a change of the ship calls for an alert for a week, and longer
//! until her model is as certain again as the vessel's limit asks, unless it is over;
//! what passes by and a reference's fault call for one while they last. The latest of
//! each cause speaks for all. Work on correctors, compass or ship that the logbook
//! tells of is expected and calls for none.

use super::alert::{AlertWanted, Cause, Dated, Evidence, Severity};
use super::findings::{Findings, FoundChange};
use super::limits::AlertLimits;
use super::wanted::sinking_slack_deg;
use crate::time::Time;
use binnacle_compass::result;
use binnacle_compass::time::Timestamp;
use std::fmt::Write as _;

/// A change of deviation of this size is to be acted on, degrees.
const WARN_DEG: f64 = 2.0;
/// A size elsewhere that is larger by less than this is not worth a word, degrees.
const WORTH_A_WORD_DEG: f64 = 0.5;
/// So long a change is news, even if the model has learnt it, seconds.
const NEWS_S: f64 = 7.0 * 86_400.0;
/// A model of fewer days than this after a change may yet turn out wrong, seconds.
const SETTLED_S: f64 = 86_400.0;
/// A compass as likely at fault as this is not to be trusted.
const COMPASS_SUSPECTED: f64 = 0.1;
/// Causes less likely than this are not worth a word.
const UNLIKELY: f64 = 0.01;

/// How far the ship's model has come with a change.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
enum Stage {
    /// It is not certain that there is one.
    Doubtful,
    /// No card holds.
    NoModel,
    /// There is a model since, of less than a day or less certain than the limit asks.
    Interim,
    /// The model since is as certain as the limit asks.
    Learnt,
    /// It is not the ship's magnetism that changed.
    NotTheShips,
}

/// The alerts that the changes call for, one of each cause.
pub(super) fn changed(
    findings: &Findings,
    limits: &AlertLimits,
    open_at: impl Fn(Cause) -> Option<Severity>,
) -> Vec<AlertWanted> {
    let mut wanted: Vec<AlertWanted> = Vec::new();
    for found in findings.changes.iter().rev() {
        let cause = cause_of(found.change.cause);
        let known = wanted.iter().any(|alert| alert.cause == cause);
        let stage = stage(found, findings, limits);
        if !known && !found.expected && holds(found, stage, findings) {
            let dated = dated(found, findings);
            let severity = severity(found, stage, limits, open_at(cause));
            wanted.push(alert(found, cause, stage, dated, severity));
        }
    }
    wanted
}

/// What became of the change that an alert was about, where it did not simply end.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub(super) enum Became {
    /// There was none after all.
    Withdrawn,
    /// It stays, and the model has learnt it.
    Learnt,
    /// Something else is held to have caused it.
    Renamed,
}

pub(super) fn became(cause: Cause, since: Time, findings: &Findings) -> Option<Became> {
    let at_that_time = findings
        .changes
        .iter()
        .filter(|found| dated(found, findings).includes(since));
    let (own, others): (Vec<_>, Vec<_>) =
        at_that_time.partition(|found| cause_of(found.change.cause) == cause);
    let stays = |found: &&&FoundChange| {
        let change = &found.change;
        change.confirmed && !change.withdrawn && change.ended.is_none()
    };
    if own.iter().any(|found| found.change.withdrawn) {
        return Some(Became::Withdrawn);
    }
    if own
        .iter()
        .filter(stays)
        .any(|found| found.change.cause.changes_deviation())
    {
        return Some(Became::Learnt);
    }
    (own.is_empty() && others.iter().any(|found| stays(&found))).then_some(Became::Renamed)
}

fn cause_of(cause: result::Cause) -> Cause {
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
        // Work that nobody reported is not known to be work.
        result::Cause::AdjustmentOrRepair | result::Cause::Unknown => Cause::UnknownChange,
    }
}

fn stage(found: &FoundChange, findings: &Findings, limits: &AlertLimits) -> Stage {
    if !found.change.confirmed {
        return Stage::Doubtful;
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
        Stage::Learnt
    } else {
        Stage::Interim
    }
}

fn holds(found: &FoundChange, stage: Stage, findings: &Findings) -> bool {
    let change = &found.change;
    if change.ended.is_some() {
        return false;
    }
    if !change.cause.changes_deviation() {
        return true;
    }
    let is_news = findings
        .data_until
        .is_some_and(|until| until.seconds_since(change.detected_at) < NEWS_S);
    let is_of_now = findings.epoch_from.is_none_or(|from| change.from >= from);
    is_news || (is_of_now && stage != Stage::Learnt)
}

/// Later samples date a change better, by days if they fill a gap, and may name
/// another cause: an alert was about the change that is nearest to its date, among
/// those of the ship, those of her references, or the others.
fn dated(found: &FoundChange, findings: &Findings) -> Dated {
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
    Dated {
        from: before.into_iter().max().map(midway),
        to: after.into_iter().min().map(midway),
    }
}

fn alert(
    found: &FoundChange,
    cause: Cause,
    stage: Stage,
    dated: Dated,
    severity: Severity,
) -> AlertWanted {
    let change = &found.change;
    let mut evidence = change.evidence.clone();
    let likely = change.causes.iter().filter(|c| c.probability >= UNLIKELY);
    let likely: Vec<String> = likely
        .map(|c| format!("{} {:.0} %", words(c.cause), 100.0 * c.probability))
        .collect();
    if !likely.is_empty() {
        evidence.push(format!("How likely each cause is: {}.", likely.join(", ")));
    }
    AlertWanted {
        cause,
        severity,
        since: change.from.into(),
        dated,
        summary: summary(found, stage),
        advice: if is_compass_or_gyro(change) {
            COMPASS_OR_GYRO
        } else if stage == Stage::Doubtful && may_be_hers(change) {
            WHICH_IS_OPEN
        } else {
            advice(change.cause, stage)
        },
        evidence: Evidence(evidence),
    }
}

/// As bad as the deviation that it causes, here or on the waters ahead; what it has been is left
/// only well below what made it so.
fn severity(
    found: &FoundChange,
    stage: Stage,
    limits: &AlertLimits,
    was: Option<Severity>,
) -> Severity {
    if found.change.cause == result::Cause::CompassFault {
        return Severity::Critical;
    }
    let ahead_deg = found.size_ahead_deg.unwrap_or(0.0);
    let size_deg = found.size_deg.unwrap_or(0.0).max(ahead_deg);
    let by_size = if size_deg >= limits.deviation_deg - sinking_slack_deg(was, Severity::Critical) {
        Severity::Critical
    } else if size_deg >= WARN_DEG - sinking_slack_deg(was, Severity::Warning)
        || found.change.cause == result::Cause::ReferenceFault
    {
        Severity::Warning
    } else {
        Severity::Notice
    };
    match stage {
        // What is in doubt may be nothing. The compass can be relied on again, by the new
        // model; what passes spoils no model.
        Stage::Doubtful | Stage::Learnt | Stage::NotTheShips => by_size.min(Severity::Warning),
        Stage::NoModel | Stage::Interim => by_size,
    }
}

fn words(cause: result::Cause) -> &'static str {
    match cause {
        result::Cause::AdjustmentOrRepair => "work on ship or compass that nobody reported",
        result::Cause::Unknown => "something unknown",
        result::Cause::ReferenceFault => "a fault of gyro or satellite compass",
        known => cause_of(known).words(),
    }
}

/// The change's size on the waters ahead, where it is worth a word beside that here.
fn ahead_deg(found: &FoundChange) -> Option<f64> {
    let (here, ahead) = found.size_deg.zip(found.size_ahead_deg)?;
    (ahead > here + WORTH_A_WORD_DEG).then_some(ahead)
}

fn summary(found: &FoundChange, stage: Stage) -> String {
    let change = &found.change;
    let since = Time(change.from).to_the_minute();
    let cause = words(change.cause);
    if change.cause == result::Cause::CompassFault {
        return format!("Since about {since} the compass does not follow the ship.");
    }
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
        Stage::Doubtful => format!(
            "Since about {since} the compass may be astray{size}; perhaps {cause}. It is not \
             certain yet."
        ),
        Stage::NotTheShips => format!(
            "Since about {since} the measured deviation is astray{size}; most likely {cause}, \
             not the ship."
        ),
        Stage::NoModel | Stage::Interim | Stage::Learnt => {
            format!("Since about {since} the deviation is another{size}; most likely {cause}.")
        }
    }
}

const COMPASS_OR_GYRO: &str = "Compass or gyro swings, and there is no third to tell which. Trust \
     neither: take an azimuth now and each watch, compare both with a steady course over ground, \
     and look at compass, sensor and cables. The samples taken meanwhile are left out of the model.";

/// A share of causes in the ship from which on she is not cleared.
const HERS_SUSPECTED: f64 = 0.05;

/// Whether a fault of the only reference may as well be one of the compass.
fn is_compass_or_gyro(change: &result::Change) -> bool {
    let of_the_compass = result::Cause::CompassFault;
    change.cause == result::Cause::ReferenceFault
        && change
            .causes
            .iter()
            .any(|c| c.cause == of_the_compass && c.probability > COMPASS_SUSPECTED)
}

const WHICH_IS_OPEN: &str = "Compass or reference is astray, and the samples do not tell yet \
     which. Take an azimuth now and once a watch and steer by what it confirms; report in the \
     logbook what may have happened.";

/// Whether what looks like a reference's fault may as well be a change of the ship.
fn may_be_hers(change: &result::Change) -> bool {
    let hers = change.causes.iter().filter(|c| c.cause.changes_deviation());
    change.cause == result::Cause::ReferenceFault
        && hers.map(|c| c.probability).sum::<f64>() > HERS_SUSPECTED
}

fn advice(cause: result::Cause, stage: Stage) -> &'static str {
    match (cause, stage) {
        (result::Cause::CompassFault, _) => {
            "Do not use the compass. Steer by gyro or satellite compass; look at bowl, pivot and \
             liquid, and at the sensor and its cable. The samples taken meanwhile are left out of \
             the model."
        }
        (result::Cause::ReferenceFault, _) => {
            "Check gyro and satellite compass against an azimuth. The magnetic compass itself is \
             not suspected."
        }
        (result::Cause::Alignment, _) => {
            "Use no card from before: the compass is off by the same on every heading. Steer by \
             gyro, satellite compass or the corrected heading and take an azimuth. Look whether \
             the bowl, the lubber line or the sensor has shifted against the ship's head; put it \
             back, and report that in the logbook. No corrector needs to be moved."
        }
        (_, Stage::Doubtful) => {
            "Steer by gyro or satellite compass until the next samples tell whether the card still \
             holds. Take an azimuth now and once a watch, and report in the logbook what may have \
             happened."
        }
        (_, Stage::NotTheShips) => {
            "Steer by gyro or satellite compass until it is over. Nothing needs to be adjusted: \
             the samples taken meanwhile are left out of the model."
        }
        (result::Cause::MagneticCargo, Stage::NoModel) => {
            "No card holds with this cargo. Steer by gyro or satellite compass, take an azimuth \
             once a watch and after each large alteration of course, and report the cargo in the \
             logbook. The model from before is used again once it is discharged."
        }
        (result::Cause::MagneticCargo, _) => {
            "Use no card from before loading. Steer by gyro, satellite compass or the corrected \
             heading, which knows the cargo, take an azimuth once a watch, and report the cargo in \
             the logbook. The model from before is used again once it is discharged."
        }
        (_, Stage::NoModel) => {
            "No card holds. Steer by gyro or satellite compass, take an azimuth once a watch and \
             on each new course, and report what happened in the logbook. Steady courses on other \
             headings make a new model soonest; expect an adjustment."
        }
        (_, Stage::Interim) => {
            "Do not use the card from before. Steer by gyro, satellite compass or the corrected \
             heading, whose band is wider for now, take an azimuth once a watch and on each new \
             course, and report what happened in the logbook. Expect an adjustment if the \
             deviation stays large."
        }
        (_, Stage::Learnt) => {
            "Put up a new card: the one from before does not hold. The corrected heading takes \
             the change into account. Check it by an azimuth, report what happened in the \
             logbook, and expect an adjustment if the deviation is over the limit."
        }
    }
}

#[cfg(test)]
mod tests;
