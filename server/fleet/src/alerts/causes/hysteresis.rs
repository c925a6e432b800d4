//! Hysteresis at a limit.
//!
//! Invariant: a limit that was exceeded is left only [`SLACK_DEG`] below it, so that an alert does
//! not open and close, nor change its severity, with every batch.

use binnacle_platform::severity::Severity;

/// Slack below a limit at which an open alert ends or sinks, degrees.
pub(super) const SLACK_DEG: f64 = 0.5;

/// Returns the slack of a severity's limit, for an alert that has been of severity `was`.
pub(super) fn hysteresis_deg(was: Option<Severity>, severity: Severity) -> f64 {
    if was >= Some(severity) {
        SLACK_DEG
    } else {
        0.0
    }
}

/// Compares a figure with its limit, as the end of a sentence.
pub(super) fn compare(figure_deg: f64, limit_deg: f64) -> String {
    if figure_deg > limit_deg {
        return format!(", over the limit of {limit_deg}°");
    }
    let ends_deg = limit_deg - SLACK_DEG;
    format!(": it was over the limit of {limit_deg}° and has not yet fallen to {ends_deg}°")
}
