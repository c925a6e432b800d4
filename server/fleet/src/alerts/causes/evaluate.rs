//! Evaluation of the table.
//!
//! Invariant: each function is pure, and names each cause at most once.

use super::change_rules::{Outcome, alert_cause, outcome};
use super::facts::{DetectedChange, Facts, OpenCause, Situation};
use super::row::{CauseRow, Ending};
use super::table::CAUSES;
use crate::alerts::cause::Cause;
use crate::alerts::clearing::{LEARNED, NOT_KNOWN, OVER, RENAMED, WITHDRAWN};
use crate::alerts::desired::DesiredAlert;
use crate::analysis::Findings;
use crate::settings::AlertLimits;
use binnacle_platform::time::Time;

/// Returns the alerts that facts call for, in the order of the table.
pub(in crate::alerts) fn evaluate(facts: Facts<'_>) -> Vec<DesiredAlert> {
    CAUSES.iter().filter_map(|row| row.find(&facts)).collect()
}

/// Returns the alerts that an analysis calls for; `open` are the open causes and severities.
///
/// Alerts about changes come first, the latest change first: the detector's word on a cause
/// goes before that of the figures.
pub(in crate::alerts) fn evaluate_analysis(
    findings: &Findings,
    limits: &AlertLimits,
    open: &[OpenCause],
) -> Vec<DesiredAlert> {
    let Some(data_until) = findings.data_until else {
        return Vec::new();
    };
    let mut desired = evaluate_changes(findings, limits, open);
    let is_other_change = |alert: &DesiredAlert| alert.cause != Cause::ReferenceFault;
    let situation = Situation {
        findings,
        limits,
        open,
        data_until,
        has_change: desired.iter().any(is_other_change),
    };
    for alert in evaluate(Facts::Findings(&situation)) {
        if desired.iter().all(|known| known.cause != alert.cause) {
            desired.push(alert);
        }
    }
    desired
}

/// Returns the alerts that the changes call for: of each cause the latest that holds.
pub(super) fn evaluate_changes(
    findings: &Findings,
    limits: &AlertLimits,
    open: &[OpenCause],
) -> Vec<DesiredAlert> {
    let mut desired: Vec<DesiredAlert> = Vec::new();
    for found in findings.changes.iter().rev() {
        let cause = alert_cause(found.change.cause);
        if desired.iter().any(|alert| alert.cause == cause) {
            continue;
        }
        let was = open.iter().find(|open| open.cause == cause);
        let detected = DetectedChange {
            found,
            findings,
            limits,
            was: was.map(|open| open.severity),
        };
        desired.extend(cause.row().find(&Facts::Change(&detected)));
    }
    desired
}

impl CauseRow {
    /// Returns the reason that clears an alert which an analysis no longer calls for.
    pub(in crate::alerts) fn clearing_reason(
        &self,
        since: Time,
        findings: &Findings,
    ) -> &'static str {
        match self.ending {
            Ending::NotMeasured(is_measured) if !is_measured(findings) => NOT_KNOWN,
            Ending::WithChange => match outcome(self.cause, since, findings) {
                Some(Outcome::Withdrawn) => WITHDRAWN,
                Some(Outcome::Learned) => LEARNED,
                Some(Outcome::Renamed) if self.is_redated => RENAMED,
                Some(Outcome::Renamed) | None => OVER,
            },
            Ending::NotFound | Ending::NotMeasured(_) | Ending::AfterSilence { .. } => OVER,
        }
    }
}
