//! Due dates by the built-in rules, each worked out by hand.

#![allow(clippy::unwrap_used)] // helpers of tests

use binnacle_schedule::needs::{Cause, CauseKind, Compass, Due, Ship, Terms, Urgency, due};
use binnacle_schedule::rules::built_in_rules;
use chrono::NaiveDate;
use serde_json::{Value, from_value, json};

/// On the twenty-first of November 2026.
fn due_of(ship: Value, compass: Value) -> Due {
    let ship: Ship = from_value(ship).unwrap();
    let compass: Compass = from_value(compass).unwrap();
    let today = day("2026-11-21");
    due(&ship, &compass, built_in_rules(), &Terms::default(), today).unwrap()
}

fn day(text: &str) -> NaiveDate {
    text.parse().unwrap()
}

#[test]
fn two_years_after_the_last_adjustment_by_iso_25862() {
    let due = due_of(json!({"flag": "NO"}), json!({"adjusted_on": "2025-03-01"}));
    assert_eq!((due.on, due.urgency), (day("2027-03-01"), Urgency::Routine));
    assert_eq!(
        due.reason,
        "24 months after the adjustment of 2025-03-01 (ISO 25862:2019, Annex G)"
    );
}

#[test]
fn a_leap_days_adjustment_is_due_on_the_last_of_february() {
    let due = due_of(json!({"flag": "NO"}), json!({"adjusted_on": "2024-02-29"}));
    assert_eq!(due.on, day("2026-02-28"));
    assert_eq!(due.urgency, Urgency::Overdue);
}

#[test]
fn a_panama_ship_that_keeps_no_record_is_due_after_one_year() {
    let compass = json!({"adjusted_on": "2026-01-15"});
    let without = due_of(json!({"flag": "PA"}), compass.clone());
    assert_eq!(
        (without.on, without.urgency),
        (day("2027-01-15"), Urgency::Soon)
    );
    assert!(without.reason.contains("MMC-138"), "{}", without.reason);
    let with = due_of(json!({"flag": "PA", "deviation_record": "kept"}), compass);
    assert_eq!(with.on, day("2028-01-15"));
}

#[test]
fn a_ship_of_no_known_flag_is_bound_by_every_flags_rules() {
    let due = due_of(json!({}), json!({"adjusted_on": "2026-01-15"}));
    assert_eq!(due.on, day("2027-01-15"));
}

#[test]
fn a_ship_is_adjusted_after_a_new_compass_is_installed() {
    let compass = json!({"adjusted_on": "2026-01-15",
        "events": [{"kind": "installation", "on": "2026-11-01"}]});
    let theirs = due_of(json!({"flag": "MH"}), compass.clone());
    assert_eq!(theirs.on, day("2026-12-01"));
    let says_so = |cause: &Cause| cause.reason.contains("MN 2-011-32, 2.1.1");
    assert!(theirs.causes.iter().any(says_so), "{:?}", theirs.causes);
    let others = due_of(json!({"flag": "NO"}), compass);
    assert_eq!(others.on, day("2026-12-01"));
    assert!(
        others.reason.contains("ISO 25862:2019, Annex G"),
        "{}",
        others.reason
    );
}

#[test]
fn a_compass_without_a_record_is_unknown_and_to_be_arranged_within_the_soon_days() {
    let due = due_of(json!({"flag": "NO"}), json!({}));
    assert_eq!((due.on, due.urgency), (day("2027-01-20"), Urgency::Unknown));
    assert_eq!(due.causes[0].kind, CauseKind::NeverAdjusted);
}

#[test]
fn a_missing_record_hides_no_change() {
    let ship: Ship = from_value(json!({"flag": "NO"})).unwrap();
    let struck = json!({"change": {"on": "2026-11-20", "size_deg": 20.0}});
    let struck: Compass = from_value(struck).unwrap();
    let terms = Terms {
        soon_days: 14,
        ..Terms::default()
    };
    let of = |today: &str| due(&ship, &struck, built_in_rules(), &terms, day(today)).unwrap();
    let found = of("2026-11-21");
    assert_eq!(
        (found.on, found.urgency),
        (day("2026-12-20"), Urgency::Routine)
    );
    assert!(found.reason.contains("20"), "{}", found.reason);
    assert_eq!(of("2026-12-08").urgency, Urgency::Urgent);
    // What is due in a year is arranged with the first adjustment.
    let transit = json!({"flag": "NO", "gross_tonnage": 5000,
                         "transits": [{"canal": "panama", "on": "2027-11-01"}]});
    assert_eq!(due_of(transit, json!({})).urgency, Urgency::Unknown);
}

