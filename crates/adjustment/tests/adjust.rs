//! Adjusting at the berth, on ships that share no code with the planner.

#![allow(clippy::unwrap_used)]

#[path = "adjusting/mod.rs"]
#[allow(dead_code)]
mod adjusting;

#[path = "adjusting/hands.rs"]
#[allow(dead_code)]
mod hands;

#[path = "adjusting/tally.rs"]
#[allow(dead_code)]
mod tally;

use adjusting::knowledge::{FLUXGATE, Instruments};
use adjusting::random::Random;
use adjusting::scene::{ALL_KNOWN, Hidden};
use binnacle_adjustment::adjust::{Adjustment, Circumstances, Limits, plan};
use binnacle_adjustment::corrector::effect;
use hands::{Ending, Hands, Slip};
use tally::{Tally, mean};

/// Without errors, the formulas and the independent iron agree.
#[test]
fn the_formulas_are_those_of_iron_that_knows_nothing_of_them() {
    for seed in 0..20 {
        let mut rng = Random::new(seed);
        let binnacle = adjusting::binnacle(&mut rng, 0);
        let binnacle = adjusting::without_tolerances(binnacle);
        let iron = adjusting::iron::Fitted::new(&mut rng, &binnacle);
        let setting = &binnacle.setting;
        let found = effect(&binnacle, setting);
        for earth in [
            [0.0; 3],
            [30_000.0, 0.0, 0.0],
            [0.0, 30_000.0, 0.0],
            [0.0, 0.0, 40_000.0],
        ] {
            let truth = iron.field(setting, earth);
            // Of the vertical field only χ33 and bz count, for heeling.
            let axes = if earth[0] == 0.0 && earth[1] == 0.0 {
                3
            } else {
                2
            };
            for axis in 0..axes {
                let induced: f64 = (0..3).map(|c| found.chi[axis][c] * earth[c]).sum();
                let off = found.b_nt[axis] + induced - truth[axis];
                // Induction across the bar, and between unequal pairs, is left out of the
                // formulas.
                let size = truth.iter().map(|part| part.abs()).fold(0.0, f64::max);
                assert!(
                    off.abs() < 0.03 * size + 5.0,
                    "{seed} {earth:?} {axis}: {off} of {truth:?}"
                );
            }
        }
        // The part across the card turns it, on any heading; the part along it turns
        // nothing.
        for step in 0..12 {
            let (east, north) = (f64::from(step) * 30.0).to_radians().sin_cos();
            let across = |[x, y]: [f64; 2]| north * y - east * x;
            let truth = across(iron.of_needles(setting, [north, east]));
            let [[a, b], [c, d]] = found.needle_nt;
            let formula = across([a * north + b * east, c * north + d * east]);
            assert!((formula - truth).abs() < 1e-6 * truth.abs() + 1e-9);
        }
    }
}

/// Needles turn the card on D and E. If they counted in λ, as soft iron would, a tenth of B
/// and C would remain on a binnacle with thick plates close by.
#[test]
fn with_strong_needles_and_no_errors_the_compass_is_left_as_predicted() {
    for seed in 0..12 {
        let mut rng = Random::new(seed);
        let binnacle = adjusting::binnacle(&mut rng, (seed % 2) as usize);
        let binnacle = adjusting::without_tolerances(binnacle);
        let mut truth = adjusting::ship(&mut rng, &binnacle);
        truth.fitted.needle_am2 = binnacle.design.needle_moment_am2;
        let standing = truth.with(&binnacle.setting);
        let waters = adjusting::knowledge::waters(&mut rng, 0.1);
        let model = adjusting::knowledge::exactly(&standing, &waters);
        let berth = waters[0].earth();
        let place = (berth.h_nt, berth.z_nt);
        let [x, y, _] = standing.field(place, 40.0);
        let adjustment = Adjustment {
            model: &model,
            earth: berth,
            reading: &adjusting::knowledge::read([x, y], 40.0, FLUXGATE),
            scale_sd: FLUXGATE.scale_sd,
            compass_deg: None,
            vertical: None,
            binnacle: &binnacle,
            now: None,
            waters: &waters,
            circumstances: Circumstances::default(),
            limits: Limits {
                residual_deg: 60.0,
                band_deg: 60.0,
                ..Limits::default()
            },
        };
        let plan = plan(&adjustment).unwrap().plans.remove(0);
        let adjusted = truth.with(&plan.setting);
        for row in &plan.after[0].rows {
            let residual = adjusted.deviation_deg(place, row.compass_deg);
            let off = adjusting::wrap(residual - row.deviation_deg);
            let before = standing.worst_deg(place);
            assert!(off.abs() < 0.03 * before + 0.1, "{seed}: {off} of {before}");
        }
    }
}

