//! Alerts from changes that the detector found.

use crate::alerts::cause::Cause;
use crate::alerts::causes::CAUSES;
use crate::alerts::causes::OpenCause;
use crate::alerts::causes::change_rules::{Outcome, outcome};
use crate::alerts::causes::evaluate::evaluate_changes;
use crate::alerts::desired::DesiredAlert;
use crate::analysis::{ChangeFinding, Findings};
use crate::settings::AlertLimits;
use binnacle_compass::result::{Cause as Found, CauseProbability, Change};
use binnacle_compass::time::Timestamp;
use binnacle_platform::severity::Severity;
use binnacle_platform::time::Time;

fn at(text: &str) -> Timestamp {
    Timestamp::parse(text).unwrap()
}

fn found(cause: Found, size_deg: f64) -> ChangeFinding {
    let from = at("2026-11-18T12:00:00Z");
    ChangeFinding {
        change: Change {
            from,
            from_earliest: from,
            from_latest: from,
            detected_at: at("2026-11-18T14:00:00Z"),
            confirmed: true,
            position: None,
            disturbed_deg: None,
            withdrawn: false,
            cause,
            causes: vec![CauseProbability {
                cause,
                probability: 0.9,
            }],
            evidence: vec!["it began at sea".to_owned()],
            deviation_change_deg: cause.changes_deviation().then_some(size_deg),
            step: None,
            ended: None,
        },
        epoch: None,
        epoch_ended: None,
        expected: false,
        size_deg: Some(size_deg),
        size_ahead_deg: None,
    }
}

/// Returns the alerts after so many days at sea, with such a band by then.
fn sailed(changes: Vec<ChangeFinding>, days: f64, band95_deg: Option<f64>) -> Vec<DesiredAlert> {
    known_as(None, changes, days, band95_deg)
}

/// Returns the alerts where one of severity `was` is open of each cause.
fn known_as(
    was: Option<Severity>,
    changes: Vec<ChangeFinding>,
    days: f64,
    band95_deg: Option<f64>,
) -> Vec<DesiredAlert> {
    let findings = Findings {
        epoch_from: changes.last().map(|found| found.change.from),
        data_until: changes
            .last()
            .map(|found| found.change.detected_at.plus_seconds(days * 86_400.0)),
        widest_band95_deg: band95_deg,
        changes,
        ..Findings::default()
    };
    let open = CAUSES.iter().filter_map(|row| {
        Some(OpenCause {
            cause: row.cause,
            severity: was?,
        })
    });
    let open: Vec<OpenCause> = open.collect();
    evaluate_changes(&findings, &AlertLimits::default(), &open)
}

#[test]
fn a_change_that_is_small_here_and_large_on_the_waters_ahead_is_as_bad_as_there() {
    let mut change = found(Found::LightningOrShock, 1.0);
    change.size_ahead_deg = Some(6.0);
    let alerts = sailed(vec![change], 0.0, None);
    assert_eq!(alerts[0].severity, Severity::Critical);
    let summary = &alerts[0].summary;
    assert!(
        summary.contains("1.0° here, 6.0° on the waters"),
        "{summary}"
    );
}

#[test]
fn a_change_is_less_bad_only_once_it_is_well_below_what_made_it_so() {
    use Severity::{Critical, Notice, Warning};
    for (was, size_deg, is) in [
        (None, 4.8, Warning),
        (Some(Critical), 4.8, Critical),
        (Some(Critical), 4.4, Warning),
        (Some(Warning), 4.8, Warning),
        (Some(Warning), 1.6, Warning),
        (Some(Warning), 1.4, Notice),
        (Some(Notice), 1.6, Notice),
    ] {
        let alerts = known_as(
            was,
            vec![found(Found::LightningOrShock, size_deg)],
            0.0,
            None,
        );
        assert_eq!(alerts[0].severity, is, "{was:?}, {size_deg}");
    }
}