#[test]
fn a_transit_of_panama_asks_for_a_table_of_the_last_twelve_months() {
    let ship = |tonnage: u32, on: &str| json!({"flag": "NO", "gross_tonnage": tonnage, "transits": [{"canal": "panama", "on": on}]});
    let compass = json!({"adjusted_on": "2026-01-10"});
    let late = due_of(ship(150, "2027-01-11"), compass.clone());
    assert_eq!(
        (late.on, late.causes[0].kind),
        (day("2027-01-11"), CauseKind::Transit)
    );
    assert!(late.reason.contains("N-1-2022"), "{}", late.reason);
    let in_time = due_of(ship(150, "2027-01-10"), compass.clone());
    assert_eq!(in_time.on, day("2028-01-10"));
    let small = due_of(ship(149, "2027-01-11"), compass);
    assert_eq!(small.on, day("2028-01-10"));
}

#[test]
fn seven_degrees_at_the_transit_are_too_much_and_six_point_nine_are_not() {
    let at = |deviation: f64| {
        due_of(
            json!({"flag": "NO", "gross_tonnage": 5000, "transits": [{"canal": "panama", "on": "2027-01-05"}]}),
            json!({"adjusted_on": "2026-06-01",
                   "predicted": [{"on": "2026-12-01", "worst_deviation_deg": deviation}]}),
        )
        .on
    };
    assert_eq!(at(7.0), day("2027-01-05"));
    assert_eq!(at(6.9), day("2028-06-01"));
}

#[test]
fn deviation_over_five_degrees_brings_a_marshall_islands_ship_forward() {
    let of = |flag: &str, deviation: f64| {
        due_of(
            json!({"flag": flag}),
            json!({"adjusted_on": "2026-06-01",
                   "predicted": [{"on": "2026-12-01", "worst_deviation_deg": 3.0},
                                 {"on": "2027-01-01", "worst_deviation_deg": deviation}]}),
        )
    };
    let over = of("MH", 5.1);
    // Two weeks from the day on which it is over the limit.
    assert_eq!(
        (over.on, over.urgency),
        (day("2027-01-15"), Urgency::Urgent)
    );
    assert_eq!(over.causes.len(), 2);
    assert_eq!(of("MH", 5.0).on, day("2028-06-01"));
    assert_eq!(of("NO", 5.1).on, day("2028-06-01"));
}

/// For a past day, a prediction gives the day since which it holds.
#[test]
fn the_two_weeks_run_from_the_day_on_which_the_limit_was_passed() {
    let over = due_of(
        json!({"flag": "MH"}),
        json!({"adjusted_on": "2026-06-01",
               "predicted": [{"on": "2026-10-01", "worst_deviation_deg": 4.0},
                             {"on": "2026-10-20", "worst_deviation_deg": 5.5},
                             {"on": "2026-12-01", "worst_deviation_deg": 6.2}]}),
    );
    assert_eq!(
        (over.on, over.urgency),
        (day("2026-11-03"), Urgency::Overdue)
    );
    let reason = &over.causes[0].reason;
    assert!(
        reason.contains("5.5° of deviation or more since 2026-10-20"),
        "{reason}"
    );
}

#[test]
fn an_event_counts_until_the_next_adjustment() {
    let of = |adjusted: &str| {
        let compass = json!({"adjusted_on": adjusted, "events": [{"kind": "dry_docking", "on": "2026-11-01"}]});
        due_of(json!({"flag": "NO"}), compass)
    };
    let before = of("2026-05-01");
    assert_eq!(
        (before.on, before.causes[0].kind),
        (day("2026-12-01"), CauseKind::Event)
    );
    assert_eq!(of("2026-11-02").on, day("2028-11-02"));
}

#[test]
fn a_change_of_two_degrees_counts_and_a_smaller_one_does_not() {
    let of = |size: f64| {
        let compass =
            json!({"adjusted_on": "2026-05-01", "change": {"on": "2026-11-11", "size_deg": size}});
        due_of(json!({"flag": "NO"}), compass)
    };
    assert_eq!(
        (of(-2.0).on, of(-2.0).urgency),
        (day("2026-12-11"), Urgency::Urgent)
    );
    assert_eq!(of(1.9).on, day("2028-05-01"));
}

#[test]
fn a_failed_verification_is_urgent_and_gives_its_error() {
    let due = due_of(
        json!({"flag": "NO"}),
        json!({"adjusted_on": "2026-11-01", "failed_verification": {"on": "2026-11-10", "worst_error_deg": 2.44}}),
    );
    assert_eq!((due.on, due.urgency), (day("2026-12-10"), Urgency::Urgent));
    assert_eq!(
        due.reason,
        "the verification of 2026-11-10 failed: headings are 2.4° off the card on the worst heading"
    );
}

