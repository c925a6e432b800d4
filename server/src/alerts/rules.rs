//! Which alerts a compass's analysis calls for.
//!
//! What always holds: [`find_desired`] is a pure function of what was found, the
//! vessel's limits and what is open already; it names each cause once. A limit that
//! was passed is left only [`SLACK_DEG`] below it, so that an alert does not come
//! and go with every batch, nor rise and sink.

use super::alert::{Cause, DesiredAlert, EventWindow, Evidence, Severity};
use super::change_rules::changed;
use super::limits::AlertLimits;
use crate::analysis::{FailedLately, Findings, LeftOut};
use crate::deviation::Worst;
use crate::time::Time;
use binnacle_magnetics::time::Timestamp;

/// An open alert stays until the figure is so far below its limit, degrees.
const SLACK_DEG: f64 = 0.5;
/// So long a ship may need to make the headings that a model asks for, seconds.
const PATIENCE_S: f64 = 7.0 * 86_400.0;
/// Of the samples of the last day, so large a part with a failed reference is more
/// than a drop-out,
const FAILED_SHARE: f64 = 0.1;
/// if there are so many of them.
const FAILED_SAMPLES: u64 = 3;

/// The alerts that ought to be open; `open` are the causes that are, and how bad.
pub fn find_desired(
    findings: &Findings,
    limits: &AlertLimits,
    open: &[(Cause, Severity)],
) -> Vec<DesiredAlert> {
    let open_at = |cause| {
        let known = open.iter().find(|(known, _)| *known == cause);
        known.map(|(_, severity)| *severity)
    };
    let slack_deg = |cause| open_at(cause).map_or(0.0, |_| SLACK_DEG);
    let Some(data_until) = findings.data_until else {
        return Vec::new();
    };
    let allowed_deg = limits.deviation_deg - slack_deg(Cause::DeviationOverLimit);
    let band_allowed_deg = limits.band95_deg - slack_deg(Cause::WideBand);
    let over = findings
        .worst
        .filter(|worst| worst.deviation_deg.abs() > allowed_deg)
        .map(|worst| {
            let was = open_at(Cause::DeviationOverLimit);
            over_limit(worst, limits, data_until, was)
        });
    let waited_since = findings
        .epoch_data_from
        .filter(|from| data_until.seconds_since(*from) >= PATIENCE_S);
    let uncertain = waited_since.and_then(|from| match &findings.refusal {
        Some(refusal) => Some(no_model(refusal, findings.left_out, from)),
        None => findings
            .widest_band95_deg
            .filter(|band_deg| *band_deg > band_allowed_deg)
            .map(|band_deg| wide_band(band_deg, limits, from)),
    });
    let references = match (findings.references_disagree_deg, &findings.failed_lately) {
        (Some(offset_deg), _) => Some(disagree(offset_deg, findings, data_until)),
        (None, Some(failed)) if failed.is_more_than_a_drop_out() => Some(one_failed(failed)),
        _ => None,
    };
    let mut wanted = changed(findings, limits, open_at);
    // Who is told of a change is told with it that less is known for now.
    let is_told = wanted
        .iter()
        .any(|alert| alert.cause != Cause::ReferenceFault);
    let uncertain = uncertain.filter(|alert| {
        let is_wide = alert.cause == Cause::WideBand;
        !(is_wide && is_told) || open_at(Cause::WideBand).is_some()
    });
    for alert in [over, references, uncertain].into_iter().flatten() {
        // What the detector says of a cause is the better word.
        if wanted.iter().all(|known| known.cause != alert.cause) {
            wanted.push(alert);
        }
    }
    wanted
}

