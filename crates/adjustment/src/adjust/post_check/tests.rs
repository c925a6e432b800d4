//! Second readings: fitting ones, slips, and unexplained ones.

use super::super::state::{MagneticState, setting_errors};
use super::super::tests::{BISCAY, Case, bare, sum};
use super::super::*;
use super::hypotheses::{HypothesisKind, Posterior};
use super::innovation::ModelVector;
use super::judge::is_slip;
use crate::berth::BerthReading;
use crate::binnacle::tests::class_a;
use crate::binnacle::{Axis, Binnacle, Setting};
use crate::corrector::effect;
use binnacle_compass::ship::ShipMagnetism;
use nalgebra::SMatrix;

/// Returns the field at the card's place of a ship with a setting, nT.
fn field(
    ship: &ShipMagnetism,
    binnacle: &Binnacle,
    setting: &Setting,
    magnetic_deg: f64,
) -> [f64; 3] {
    let there = effect(binnacle, setting).as_ship(f64::INFINITY);
    sum(ship, &there).field_at_compass(BISCAY.in_ship_axes(magnetic_deg.to_radians()))
}

fn ship() -> ShipMagnetism {
    let mut ship = bare();
    ship.b_nt = [4_000.0, 3_500.0, 0.0];
    ship
}

/// A case with its best plan, all steps done, none read on the compass.
struct Adjusted {
    case: Case,
    magnetic_deg: f64,
    down_nt: f64,
    plan: Plan,
}

impl Adjusted {
    fn new(magnetic_deg: f64) -> Adjusted {
        let case = Case::new(ship(), class_a(), magnetic_deg);
        let [_, _, down_nt] = field(
            &ship(),
            &case.binnacle,
            &case.binnacle.setting,
            magnetic_deg,
        );
        let mut adjustment = case.adjustment();
        adjustment.vertical = Some(VerticalReading { down_nt });
        let plan = plan(&adjustment).unwrap().plans.remove(0);
        Adjusted {
            case,
            magnetic_deg,
            down_nt,
            plan,
        }
    }

    fn done(&self) -> Vec<CompletedStep> {
        let steps = self.plan.steps.iter().cloned();
        steps
            .map(|step| CompletedStep {
                step,
                turned_deg: None,
            })
            .collect()
    }

    /// Judges a reading of the actual setting with an error.
    fn read(&self, truly: &Setting, off_nt: [f64; 3]) -> PostCheck {
        let [x, y, z] = field(&ship(), &self.case.binnacle, truly, self.magnetic_deg);
        self.judge(
            [x + off_nt[0], y + off_nt[1], z + off_nt[2]],
            Unit::Nanotesla,
        )
    }

    fn judge(&self, field_nt: [f64; 3], named: Unit) -> PostCheck {
        self.judge_with(field_nt, None, named)
    }

    fn judge_with(&self, [x, y, z]: [f64; 3], compass_deg: Option<f64>, named: Unit) -> PostCheck {
        let first = &self.case.reading;
        let reading =
            BerthReading::new(first.magnetic(), [x, y], first.errors(), first.alignment()).unwrap();
        let mut adjustment = self.case.adjustment();
        adjustment.vertical = Some(VerticalReading {
            down_nt: self.down_nt,
        });
        adjustment.now = Some(&self.plan.setting);
        let vertical = Some(VerticalReading { down_nt: z });
        let done = self.done();
        check_second_reading(&adjustment, &done, &reading, vertical, compass_deg, named).unwrap()
    }
}

#[test]
fn a_reading_as_predicted_confirms_the_plan_and_its_band() {
    for magnetic_deg in [10.0, 100.0, 200.0, 290.0] {
        let adjusted = Adjusted::new(magnetic_deg);
        let again = adjusted.read(&adjusted.plan.setting, [0.0; 3]);
        for part in &again.parts {
            assert!((part.read_nt - part.expected_nt).abs() < 1.0, "{part:?}");
            assert!(
                (100.0..1_000.0).contains(&part.standard_error_nt),
                "{part:?}"
            );
        }
        let Verdict::AsPlanned { updated: learnt } = again.verdict else {
            panic!("{magnetic_deg}: {:?}", again.verdict)
        };
        let wider_deg = learnt.widest_band_deg - adjusted.plan.widest_band_deg;
        assert!((-0.6..0.15).contains(&wider_deg), "{wider_deg}");
        for (new, old) in learnt.after[0]
            .rows
            .iter()
            .zip(&adjusted.plan.after[0].rows)
        {
            let off = new.deviation_deg - old.deviation_deg;
            assert!(off.abs() < 0.1, "{off}");
        }
    }
}

