use super::*;
use binnacle_compass::result::{Cause as Found, CauseProbability, Change};
use binnacle_compass::time::Timestamp;

fn at(text: &str) -> Timestamp {
    Timestamp::parse(text).unwrap()
}

fn found(cause: Found, size_deg: f64) -> FoundChange {
    let from = at("2026-11-18T12:00:00Z");
    FoundChange {
        change: Change {
            from,
            from_earliest: from,
            from_latest: from,
            detected_at: at("2026-11-18T14:00:00Z"),
            confirmed: true,
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
        position: None,
    }
}

/// A ship that has sailed for so many days since, with such a band by now.
fn sailed(changes: Vec<FoundChange>, days: f64, band95_deg: Option<f64>) -> Vec<AlertWanted> {
    known_as(None, changes, days, band95_deg)
}

/// The same where an alert of such a severity is open of each cause.
fn known_as(
    was: Option<Severity>,
    changes: Vec<FoundChange>,
    days: f64,
    band95_deg: Option<f64>,
) -> Vec<AlertWanted> {
    let findings = Findings {
        epoch_from: changes.last().map(|found| found.change.from),
        data_until: changes
            .last()
            .map(|found| found.change.detected_at.plus_seconds(days * 86_400.0)),
        widest_band95_deg: band95_deg,
        changes,
        ..Findings::default()
    };
    changed(&findings, &AlertLimits::default(), |_| was)
}

#[test]
fn a_change_that_is_small_here_and_large_on_the_waters_ahead_is_as_bad_as_there() {
    let mut change = found(Found::LightningOrShock, 1.0);
    change.size_ahead_deg = Some(6.0);
    let wanted = sailed(vec![change], 0.0, None);
    assert_eq!(wanted[0].severity, Severity::Critical);
    let summary = &wanted[0].summary;
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
        let wanted = known_as(
            was,
            vec![found(Found::LightningOrShock, size_deg)],
            0.0,
            None,
        );
        assert_eq!(wanted[0].severity, is, "{was:?}, {size_deg}");
    }
}

#[test]
fn a_change_is_as_bad_as_the_deviation_that_it_causes() {
    for (size_deg, severity) in [
        (6.0, Severity::Critical),
        (3.0, Severity::Warning),
        (1.0, Severity::Notice),
    ] {
        let wanted = sailed(vec![found(Found::LightningOrShock, size_deg)], 0.0, None);
        assert_eq!(wanted[0].severity, severity, "{size_deg}");
        assert_eq!(wanted[0].cause, Cause::LightningOrShock);
        assert!(wanted[0].evidence.0[1].contains("lightning or a shock 90 %"));
    }
    let passing = sailed(vec![found(Found::MagneticStorm, 8.0)], 0.0, None);
    assert_eq!(passing[0].severity, Severity::Warning);
    assert!(passing[0].summary.contains("not the ship"));
}

#[test]
fn what_is_not_certain_is_told_as_such_and_trusts_no_card() {
    let mut doubtful = found(Found::Unknown, 8.0);
    doubtful.change.confirmed = false;
    let wanted = sailed(vec![doubtful], 0.0, Some(1.0));
    assert_eq!(wanted[0].severity, Severity::Warning);
    assert!(wanted[0].summary.contains("not certain yet"), "{wanted:?}");
    assert!(
        wanted[0].advice.contains("whether the card still holds"),
        "{wanted:?}"
    );
}

#[test]
fn the_advice_follows_the_model_and_the_alert_ends_with_its_certainty() {
    let struck = || vec![found(Found::LightningOrShock, 6.0)];
    let told = |days, band_deg| sailed(struck(), days, band_deg);
    assert!(told(0.1, None)[0].advice.starts_with("No card holds."));
    for (days, band_deg) in [(0.5, 2.0), (3.0, 4.0)] {
        let interim = &told(days, Some(band_deg))[0];
        assert!(interim.advice.contains("band is wider for now"));
        assert_eq!(interim.severity, Severity::Critical);
    }
    let learnt = &told(3.0, Some(2.0))[0];
    assert!(learnt.advice.starts_with("Put up a new card"));
    assert_eq!(learnt.severity, Severity::Warning);
    assert_eq!(told(8.0, Some(2.0)), []);
    assert_eq!(told(8.0, Some(4.0)).len(), 1, "not learnt yet");
}

#[test]
fn a_change_that_became_calls_for_no_alert_and_clears_its_own() {
    let mut none = found(Found::LightningOrShock, 3.0);
    let told: Time = none.change.from.into();
    let findings = |change: &FoundChange| Findings {
        changes: vec![change.clone()],
        ..Findings::default()
    };
    let of = |cause, change: &FoundChange| became(cause, told, &findings(change));
    let lightning = Cause::LightningOrShock;
    assert_eq!(of(lightning, &none), Some(Became::Learnt));
    (none.change.confirmed, none.change.withdrawn) = (false, true);
    none.change.ended = Some(at("2026-11-20T00:00:00Z"));
    assert_eq!(of(lightning, &none), Some(Became::Withdrawn));
    assert_eq!(of(Cause::MagneticCargo, &none), None);
    assert_eq!(sailed(vec![none], 0.5, Some(1.0)), []);
}

