//! Evidence of a change, in words that an officer knows.

use super::size::Disturbance;
use crate::constants::{IMPROBABLE, TRUSTED};
use crate::hypotheses::kinds::Kind;
use crate::report::faults::{FaultyReference, reference};
use crate::weighing::records::{Class, Detected, EventPosterior};
use binnacle_compass::time::Timestamp;

/// Facts about a change beside its posterior.
#[allow(clippy::struct_excessive_bools, reason = "each is a fact of its own")]
#[derive(Clone, Debug, Default)]
pub(super) struct Facts {
    /// Largest change of the deviation over headings, degrees.
    pub(super) worst_deg: Option<f64>,
    /// Error of the compass during a disturbance.
    pub(super) disturbance: Option<Disturbance>,
    /// Duration, seconds; none while it lasts.
    pub(super) lasted_s: Option<f64>,
    /// True if it ended at a port call; none while it lasts.
    pub(super) ended_in_port: Option<bool>,
    /// Time of the first row after its possible end.
    pub(super) possible_end: Option<Timestamp>,
    /// True if there was one reference only.
    pub(super) one_reference: bool,
    /// Number of sudden changes of the vessel within a day of it, itself included.
    pub(super) changes_within_a_day: usize,
    /// True if the logbook has a report of about its time.
    pub(super) is_reported: bool,
    /// True if the logbook has cargo discharged at its time.
    pub(super) is_discharge: bool,
    /// Time since work in the logbook that does not explain it, seconds.
    pub(super) work_before_s: Option<f64>,
    /// False if it is suspected only.
    pub(super) is_certain: bool,
}

/// Returns the evidence of a detected or suspected event.
pub(super) fn evidence(detected: &Detected, facts: &Facts) -> Vec<String> {
    let mut lines = vec![explanation(detected, facts)];
    lines.extend(beginning(detected));
    lines.extend(ending(detected, facts));
    if facts.changes_within_a_day > 1 {
        lines.push(format!(
            "it is one of {} changes within a day",
            facts.changes_within_a_day
        ));
    }
    lines.extend(size(detected, facts));
    if let Some(seconds) = facts.lasted_s.filter(|_| detected.class != Class::Ship) {
        lines.push(lasted(seconds));
    }
    lines.extend(by_logbook(facts));
    lines.extend(certainty(detected, facts));
    lines
}

/// Returns the kind of event against its alternatives.
fn explanation(detected: &Detected, facts: &Facts) -> String {
    let posterior = &detected.posterior;
    let own = posterior.probability;
    let none = (1.0 - own - instead(posterior, |_| true)).max(0.0);
    let of = |class: Class| instead(posterior, |kind| Class::of(kind) == class);
    let against_none = likelier(own, none);
    match detected.event.kind {
        Kind::Strike | Kind::Cargo => format!(
            "a change of the vessel's own magnetism explains the samples: {against_none} no \
             change, {} a passing disturbance and {} a fault of the reference",
            likelier(own, of(Class::Passing)),
            likelier(own, of(Class::Reference))
        ),
        Kind::Alignment => format!(
            "the error changed equally on every heading{}: a change of the compass's own \
             alignment is {} a change of the vessel's magnetism and {} a fault of the reference",
            if facts.one_reference {
                ""
            } else {
                ", and gyro and satellite compass do not part"
            },
            likelier(
                kind(posterior, Kind::Alignment),
                own - kind(posterior, Kind::Alignment)
            ),
            likelier(own, of(Class::Reference))
        ),
        Kind::ShipDrift => format!(
            "{}: a drift is {} one sudden change",
            drifted(facts.worst_deg.unwrap_or(0.0)),
            likelier(
                kind(posterior, Kind::ShipDrift),
                own - kind(posterior, Kind::ShipDrift)
            )
        ),
        Kind::Storm | Kind::SevereStorm | Kind::Anomaly => format!(
            "the compass was disturbed for a time: a passing disturbance is {against_none} none \
             and {} a change of the vessel",
            likelier(own, of(Class::Ship))
        ),
        Kind::FailedCard => match detected.event.held_deg {
            Some(held_deg) => format!(
                "the compass stayed near {held_deg:.1} degrees while the vessel turned: a stuck \
                 compass is {against_none} a sound one"
            ),
            None => format!(
                "the compass swung by itself: a failed compass is {against_none} a sound one, \
                 and {} a passing disturbance",
                likelier(own, of(Class::Passing))
            ),
        },
        Kind::Deflection => format!(
            "the compass was deflected for hours, as by steel or a current near it: that is \
             {against_none} no change, and {} a passing disturbance of the earth's field",
            likelier(own, of(Class::Passing))
        ),
        _ => format!(
            "by the magnetic compass, {} had failed: a fault of the reference is {against_none} \
             no fault and {} a change of the vessel",
            failed(detected.event.kind),
            likelier(own, of(Class::Ship))
        ),
    }
}

fn failed(kind: Kind) -> &'static str {
    match reference(kind) {
        Some(FaultyReference::Satellite) => "the satellite compass",
        _ => "the gyro",
    }
}

/// Returns the probability of the kinds of other classes.
fn instead(posterior: &EventPosterior, is_meant: impl Fn(Kind) -> bool) -> f64 {
    let kinds = posterior.instead.iter();
    kinds
        .filter(|(kind, _)| is_meant(*kind))
        .map(|(_, p)| p)
        .sum()
}

/// Returns the probability of a kind.
fn kind(posterior: &EventPosterior, kind: Kind) -> f64 {
    let mut kinds = posterior.kinds.iter();
    kinds
        .find(|(known, _)| *known == kind)
        .map_or(0.0, |(_, p)| *p)
}

