//! The vertical field, which nothing else at the berth verifies.

use super::super::*;
use super::*;

/// Returns the vertical reading with the present setting.
fn down_nt(case: &Case) -> f64 {
    let there = effect(&case.binnacle, &case.binnacle.setting).as_ship(f64::INFINITY);
    sum(&case.bare, &there).field_at_compass([0.0, 0.0, BISCAY.z_nt])[2]
}

/// A ship without heeling magnets.
fn without_magnets() -> Case {
    let mut form: BinnacleForm = class_a().into();
    form.setting.heeling = None;
    Case::new(bare(), Binnacle::try_from(form).unwrap(), 60.0)
}

fn planned(case: &Case, down_nt: f64) -> Outcome {
    let mut adjustment = case.adjustment();
    adjustment.vertical = Some(VerticalReading { down_nt });
    plan(&adjustment).unwrap()
}

#[test]
fn an_upward_axis_or_another_unit_is_named_and_sets_no_heeling_magnets() {
    let case = without_magnets();
    let down_nt = down_nt(&case);
    let sound = planned(&case, down_nt);
    assert!(!sound.plans.is_empty() && !sound.plans[0].heeling.left_as_found);
    for (read_nt, misreading) in [
        (-down_nt, Misreading::DownReversed),
        (down_nt / 1e3, Misreading::DownInAnotherUnit),
        (down_nt / 1e2, Misreading::DownInAnotherUnit),
    ] {
        let refused = planned(&case, read_nt).refusals.remove(0);
        assert_eq!(
            refused.refusal.misreadings(),
            [misreading],
            "{}",
            refused.words
        );
        assert_eq!(refused.cures[0], Cure::ReadAgain);
        assert!(
            refused.words.contains("microtesla down"),
            "{}",
            refused.words
        );
    }
    // Stronger than any ship, in every unit.
    let refused = planned(&case, 95_000.0).refusals.remove(0);
    assert_eq!(refused.refusal.misreadings(), []);
    assert!(
        refused.words.contains("magnets as found"),
        "{}",
        refused.words
    );
}

/// In a weak vertical field of the earth, an upward axis still gives a plausible ship.
#[test]
fn a_reading_that_few_ships_make_and_an_upward_axis_explains_leaves_the_magnets() {
    let mut case = without_magnets();
    let weak = EarthField {
        h_nt: 30_000.0,
        z_nt: 11_000.0,
    };
    let there = effect(&case.binnacle, &case.binnacle.setting).as_ship(f64::INFINITY);
    let ship = sum(&case.bare, &there);
    let [x, y, down_nt] = ship.field_at_compass(weak.in_ship_axes(60.0_f64.to_radians()));
    let (errors, heading) = (case.reading.errors(), case.reading.magnetic());
    case.reading = BerthReading::new(heading, [x, y], errors, Alignment::Keel).unwrap();
    let of = |down_nt: f64| {
        let mut adjustment = case.adjustment();
        adjustment.earth = weak;
        adjustment.vertical = Some(VerticalReading { down_nt });
        plan(&adjustment).unwrap()
    };
    let left = |outcome: &Outcome| outcome.plans[0].heeling.left_as_found;
    assert!(!left(&of(down_nt)));
    let implausible = of(-down_nt);
    assert!(left(&implausible), "{:?}", implausible.plans[0].heeling);
    assert_eq!(implausible.plans[0].setting.heeling, None);
    let named = |note: &String| note.contains("vertical axis points up");
    assert!(
        implausible.notes.iter().any(named),
        "{:?}",
        implausible.notes
    );
}

#[test]
fn a_vertical_axis_that_changed_places_is_named() {
    let case = without_magnets();
    let (down_nt, [x, y]) = (down_nt(&case), case.reading.field_nt());
    for (field_nt, read_nt, misreading) in [
        ([down_nt, y], x, Misreading::ForwardDownSwapped),
        ([x, down_nt], y, Misreading::StarboardDownSwapped),
    ] {
        let (errors, heading) = (case.reading.errors(), case.reading.magnetic());
        let reading = BerthReading::new(heading, field_nt, errors, Alignment::Keel).unwrap();
        let mut adjustment = case.adjustment();
        adjustment.reading = &reading;
        adjustment.vertical = Some(VerticalReading { down_nt: read_nt });
        let refused = plan(&adjustment).unwrap().refusals.remove(0);
        assert!(
            refused.refusal.misreadings().contains(&misreading),
            "{}",
            refused.words
        );
    }
}

#[test]
fn a_heeling_error_that_is_left_is_said() {
    let said = |more_nt: f64, magnets: u16| {
        let mut form: BinnacleForm = class_a().into();
        form.setting.heeling = None;
        form.inventory.magnets[1].count = magnets;
        let case = Case::new(bare(), Binnacle::try_from(form).unwrap(), 60.0);
        let outcome = planned(&case, down_nt(&case) + more_nt);
        let note = |note: &String| note.contains("degrees of heeling error are left");
        (
            outcome.plans[0].heeling.after_deg_per_deg.unwrap().abs() > 0.2,
            outcome.notes.iter().any(note),
        )
    };
    assert_eq!(said(10_000.0, 2), (false, false));
    assert_eq!(said(10_000.0, 0), (true, true));
}