/// The berth of docs/plan.md is valid.
#[test]
fn the_berth_in_the_documentation_reads() {
    let page = include_str!("../../../docs/plan.md");
    let from = page.split("```json\n").nth(1).unwrap();
    let form = from.split("```").next().unwrap();
    let form: binnacle_adjustment::adjust::BerthForm = serde_json::from_str(form).unwrap();
    let berth = form.parse().unwrap();
    assert_eq!(berth.waters.len(), 2);
    assert!((22_000.0..27_000.0).contains(&berth.earth.h_nt));
    // Variation is near zero there in 2026.
    assert!((berth.reading.magnetic().degrees() - 63.0).abs() < 1.5);
}

/// Implausible numbers in every field of the form give an error, a refusal or a plan in
/// finite numbers, and never a panic.
#[test]
fn nothing_that_is_written_of_a_berth_brings_the_planner_down() {
    let page = include_str!("../../../docs/plan.md");
    let form = page
        .split("```json\n")
        .nth(1)
        .unwrap()
        .split("```")
        .next()
        .unwrap();
    let mut form: serde_json::Value = serde_json::from_str(form).unwrap();
    let mut rng = Random::new(5);
    let binnacle = adjusting::binnacle(&mut rng, 1);
    let truth = adjusting::ship(&mut rng, &binnacle).with(&binnacle.setting);
    let waters = adjusting::knowledge::waters(&mut rng, 0.15);
    let model = adjusting::knowledge::model(&mut rng, &truth, &waters);
    // The reading is the ship's own, so that most inputs do give a plan.
    let page: binnacle_adjustment::adjust::BerthForm =
        serde_json::from_value(form.clone()).unwrap();
    let there = page.parse().unwrap();
    let place = (there.earth.h_nt, there.earth.z_nt);
    let [x, y, z] = truth.field(place, there.reading.magnetic().degrees());
    let reading = &mut form["reading"];
    for (name, part) in [("forward", x), ("starboard", y), ("down", z)] {
        reading[name] = serde_json::json!(part / 1000.0);
    }
    // So is the compass, except for the needles' induction.
    let compass_deg = (-y).atan2(x).to_degrees().rem_euclid(360.0);
    reading["compass_deg"] = serde_json::json!(compass_deg);
    let strange = [
        0.0, -0.0, 1e-300, -1.0, 1.0, 89.9, 180.0, 359.9, 4e3, -7e4, 1e9, -1e308,
    ];
    let names = |of: &serde_json::Value, before: &str| -> Vec<String> {
        let keys = of.as_object().unwrap().keys();
        keys.map(|name| format!("{before}/{name}")).collect()
    };
    let mut fields = names(&form, "");
    fields.extend(names(&form["reading"], "/reading"));
    let mut planned = 0;
    for field in &fields {
        for value in strange {
            let mut form = form.clone();
            *form.pointer_mut(field).unwrap() = serde_json::json!(value);
            let form = serde_json::from_value::<binnacle_adjustment::adjust::BerthForm>(form);
            let Ok(berth) = form
                .map_err(drop)
                .and_then(|form| form.parse().map_err(drop))
            else {
                continue;
            };
            let mut adjustment = berth.adjustment(&model, &binnacle);
            // Wider than any accepted limit.
            (adjustment.limits.residual_deg, adjustment.limits.band_deg) = (60.0, 60.0);
            let Ok(outcome) = binnacle_adjustment::adjust::plan(&adjustment) else {
                continue;
            };
            planned += u32::from(!outcome.plans.is_empty());
            for plan in &outcome.plans {
                assert!(plan.worst_residual_deg.is_finite() && plan.widest_band_deg.is_finite());
                assert!(
                    plan.steps
                        .iter()
                        .all(|step| step.expected_compass_deg.is_finite())
                );
            }
        }
    }
    // A vertical part of other waters or in another unit is refused.
    assert!(planned >= 10, "{planned}");
}

