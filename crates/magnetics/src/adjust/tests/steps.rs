//! Steps, and what the compass shows after them.

use super::super::*;
use super::*;

#[test]
fn after_the_last_step_the_ship_is_as_foretold_and_the_compass_as_each_step_says() {
    for magnetic_deg in [10.0, 100.0, 200.0, 290.0] {
        let case = case(magnetic_deg);
        let outcome = case.plan();
        for plan in &outcome.plans {
            let Some(last) = plan.steps.last() else {
                continue;
            };
            assert_eq!(sorted(&last.setting_after), sorted(&plan.setting));
            for step in &plan.steps {
                case.binnacle
                    .with_setting(step.setting_after.clone())
                    .unwrap();
                let there = effect(&case.binnacle, &step.setting_after).as_ship(BISCAY.h_nt);
                let ship = sum(&case.bare, &there);
                let deviation = ship.deviation_rad(magnetic_deg.to_radians(), BISCAY);
                let compass = magnetic_deg - deviation.to_degrees();
                let off = crate::angle::wrap_180(step.expected_compass_deg - compass);
                assert!(off.abs() < 1e-6, "{magnetic_deg} {}: {off}", step.words);
            }
            let berth = &plan.after[0];
            let ship = sum(
                &case.bare,
                &effect(&case.binnacle, &plan.setting).as_ship(BISCAY.h_nt),
            );
            let coefficients = crate::deviation::Coefficients::new(
                &ship.parameters_over_lambda().unwrap(),
                BISCAY,
            );
            for row in &berth.rows {
                let exact = coefficients.unwrap();
                let exact = exact.deviation_at_compass_rad(row.compass_deg.to_radians());
                let off = row.deviation_deg - 0.2 - exact.unwrap().to_degrees();
                assert!(off.abs() < 1e-6, "{off}");
                assert!(row.band95_deg.unwrap() > 0.5);
            }
        }
    }
}

fn sorted(setting: &Setting) -> Setting {
    let mut sorted = setting.clone();
    for axis in Axis::BOTH {
        sorted.trays_mut(axis).sort_by_key(|tray| tray.hole);
    }
    sorted
}

#[test]
fn the_compass_read_before_shifts_what_is_expected() {
    let case = case(100.0);
    let plain = case.plan();
    let expected = plain.plans[0].steps[0].expected_compass_deg;
    let before = expected - plain.plans[0].steps[0].change_deg;
    let mut adjustment = case.adjustment();
    adjustment.compass_deg = Some(before + 1.5);
    let shifted = plan(&adjustment).unwrap();
    assert!((shifted.plans[0].steps[0].expected_compass_deg - expected - 1.5).abs() < 1e-9);
}

#[test]
fn soft_iron_stands_before_magnets_are_touched() {
    let outcome = case(60.0).plan();
    for plan in &outcome.plans {
        let order: Vec<u8> = plan.steps.iter().map(|step| step.corrector as u8).collect();
        assert!(order.is_sorted(), "{order:?}");
        for step in &plan.steps {
            let iron = matches!(step.corrector, Corrector::Flinders | Corrector::Quadrantal);
            assert_eq!(step.check.is_some(), iron);
        }
    }
}

#[test]
fn heeling_magnets_are_left_without_a_vertical_reading_and_nulled_with_one() {
    let case = case(60.0);
    let outcome = case.plan();
    assert!(outcome.plans[0].heeling.left_as_found);
    assert_eq!(
        outcome.plans[0].setting.heeling,
        case.binnacle.setting.heeling
    );
    let there = effect(&case.binnacle, &case.binnacle.setting);
    let ship = sum(&case.bare, &there.as_ship(f64::INFINITY));
    let mut adjustment = case.adjustment();
    adjustment.vertical = Some(VerticalReading {
        down_nt: ship.field_aboard([0.0, 0.0, BISCAY.z_nt])[2],
    });
    let outcome = plan(&adjustment).unwrap();
    let plan = &outcome.plans[0];
    let (before, after) = (
        plan.heeling.before_deg_per_deg.unwrap(),
        plan.heeling.after_deg_per_deg.unwrap(),
    );
    assert!(
        after.abs() < 0.06 && after.abs() <= before.abs(),
        "{before} {after}"
    );
    // J itself, from the ship as she then is.
    let there = effect(&case.binnacle, &plan.setting);
    let ship = sum(&case.bare, &there.as_ship(BISCAY.h_nt));
    let j = ((ship.chi[1][1] - ship.chi[2][2]) * BISCAY.z_nt - ship.b_nt[2])
        / (ship.lambda() * BISCAY.h_nt);
    assert!((j - after).abs() < 1e-6, "{j} {after}");
}