/// What calls for an alert when nothing has come since `last`.
pub fn silence(last: Time, limits: &AlertLimits, now: Time) -> Option<DesiredAlert> {
    let days = now.0.seconds_since(last.0) / 86_400.0;
    (days > limits.silent_days).then(|| DesiredAlert {
        cause: Cause::SilentAgent,
        severity: Severity::Notice,
        since: last,
        window: EventWindow::default(),
        summary: format!(
            "Nothing has come from the vessel's agent for more than {} days.",
            limits.silent_days
        ),
        advice: "Ask the ship whether the agent's computer is on and what its page says of the \
                 link. What it sampled meanwhile is kept aboard and comes by itself.",
        evidence: Evidence(vec![format!(
            "The last batch came at {}.",
            last.to_the_minute()
        )]),
    })
}

/// How far below what made an alert so bad the figure must be, for one that has been.
pub(super) fn hysteresis_deg(was: Option<Severity>, severity: Severity) -> f64 {
    if was >= Some(severity) {
        SLACK_DEG
    } else {
        0.0
    }
}

fn over_limit(
    worst: Worst,
    limits: &AlertLimits,
    data_until: Timestamp,
    was: Option<Severity>,
) -> DesiredAlert {
    let size_deg = worst.deviation_deg.abs();
    let surely_deg = size_deg - worst.band95_deg.unwrap_or(0.0);
    let severity =
        if size_deg > 2.0 * limits.deviation_deg - hysteresis_deg(was, Severity::Critical) {
            Severity::Critical
        } else if surely_deg > limits.deviation_deg - hysteresis_deg(was, Severity::Warning) {
            Severity::Warning
        } else {
            Severity::Notice
        };
    let side = if worst.deviation_deg < 0.0 { "W" } else { "E" };
    let heading = format!("{:03.0}°", worst.compass_deg);
    let stands = stands(size_deg, limits.deviation_deg);
    let mut evidence = vec![format!(
        "By the model of the samples up to {}, at the place of the last one.",
        Time(data_until).to_the_minute()
    )];
    evidence.extend(
        worst
            .band95_deg
            .map(|band_deg| format!("Its 95 % band there is ±{band_deg:.1}°.")),
    );
    DesiredAlert {
        cause: Cause::DeviationOverLimit,
        severity,
        since: data_until.into(),
        window: EventWindow::default(),
        summary: format!(
            "Deviation is {size_deg:.1}° {side} on compass heading {heading}{stands}."
        ),
        advice: "Steer by the corrected heading or the gyro, check the compass error by azimuth \
                 once a watch, and have the compass adjusted.",
        evidence: Evidence(evidence),
    }
}

/// How a figure stands to its limit, while the alert lasts.
fn stands(figure_deg: f64, limit_deg: f64) -> String {
    if figure_deg > limit_deg {
        return format!(", over the limit of {limit_deg}°");
    }
    let ends_deg = limit_deg - SLACK_DEG;
    format!(": it was over the limit of {limit_deg}° and has not yet fallen to {ends_deg}°")
}

fn no_model(refusal: &str, left_out: LeftOut, from: Timestamp) -> DesiredAlert {
    DesiredAlert {
        cause: Cause::NoModel,
        severity: Severity::Notice,
        since: from.into(),
        window: EventWindow::default(),
        summary: "Samples have come for more than a week, but no model could be made of them."
            .to_owned(),
        advice: "Use no deviation card of earlier date. Take azimuths, and let the ship lie on \
                 the headings that are missing where the passage allows.",
        evidence: Evidence(vec![format!("What is missing: {refusal}{left_out}.")]),
    }
}

fn wide_band(band_deg: f64, limits: &AlertLimits, from: Timestamp) -> DesiredAlert {
    DesiredAlert {
        cause: Cause::WideBand,
        severity: Severity::Notice,
        since: from.into(),
        window: EventWindow::default(),
        summary: format!(
            "On some heading the deviation is known only to ±{band_deg:.1}°{}.",
            stands(band_deg, limits.band95_deg)
        ),
        advice: "Take an azimuth before relying on the card on a heading that she seldom lies \
                 on. The vessel's page says which headings would tell most.",
        evidence: Evidence(vec![format!(
            "Samples have come since {}.",
            Time(from).to_the_minute()
        )]),
    }
}