/// In all four quadrants of signs, an error of each part moves the prediction in its
/// direction.
#[test]
fn what_is_read_off_moves_bx_and_by_towards_it() {
    let adjusted = Adjusted::new(45.0);
    let before = adjusted.plan.model_after.parameters_over_lambda;
    for off_nt in [
        [300.0, 200.0],
        [300.0, -200.0],
        [-300.0, 200.0],
        [-300.0, -200.0],
    ] {
        let again = adjusted.read(&adjusted.plan.setting, [off_nt[0], off_nt[1], 0.0]);
        let (Verdict::AsPlanned { updated: learnt }
        | Verdict::Replan {
            updated: learnt, ..
        }) = again.verdict
        else {
            panic!("{off_nt:?}: {:?}", again.verdict)
        };
        let after = learnt.model_after.parameters_over_lambda;
        let moved = [after.bx_nt - before.bx_nt, after.by_nt - before.by_nt];
        for (moved, off) in moved.iter().zip(off_nt) {
            assert!(
                moved * off > 0.0 && moved.abs() < off.abs(),
                "{moved} {off}"
            );
        }
    }
}

/// On any heading: the compass shows half of these slips hardly or not at all.
#[test]
fn magnets_with_the_wrong_end_are_named_whatever_the_heading() {
    for magnetic_deg in [0.0, 5.0, 90.0, 180.0, 225.0, 270.0] {
        let adjusted = Adjusted::new(magnetic_deg);
        for (index, step) in adjusted.plan.steps.iter().enumerate() {
            let Some(Place::Magnets(tray)) = &step.to else {
                continue;
            };
            let mut truly = adjusted.plan.setting.clone();
            let axis = match step.corrector {
                Corrector::ForeAndAft => Axis::ForeAndAft,
                _ => Axis::Athwartship,
            };
            let trays = truly.trays_mut(axis).iter_mut();
            trays
                .filter(|other| *other == tray)
                .for_each(|other| other.red = other.red.reversed());
            let again = adjusted.read(&truly, [0.0; 3]);
            let Verdict::Slip {
                step,
                slip,
                setting,
                share,
                outcome,
            } = again.verdict
            else {
                panic!("{magnetic_deg}: {:?}", again.verdict)
            };
            assert_eq!((step as usize, slip), (index + 1, Slip::WrongEnd));
            assert!(share > 0.8, "{share}");
            assert_eq!(setting, truly);
            // The plan from there reverses them, or is as good.
            assert!(!outcome.plans.is_empty());
            assert!(outcome.plans[0].worst_residual_deg < adjusted.plan.worst_residual_deg + 0.3);
        }
    }
}

#[test]
fn a_heeling_magnet_that_was_left_where_it_was_is_seen_by_the_vertical_part() {
    let adjusted = Adjusted::new(60.0);
    let steps = &adjusted.plan.steps;
    let is_heeling = |step: &Step| step.corrector == Corrector::Heeling;
    let index = steps.iter().position(is_heeling).unwrap();
    let mut truly = adjusted.plan.setting.clone();
    truly
        .heeling
        .clone_from(&adjusted.case.binnacle.setting.heeling);
    let again = adjusted.read(&truly, [0.0; 3]);
    let Verdict::Slip { step, slip, .. } = again.verdict else {
        panic!("{:?}", again.verdict)
    };
    assert_eq!((step as usize, slip), (index + 1, Slip::NotDone));
}