/// Returns the odds of two probabilities in words.
fn likelier(probability: f64, other: f64) -> String {
    let odds = probability / other.max(f64::MIN_POSITIVE);
    match odds {
        ..0.7 => "less likely than".to_owned(),
        ..1.5 => "about as likely as".to_owned(),
        ..10.0 => format!("{odds:.1} times likelier than"),
        ..100.0 => format!("{:.0} times likelier than", (odds / 10.0).round() * 10.0),
        ..1000.0 => format!("{:.0} times likelier than", (odds / 100.0).round() * 100.0),
        _ => "more than a thousand times likelier than".to_owned(),
    }
}

/// Returns the extent of a drift.
fn drifted(worst_deg: f64) -> String {
    if worst_deg < 0.1 {
        return "the deviation varies, and is now within 0.1 degrees of its earlier value"
            .to_owned();
    }
    format!("the deviation continues to change, by up to {worst_deg:.1} degrees so far")
}

/// Returns the place at which it began. A drift has no beginning, and a reference none that
/// matters.
fn beginning(detected: &Detected) -> Option<String> {
    let has_beginning = match detected.class {
        Class::Ship => detected.event.kind != Kind::ShipDrift,
        Class::Passing => true,
        Class::Reference | Class::Compass => false,
    };
    if !has_beginning {
        return None;
    }
    let posterior = &detected.posterior;
    let in_port = posterior.in_port / posterior.probability.max(f64::MIN_POSITIVE);
    let line = if in_port > TRUSTED {
        "it began at a port call"
    } else if in_port < 1.0 - TRUSTED {
        "it began at sea"
    } else {
        "it may have begun at the port call before, where cargo is loaded, or at sea"
    };
    Some(line.to_owned())
}

/// Returns the place at which the vessel returned to its earlier state, or may have.
fn ending(detected: &Detected, facts: &Facts) -> Option<String> {
    if detected.class != Class::Ship {
        return None;
    }
    match (facts.ended_in_port, facts.possible_end) {
        (Some(true), _) => {
            Some("the vessel returned to its earlier state at a port call".to_owned())
        }
        (Some(false), _) => Some("the vessel returned to its earlier state at sea".to_owned()),
        (None, Some(end)) if detected.posterior.is_over > IMPROBABLE => Some(format!(
            "it may have ended at the port call before {end}: {:.0} %",
            100.0 * detected.posterior.is_over
        )),
        _ => None,
    }
}

/// Returns the size of a large error, and whether it may be the reference's.
fn size(detected: &Detected, facts: &Facts) -> Vec<String> {
    let mut lines = Vec::new();
    let large = facts
        .disturbance
        .filter(|disturbance| disturbance.nominal_deg > Kind::FailedCard.row().error_deg);
    if let Some(Disturbance { seen_deg, .. }) = large {
        lines.push(if seen_deg > 90.0 {
            format!("the error was {seen_deg:.0} degrees: the compass no longer pointed north")
        } else {
            format!("the error was {seen_deg:.0} degrees, which few storms and anomalies reach")
        });
    }
    let is_open = detected.class == Class::Reference && facts.lasted_s.is_none();
    if facts.one_reference && (is_open || large.is_some()) {
        lines.push(
            "compass or reference: with no other reference this cannot be decided".to_owned(),
        );
    }
    lines
}

/// Returns the duration; that of a single sample is unknown.
fn lasted(seconds: f64) -> String {
    let hours = seconds / 3600.0;
    if hours < 0.05 {
        return "it lasted a few minutes".to_owned();
    }
    format!("it lasted {hours:.1} hours")
}

fn by_logbook(facts: &Facts) -> Vec<String> {
    let mut lines = Vec::new();
    if facts.is_reported {
        lines.push("the logbook has a report of that time".to_owned());
    }
    if let Some(after_s) = facts.work_before_s {
        lines.push(format!(
            "the logbook has work on vessel or compass {:.0} hours before: if it was done at \
             this time, correct the entry",
            after_s / 3600.0
        ));
    }
    if facts.is_discharge {
        lines.push("the logbook has cargo discharged at this time".to_owned());
    }
    lines
}

fn certainty(detected: &Detected, facts: &Facts) -> Option<String> {
    let line = if detected.withdrawn.is_some() {
        "it was reported as certain and is withdrawn: the samples since do not confirm it"
    } else if facts.is_certain {
        return None;
    } else if facts.lasted_s.is_some() {
        "too weak for this vessel alone to confirm"
    } else {
        "not yet certain: more samples are needed"
    };
    Some(line.to_owned())
}

#[cfg(test)]
mod tests {
    use super::{drifted, lasted, likelier};

    #[test]
    fn a_change_seen_in_one_sample_is_not_reported_as_no_hours() {
        assert_eq!(lasted(0.0), "it lasted a few minutes");
        assert_eq!(lasted(600.0), "it lasted 0.2 hours");
        assert_eq!(lasted(19_000.0), "it lasted 5.3 hours");
    }

    #[test]
    fn a_drift_that_has_come_back_is_not_reported_as_one_of_no_degrees() {
        assert!(drifted(0.02).contains("within 0.1 degrees"));
        assert!(drifted(0.26).contains("up to 0.3 degrees so far"));
    }

    #[test]
    fn odds_are_round_figures_and_finite() {
        assert_eq!(likelier(0.5, 0.5), "about as likely as");
        assert_eq!(likelier(0.9, 0.03), "30 times likelier than");
        assert!(likelier(1.0, 0.0).starts_with("more than a thousand times"));
    }
}
