//! Results of the search, and their optimality.

use super::super::search::{candidates, objective, soft_iron};
use super::super::state::IronBands;
use super::super::*;
use super::*;

/// Catalogues with so few settings that all can be tried, for ships of all signs.
#[test]
fn the_search_finds_what_trying_everything_finds() {
    use rand::{RngExt, SeedableRng};
    let mut rng = rand_chacha::ChaCha8Rng::seed_from_u64(11);
    for round in 0..8 {
        let mut ship = bare();
        ship.b_nt = [0, 1, 2].map(|axis| match axis {
            2 => 0.0,
            _ => rng.random_range(-3_000.0..3_000.0),
        });
        ship.chi[1][1] = rng.random_range(-0.25..-0.05);
        ship.chi[0][2] = rng.random_range(-0.05..0.05);
        let heading = rng.random_range(0.0..360.0);
        // The first round has the whole catalogue, the others draw from it.
        let mut form: BinnacleForm = little().into();
        if round > 0 {
            let mut design: DesignForm = form.design.into();
            for rack in [&mut design.fore_and_aft, &mut design.athwartship] {
                rack.holes.truncate(rng.random_range(3..=4));
                rack.magnets_each = rng.random_range(1..=2);
            }
            let iron = design.quadrantal.as_mut().unwrap();
            iron.marks.truncate(rng.random_range(1..=3));
            let mark_mm = iron.marks[0].mark_mm;
            form.design = design.try_into().unwrap();
            form.setting.quadrantal.as_mut().unwrap().mark_mm = mark_mm;
            form.setting.fore_and_aft.clear();
            form.setting.athwartship[0].hole = rng.random_range(1..=3);
            form.setting.athwartship[0].count = 1;
            form.inventory.magnets[0].count = rng.random_range(1..=4);
        }
        let binnacle = Binnacle::try_from(form).unwrap();
        trying_everything(&Case::new(ship, binnacle, heading));
    }
}

fn trying_everything(case: &Case) {
    let adjustment = case.adjustment();
    let state = MagneticState::new(&adjustment).unwrap();
    let front = search::search(&adjustment, &state);
    let mut best: Vec<f64> = vec![f64::INFINITY; 20];
    every_setting(&state, |setting| {
        if case.binnacle.with_setting(setting.clone()).is_err() {
            return;
        }
        let standing = &case.binnacle.setting;
        let moves = corrector_moves::tray_moves(&standing.fore_and_aft, &setting.fore_and_aft)
            + corrector_moves::tray_moves(&standing.athwartship, &setting.athwartship)
            + corrector_moves::pair_moves(
                standing.quadrantal.as_ref(),
                setting.quadrantal.as_ref(),
            )
            + corrector_moves::bar_moves(standing.flinders.as_ref(), setting.flinders.as_ref());
        let worst = worst_of(case, &state, setting);
        let known = &mut best[moves as usize];
        *known = known.min(worst);
    });
    let mut least = f64::INFINITY;
    let mut levels = 0;
    for (moves, worst) in best.into_iter().enumerate() {
        least = least.min(worst);
        let found = front.undominated();
        let found = found.iter().filter(|f| f.moves as usize <= moves);
        let found = found.map(|f| f.reach_deg).fold(f64::INFINITY, f64::min);
        assert!((found - least).abs() < 0.0051, "{moves}: {found} {least}");
        levels += usize::from(worst.is_finite());
    }
    assert!(levels > 3 && front.optimality.proven);
}

fn worst_of(case: &Case, state: &MagneticState<'_>, setting: &Setting) -> f64 {
    let compass = objective::HeadingGrid::new(state.constant_deg());
    let effect = effect(&case.binnacle, setting);
    let soft = setting.soft();
    let bands = IronBands::new(state, &case.binnacle.setting, &soft, &case.waters);
    objective::Objective::new(
        &compass,
        &case.waters,
        |h_nt| state.with_effect(&effect, h_nt),
        |water, magnetic_rad| bands.band_rad(water, magnetic_rad),
    )
    .reach_deg([0.0; 2])
}