#[test]
fn a_reading_that_nothing_explains_confirms_nothing() {
    let adjusted = Adjusted::new(45.0);
    let again = adjusted.read(&adjusted.plan.setting, [-5_300.0, 4_700.0, 9_000.0]);
    assert_eq!(
        again.verdict,
        Verdict::Unexplained {
            misreadings: Vec::new()
        }
    );
}

#[test]
fn swapped_axes_and_another_unit_are_named() {
    let adjusted = Adjusted::new(70.0);
    let [x, y, z] = field(
        &ship(),
        &adjusted.case.binnacle,
        &adjusted.plan.setting,
        70.0,
    );
    let Verdict::Unexplained { misreadings } = adjusted.judge([y, x, z], Unit::Nanotesla).verdict
    else {
        panic!("swapped")
    };
    assert_eq!(misreadings, [Misreading::SwappedAxes]);
    let as_gauss = [x, y, z].map(|part| part / 1e3 * 1e2);
    let Verdict::Unexplained { misreadings } = adjusted.judge(as_gauss, Unit::Milligauss).verdict
    else {
        panic!("unit")
    };
    assert_eq!(misreadings, [Misreading::Microtesla]);
}

/// The compass distinguishes them from a correct field with a sticking card.
#[test]
fn swapped_axes_are_named_where_the_compass_was_read_too() {
    let adjusted = Adjusted::new(70.0);
    let setting = &adjusted.plan.setting;
    let [x, y, z] = field(&ship(), &adjusted.case.binnacle, setting, 70.0);
    let compass_deg = binnacle_compass::angle::wrap_360((-y).atan2(x).to_degrees());
    let judged = |field_nt: [f64; 3], compass_deg: f64| {
        let again = adjusted.judge_with(field_nt, Some(compass_deg), Unit::Nanotesla);
        let Verdict::Unexplained { misreadings } = again.verdict else {
            panic!("{:?}", again.verdict)
        };
        assert!(again.card.unwrap().is_refused());
        misreadings
    };
    assert_eq!(judged([y, x, z], compass_deg), [Misreading::SwappedAxes]);
    let stuck_deg = binnacle_compass::angle::wrap_360(compass_deg + 60.0);
    assert!(judged([x, y, z], stuck_deg).is_empty());
}

/// The errors of innovation and model sum to the covariance of the plan's model.
#[test]
fn causes_and_model_add_up_to_the_covariance_of_the_plan() {
    let adjusted = Adjusted::new(45.0);
    let mut adjustment = adjusted.case.adjustment();
    adjustment.now = Some(&adjusted.plan.setting);
    let state = MagneticState::new(&adjustment).unwrap();
    let known = state.with_setting(&adjusted.plan.setting).unwrap();
    let slopes = SMatrix::<f64, 8, 9>::from_fn(|r, c| known.slopes()[r][c]);
    let joint = SMatrix::<f64, 9, 9>::from_fn(|r, c| state.joint()[r][c]);
    let mut sum = slopes * joint * slopes.transpose();
    for error in setting_errors(state.binnacle, &adjusted.plan.setting) {
        let way = ModelVector::from(known.sensitivity(&error));
        sum += way * way.transpose();
    }
    let covariance = known.model.covariance.unwrap();
    for row in 0..8 {
        let (new, old) = (sum[(row, row)], covariance[row][row]);
        assert!((new - old).abs() < 1e-9 * old, "{row}: {new} {old}");
    }
}

/// Completed steps with a share of the expected turn of the compass.
fn turned(adjusted: &Adjusted, share: f64) -> Vec<CompletedStep> {
    let steps = adjusted.plan.steps.iter();
    steps
        .map(|step| {
            let magnets = matches!(step.to, Some(Place::Magnets(_)));
            let share = if magnets { share } else { 1.0 };
            CompletedStep {
                step: step.clone(),
                turned_deg: Some(share * step.change_deg),
            }
        })
        .collect()
}