const TRUST_NEITHER: &str = "Check both against an azimuth, and the alignment and the speed and \
     latitude settings of the gyro. Until then take neither as the compass's true heading; the \
     magnetic compass itself is not suspected.";

fn disagree(offset_deg: f64, findings: &Findings, data_until: Timestamp) -> DesiredAlert {
    DesiredAlert {
        cause: Cause::ReferenceFault,
        severity: Severity::Warning,
        since: findings.epoch_data_from.unwrap_or(data_until).into(),
        window: EventWindow::default(),
        summary: format!(
            "Gyro and satellite compass differ by {:.1}° throughout, more than any alignment \
             explains: one of them is wrong.",
            offset_deg.abs()
        ),
        advice: TRUST_NEITHER,
        evidence: Evidence(
            findings
                .refusal
                .iter()
                .map(|text| format!("{text}."))
                .collect(),
        ),
    }
}

fn one_failed(failed: &FailedLately) -> DesiredAlert {
    DesiredAlert {
        cause: Cause::ReferenceFault,
        severity: Severity::Warning,
        since: failed.from.into(),
        window: EventWindow::default(),
        summary: format!(
            "Gyro and satellite compass parted: lately they departed by {:.1}° from their usual \
             difference.",
            failed.departure_deg.abs()
        ),
        advice: TRUST_NEITHER,
        evidence: Evidence(vec![
            format!(
                "So it was in {} of the {} samples of the last day that had both.",
                failed.samples, failed.of
            ),
            format!(
                "Since the compass was last altered the gyro was left out {} times, the satellite \
                 compass {} times.",
                failed.gyro_dropped, failed.satellite_dropped
            ),
        ]),
    }
}