fn every_setting(state: &MagneticState<'_>, mut visit: impl FnMut(&Setting)) {
    let binnacle = state.binnacle;
    let standing = &binnacle.setting;
    let options = |axis: Axis| {
        let mut all = vec![Vec::new()];
        for hole in &binnacle.design.rack(axis).holes {
            for count in 1..=2 {
                for positive in [true, false] {
                    all.push(vec![crate::binnacle::Tray {
                        hole: hole.number,
                        magnet: "200 mm".to_owned(),
                        count,
                        red: axis.red(positive),
                    }]);
                }
            }
        }
        all
    };
    for (soft, _) in soft_iron::iron(state, standing) {
        for fore_and_aft in options(Axis::ForeAndAft) {
            for athwartship in options(Axis::Athwartship) {
                visit(&Setting {
                    fore_and_aft: fore_and_aft.clone(),
                    athwartship,
                    quadrantal: soft.quadrantal.clone(),
                    flinders: soft.flinders.clone(),
                    heeling: standing.heeling.clone(),
                });
            }
        }
    }
}

/// Without an induced field a bar has nothing to correct, though in one water it would work
/// as well as a magnet.
#[test]
fn a_bar_is_no_cure_for_what_is_permanent() {
    let plans = |chi13: f64, waters: usize| {
        let mut ship = bare();
        ship.chi[0][2] = chi13;
        ship.chi[1][2] = 0.0;
        let mut form: BinnacleForm = class_a().into();
        form.setting.flinders = None;
        let mut case = Case::new(ship, Binnacle::try_from(form).unwrap(), 60.0);
        case.waters.truncate(waters);
        let plans = case.plan().plans;
        assert!(!plans.is_empty());
        plans
    };
    for plan in plans(0.0, 1) {
        assert_eq!(plan.setting.flinders, None);
    }
    // In two hemispheres no magnet replaces a bar.
    let induced = &plans(-0.05, 2)[0];
    assert!(induced.setting.flinders.is_some());
    let left = induced.model_after.parameters_over_lambda.chi13;
    assert!(left.abs() < 0.05, "{left}");
}

#[test]
fn a_bound_is_never_above_what_it_bounds() {
    use rand::{RngExt, SeedableRng};
    let mut rng = rand_chacha::ChaCha8Rng::seed_from_u64(7);
    let waters = [
        water("a", 24_000.0, 38_000.0, 1.0),
        water("b", 30_000.0, -9_000.0, 0.5),
    ];
    let compass = objective::HeadingGrid::new(0.7);
    for _ in 0..200 {
        let ship = crate::test_support::random_ship(&mut rng);
        let band_rad: f64 = rng.random_range(0.0..0.1);
        let band = |_: &Water, magnetic_rad: f64| band_rad * magnetic_rad.sin().powi(2);
        let objective = objective::Objective::new(&compass, &waters, |_| ship, band);
        let corner: [f64; 2] = std::array::from_fn(|_| rng.random_range(-9_000.0..9_000.0));
        let size: [f64; 2] = std::array::from_fn(|_| rng.random_range(0.0..4_000.0));
        let within = objective::FieldBox {
            x: [corner[0], corner[0] + size[0]],
            y: [corner[1], corner[1] + size[1]],
        };
        let (iron, bound) = (objective.bound_for_iron(), objective.bound_deg(&within));
        for _ in 0..20 {
            let b = [0, 1].map(|a| corner[a] + size[a] * rng.random_range(0.0..1.0));
            let worst = objective.reach_deg(b);
            assert!(bound <= worst + 1e-9, "{bound} {worst}");
            assert!(iron <= worst + 1e-9, "{iron} {worst}");
        }
    }
}

/// In every quadrant of the ship's field, magnets are fitted with the right ends, and the
/// residual is small.
#[test]
fn magnets_cure_every_quadrant_of_signs() {
    for (bx, by) in [
        (4_000.0, 3_000.0),
        (4_000.0, -3_000.0),
        (-4_000.0, 3_000.0),
        (-4_000.0, -3_000.0),
    ] {
        let mut ship = bare();
        ship.b_nt = [bx, by, 0.0];
        let case = Case::new(ship, class_a(), 33.0);
        let outcome = case.plan();
        let plan = &outcome.plans[0];
        assert!(
            plan.worst_residual_deg < 1.0,
            "{bx} {by}: {}",
            plan.worst_residual_deg
        );
        let cures = |axis: Axis, b: f64| {
            let trays = plan.setting.trays(axis);
            assert!(!trays.is_empty());
            trays.iter().all(|tray| tray.red == axis.red(b > 0.0))
        };
        assert!(
            cures(Axis::ForeAndAft, bx) && cures(Axis::Athwartship, by),
            "{bx} {by}"
        );
    }
}