/// Steps within their tolerance leave more uncertainty than the plan, and all of them
/// together reveal weak magnets.
#[test]
fn what_the_compass_leaves_open_of_the_steps_is_in_the_band() {
    let adjusted = Adjusted::new(45.0);
    let mut adjustment = adjusted.case.adjustment();
    adjustment.now = Some(&adjusted.plan.setting);
    let by = |share: f64| predict_by_compass(&adjustment, &turned(&adjusted, share)).unwrap();
    let planned = &adjusted.plan;
    let right = by(1.0);
    let wider_deg = right.widest_band_deg - planned.widest_band_deg;
    assert!((0.0..0.8).contains(&wider_deg), "{wider_deg}");
    let weak = by(0.8);
    assert!(weak.widest_band_deg > planned.widest_band_deg);
    // Weaker magnets leave more of the field that they should correct.
    let left = |learnt: &UpdatedPrediction| {
        let after = learnt.model_after.parameters_over_lambda;
        let before = adjusted.case.model.parameters_over_lambda;
        let plan = planned.model_after.parameters_over_lambda;
        [
            (after.bx_nt - plan.bx_nt) / (before.bx_nt - plan.bx_nt),
            (after.by_nt - plan.by_nt) / (before.by_nt - plan.by_nt),
        ]
    };
    for (right, weak) in left(&right).iter().zip(left(&weak)) {
        assert!(weak > right + 0.05, "{right} {weak}");
        assert!(right.abs() < 0.03, "{right}");
    }
}

#[test]
fn a_vertical_part_the_wrong_way_round_or_in_another_unit_is_named() {
    let adjusted = Adjusted::new(45.0);
    let setting = &adjusted.plan.setting;
    let [x, y, z] = field(&ship(), &adjusted.case.binnacle, setting, 45.0);
    for (down_nt, misreading) in [
        (-z, Misreading::DownReversed),
        (z / 1_000.0, Misreading::DownInAnotherUnit),
    ] {
        let Verdict::Unexplained { misreadings } =
            adjusted.judge([x, y, down_nt], Unit::Nanotesla).verdict
        else {
            panic!("{down_nt}")
        };
        assert_eq!(misreadings, [misreading]);
    }
    let swapped = adjusted.judge([z, y, x], Unit::Nanotesla).verdict;
    let Verdict::Unexplained { misreadings } = swapped else {
        panic!("{swapped:?}")
    };
    assert!(misreadings.contains(&Misreading::ForwardDownSwapped));
}

#[test]
fn a_compass_that_does_not_point_along_the_field_read_again_is_not_explained() {
    let adjusted = Adjusted::new(45.0);
    let setting = &adjusted.plan.setting;
    let read = field(&ship(), &adjusted.case.binnacle, setting, 45.0);
    let card = |compass_deg| adjusted.judge_with(read, compass_deg, Unit::Nanotesla);
    let implied_deg = card(Some(0.0)).card.unwrap().implied_deg;
    for off_deg in [-1.0, 0.0, 1.0] {
        let again = card(Some(implied_deg + off_deg));
        assert!(matches!(again.verdict, Verdict::AsPlanned { .. }));
    }
    for off_deg in [-8.0, 8.0, 180.0] {
        let again = card(Some(implied_deg + off_deg));
        assert!(matches!(again.verdict, Verdict::Unexplained { .. }));
        assert!((again.card.unwrap().off_deg.abs() - off_deg.abs()).abs() < 1.0);
    }
    assert_eq!(card(None).card, None);
}

/// The second reading of docs/plan.md is valid together with its berth.
#[test]
fn the_second_reading_in_the_documentation_reads() {
    let page = include_str!("../../../../../docs/plan.md");
    let block = |nth: usize| {
        let from = page.split("```json\n").nth(nth).unwrap();
        from.split("```").next().unwrap()
    };
    let berth: BerthForm = serde_json::from_str(block(1)).unwrap();
    let after: PostCheckForm = serde_json::from_str(block(2)).unwrap();
    let (first, there) = (berth.parse().unwrap(), berth.parse_after(&after).unwrap());
    // Variation is for the reading's own time.
    let [one, other] = [&there, &first].map(|berth| berth.reading.magnetic().degrees());
    assert!((one - other).abs() < 1e-3);
    assert_eq!(there.reading.errors(), first.reading.errors());
    assert!((there.reading.field_nt()[0] - 15_100.0).abs() < 1e-6);
    let mut early = after.clone();
    early.reading.at = binnacle_compass::time::Timestamp::parse("2026-11-21T09:59:59Z").unwrap();
    let refused = berth.parse_after(&early).unwrap_err();
    assert_eq!(refused.field, "reading.at");
    let mut wild = after;
    wild.turned_deg = vec![None, Some(f64::NAN)];
    assert_eq!(berth.parse_after(&wild).unwrap_err().field, "turned_deg[1]");
}

