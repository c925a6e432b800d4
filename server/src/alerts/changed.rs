//! Alerts for what the analysis found to have changed.
//!
//! What always holds: a change calls for an alert until it is over, or until the
//! epoch that it began has a model as certain as the vessel's limit asks; the latest
//! of each cause speaks for all. Work on correctors, compass or ship is expected and
//! calls for none.

use super::alert::{AlertWanted, Cause, Evidence, Severity};
use super::findings::Findings;
use super::limits::AlertLimits;
use binnacle_magnetics::change::{self, Change};

/// A change of deviation of this size is to be acted on, degrees.
const WARN_DEG: f64 = 2.0;

/// The alerts that the changes call for, one of each cause.
pub(super) fn changed(findings: &Findings, limits: &AlertLimits) -> Vec<AlertWanted> {
    let mut wanted: Vec<AlertWanted> = Vec::new();
    for change in findings.changes.iter().rev() {
        let Some(cause) = cause_of(change.cause) else {
            continue;
        };
        let known = wanted.iter().any(|alert| alert.cause == cause);
        if known || change.ended.is_some() || is_learnt(change, findings, limits) {
            continue;
        }
        wanted.push(alert(change, cause, limits));
    }
    wanted
}

fn cause_of(cause: change::Cause) -> Option<Cause> {
    Some(match cause {
        change::Cause::LightningOrShock => Cause::LightningOrShock,
        change::Cause::MagneticCargo => Cause::MagneticCargo,
        change::Cause::AdjustmentOrRepair => return None,
        change::Cause::Drift => Cause::Drift,
        change::Cause::ReferenceFault => Cause::ReferenceFault,
        change::Cause::LocalAnomaly => Cause::LocalAnomaly,
        change::Cause::MagneticStorm => Cause::MagneticStorm,
        change::Cause::BerthSteel => Cause::BerthSteel,
        change::Cause::Unknown => Cause::UnknownChange,
    })
}

/// Whether the model of the epoch since then is as certain as is asked.
fn is_learnt(change: &Change, findings: &Findings, limits: &AlertLimits) -> bool {
    let since = findings.epoch_from.is_some_and(|from| from >= change.from);
    let band_deg = findings.widest_band95_deg.unwrap_or(f64::INFINITY);
    change.cause.is_the_ships() && since && band_deg <= limits.band95_deg
}

fn alert(change: &Change, cause: Cause, limits: &AlertLimits) -> AlertWanted {
    let size_deg = change.deviation_change_deg.map_or(0.0, f64::abs);
    let severity = if !change.confirmed {
        Severity::Notice
    } else if size_deg >= limits.deviation_deg {
        Severity::Critical
    } else if size_deg >= WARN_DEG || cause == Cause::ReferenceFault {
        Severity::Warning
    } else {
        Severity::Notice
    };
    let mut evidence = change.evidence.clone();
    let likely = change
        .causes
        .iter()
        .filter(|other| other.probability >= 0.01);
    let likely: Vec<String> = likely
        .map(|other| {
            let words = cause_of(other.cause).map_or("work on ship or compass", Cause::words);
            format!("{words} {:.0} %", 100.0 * other.probability)
        })
        .collect();
    if !likely.is_empty() {
        evidence.push(format!("How likely each cause is: {}.", likely.join(", ")));
    }
    AlertWanted {
        cause,
        severity,
        since: change.from.into(),
        summary: summary(change, cause),
        advice: advice(cause),
        evidence: Evidence(evidence),
    }
}

fn summary(change: &Change, cause: Cause) -> String {
    let doubt = if change.confirmed {
        ""
    } else {
        " It is not certain yet."
    };
    let words = cause.words();
    match change.deviation_change_deg {
        Some(degrees) if change.cause.is_the_ships() => format!(
            "Deviation changed by up to {:.1}° since about {}; most likely: {words}.{doubt}",
            degrees.abs(),
            change.from
        ),
        _ => format!(
            "Since about {} something disturbs: {words}.{doubt}",
            change.from
        ),
    }
}

