//! Alerts from the figures of an analysis, and from the clock.

use crate::alerts::cause::Cause;
use crate::alerts::causes::{Facts, OpenCause, Silence, evaluate, evaluate_analysis};
use crate::analysis::{FailedLately, Findings};
use crate::deviation::WorstHeading;
use crate::settings::AlertLimits;
use binnacle_compass::time::Timestamp;
use binnacle_platform::severity::Severity;
use binnacle_platform::time::Time;

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
        worst: Some(WorstHeading {
            compass_deg: 95.0,
            deviation_deg,
            band95_deg: Some(band95_deg),
        }),
        widest_band95_deg: Some(band95_deg),
        ..found()
    }
}

fn causes(findings: &Findings, open: &[OpenCause]) -> Vec<(Cause, Severity)> {
    let alerts = evaluate_analysis(findings, &AlertLimits::default(), open);
    alerts
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
    let alerts = evaluate_analysis(&with_worst(-6.1, 1.0), &AlertLimits::default(), &[]);
    assert!(
        alerts[0].summary.contains("6.1° W on compass heading 095°"),
        "{alerts:?}"
    );
}

#[test]
fn an_open_alert_stays_until_the_figure_is_well_below_its_limit() {
    let open = [OpenCause {
        cause: Cause::DeviationOverLimit,
        severity: Severity::Notice,
    }];
    let alerts = evaluate_analysis(&with_worst(-4.9, 1.0), &AlertLimits::default(), &open);
    assert_eq!(
        alerts[0].summary,
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
        let open = [OpenCause {
            cause: Cause::DeviationOverLimit,
            severity: was,
        }];
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
    let last_upload = Time(at("2026-11-17T00:00:00Z"));
    let limits = AlertLimits::default();
    let silence = |now| {
        evaluate(Facts::Clock(&Silence {
            last_upload,
            limits: &limits,
            now: Time(at(now)),
        }))
    };
    assert_eq!(silence("2026-11-19T23:00:00Z"), []);
    let alerts = silence("2026-11-20T01:00:00Z");
    assert_eq!(alerts.len(), 1);
    assert_eq!(
        (alerts[0].cause, alerts[0].since),
        (Cause::SilentAgent, last_upload)
    );
}