/// What stays is not over: the deviation is another one for good.
#[test]
fn only_what_ended_is_over() {
    let mut struck = found(Found::LightningOrShock, 3.0);
    let told: Time = struck.change.from.into();
    let of = |cause, change: &FoundChange| {
        let changes = vec![change.clone()];
        became(
            cause,
            told,
            &Findings {
                changes,
                ..Findings::default()
            },
        )
    };
    assert_eq!(of(Cause::LightningOrShock, &struck), Some(Became::Learnt));
    assert_eq!(of(Cause::Drift, &struck), Some(Became::Renamed));
    struck.change.ended = Some(at("2026-11-20T00:00:00Z"));
    assert_eq!(of(Cause::LightningOrShock, &struck), None);
    let storm = found(Found::MagneticStorm, 3.0);
    assert_eq!(of(Cause::MagneticStorm, &storm), None);
}

#[test]
fn an_earlier_change_is_told_for_a_week_only() {
    let struck = found(Found::LightningOrShock, 3.0);
    let mut loaded = found(Found::MagneticCargo, 3.0);
    loaded.change.from = at("2026-11-19T12:00:00Z");
    loaded.change.detected_at = at("2026-11-19T13:00:00Z");
    let causes = |days| -> Vec<Cause> {
        let wanted = sailed(vec![struck.clone(), loaded.clone()], days, Some(4.0));
        wanted.iter().map(|alert| alert.cause).collect()
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
    let wanted = sailed(vec![first, second], 0.0, None);
    assert_eq!(wanted.len(), 1);
    assert_eq!(wanted[0].since, since);
}

#[test]
fn an_alert_was_about_the_change_nearest_to_its_date() {
    let first = found(Found::LightningOrShock, 3.0);
    let mut second = first.clone();
    second.change.from = first.change.from.plus_seconds(86_400.0);
    let mut storm = found(Found::MagneticStorm, 3.0);
    storm.change.from = second.change.from.plus_seconds(-600.0);
    let after_first =
        |seconds: f64| -> crate::time::Time { first.change.from.plus_seconds(seconds).into() };
    let alone = sailed(vec![first.clone()], 0.0, None);
    assert!(alone[0].dated.includes(after_first(5.0 * 86_400.0)));

    // The first is taken for something else by now.
    let mut renamed = first.clone();
    renamed.change.cause = Found::Unknown;
    for earlier in [first.clone(), renamed] {
        let wanted = sailed(vec![earlier, storm.clone(), second.clone()], 0.0, None);
        let struck = &wanted[0];
        assert_eq!(struck.since, second.change.from.into());
        assert!(!struck.dated.includes(after_first(3600.0)));
        assert!(struck.dated.includes(after_first(80_000.0)));
    }
}

#[test]
fn a_second_fault_of_a_reference_is_another_alert() {
    let mut first = found(Found::ReferenceFault, 0.0);
    first.change.ended = Some(at("2026-11-19T12:00:00Z"));
    let mut second = found(Found::ReferenceFault, 0.0);
    second.change.from = at("2026-11-21T12:00:00Z");
    let wanted = sailed(vec![first, second], 0.1, Some(1.0));
    assert_eq!(wanted.len(), 1);
    assert!(!wanted[0].dated.includes(at("2026-11-18T12:00:00Z").into()));
    assert!(wanted[0].dated.includes(at("2026-11-21T12:00:00Z").into()));
}

#[test]
fn a_zero_that_moved_is_told_with_what_to_do() {
    let wanted = sailed(vec![found(Found::Alignment, 3.0)], 0.1, Some(1.0));
    assert_eq!(wanted[0].cause, Cause::Alignment);
    assert!(wanted[0].summary.contains("the compass's zero moved"));
    assert!(wanted[0].advice.contains("lubber line"));
    assert!(wanted[0].advice.contains("No corrector"));
}

#[test]
fn while_a_references_fault_is_open_the_compass_is_cleared_only_where_she_did_not_change() {
    let advice = |hers: f64| {
        let mut open = found(Found::ReferenceFault, 2.0);
        open.change.confirmed = false;
        open.change.causes.push(CauseProbability {
            cause: Found::LightningOrShock,
            probability: hers,
        });
        sailed(vec![open], 0.1, Some(1.0))[0].advice
    };
    assert!(advice(0.02).contains("is not suspected"));
    assert!(advice(0.1).contains("do not tell yet which"));
}