/// Holes share a probability that none of them has alone.
#[test]
fn a_slip_is_named_by_the_probability_of_all_its_holes() {
    let posterior = |shares: &[(HypothesisKind, f64)]| -> Vec<Posterior> {
        let one = |(kind, share): &(HypothesisKind, f64)| Posterior {
            kind: kind.clone(),
            share: *share,
            correction: ModelVector::zeros(),
            covariance: SMatrix::zeros(),
            squared: 0.0,
        };
        shares.iter().map(one).collect()
    };
    let hole = |hole| HypothesisKind::Step(1, Slip::OtherHole { hole }, Setting::default());
    let planned = HypothesisKind::AsPlanned;
    let shared = [
        (planned.clone(), 0.35),
        (hole(3), 0.2),
        (hole(4), 0.2),
        (hole(5), 0.15),
    ];
    assert!(is_slip(&posterior(&shared)));
    let stood = [
        (planned.clone(), 0.1),
        (hole(3), 0.2),
        (HypothesisKind::AsFound(1), 0.7),
    ];
    assert!(!is_slip(&posterior(&stood)));
    assert!(!is_slip(&posterior(&[(planned, 0.6), (hole(3), 0.4)])));
}

/// The record has a red end the wrong way, on either axis: after the magnets have moved, the ship
/// without correctors turns out to be another, with the right sign.
#[test]
fn magnets_recorded_with_the_wrong_end_move_the_model_towards_the_ship() {
    for axis in [Axis::ForeAndAft, Axis::Athwartship] {
        let case = Case::new(ship(), class_a(), 45.0);
        let mut wrong = case.binnacle.setting.clone();
        let tray = &mut wrong.trays_mut(axis)[0];
        tray.red = tray.red.reversed();
        let recorded = case.binnacle.with_setting(wrong).unwrap();
        let mut out = recorded.setting.clone();
        out.trays_mut(axis).clear();
        let adjustment = Adjustment {
            binnacle: &recorded,
            now: Some(&out),
            ..case.adjustment()
        };
        let state = MagneticState::new(&adjustment).unwrap();
        let from_record = Adjustment {
            now: None,
            ..adjustment.clone()
        };
        let done: Vec<CompletedStep> = instructions::steps(&from_record, &state, &out)
            .into_iter()
            .map(|step| CompletedStep {
                step,
                turned_deg: None,
            })
            .collect();
        let [x, y, _] = field(&ship(), &case.binnacle, &out, 45.0);
        let first = &case.reading;
        let read =
            BerthReading::new(first.magnetic(), [x, y], first.errors(), first.alignment()).unwrap();
        let again =
            check_second_reading(&adjustment, &done, &read, None, None, Unit::Nanotesla).unwrap();
        let (Verdict::AsPlanned { updated } | Verdict::Replan { updated, .. }) = again.verdict
        else {
            panic!("{axis:?}: {:?}", again.verdict)
        };
        let there = effect(&case.binnacle, &out).as_ship(BISCAY.h_nt);
        let truly = sum(&ship(), &there).parameters_over_lambda().unwrap();
        let believed = state.model_with(&out).unwrap();
        let off = |model: &binnacle_compass::model::Model| {
            let parameters = model.parameters_over_lambda;
            (parameters.bx_nt - truly.bx_nt).hypot(parameters.by_nt - truly.by_nt)
        };
        let [before, after] = [&believed, &updated.model_after].map(off);
        assert!(before > 1_000.0 && after < 0.2 * before, "{before} {after}");
    }
}
