//! Correctors of another strength than assumed.

use super::super::*;
use super::*;
use crate::binnacle::{Calibrated, Rack, Soft};
use crate::corrector::{Iron, magnet_field};

/// A ship without correctors fitted, which needs soft iron and magnets.
fn wanting() -> Case {
    let mut ship = bare();
    ship.b_nt = [4_000.0, 3_500.0, 0.0];
    let mut form: BinnacleForm = class_a().into();
    form.setting = Setting::default();
    Case::new(ship, Binnacle::try_from(form).unwrap(), 45.0)
}

fn step_of(adjustment: &Adjustment<'_>, corrector: Corrector) -> Step {
    let steps = &plan(adjustment).unwrap().plans[0].steps;
    let largest = steps
        .iter()
        .filter(|step| step.corrector == corrector)
        .max_by(|a, b| a.change_deg.abs().total_cmp(&b.change_deg.abs()));
    largest.unwrap().clone()
}

/// Judges a step with this multiple of the expected turn.
fn read(adjustment: &Adjustment<'_>, step: &Step, times: f64) -> StepCheck {
    let after_deg = binnacle_compass::angle::wrap_360(50.0 + times * step.change_deg);
    check_step(adjustment, step, 50.0, after_deg).unwrap()
}

#[test]
fn a_pair_found_stronger_is_so_at_every_mark() {
    let case = wanting();
    let adjustment = case.adjustment();
    let step = step_of(&adjustment, Corrector::Quadrantal);
    let Some(Place::Pair(pair)) = &step.to else {
        panic!("{step:?}")
    };
    // Far beyond the compass's errors, but plausible for a pair.
    let mut step = step.clone();
    step.tolerance_deg = 0.2;
    let StepCheck::OtherStrength {
        share, binnacle, ..
    } = read(&adjustment, &step, 1.12)
    else {
        panic!("{step:?}")
    };
    assert!((1.05..1.2).contains(&share), "{share}");
    let q = |binnacle: &Binnacle, size: &str, mark_mm: f64| {
        let mut at = pair.clone();
        (at.size, at.mark_mm) = (size.to_owned(), mark_mm);
        let soft = Soft {
            quadrantal: Some(at),
            flinders: None,
        };
        Iron::new(binnacle, &soft).pair.unwrap().q()
    };
    for mark in &case.binnacle.design.quadrantal.as_ref().unwrap().marks {
        let [was, is] = [&case.binnacle, &*binnacle].map(|of| q(of, &pair.size, mark.mark_mm));
        assert!((is / was - share).abs() < 1e-9, "{} mm", mark.mark_mm);
    }
    let other = ["5 inch", "7 inch", "8.5 inch"];
    let other = other.into_iter().find(|size| *size != pair.size).unwrap();
    let [was, is] = [&case.binnacle, &*binnacle].map(|of| q(of, other, 320.0));
    assert!((was - is).abs() < 1e-12);
}

#[test]
fn a_bar_found_weaker_is_so_at_every_length() {
    let mut ship = bare();
    ship.chi[0][2] = -0.08;
    let mut form: BinnacleForm = class_a().into();
    form.setting = Setting::default();
    let case = Case::new(ship, Binnacle::try_from(form).unwrap(), 90.0);
    let adjustment = case.adjustment();
    let mut step = step_of(&adjustment, Corrector::Flinders);
    step.tolerance_deg = 0.2;
    let StepCheck::OtherStrength {
        share, binnacle, ..
    } = read(&adjustment, &step, 0.85)
    else {
        panic!("{step:?}")
    };
    assert!((0.75..0.95).contains(&share), "{share}");
    let lengths = case.binnacle.bar_lengths();
    assert!(lengths.len() > 4);
    for (length_mm, _) in lengths {
        let soft = Soft {
            quadrantal: None,
            flinders: Some(crate::binnacle::BarSetting {
                length_mm,
                side: crate::binnacle::Side::Forward,
                slew_deg: 0.0,
            }),
        };
        let [was, is] =
            [&case.binnacle, &*binnacle].map(|of| Iron::new(of, &soft).bar.unwrap().c());
        assert!((is / was - share).abs() < 1e-9, "{length_mm} mm");
    }
}

/// With iron of three times its strength, or a magnet of twice, the ship has moved, the
/// iron has retentive magnetism, or the wrong corrector was moved.
#[test]
fn a_strength_that_no_corrector_of_its_kind_has_explains_nothing() {
    let case = wanting();
    let adjustment = case.adjustment();
    for (corrector, times) in [
        (Corrector::Quadrantal, 2.97),
        (Corrector::Quadrantal, 1.6),
        (Corrector::Quadrantal, 0.5),
        (Corrector::Athwartship, 2.8),
        (Corrector::Athwartship, 0.2),
    ] {
        let mut step = step_of(&adjustment, corrector);
        step.tolerance_deg = 0.2;
        let found = read(&adjustment, &step, times);
        assert!(
            matches!(found, StepCheck::Unexplained { .. }),
            "{corrector:?} {times}: {found:?}"
        );
    }
}