#[test]
fn the_first_plan_takes_the_fewest_moves_among_near_equals_and_the_others_trade() {
    let outcome = case(60.0).plan();
    let first = &outcome.plans[0];
    let reach = |plan: &Plan| {
        let reaches = plan.after.iter().skip(1).zip([2.0, 1.0]);
        let weighed = reaches.map(|(table, weight)| weight * table.reach_deg.unwrap());
        weighed.sum::<f64>() / 3.0
    };
    let best = outcome
        .plans
        .iter()
        .map(reach)
        .fold(f64::INFINITY, f64::min);
    // The errors of moved magnets are in the tables, not in the search.
    assert!(reach(first) <= best + 0.2);
    assert!(outcome.plans.len() >= 3);
    for other in &outcome.plans[1..] {
        assert!(other.moves != first.moves);
        let more = other.moves > first.moves;
        assert!(more || reach(other) > reach(first));
    }
    assert!(outcome.optimality.unwrap().proven);
}

#[test]
fn an_alternative_keeps_to_the_limits_that_the_recommended_plan_keeps_to() {
    let case = case(60.0);
    let wide = Limits {
        residual_deg: 30.0,
        band_deg: 10.0,
        ..Limits::default()
    };
    let with = |limits: Limits| {
        let mut adjustment = case.adjustment();
        adjustment.limits = limits;
        plan(&adjustment).unwrap()
    };
    let all = with(wide).plans;
    let reach = |plan: &Plan| {
        let reaches = plan.after.iter().filter_map(|table| table.reach_deg);
        reaches.fold(0.0, f64::max)
    };
    let furthest = all.iter().map(reach).fold(0.0, f64::max);
    let narrow = Limits {
        residual_deg: furthest - 0.01,
        ..wide
    };
    let kept = with(narrow).plans;
    assert!(!kept.is_empty() && kept.len() < all.len());
    for plan in &all {
        let within = reach(plan) <= narrow.residual_deg;
        assert_eq!(
            plan.limit_violation(&narrow, &case.waters).is_none(),
            within
        );
        assert_eq!(kept.contains(plan), within);
    }
}

#[test]
fn no_plan_uses_what_is_not_on_board() {
    let mut form: BinnacleForm = class_a().into();
    form.inventory.magnets[0].count = 5;
    form.inventory.quadrantal = vec!["7 inch".to_owned()];
    form.inventory.flinders_pieces_mm = vec![225.0];
    let binnacle = Binnacle::try_from(form).unwrap();
    let mut ship = bare();
    ship.b_nt = [9_000.0, 7_000.0, 0.0];
    let outcome = Case::new(ship, binnacle.clone(), 60.0).plan();
    assert!(!outcome.plans.is_empty());
    for plan in &outcome.plans {
        for step in &plan.steps {
            binnacle.with_setting(step.setting_after.clone()).unwrap();
        }
        let used: u8 = Axis::BOTH
            .iter()
            .flat_map(|a| plan.setting.trays(*a))
            .map(|t| t.count)
            .sum();
        assert!(used <= 5);
    }
}

/// With port and starboard exchanged, the plan has the same residual and moves.
#[test]
fn the_mirror_image_of_a_ship_gets_as_good_a_plan() {
    let mut ship = bare();
    ship.b_nt = [2_500.0, 1_800.0, 500.0];
    let mut mirrored = ship;
    for (row, column) in [(0, 1), (1, 0), (1, 2), (2, 1)] {
        mirrored.chi[row][column] *= -1.0;
    }
    mirrored.b_nt[1] *= -1.0;
    let mut binnacle: BinnacleForm = class_a().into();
    binnacle.setting.athwartship.clear();
    let binnacle = Binnacle::try_from(binnacle).unwrap();
    let plan = |ship, heading| {
        let mut case = Case::new(ship, binnacle.clone(), heading);
        case.model.constant_deg = 0.0;
        case.plan().plans.remove(0)
    };
    let (one, other) = (plan(ship, 70.0), plan(mirrored, 290.0));
    assert!((one.worst_residual_deg - other.worst_residual_deg).abs() < 0.011);
    assert_eq!(one.moves, other.moves);
    let [a, b] = [one, other].map(|plan| plan.setting.athwartship[0].red);
    assert_eq!(a, b.reversed());
}