impl FailedLately {
    fn is_more_than_a_drop_out(&self) -> bool {
        self.samples >= FAILED_SAMPLES && self.samples as f64 >= FAILED_SHARE * self.of as f64
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    fn at(text: &str) -> Timestamp {
        Timestamp::parse(text).unwrap()
    }

    fn found() -> Findings {
        Findings {
            data_until: Some(at("2026-11-20T00:00:00Z")),
            epoch_data_from: Some(at("2026-11-10T00:00:00Z")),
            ..Findings::default()
        }
    }

    fn with_worst(deviation_deg: f64, band95_deg: f64) -> Findings {
        Findings {
            worst: Some(Worst {
                compass_deg: 95.0,
                deviation_deg,
                band95_deg: Some(band95_deg),
            }),
            widest_band95_deg: Some(band95_deg),
            ..found()
        }
    }

    fn causes(findings: &Findings, open: &[(Cause, Severity)]) -> Vec<(Cause, Severity)> {
        let wanted = find_desired(findings, &AlertLimits::default(), open);
        wanted
            .iter()
            .map(|alert| (alert.cause, alert.severity))
            .collect()
    }

    #[test]
    fn deviation_over_the_limit_is_as_bad_as_it_is_certain_and_large() {
        use Severity::{Critical, Notice, Warning};
        for (deviation_deg, severity) in [
            (4.9, None),
            (-4.9, None),
            (5.1, Some(Notice)),
            (6.1, Some(Warning)),
            (-6.1, Some(Warning)),
            (-10.1, Some(Critical)),
        ] {
            let expected: Vec<_> = severity
                .map(|severity| (Cause::DeviationOverLimit, severity))
                .into_iter()
                .collect();
            let findings = with_worst(deviation_deg, 1.0);
            assert_eq!(causes(&findings, &[]), expected, "{deviation_deg}");
        }
        let wanted = find_desired(&with_worst(-6.1, 1.0), &AlertLimits::default(), &[]);
        assert!(
            wanted[0].summary.contains("6.1° W on compass heading 095°"),
            "{wanted:?}"
        );
    }

    #[test]
    fn an_open_alert_stays_until_the_figure_is_well_below_its_limit() {
        let open = [(Cause::DeviationOverLimit, Severity::Notice)];
        let wanted = find_desired(&with_worst(-4.9, 1.0), &AlertLimits::default(), &open);
        assert_eq!(
            wanted[0].summary,
            "Deviation is 4.9° W on compass heading 095°: it was over the limit of 5° and has not \
             yet fallen to 4.5°."
        );
        assert_eq!(causes(&with_worst(4.4, 1.0), &open), []);
    }

    #[test]
    fn an_alert_sinks_when_the_figure_is_well_below_what_made_it_so_bad() {
        use Severity::{Critical, Notice, Warning};
        for (was, deviation_deg, is) in [
            (Critical, 9.6, Critical),
            (Critical, 9.4, Warning),
            (Warning, 9.6, Warning),
            (Warning, 5.6, Warning),
            (Warning, 5.4, Notice),
            (Notice, 5.6, Notice),
        ] {
            let open = [(Cause::DeviationOverLimit, was)];
            let found = causes(&with_worst(deviation_deg, 1.0), &open);
            let expected = [(Cause::DeviationOverLimit, is)];
            assert_eq!(found, expected, "{was:?} {deviation_deg}");
        }
    }

    #[test]
    fn a_ship_has_a_week_to_make_the_headings_for_a_model() {
        let mut findings = Findings {
            refusal: Some("3 usable samples; at least 8 are needed".to_owned()),
            ..found()
        };
        assert_eq!(causes(&findings, &[]), [(Cause::NoModel, Severity::Notice)]);
        findings.epoch_data_from = Some(at("2026-11-14T00:00:00Z"));
        assert_eq!(causes(&findings, &[]), []);
        // An epoch without samples waits for them, not for a person.
        findings.epoch_data_from = None;
        assert_eq!(causes(&findings, &[]), []);
    }

    #[test]
    fn a_wide_band_is_an_alert_after_a_week() {
        let mut findings = with_worst(2.0, 3.5);
        assert_eq!(
            causes(&findings, &[]),
            [(Cause::WideBand, Severity::Notice)]
        );
        findings.epoch_data_from = Some(at("2026-11-14T00:00:00Z"));
        assert_eq!(causes(&findings, &[]), []);
    }

    #[test]
    fn references_that_disagree_are_one_alert_and_a_drop_out_is_none() {
        let failed = |samples| Findings {
            failed_lately: Some(FailedLately {
                from: at("2026-11-19T10:00:00Z"),
                samples,
                of: 100,
                departure_deg: -7.0,
                gyro_dropped: samples,
                satellite_dropped: 0,
            }),
            ..found()
        };
        assert_eq!(causes(&failed(2), &[]), []);
        assert_eq!(
            causes(&failed(10), &[]),
            [(Cause::ReferenceFault, Severity::Warning)]
        );
        let throughout = Findings {
            references_disagree_deg: Some(-20.0),
            refusal: Some("gyro and satellite compass differ".to_owned()),
            epoch_data_from: Some(at("2026-11-19T00:00:00Z")),
            ..failed(10)
        };
        assert_eq!(
            causes(&throughout, &[]),
            [(Cause::ReferenceFault, Severity::Warning)]
        );
    }

    #[test]
    fn nothing_found_calls_for_nothing() {
        assert_eq!(causes(&Findings::default(), &[]), []);
    }

    #[test]
    fn silence_is_an_alert_only_after_its_days() {
        let last = Time(at("2026-11-17T00:00:00Z"));
        let limits = AlertLimits::default();
        assert_eq!(
            silence(last, &limits, Time(at("2026-11-19T23:00:00Z"))),
            None
        );
        let wanted = silence(last, &limits, Time(at("2026-11-20T01:00:00Z"))).unwrap();
        assert_eq!((wanted.cause, wanted.since), (Cause::SilentAgent, last));
    }
}
