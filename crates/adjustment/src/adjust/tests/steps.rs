//! Steps, and the compass headings after them.

use super::super::*;
use super::*;

#[test]
fn after_the_last_step_the_ship_is_as_predicted_and_the_compass_as_each_step_says() {
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
                let off = binnacle_compass::angle::wrap_180(step.expected_compass_deg - compass);
                assert!(off.abs() < 1e-6, "{magnetic_deg} {}: {off}", step.words);
            }
            let berth = &plan.after[0];
            let ship = sum(
                &case.bare,
                &effect(&case.binnacle, &plan.setting).as_ship(BISCAY.h_nt),
            );
            let coefficients = binnacle_compass::deviation::Coefficients::new(
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
        down_nt: ship.field_at_compass([0.0, 0.0, BISCAY.z_nt])[2],
    });
    let outcome = plan(&adjustment).unwrap();
    let left = |note: &String| note.starts_with("the heeling magnets are left");
    assert!(case.plan().notes.iter().any(left) && !outcome.notes.iter().any(left));
    let plan = &outcome.plans[0];
    let (before, after) = (
        plan.heeling.before_deg_per_deg.unwrap(),
        plan.heeling.after_deg_per_deg.unwrap(),
    );
    assert!(
        after.abs() < 0.06 && after.abs() <= before.abs(),
        "{before} {after}"
    );
    // J itself, from the ship after the plan.
    let there = effect(&case.binnacle, &plan.setting);
    let ship = sum(&case.bare, &there.as_ship(BISCAY.h_nt));
    let j = ((ship.chi[1][1] - ship.chi[2][2]) * BISCAY.z_nt - ship.b_nt[2])
        / (ship.lambda() * BISCAY.h_nt);
    assert!((j - after).abs() < 1e-6, "{j} {after}");
}