#[test]
fn the_band_holds_and_little_is_left_on_ships_that_the_planner_never_saw() {
    let tally = Tally::from_seeds(1000..1060, 0, FLUXGATE);
    println!("{tally}");
    assert!(tally.planned >= 30, "{tally}");
    assert!(tally.coverage() >= 0.92, "{tally}");
    assert!(tally.within_3_deg() >= 0.95, "{tally}");
}

/// With any stated heading error: changes across the needle that turn the field by 5° to
/// 10°.
#[test]
fn a_ship_that_changed_since_her_model_is_refused_however_unsure_the_heading_is_said_to_be() {
    for heading_sd_deg in [0.5, 2.0, 5.0] {
        let said = Instruments {
            heading_sd_deg,
            ..FLUXGATE
        };
        let changed = Tally::changed(0..8, [0.0..0.0, 5.0..10.0], FLUXGATE, said, None);
        assert_eq!(changed.planned, 0, "{heading_sd_deg}: {changed}");
    }
    let honest = Tally::changed(0..8, [0.0..0.0, 0.0..0.0], FLUXGATE, FLUXGATE, None);
    assert!(honest.planned >= 7, "{honest}");
}

#[test]
fn a_change_along_the_needle_is_refused_where_an_earlier_berth_gave_lambda() {
    let changed = Tally::changed(0..8, [5.0..10.0, 0.0..0.0], FLUXGATE, FLUXGATE, Some(0.012));
    assert_eq!(changed.planned, 0, "{changed}");
    let honest = Tally::changed(0..8, [0.0..0.0, 0.0..0.0], FLUXGATE, FLUXGATE, Some(0.012));
    assert!(honest.planned >= 7, "{honest}");
}

/// The model was fitted in other waters than those of the plan, and the ship sails to others
/// still: needles' induction counts in each by its own field.
#[test]
fn a_model_from_elsewhere_keeps_its_band_here_and_in_other_waters() {
    let elsewhere = Hidden {
        model_from_elsewhere: true,
        ..ALL_KNOWN
    };
    let tally = Tally::hidden(2000..2024, 0, FLUXGATE, elsewhere);
    assert!(tally.planned >= 15, "{tally}");
    assert!(tally.coverage() >= 0.9, "{tally}");
    assert!(mean(&tally.held_elsewhere) >= 0.9, "{tally}");
}

#[test]
fn with_a_second_heading_steel_on_the_quay_hardly_passes_for_lambda() {
    let with = |steel_nt: f64, is_shifted: bool| {
        let hidden = Hidden {
            steel_nt,
            is_shifted,
            ..ALL_KNOWN
        };
        Tally::hidden(0..45, 0, FLUXGATE, hidden)
    };
    let [one, two] = [false, true].map(|is_shifted| with(2_000.0, is_shifted));
    assert!(one.planned >= 10, "{one}");
    assert!(two.planned <= 4 && two.outside == 0, "{two}");
    let clean = with(0.0, true);
    assert!(clean.planned >= 36, "{clean}");
}

#[test]
fn a_wrong_end_in_the_inventory_ends_in_no_signed_adjustment_outside_its_band() {
    let wrong_end = Slip::Berth(Hidden {
        wrong_end: true,
        ..ALL_KNOWN
    });
    let hands = Hands::from_seeds(0..15, wrong_end, Ending::ReadAgain);
    assert!(hands.ships >= 12, "{hands}");
    assert_eq!(hands.outside, 0, "{hands}");
}