#[test]
fn a_change_is_as_bad_as_the_deviation_that_it_causes() {
    for (size_deg, severity) in [
        (6.0, Severity::Critical),
        (3.0, Severity::Warning),
        (1.0, Severity::Notice),
    ] {
        let alerts = sailed(vec![found(Found::LightningOrShock, size_deg)], 0.0, None);
        assert_eq!(alerts[0].severity, severity, "{size_deg}");
        assert_eq!(alerts[0].cause, Cause::LightningOrShock);
        assert!(alerts[0].evidence.0[1].contains("lightning or a shock 90 %"));
    }
    let passing = sailed(vec![found(Found::MagneticStorm, 8.0)], 0.0, None);
    assert_eq!(passing[0].severity, Severity::Warning);
    assert!(passing[0].summary.contains("not the ship"));
}

#[test]
fn an_unconfirmed_change_says_so_and_trusts_no_card() {
    let mut unconfirmed = found(Found::Unknown, 8.0);
    unconfirmed.change.confirmed = false;
    let alerts = sailed(vec![unconfirmed], 0.0, Some(1.0));
    assert_eq!(alerts[0].severity, Severity::Warning);
    assert!(alerts[0].summary.contains("not certain yet"), "{alerts:?}");
    assert!(
        alerts[0].advice.contains("whether the card still holds"),
        "{alerts:?}"
    );
}

#[test]
fn the_advice_follows_the_model_and_the_alert_ends_with_its_certainty() {
    let struck = || vec![found(Found::LightningOrShock, 6.0)];
    let alerts = |days, band_deg| sailed(struck(), days, band_deg);
    assert!(alerts(0.1, None)[0].advice.starts_with("No card holds."));
    for (days, band_deg) in [(0.5, 2.0), (3.0, 4.0)] {
        let interim = &alerts(days, Some(band_deg))[0];
        assert!(interim.advice.contains("band is wider for now"));
        assert_eq!(interim.severity, Severity::Critical);
    }
    let learned = &alerts(3.0, Some(2.0))[0];
    assert!(learned.advice.starts_with("Print and post a new card"));
    assert_eq!(learned.severity, Severity::Warning);
    assert_eq!(alerts(8.0, Some(2.0)), []);
    assert_eq!(alerts(8.0, Some(4.0)).len(), 1, "not learned yet");
}

#[test]
fn a_change_that_became_calls_for_no_alert_and_clears_its_own() {
    let mut none = found(Found::LightningOrShock, 3.0);
    let since: Time = none.change.from.into();
    let findings = |change: &ChangeFinding| Findings {
        changes: vec![change.clone()],
        ..Findings::default()
    };
    let of = |cause, change: &ChangeFinding| outcome(cause, since, &findings(change));
    let lightning = Cause::LightningOrShock;
    assert_eq!(of(lightning, &none), Some(Outcome::Learned));
    (none.change.confirmed, none.change.withdrawn) = (false, true);
    none.change.ended = Some(at("2026-11-20T00:00:00Z"));
    assert_eq!(of(lightning, &none), Some(Outcome::Withdrawn));
    assert_eq!(of(Cause::MagneticCargo, &none), None);
    assert_eq!(sailed(vec![none], 0.5, Some(1.0)), []);
}

/// A change that stays is not over: the deviation is another one for good.
#[test]
fn only_what_ended_is_over() {
    let mut struck = found(Found::LightningOrShock, 3.0);
    let since: Time = struck.change.from.into();
    let of = |cause, change: &ChangeFinding| {
        let changes = vec![change.clone()];
        outcome(
            cause,
            since,
            &Findings {
                changes,
                ..Findings::default()
            },
        )
    };
    assert_eq!(of(Cause::LightningOrShock, &struck), Some(Outcome::Learned));
    assert_eq!(of(Cause::Drift, &struck), Some(Outcome::Renamed));
    struck.change.ended = Some(at("2026-11-20T00:00:00Z"));
    assert_eq!(of(Cause::LightningOrShock, &struck), None);
    let storm = found(Found::MagneticStorm, 3.0);
    assert_eq!(of(Cause::MagneticStorm, &storm), None);
}