#[test]
fn magnets_against_what_the_vertical_field_induces_are_for_one_dip_and_that_is_said() {
    let first_note = |chi13: f64, waters: usize| {
        let mut ship = bare();
        ship.chi[0][2] = chi13;
        let mut form: BinnacleForm = class_a().into();
        form.setting.flinders = None;
        form.inventory.flinders_pieces_mm.clear();
        let mut case = Case::new(ship, Binnacle::try_from(form).unwrap(), 60.0);
        case.waters.truncate(waters);
        let mut notes = case.plan().notes.into_iter();
        notes
            .next()
            .filter(|note| note.starts_with("this plan is for waters of one dip"))
    };
    let note = first_note(-0.05, 1).unwrap();
    assert!(
        note.contains("magnetic equator") && note.contains("Flinders bar"),
        "{note}"
    );
    assert_eq!(first_note(-0.05, 2), None);
    assert_eq!(first_note(-0.002, 1), None);
}

/// A class A binnacle whose fore-and-aft rack has four trays of two magnets.
fn four_trays(magnets: u16, each: u8) -> Binnacle {
    let mut form: BinnacleForm = class_a().into();
    let mut design: DesignForm = form.design.into();
    for rack in [&mut design.fore_and_aft, &mut design.athwartship] {
        (rack.at_once, rack.magnets_each) = (4, each);
        rack.magnets = vec!["100 mm".to_owned()];
    }
    form.design = design.try_into().unwrap();
    form.setting.fore_and_aft.clear();
    form.setting.athwartship.clear();
    form.inventory.magnets[0].magnet = "100 mm".to_owned();
    form.inventory.magnets[0].count = magnets;
    Binnacle::try_from(form).unwrap()
}

/// A residual that only four trays together reach is found, though the settings are too
/// many to go through.
#[test]
fn every_tray_of_a_rack_is_used_where_it_takes_them() {
    let mut ship = bare();
    ship.b_nt = [12_000.0, -1_900.0, 0.0];
    let mut case = Case::new(ship, four_trays(40, 2), 40.0);
    case.waters.truncate(1);
    let outcome = case.plan();
    let best = &outcome.plans[0];
    assert_eq!(best.setting.fore_and_aft.len(), 4, "{:?}", best.setting);
    assert!(best.worst_residual_deg < 1.5, "{}", best.worst_residual_deg);
    let optimality = outcome.optimality.unwrap();
    assert_eq!(optimality.trays_in_use, [4, 4]);
    assert!(
        optimality.proven && optimality.gap_deg <= 0.05,
        "{optimality:?}"
    );
}

/// For a ship beyond the racks' reach, no untried setting suffices, and that is proven.
#[test]
fn a_ship_beyond_all_trays_is_refused_and_that_is_proven() {
    let mut ship = bare();
    ship.b_nt = [16_000.0, -1_900.0, 0.0];
    let mut case = Case::new(ship, four_trays(40, 2), 40.0);
    case.waters.truncate(1);
    let mut adjustment = case.adjustment();
    adjustment.limits = Limits::default();
    let outcome = plan(&adjustment).unwrap();
    assert!(outcome.plans.is_empty());
    let optimality = outcome.optimality.unwrap();
    assert!(optimality.proven, "{optimality:?}");
    assert!(outcome.notes.is_empty(), "{:?}", outcome.notes);
}

/// No magnets of a rack exceed its stated reach, with any iron and any number of magnets on
/// board.
#[test]
fn nothing_is_beyond_the_reach_that_a_rack_is_said_to_have() {
    for (magnets, each) in [(40, 2), (5, 4), (3, 1), (12, 3)] {
        let case = Case::new(bare(), four_trays(magnets, each), 40.0);
        let adjustment = case.adjustment();
        let state = MagneticState::new(&adjustment).unwrap();
        for axis in Axis::BOTH {
            let standing = &case.binnacle.setting;
            let rack = candidates::AxisCandidates::new(&case.binnacle, axis, standing);
            for (soft, _) in soft_iron::iron(&state, standing).iter().step_by(37) {
                let iron = crate::corrector::Iron::new(&case.binnacle, soft);
                let fields = rack.fields(&case.binnacle, &iron);
                let reach = rack.reach_nt(&fields);
                let mut nearest = 0.0_f64;
                for magnets in &rack.settings {
                    let field = magnets.field_nt(&fields);
                    for part in 0..2 {
                        assert!(field[part].abs() <= reach[part] + 1e-6);
                    }
                    let along = usize::from(axis == Axis::Athwartship);
                    nearest = nearest.max(field[along].abs() / reach[along]);
                }
                assert!(nearest > 0.999, "{magnets} {each} {axis}: {nearest}");
            }
        }
    }
}