/// A catalogue's moment may be of another make; a tested moment is not.
#[test]
fn magnets_that_were_tested_are_not_much_stronger() {
    let mut case = wanting();
    for (is_tested, is_found) in [(false, true), (true, false)] {
        if is_tested {
            case.binnacle = case.binnacle.with_moment("200 mm", 1.0, 0.02).unwrap();
        }
        let adjustment = case.adjustment();
        let step = step_of(&adjustment, Corrector::Athwartship);
        let found = read(&adjustment, &step, 1.6);
        let is_other = matches!(found, StepCheck::OtherStrength { .. });
        assert_eq!(is_other, is_found, "{is_tested}: {found:?}");
    }
}

/// Every hole is measured, which takes precedence over the formulas.
#[test]
fn weak_magnets_are_found_in_holes_that_were_measured() {
    let mut case = wanting();
    let mut form: BinnacleForm = case.binnacle.clone().into();
    let holes = |rack: &Rack| {
        rack.holes
            .iter()
            .map(|hole| hole.number)
            .collect::<Vec<_>>()
    };
    for axis in Axis::BOTH {
        for hole in holes(form.design.rack(axis)) {
            let field = magnet_field(&form, &Iron::default(), axis, "200 mm", hole).unwrap();
            let field_nt = field.iter().map(|part| part * part).sum::<f64>().sqrt();
            form.calibration.push(Calibrated::Magnet {
                axis,
                magnet: "200 mm".to_owned(),
                hole,
                field_nt,
                sd: 0.02,
            });
        }
    }
    case.binnacle = Binnacle::try_from(form).unwrap();
    let adjustment = case.adjustment();
    let step = step_of(&adjustment, Corrector::Athwartship);
    let StepCheck::OtherStrength {
        share, binnacle, ..
    } = read(&adjustment, &step, 0.5)
    else {
        panic!("{step:?}")
    };
    assert!((0.4..0.6).contains(&share), "{share}");
    for axis in Axis::BOTH {
        for hole in holes(case.binnacle.design.rack(axis)) {
            let [was, is] = [&case.binnacle, &*binnacle].map(|of| {
                let field = magnet_field(of, &Iron::default(), axis, "200 mm", hole).unwrap();
                field[usize::from(axis == Axis::Athwartship)]
            });
            assert!((is / was - share).abs() < 1e-9, "{axis} {hole}");
        }
    }
}

/// Returns the step with its tray some holes off, and the resulting turn of the compass.
fn miscounted(adjustment: &Adjustment<'_>, step: &Step, by: i32) -> (u16, Setting, f64) {
    let mut setting = step.setting_after.clone();
    let Some(Place::Magnets(to)) = &step.to else {
        panic!("{step:?}")
    };
    let hole = u16::try_from(i32::from(to.hole) + by).unwrap();
    let mut trays = setting.trays_mut(Axis::Athwartship).iter_mut();
    trays.find(|tray| *tray == to).unwrap().hole = hole;
    let state = MagneticState::new(adjustment).unwrap();
    let before = &step.setting_before;
    let turn = instructions::compass_turn(adjustment, &state, before, &setting);
    (hole, setting, turn.change_deg)
}

#[test]
fn magnets_that_seem_of_another_strength_may_stand_in_another_hole() {
    let case = wanting();
    let adjustment = case.adjustment();
    let mut step = step_of(&adjustment, Corrector::Athwartship);
    step.tolerance_deg = 0.2;
    for by in [-2, 2, 3] {
        let (hole, _, change_deg) = miscounted(&adjustment, &step, by);
        let found = read(&adjustment, &step, change_deg / step.change_deg);
        let StepCheck::OtherStrength { other_hole, .. } = found else {
            panic!("{by}: {found:?}")
        };
        assert_eq!(other_hole, Some(hole), "{by}");
    }
    // No nearby hole has that effect.
    let found = read(&adjustment, &step, 0.35);
    let StepCheck::OtherStrength { other_hole, .. } = found else {
        panic!("{found:?}")
    };
    assert_eq!(other_hole, None);
}

#[test]
fn a_strength_is_learnt_anew_from_where_the_magnets_stand() {
    let case = wanting();
    let adjustment = case.adjustment();
    let step = step_of(&adjustment, Corrector::Athwartship);
    let (hole, setting, change_deg) = miscounted(&adjustment, &step, 3);
    let anew = |turned_deg: Option<f64>| {
        let compass_deg = turned_deg.map(|turned| binnacle_compass::angle::wrap_360(50.0 + turned));
        check_step_with_setting(&adjustment, &step, 50.0, &setting, compass_deg).unwrap()
    };
    // The compass shows the effect of unscaled magnets there; an unread step changes
    // nothing.
    for turned_deg in [Some(change_deg), None] {
        let (done, binnacle) = anew(turned_deg);
        assert_eq!(binnacle, case.binnacle);
        assert!(matches!(&done.to, Some(Place::Magnets(tray)) if tray.hole == hole));
        assert!(done.is_contradicted(&setting, &step.setting_after));
    }
    // Magnets with 0.6 of their moment in that hole.
    let weaker = case.binnacle.with_moment("200 mm", 0.6, 0.02).unwrap();
    let weak = Adjustment {
        binnacle: &weaker,
        ..adjustment.clone()
    };
    let (_, _, turned_deg) = miscounted(&weak, &step, 3);
    let (_, binnacle) = anew(Some(turned_deg));
    let kind = binnacle.design.magnet("200 mm").unwrap();
    let am2 = binnacle.moment(kind).am2;
    assert!((am2 - 0.6).abs() < 0.01, "{am2}");
}