/// A Norwegian ship, whose flag sets no limit.
fn over_own_limit(compass: &Value) -> Due {
    due_of(json!({"flag": "NO"}), compass.clone())
}

#[test]
fn deviation_over_the_vessels_own_limit_is_due_where_her_flag_sets_none() {
    let mut compass = json!({"adjusted_on": "2025-11-20", "deviation_limit_deg": 5.0,
        "predicted": [
            {"on": "2026-11-18", "worst_deviation_deg": 5.4},
            {"on": "2026-11-21", "place": "her position", "worst_deviation_deg": 25.7,
             "side": "west"}]});
    let over = over_own_limit(&compass);
    assert_eq!(
        (over.on, over.urgency),
        (day("2026-12-02"), Urgency::Urgent)
    );
    assert_eq!(
        over.reason,
        "25.7° W of deviation at her position, 5.4° or more since 2026-11-18, over the vessel's own \
         limit of 5°"
    );
    assert_eq!(over.causes[0].rule, None);
    compass["deviation_limit_deg"] = json!(26.0);
    assert_eq!(over_own_limit(&compass).on, day("2027-11-20"));
}

#[test]
fn deviation_over_the_vessels_own_limit_at_a_port_ahead_names_the_port() {
    let over = over_own_limit(
        &json!({"adjusted_on": "2025-11-20", "deviation_limit_deg": 4.5,
        "predicted": [
            {"on": "2026-12-08", "place": "Tromsø", "worst_deviation_deg": 4.6, "side": "east"}]}),
    );
    assert_eq!(over.on, day("2026-12-22"));
    assert_eq!(
        over.reason,
        "4.6° E of deviation predicted for 2026-12-08 at Tromsø, over the vessel's own limit of 4.5°"
    );
}

#[test]
fn a_flags_stricter_limit_speaks_and_the_vessels_own_speaks_below_it() {
    let of = |own: f64, deviation: f64| {
        let compass = json!({"adjusted_on": "2026-06-01", "deviation_limit_deg": own,
            "predicted": [{"on": "2026-12-01", "worst_deviation_deg": deviation}]});
        let causes = due_of(json!({"flag": "MH"}), compass).causes;
        let over = causes.into_iter();
        let over = over.filter(|cause| cause.kind == CauseKind::OverLimit);
        over.map(|cause| cause.rule.unwrap_or("own".to_owned()))
            .collect::<Vec<_>>()
    };
    assert_eq!(of(5.0, 9.0), ["marshall-islands-limit"]);
    assert_eq!(of(8.0, 9.0), ["marshall-islands-limit"]);
    assert_eq!(of(3.0, 4.0), ["own"]);
    assert_eq!(of(3.0, 9.0), ["marshall-islands-limit", "own"]);
}

#[test]
fn deviation_over_the_limit_is_due_where_no_adjustment_is_on_record() {
    let over = over_own_limit(&json!({"deviation_limit_deg": 5.0,
        "predicted": [
            {"on": "2026-11-21", "place": "her position", "worst_deviation_deg": 25.7,
             "side": "west"}]}));
    assert_eq!(
        (over.on, over.urgency),
        (day("2026-12-05"), Urgency::Urgent)
    );
    assert_eq!(
        over.reason,
        "25.7° W of deviation at her position on 2026-11-21, over the vessel's own limit of 5°"
    );
}

#[test]
fn an_excess_before_the_adjustment_counts_from_the_adjustment() {
    let over = over_own_limit(
        &json!({"adjusted_on": "2026-11-15", "deviation_limit_deg": 5.0,
        "predicted": [
            {"on": "2026-10-01", "worst_deviation_deg": 6.0},
            {"on": "2026-11-21", "worst_deviation_deg": 6.1}]}),
    );
    assert_eq!(over.on, day("2026-11-29"));
    assert!(
        over.reason.contains("or more since 2026-11-15"),
        "{}",
        over.reason
    );
}

#[test]
fn an_unverified_adjustment_is_marked_as_unverified() {
    let compass = json!({"adjusted_on": "2026-11-21", "awaits_verification": true});
    let due = due_of(json!({"flag": "NO"}), compass);
    assert_eq!((due.on, due.urgency), (day("2028-11-21"), Urgency::Routine));
    assert_eq!(
        due.reason,
        "adjusted, not yet verified at sea: 24 months after the adjustment of 2026-11-21 (ISO \
         25862:2019, Annex G)"
    );
}

#[test]
fn a_change_on_the_day_of_the_adjustment_counts() {
    let compass = json!({"adjusted_on": "2026-11-20",
        "change": {"on": "2026-11-20", "size_deg": 6.0}});
    let due = due_of(json!({"flag": "NO"}), compass);
    assert_eq!(due.causes[0].kind, CauseKind::Change);
}
