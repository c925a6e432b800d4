//! Evidence of an event, in words that an officer knows.

use crate::change::{Circumstances, Event, EventKind, tempered_odds};

/// Error from which it is mentioned, degrees where H is 24 µT.
const MENTIONED_ERROR_DEG: f64 = 8.0;
/// Error from which a compass no longer points north, degrees.
const POINTLESS_DEG: f64 = 90.0;
/// Smallest drift that is given, degrees: a smaller figure would read as none.
const SMALLEST_DRIFT_DEG: f64 = 0.1;
/// Evidence of a transient that other vessels may confirm.
const UNCONFIRMED: &str = "too weak for this vessel alone to confirm";

/// Evidence that one reference alone leaves open.
const EITHER: &str = "compass or reference: with no other reference this cannot be decided";

/// Evidence of a transient that is over.
pub(super) const LASTED: &str = "it lasted ";
/// Evidence of a withdrawn change.
const WITHDRAWN: &str = "it was reported as certain and is withdrawn: the samples since do not \
                         confirm it";

/// Returns the evidence of an event; `seen_deg` is the error of the compass as seen.
pub(super) fn evidence(
    event: &Event,
    known: &Circumstances,
    worst_deg: f64,
    seen_deg: Option<f64>,
) -> Vec<String> {
    let [step, reference, burst, _] = event.leads;
    let mut lines = vec![match event.kind {
        EventKind::Step | EventKind::Return(_) => format!(
            "a change of the vessel's own magnetism explains the samples: {} no change, {} a passing \
             disturbance and {} a fault of the reference",
            likelier(step),
            likelier(step - burst),
            likelier(step - reference)
        ),
        EventKind::Alignment => format!(
            "the error changed equally on every heading, and gyro and satellite compass agree: \
             a change of the compass's own alignment is {} a change of the vessel's magnetism",
            likelier(event.over_step_log_likelihood_ratio)
        ),
        EventKind::Drift => format!(
            "{}: a drift is {} one sudden change",
            drifted(worst_deg),
            likelier(event.over_step_log_likelihood_ratio)
        ),
        EventKind::ReferenceFault => format!(
            "the error changed equally on every heading: a fault of the reference is {} no fault and \
             {} a change of the vessel",
            likelier(reference),
            likelier(reference - step)
        ),
        EventKind::Transient => format!(
            "the compass was disturbed for a time: a passing disturbance is {} none and {} a \
             change of the vessel",
            likelier(burst),
            likelier(burst - step)
        ),
    }];
    if event.was_step {
        lines.push(
            "at first taken for a change of the vessel's own magnetism, until it ended at sea"
                .to_owned(),
        );
    }
    match known.at_port {
        Some(true) => lines.push("it began at a port call".to_owned()),
        Some(false) => lines.push("it began at sea".to_owned()),
        None if event.noticed_late => lines.push(
            "it may have begun at the port call before, where cargo is loaded, though it showed \
             only at sea"
                .to_owned(),
        ),
        None => {}
    }
    match known.ended_at_port {
        Some(true) => {
            lines.push("the vessel returned to its earlier state at a port call".to_owned());
        }
        Some(false) => lines.push("the vessel returned to its earlier state at sea".to_owned()),
        None => {}
    }
    if known.changes_within_a_day > 1 {
        lines.push(format!(
            "it is one of {} changes within a day",
            known.changes_within_a_day
        ));
    }
    if known.is_drifting {
        lines.push("another change within weeks had the same direction".to_owned());
    }
    let is_wild = known
        .disturbance_deg
        .is_some_and(|degrees| degrees > MENTIONED_ERROR_DEG);
    if let Some(degrees) = seen_deg.filter(|_| is_wild) {
        lines.push(if degrees > POINTLESS_DEG {
            format!("the error was {degrees:.0} degrees: the compass no longer pointed north")
        } else {
            format!("the error was {degrees:.0} degrees, which few storms and anomalies reach")
        });
        if known.one_reference {
            lines.push(EITHER.to_owned());
        }
    }
    if event.kind == EventKind::ReferenceFault && known.one_reference && !known.is_over {
        lines.push(EITHER.to_owned());
    }
    if let Some(seconds) = known.transient_s.filter(|_| known.is_over) {
        lines.push(lasted(seconds));
    }
    if !known.reported.is_empty() {
        lines.push("the logbook has a report of that time".to_owned());
    }
    if event.withdrawn.is_some() {
        lines.push(WITHDRAWN.to_owned());
    }
    match (event.confirmed || event.withdrawn.is_some(), event.last) {
        (true, _) => {}
        (false, None) => lines.push("not yet certain: more samples are needed".to_owned()),
        (false, Some(_)) => lines.push(UNCONFIRMED.to_owned()),
    }
    lines
}

/// Returns the duration; that of a single sample is unknown.
fn lasted(seconds: f64) -> String {
    let hours = seconds / 3600.0;
    if hours < 0.05 {
        return format!("{LASTED}a few minutes");
    }
    format!("{LASTED}{hours:.1} hours")
}

/// Returns the extent of a drift.
fn drifted(worst_deg: f64) -> String {
    if worst_deg < SMALLEST_DRIFT_DEG {
        return format!(
            "the deviation varies, and is now within {SMALLEST_DRIFT_DEG:.1} degrees of its earlier value"
        );
    }
    format!("the deviation continues to change, by up to {worst_deg:.1} degrees so far")
}

/// Returns the likelihood against an alternative in words, with the temper of `causes`: the
/// models are only nearly right.
fn likelier(log_likelihood_ratio: f64) -> String {
    let odds = tempered_odds(log_likelihood_ratio);
    match odds {
        ..0.7 => "less likely than".to_owned(),
        ..1.5 => "about as likely as".to_owned(),
        ..10.0 => format!("{odds:.1} times likelier than"),
        ..100.0 => format!("{:.0} times likelier than", (odds / 10.0).round() * 10.0),
        ..1000.0 => format!("{:.0} times likelier than", (odds / 100.0).round() * 100.0),
        ..1e6 => "more than a thousand times likelier than".to_owned(),
        _ => "more than a million times likelier than".to_owned(),
    }
}

#[cfg(test)]
mod tests {
    use super::{drifted, lasted};

    #[test]
    fn a_change_seen_in_one_sample_is_not_reported_as_no_hours() {
        assert_eq!(lasted(0.0), "it lasted a few minutes");
        assert_eq!(lasted(600.0), "it lasted 0.2 hours");
        assert_eq!(lasted(19_000.0), "it lasted 5.3 hours");
    }

    #[test]
    fn a_drift_that_has_come_back_is_not_reported_as_one_of_no_degrees() {
        assert!(!drifted(0.02).contains("0.0 degrees"));
        assert!(drifted(0.02).contains("within 0.1 degrees"));
        assert!(drifted(0.26).contains("up to 0.3 degrees so far"));
    }
}