/// Steps with the expected turn, with a wrong end, and with a weaker magnet.
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
    let wrap = binnacle_compass::angle::wrap_360;
    let read = |change: f64| check_step(&adjustment, step, 50.0, wrap(50.0 + change)).unwrap();
    let confirmed = read(step.change_deg + 0.1);
    assert!(
        matches!(confirmed, StepCheck::Confirmed { .. }),
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
    let state = MagneticState::new(&adjustment).unwrap();
    let change = instructions::compass_turn(&adjustment, &state, &step.setting_before, &reversed);
    let StepCheck::WrongEnd {
        setting, outcome, ..
    } = read(change.change_deg)
    else {
        panic!("{change:?}")
    };
    assert_eq!(setting, reversed);
    // The new plan continues from the observed heading.
    let first = &outcome.plans[0].steps[0];
    let read_deg = wrap(50.0 + change.change_deg);
    let next_deg = wrap(read_deg + first.change_deg);
    assert!((first.expected_compass_deg - next_deg).abs() < 1e-9);
    assert!(outcome.plans[0].moves > 0);

    // Magnets with 0.6 of their moment, then as at the first reading.
    let weaker = case.binnacle.with_moment("200 mm", 0.6, 0.02).unwrap();
    let weak = Adjustment {
        binnacle: &weaker,
        ..adjustment.clone()
    };
    let truly = MagneticState::new(&weak).unwrap();
    let change =
        instructions::compass_turn(&weak, &truly, &step.setting_before, &step.setting_after)
            .change_deg;
    let StepCheck::OtherStrength {
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
    let forgotten = read(0.2);
    assert!(
        matches!(forgotten, StepCheck::Unexplained { unmoved: true, .. }),
        "{forgotten:?}"
    );
    let wild = read(step.change_deg + 25.0);
    assert!(!matches!(wild, StepCheck::Confirmed { .. }));
}

#[test]
fn a_step_that_the_heading_does_not_show_is_said_to_be_so() {
    // On north, fore-and-aft magnets only weaken or strengthen the field.
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
    let found = check_step(&adjustment, along, 1.0, 1.0 + along.change_deg).unwrap();
    assert!(matches!(found, StepCheck::NotSeen { .. }));
    let notes = &outcome.notes;
    assert!(
        notes.iter().any(|n| n.contains("fore-and-aft magnets")),
        "{notes:?}"
    );
    let seen = outcome.berth.unwrap().seen;
    assert!(seen.b < 1e-9 && seen.c > 0.99 && seen.d < 1e-9 && seen.e > 0.99);
}

/// Magnets with 0.59 of their moment, shown by 1.5 degrees: within the reading errors, and
/// no proof of their strength.
#[test]
fn a_small_turn_is_confirmed_with_how_little_it_proves() {
    let case = case(60.0);
    let adjustment = case.adjustment();
    let mut step = plan(&adjustment).unwrap().plans[0].steps[0].clone();
    (step.change_deg, step.tolerance_deg, step.seen) = (-1.52, 0.80, true);
    let StepCheck::Confirmed { proven, .. } = check_step(&adjustment, &step, 50.0, 49.1).unwrap()
    else {
        panic!()
    };
    assert!((proven.share - 0.59).abs() < 0.01, "{proven:?}");
    assert!((proven.precision - 0.39).abs() < 0.01, "{proven:?}");
    let words = proven.to_string();
    assert!(
        words.contains("59 per cent") && words.contains("only to within 39 per cent"),
        "{words}"
    );
    (step.change_deg, step.tolerance_deg) = (15.0, 2.0);
    let StepCheck::Confirmed { proven, .. } = check_step(&adjustment, &step, 50.0, 64.5).unwrap()
    else {
        panic!()
    };
    assert!(!proven.to_string().contains("only"), "{proven:?}");
}

/// Each step is a little small in the same direction, within its own tolerance.
#[test]
fn what_each_step_hides_all_of_them_show() {
    let mut ship = bare();
    ship.b_nt = [4_000.0, 3_500.0, 0.0];
    let case = Case::new(ship, class_a(), 45.0);
    let adjustment = case.adjustment();
    let steps = plan(&adjustment).unwrap().plans.remove(0).steps;
    let last = &steps.last().unwrap().setting_after;
    let expected: f64 = steps.iter().map(|step| step.change_deg).sum();
    let wrap = binnacle_compass::angle::wrap_360;
    let in_all = |off_deg: f64| {
        check_total_turn(&adjustment, 50.0, last, wrap(50.0 + expected + off_deg)).unwrap()
    };
    let found = in_all(0.0);
    assert!(found.agrees() && found.off_deg.abs() < 1e-6, "{found:?}");
    let hidden: f64 = steps.iter().map(|step| 0.95 * step.tolerance_deg).sum();
    assert!(steps.len() > 2 && hidden > found.tolerance_deg, "{found:?}");
    let found = in_all(hidden);
    assert!(!found.agrees(), "{found:?}");
    assert!(found.to_string().starts_with("in all, the compass turned"));
}

/// Iron that comes out needs no check of its retentive magnetism, and no place in the tube.
#[test]
fn iron_is_tried_where_it_goes_in_and_a_bar_stands_at_the_cards_height() {
    let case = case(60.0);
    let adjustment = case.adjustment();
    let state = MagneticState::new(&adjustment).unwrap();
    let mut bare = case.binnacle.setting.clone();
    (bare.flinders, bare.quadrantal) = (None, None);
    let out = instructions::steps(&adjustment, &state, &bare);
    assert_eq!(out.len(), 2);
    assert!(out.iter().all(|step| step.check.is_none()), "{out:?}");
    let adjustment = Adjustment {
        now: Some(&bare),
        ..adjustment.clone()
    };
    let back = instructions::steps(&adjustment, &state, &case.binnacle.setting);
    assert!(back.iter().all(|step| step.check.is_some()));
    assert!(
        back[0].words.contains("fill the tube below"),
        "{}",
        back[0].words
    );
}

/// The compass on an even keel shows nothing of them, the vertical field everything.
#[test]
fn heeling_magnets_are_verified_by_the_vertical_field() {
    let case = case(60.0);
    let down_nt = |setting: &Setting| {
        let there = effect(&case.binnacle, setting).as_ship(f64::INFINITY);
        sum(&case.bare, &there).field_at_compass([0.0, 0.0, BISCAY.z_nt])[2]
    };
    let mut moved = 0;
    for more_nt in [-12_000.0, -6_000.0, 6_000.0, 12_000.0] {
        let mut adjustment = case.adjustment();
        adjustment.vertical = Some(VerticalReading {
            down_nt: down_nt(&case.binnacle.setting) + more_nt,
        });
        for step in &plan(&adjustment).unwrap().plans[0].steps {
            if step.corrector != Corrector::Heeling {
                continue;
            }
            let [was, will] = [&step.setting_before, &step.setting_after]
                .map(|setting| (down_nt(setting) + more_nt) / 1e3);
            let words = step.check.as_ref().unwrap();
            assert!(
                words.contains(&format!("read {will:.1} microtesla down")),
                "{words} {will}"
            );
            assert!(
                words.contains(&format!("before this step {was:.1}")),
                "{words} {was}"
            );
            assert!((was - will).abs() > 1.0, "{words}");
            moved += 1;
        }
    }
    assert!(moved >= 2, "{moved}");
}

/// A step from a record with the wrong end, and the turn of the compass by it.
struct Misrecorded {
    case: Case,
    recorded: Binnacle,
    step: Step,
    turned_deg: f64,
}

impl Misrecorded {
    /// Moves the magnets of an axis from a hole to another, or takes them out.
    fn new(axis: Axis, from: u16, to: Option<u16>) -> Misrecorded {
        let mut ship = bare();
        ship.b_nt = [-2_500.0, 2_500.0, 0.0];
        let mut stood = class_a().setting.clone();
        stood.trays_mut(axis)[0].hole = from;
        let case = Case::new(ship, class_a().with_setting(stood).unwrap(), 45.0);
        let mut recorded = case.binnacle.setting.clone();
        let tray = &mut recorded.trays_mut(axis)[0];
        tray.red = tray.red.reversed();
        let recorded = case.binnacle.with_setting(recorded).unwrap();
        let adjustment = Adjustment {
            binnacle: &recorded,
            ..case.adjustment()
        };
        let state = MagneticState::new(&adjustment).unwrap();
        let mut moved = recorded.setting.clone();
        match to {
            Some(hole) => moved.trays_mut(axis)[0].hole = hole,
            None => moved.trays_mut(axis).clear(),
        }
        let step = instructions::steps(&adjustment, &state, &moved).remove(0);
        assert_eq!(step.setting_after, moved);
        let truth = case.adjustment();
        let truly = MagneticState::new(&truth).unwrap();
        let turn = instructions::compass_turn(&truth, &truly, &case.binnacle.setting, &moved);
        Misrecorded {
            turned_deg: turn.change_deg,
            recorded,
            step,
            case,
        }
    }

    fn check(&self) -> StepCheck {
        let adjustment = Adjustment {
            binnacle: &self.recorded,
            ..self.case.adjustment()
        };
        let after_deg = binnacle_compass::angle::wrap_360(50.0 + self.turned_deg);
        check_step(&adjustment, &self.step, 50.0, after_deg).unwrap()
    }
}

/// The record has the red end the wrong way: the compass turns the other way when the magnets
/// are taken out, too far when they move, and the plan is made for the ship as she is.
#[test]
fn magnets_that_stood_otherwise_than_recorded_are_found_by_the_first_step() {
    let ways = [
        (Axis::Athwartship, 7, None),
        (Axis::ForeAndAft, 5, None),
        (Axis::Athwartship, 7, Some(11)),
        (Axis::ForeAndAft, 7, Some(11)),
    ];
    for (axis, from, to) in ways {
        let misrecorded = Misrecorded::new(axis, from, to);
        let case = &misrecorded.case;
        let found = misrecorded.check();
        let StepCheck::FoundOtherwise {
            binnacle, outcome, ..
        } = found
        else {
            panic!("{axis:?} {to:?}: {found:?}")
        };
        assert_eq!(binnacle.setting, case.binnacle.setting);
        let with_truth = plan(&Adjustment {
            now: Some(&misrecorded.step.setting_after),
            compass_deg: Some(50.0 + misrecorded.turned_deg),
            ..case.adjustment()
        });
        assert_eq!(
            outcome.plans[0].setting,
            with_truth.unwrap().plans[0].setting
        );
    }
}

/// Magnets from a deep hole turn the compass by a little more than expected where their end was
/// recorded wrongly, which stronger magnets do oftener.
#[test]
fn a_small_surplus_is_strength_before_it_is_a_wrong_record() {
    let misrecorded = Misrecorded::new(Axis::Athwartship, 1, Some(19));
    let share = misrecorded.turned_deg / misrecorded.step.change_deg;
    assert!((1.1..1.4).contains(&share), "{share}");
    let found = misrecorded.check();
    let StepCheck::OtherStrength {
        or_found_otherwise, ..
    } = found
    else {
        panic!("{found:?}")
    };
    assert!(or_found_otherwise);
}