#[test]
fn an_earlier_change_is_an_alert_for_a_week_only() {
    let struck = found(Found::LightningOrShock, 3.0);
    let mut loaded = found(Found::MagneticCargo, 3.0);
    loaded.change.from = at("2026-11-19T12:00:00Z");
    loaded.change.detected_at = at("2026-11-19T13:00:00Z");
    let causes = |days| -> Vec<Cause> {
        let alerts = sailed(vec![struck.clone(), loaded.clone()], days, Some(4.0));
        alerts.iter().map(|alert| alert.cause).collect()
    };
    assert_eq!(causes(1.0), [Cause::MagneticCargo, Cause::LightningOrShock]);
    assert_eq!(causes(8.0), [Cause::MagneticCargo]);
}

#[test]
fn what_is_over_or_expected_is_no_alert_and_the_latest_speaks_for_all() {
    let mut over = found(Found::MagneticCargo, 6.0);
    over.change.ended = Some(at("2026-11-19T00:00:00Z"));
    let mut expected = found(Found::AdjustmentOrRepair, 6.0);
    expected.expected = true;
    assert_eq!(sailed(vec![over, expected.clone()], 0.0, None), []);
    expected.expected = false;
    let unreported = sailed(vec![expected], 0.0, None);
    assert_eq!(unreported[0].cause, Cause::UnknownChange);
    assert!(unreported[0].summary.contains("nobody reported"));

    let first = found(Found::LightningOrShock, 3.0);
    let mut second = first.clone();
    second.change.from = at("2026-11-19T12:00:00Z");
    let since = second.change.from.into();
    let alerts = sailed(vec![first, second], 0.0, None);
    assert_eq!(alerts.len(), 1);
    assert_eq!(alerts[0].since, since);
}

#[test]
fn an_alert_was_about_the_change_nearest_to_its_date() {
    let first = found(Found::LightningOrShock, 3.0);
    let mut second = first.clone();
    second.change.from = first.change.from.plus_seconds(86_400.0);
    let mut storm = found(Found::MagneticStorm, 3.0);
    storm.change.from = second.change.from.plus_seconds(-600.0);
    let after_first = |seconds: f64| -> binnacle_platform::time::Time {
        first.change.from.plus_seconds(seconds).into()
    };
    let alone = sailed(vec![first.clone()], 0.0, None);
    assert!(alone[0].window.includes(after_first(5.0 * 86_400.0)));

    // The first is taken for something else by now.
    let mut renamed = first.clone();
    renamed.change.cause = Found::Unknown;
    for earlier in [first.clone(), renamed] {
        let alerts = sailed(vec![earlier, storm.clone(), second.clone()], 0.0, None);
        let struck = &alerts[0];
        assert_eq!(struck.since, second.change.from.into());
        assert!(!struck.window.includes(after_first(3600.0)));
        assert!(struck.window.includes(after_first(80_000.0)));
    }
}

#[test]
fn a_second_fault_of_a_reference_is_another_alert() {
    let mut first = found(Found::ReferenceFault, 0.0);
    first.change.ended = Some(at("2026-11-19T12:00:00Z"));
    let mut second = found(Found::ReferenceFault, 0.0);
    second.change.from = at("2026-11-21T12:00:00Z");
    let alerts = sailed(vec![first, second], 0.1, Some(1.0));
    assert_eq!(alerts.len(), 1);
    assert!(!alerts[0].window.includes(at("2026-11-18T12:00:00Z").into()));
    assert!(alerts[0].window.includes(at("2026-11-21T12:00:00Z").into()));
}

#[test]
fn a_moved_zero_comes_with_advice() {
    let alerts = sailed(vec![found(Found::Alignment, 3.0)], 0.1, Some(1.0));
    assert_eq!(alerts[0].cause, Cause::Alignment);
    assert!(alerts[0].summary.contains("the compass's zero moved"));
    assert!(alerts[0].advice.contains("lubber line"));
    assert!(alerts[0].advice.contains("No corrector"));
}

#[test]
fn while_a_references_fault_is_open_the_compass_is_cleared_only_where_the_ship_did_not_change() {
    let advice = |ship: f64| {
        let mut open = found(Found::ReferenceFault, 2.0);
        open.change.confirmed = false;
        open.change.causes.push(CauseProbability {
            cause: Found::LightningOrShock,
            probability: ship,
        });
        sailed(vec![open], 0.1, Some(1.0))[0].advice
    };
    assert!(advice(0.02).contains("is not suspected"));
    assert!(advice(0.1).contains("do not tell yet which"));
}
