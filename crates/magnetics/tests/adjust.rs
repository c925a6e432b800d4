//! Adjusting at the berth, on ships that share no code with the planner.

#![allow(clippy::unwrap_used)]

#[path = "adjusting/mod.rs"]
#[allow(dead_code)]
mod adjusting;

#[path = "adjusting/tally.rs"]
#[allow(dead_code)]
mod tally;

use adjusting::knowledge::FLUXGATE;
use adjusting::random::Random;
use binnacle_magnetics::corrector::effect;
use tally::Tally;

/// With no errors at all the formulas and the independent iron say the same.
#[test]
fn the_formulas_are_those_of_iron_that_knows_nothing_of_them() {
    for seed in 0..20 {
        let mut rng = Random::new(seed);
        let binnacle = adjusting::binnacle(&mut rng, 0);
        let mut form: binnacle_magnetics::binnacle::BinnacleForm = binnacle.into();
        let mut design: binnacle_magnetics::binnacle::DesignForm = form.design.into();
        for kind in &mut design.magnets {
            kind.moment_tolerance = 0.0;
        }
        for rack in [&mut design.fore_and_aft, &mut design.athwartship] {
            rack.position_sd_mm = 0.0;
        }
        for size in &mut design.quadrantal.as_mut().unwrap().sizes {
            size.tolerance = 0.0;
        }
        design.flinders.as_mut().unwrap().tolerance = 0.0;
        form.design = design.try_into().unwrap();
        let binnacle = binnacle_magnetics::binnacle::Binnacle::try_from(form).unwrap();
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
                // What magnetises the bar across, and pairs of odd magnets, are left out.
                let size = truth.iter().map(|part| part.abs()).fold(0.0, f64::max);
                assert!(
                    off.abs() < 0.03 * size + 5.0,
                    "{seed} {earth:?} {axis}: {off} of {truth:?}"
                );
            }
        }
        for card in [[1.0, 0.0], [0.0, 1.0]] {
            let truth = iron.of_needles(setting, card);
            // The part along the needles, a third, turns nothing.
            let along = if card[1] > 0.5 { 0.75 * truth[1] } else { 0.0 };
            let formula = card[0] * found.needle_nt[1][0] + card[1] * found.needle_nt[1][1];
            assert!((formula - along).abs() < 1e-6 * truth[1].abs() + 1e-9);
        }
    }
}

/// The berth of docs/plan.md is one.
#[test]
fn the_berth_in_the_documentation_reads() {
    let page = include_str!("../../../docs/plan.md");
    let from = page.split("```json\n").nth(1).unwrap();
    let form = from.split("```").next().unwrap();
    let form: binnacle_magnetics::adjust::BerthForm = serde_json::from_str(form).unwrap();
    let berth = form.read().unwrap();
    assert_eq!(berth.waters.len(), 2);
    assert!((22_000.0..27_000.0).contains(&berth.earth.h_nt));
    // Variation is about nil there in 2026.
    assert!((berth.reading.magnetic().degrees() - 63.0).abs() < 1.5);
}

/// Numbers that no ship has, in every field of the form: an error, a refusal or a plan in
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
    // The reading is hers, so that most of what is written does give a plan.
    let page: binnacle_magnetics::adjust::BerthForm = serde_json::from_value(form.clone()).unwrap();
    let there = page.read().unwrap();
    let place = (there.earth.h_nt, there.earth.z_nt);
    let [x, y, z] = truth.field(place, there.reading.magnetic().degrees());
    form["forward_nt"] = serde_json::json!(x);
    form["starboard_nt"] = serde_json::json!(y);
    form["down_nt"] = serde_json::json!(z);
    form["limits"] = serde_json::json!({ "residual_deg": 60, "band_deg": 60 });
    let strange = [
        0.0, -0.0, 1e-300, -1.0, 1.0, 89.9, 180.0, 359.9, 4e3, -7e4, 1e9, -1e308,
    ];
    let fields: Vec<String> = form.as_object().unwrap().keys().cloned().collect();
    let mut planned = 0;
    for field in &fields {
        for value in strange {
            let mut form = form.clone();
            form[field] = serde_json::json!(value);
            let form = serde_json::from_value::<binnacle_magnetics::adjust::BerthForm>(form);
            let Ok(berth) = form
                .map_err(drop)
                .and_then(|form| form.read().map_err(drop))
            else {
                continue;
            };
            let adjustment = berth.adjustment(&model, &binnacle);
            let Ok(outcome) = binnacle_magnetics::adjust::plan(&adjustment) else {
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
    assert!(planned > 20, "{planned}");
}

#[test]
fn the_band_holds_and_little_is_left_on_ships_that_the_planner_never_saw() {
    let tally = Tally::of(1000..1060, 0, FLUXGATE);
    println!("{tally}");
    assert!(tally.planned >= 30, "{tally}");
    assert!(tally.coverage() >= 0.92, "{tally}");
    assert!(tally.within_3_deg() >= 0.95, "{tally}");
}