fn advice(cause: Cause) -> &'static str {
    match cause {
        Cause::MagneticCargo => {
            "Steer by the gyro and take an azimuth once a watch and after each large alteration \
             of course. Report the cargo in the logbook; the model from before it is used again \
             once it is discharged."
        }
        Cause::ReferenceFault => {
            "Check gyro and satellite compass against an azimuth. The magnetic compass itself is \
             not suspected."
        }
        Cause::LocalAnomaly | Cause::MagneticStorm | Cause::BerthSteel => {
            "Rely on the gyro until it is over. Nothing needs to be adjusted: the samples taken \
             meanwhile are left out of the model."
        }
        _ => {
            "Do not use the old deviation card. Steer by the gyro, take an azimuth once a watch \
             and on each new course, and report what happened in the logbook. Expect an \
             adjustment if the deviation stays large."
        }
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use binnacle_magnetics::change::CauseProbability;
    use binnacle_magnetics::time::Timestamp;

    fn at(text: &str) -> Timestamp {
        Timestamp::parse(text).unwrap()
    }

    fn found(cause: change::Cause, deviation_change_deg: f64) -> Change {
        let from = at("2026-11-18T12:00:00Z");
        Change {
            from,
            from_earliest: from,
            from_latest: from,
            detected_at: at("2026-11-18T14:00:00Z"),
            confirmed: true,
            cause,
            causes: vec![CauseProbability {
                cause,
                probability: 0.9,
            }],
            evidence: vec!["It came at once, at sea.".to_owned()],
            deviation_change_deg: Some(deviation_change_deg),
            step: None,
            ended: None,
        }
    }

    fn alerts(changes: Vec<Change>) -> Vec<AlertWanted> {
        let findings = Findings {
            changes,
            ..Findings::default()
        };
        changed(&findings, &AlertLimits::default())
    }

    #[test]
    fn a_change_is_as_bad_as_the_deviation_that_it_causes() {
        for (deviation_deg, severity) in [
            (-6.0, Severity::Critical),
            (3.0, Severity::Warning),
            (1.0, Severity::Notice),
        ] {
            let wanted = alerts(vec![found(change::Cause::LightningOrShock, deviation_deg)]);
            assert_eq!(wanted[0].severity, severity, "{deviation_deg}");
            assert_eq!(wanted[0].cause, Cause::LightningOrShock);
            assert!(wanted[0].evidence.0[1].contains("lightning or a shock 90 %"));
        }
        let mut doubtful = found(change::Cause::Unknown, 8.0);
        doubtful.confirmed = false;
        assert_eq!(alerts(vec![doubtful])[0].severity, Severity::Notice);
    }

    #[test]
    fn what_is_over_or_expected_is_no_alert_and_the_latest_speaks_for_all() {
        let mut over = found(change::Cause::MagneticCargo, 6.0);
        over.ended = Some(at("2026-11-19T00:00:00Z"));
        let expected = found(change::Cause::AdjustmentOrRepair, 6.0);
        assert_eq!(alerts(vec![over, expected]), []);
        let first = found(change::Cause::LightningOrShock, 3.0);
        let mut second = first.clone();
        second.from = at("2026-11-19T12:00:00Z");
        let wanted = alerts(vec![first, second.clone()]);
        assert_eq!(wanted.len(), 1);
        assert_eq!(wanted[0].since, second.from.into());
    }

    #[test]
    fn a_change_is_told_until_the_new_magnetism_is_known() {
        let change = found(change::Cause::LightningOrShock, 6.0);
        let mut findings = Findings {
            epoch_from: Some(change.from),
            widest_band95_deg: Some(8.0),
            changes: vec![change],
            ..Findings::default()
        };
        let limits = AlertLimits::default();
        assert_eq!(changed(&findings, &limits).len(), 1);
        findings.widest_band95_deg = Some(1.2);
        assert_eq!(changed(&findings, &limits), []);
    }
}