/// Steps that read as they should, with a wrong end, and with a weaker magnet.
#[test]
fn a_step_is_confirmed_or_explained_and_the_plan_made_anew() {
    let mut ship = bare();
    ship.b_nt = [4_000.0, 3_500.0, 0.0];
    let case = Case::new(ship, class_a(), 45.0);
    let adjustment = case.adjustment();
    let outcome = plan(&adjustment).unwrap();
    let magnets = outcome.plans[0].steps.iter();
    let magnets = magnets.filter(|step| matches!(step.to, Some(Place::Magnets(_))));
    let step = magnets
        .max_by(|a, b| a.change_deg.abs().total_cmp(&b.change_deg.abs()))
        .unwrap();
    let wrap = crate::angle::wrap_360;
    let read = |change: f64| recheck(&adjustment, step, 50.0, wrap(50.0 + change)).unwrap();
    let confirmed = read(step.change_deg + 0.1);
    assert!(
        matches!(confirmed, Recheck::Confirmed { .. }),
        "{confirmed:?}"
    );

    let mut reversed = step.setting_after.clone();
    let Some(Place::Magnets(moved)) = &step.to else {
        panic!()
    };
    for axis in Axis::BOTH {
        for tray in reversed
            .trays_mut(axis)
            .iter_mut()
            .filter(|tray| *tray == moved)
        {
            tray.red = tray.red.reversed();
        }
    }
    let condition = Condition::new(&adjustment).unwrap();
    let change = instructions::change_deg(&adjustment, &condition, &step.setting_before, &reversed);
    let Recheck::WrongEnd {
        setting, outcome, ..
    } = read(change.0)
    else {
        panic!("{change:?}")
    };
    assert_eq!(setting, reversed);
    // The new plan goes on from what was read.
    let first = &outcome.plans[0].steps[0];
    let read_deg = wrap(50.0 + change.0);
    let next_deg = wrap(read_deg + first.change_deg);
    assert!((first.expected_compass_deg - next_deg).abs() < 1e-9);
    assert!(outcome.plans[0].moves > 0);

    // Magnets of 0.6 of their moment, then as when she was measured.
    let weaker = case.binnacle.with_moment("200 mm", 0.6, 0.02).unwrap();
    let weak = Adjustment {
        binnacle: &weaker,
        ..adjustment.clone()
    };
    let truly = Condition::new(&weak).unwrap();
    let change =
        instructions::change_deg(&weak, &truly, &step.setting_before, &step.setting_after).0;
    let Recheck::OtherStrength {
        share,
        outcome,
        setting,
        ..
    } = read(change)
    else {
        panic!("{change} of {}", step.change_deg)
    };
    assert!((share - 0.6).abs() < 0.01, "{share}");
    assert_eq!(setting, step.setting_after);
    assert!(!outcome.plans.is_empty());
    let wild = read(step.change_deg + 25.0);
    assert!(!matches!(wild, Recheck::Confirmed { .. }));
}

#[test]
fn a_step_that_the_heading_does_not_show_is_said_to_be_so() {
    // On north fore-and-aft magnets only weaken or strengthen the field.
    let mut ship = bare();
    ship.b_nt = [5_000.0, 0.0, 0.0];
    let case = Case::new(ship, class_a(), 0.0);
    let adjustment = case.adjustment();
    let outcome = plan(&adjustment).unwrap();
    let steps = &outcome.plans[0].steps;
    let along = steps
        .iter()
        .find(|s| s.corrector == Corrector::ForeAndAft)
        .unwrap();
    assert!(!along.seen);
    let found = recheck(&adjustment, along, 1.0, 1.0 + along.change_deg).unwrap();
    assert!(matches!(found, Recheck::NotSeen { .. }));
    let notes = &outcome.notes;
    assert!(
        notes.iter().any(|n| n.contains("fore-and-aft magnets")),
        "{notes:?}"
    );
    let seen = outcome.berth.unwrap().seen;
    assert!(seen.b < 1e-9 && seen.c > 0.99 && seen.d < 1e-9 && seen.e > 0.99);
}
