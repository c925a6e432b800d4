use super::*;
use crate::angle::MagneticHeading;
use crate::berth::{Alignment, ReadingErrors};
use crate::binnacle::tests::class_a;
use crate::binnacle::{Axis, BinnacleForm, DesignForm};
use crate::corrector::effect;
use crate::model::{Identifiable, Parameters};
use crate::ship::ShipMagnetism;

pub(super) const BISCAY: EarthField = EarthField {
    h_nt: 24_000.0,
    z_nt: 38_500.0,
};

/// A ship without correctors, and what is read and known of her with those of a binnacle.
pub(super) struct Case {
    pub(super) model: Model,
    pub(super) reading: BerthReading,
    pub(super) binnacle: Binnacle,
    pub(super) waters: Vec<Water>,
    bare: ShipMagnetism,
}

pub(super) fn bare() -> ShipMagnetism {
    ShipMagnetism {
        chi: [
            [-0.06, 0.002, -0.021],
            [0.003, -0.15, 0.002],
            [0.0, 0.0, -0.05],
        ],
        b_nt: [-900.0, -700.0, 1_500.0],
    }
}

fn small_covariance() -> crate::model::Covariance {
    let mut covariance = [[0.0; 8]; 8];
    for (index, sd) in [60.0_f64, 1.5e-3, 50.0, 1.5e-3, 2e-3, 2e-3, 2e-3, 0.3]
        .into_iter()
        .enumerate()
    {
        covariance[index][index] = sd.powi(2);
    }
    covariance
}

impl Case {
    pub(super) fn new(bare: ShipMagnetism, binnacle: Binnacle, magnetic_deg: f64) -> Case {
        let waters = vec![
            water("Biscay", BISCAY.h_nt, BISCAY.z_nt, 2.0),
            water("Cape Town", 15_500.0, -20_000.0, 1.0),
        ];
        let mean_h = 3.0 / (2.0 / BISCAY.h_nt + 1.0 / 15_500.0);
        let there = effect(&binnacle, &binnacle.setting);
        let seen = sum(&bare, &there.as_ship(mean_h));
        let model = Model {
            parameters_over_lambda: seen.parameters_over_lambda().unwrap(),
            constant_deg: 0.2,
            covariance: Some(small_covariance()),
            identifiable: None,
            rms_deg: None,
            samples_used: 100,
            samples_rejected: 0,
            quality: None,
        };
        // The magnetometer meets no needles.
        let there = sum(&bare, &there.as_ship(f64::INFINITY));
        let [x, y, _] = there.field_aboard(BISCAY.in_ship_axes(magnetic_deg.to_radians()));
        let errors = ReadingErrors {
            field_sd_nt: 150.0,
            heading_sd_deg: 0.5,
            alignment_sd_deg: 0.3,
            tilt_sd_deg: 0.2,
        };
        let heading = MagneticHeading::new(magnetic_deg).unwrap();
        Case {
            model,
            reading: BerthReading::new(heading, [x, y], errors, Alignment::Keel).unwrap(),
            binnacle,
            waters,
            bare,
        }
    }

    pub(super) fn adjustment(&self) -> Adjustment<'_> {
        Adjustment {
            model: &self.model,
            earth: BISCAY,
            reading: &self.reading,
            scale_sd: 0.003,
            compass_deg: None,
            vertical: None,
            binnacle: &self.binnacle,
            now: None,
            waters: &self.waters,
            circumstances: Circumstances::default(),
            limits: Limits {
                residual_deg: 10.0,
                band_deg: 5.0,
                ..Limits::default()
            },
        }
    }

    fn plan(&self) -> Outcome {
        plan(&self.adjustment()).unwrap()
    }
}

pub(super) fn water(name: &str, h_nt: f64, z_nt: f64, weight: f64) -> Water {
    Water {
        name: name.to_owned(),
        h_nt,
        z_nt,
        weight,
    }
}

fn sum(one: &ShipMagnetism, other: &ShipMagnetism) -> ShipMagnetism {
    ShipMagnetism {
        chi: std::array::from_fn(|r| std::array::from_fn(|c| one.chi[r][c] + other.chi[r][c])),
        b_nt: std::array::from_fn(|axis| one.b_nt[axis] + other.b_nt[axis]),
    }
}

pub(super) fn case(magnetic_deg: f64) -> Case {
    Case::new(bare(), class_a(), magnetic_deg)
}

/// A binnacle with so little in it that every setting can be tried.
pub(super) fn little() -> Binnacle {
    let mut form: BinnacleForm = class_a().into();
    let mut design: DesignForm = form.design.into();
    for rack in [&mut design.fore_and_aft, &mut design.athwartship] {
        rack.holes.truncate(6);
        rack.at_once = 1;
        rack.magnets_each = 2;
    }
    let iron = design.quadrantal.as_mut().unwrap();
    iron.marks
        .retain(|mark| mark.mark_mm <= 280.0 || (mark.mark_mm - 320.0).abs() < 1e-9);
    iron.slews_deg = vec![0.0];
    form.aboard.flinders_pieces_mm = vec![225.0];
    form.aboard.quadrantal = vec!["7 inch".to_owned()];
    form.setting.athwartship[0].hole = 3;
    form.design = design.try_into().unwrap();
    Binnacle::try_from(form).unwrap()
}

#[test]
fn the_search_finds_what_trying_everything_finds() {
    let mut ship = bare();
    ship.b_nt = [1_500.0, -2_200.0, 0.0];
    let case = Case::new(ship, little(), 60.0);
    let adjustment = case.adjustment();
    let condition = Condition::new(&adjustment).unwrap();
    let front = search::search(&adjustment, &condition);
    let mut best: Vec<f64> = vec![f64::INFINITY; 20];
    every_setting(&case.binnacle, |setting| {
        if case.binnacle.with_setting(setting.clone()).is_err() {
            return;
        }
        let standing = &case.binnacle.setting;
        let moves = moves::trays(&standing.fore_and_aft, &setting.fore_and_aft)
            + moves::trays(&standing.athwartship, &setting.athwartship)
            + moves::pair(standing.quadrantal.as_ref(), setting.quadrantal.as_ref())
            + moves::bar(standing.flinders.as_ref(), setting.flinders.as_ref());
        let worst = worst_of(&case, &condition, setting);
        let known = &mut best[moves as usize];
        *known = known.min(worst);
    });
    let mut least = f64::INFINITY;
    let mut levels = 0;
    for (moves, worst) in best.into_iter().enumerate() {
        least = least.min(worst);
        let found = front.undominated();
        let found = found.iter().filter(|f| f.moves as usize <= moves);
        let found = found.map(|f| f.worst_deg).fold(f64::INFINITY, f64::min);
        assert!((found - least).abs() < 0.0051, "{moves}: {found} {least}");
        levels += usize::from(worst.is_finite());
    }
    assert!(levels > 4 && front.optimality.proven);
}

fn worst_of(case: &Case, condition: &Condition<'_>, setting: &Setting) -> f64 {
    let compass = objective::Compass::new(condition.constant_deg());
    let effect = effect(&case.binnacle, setting);
    objective::Objective::new(&compass, &case.waters, |h_nt| {
        condition.aboard(&effect, h_nt)
    })
    .worst_deg([0.0; 2])
}

fn every_setting(binnacle: &Binnacle, mut visit: impl FnMut(&Setting)) {
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
    for (soft, _) in candidates::iron(binnacle, standing, true, true) {
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

#[test]
fn a_bound_is_never_above_what_it_bounds() {
    use rand::{RngExt, SeedableRng};
    let mut rng = rand_chacha::ChaCha8Rng::seed_from_u64(7);
    let waters = [
        water("a", 24_000.0, 38_000.0, 1.0),
        water("b", 30_000.0, -9_000.0, 0.5),
    ];
    let compass = objective::Compass::new(0.7);
    for _ in 0..200 {
        let ship = crate::ship::test_support::random_ship(&mut rng);
        let objective = objective::Objective::new(&compass, &waters, |_| ship);
        let corner: [f64; 2] = std::array::from_fn(|_| rng.random_range(-9_000.0..9_000.0));
        let size: [f64; 2] = std::array::from_fn(|_| rng.random_range(0.0..4_000.0));
        let within = objective::Box2 {
            x: [corner[0], corner[0] + size[0]],
            y: [corner[1], corner[1] + size[1]],
        };
        let (iron, bound) = (objective.bound_for_iron(), objective.bound_deg(&within));
        for _ in 0..20 {
            let b = [0, 1].map(|a| corner[a] + size[a] * rng.random_range(0.0..1.0));
            let worst = objective.worst_deg(b);
            assert!(bound <= worst + 1e-9, "{bound} {worst}");
            assert!(iron <= worst + 1e-9, "{iron} {worst}");
        }
    }
}

/// Whatever the quadrant of the ship's field, magnets go in with the right ends, and
/// what is left is small.
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
fn the_first_plan_takes_the_fewest_moves_among_near_equals_and_the_others_trade() {
    let outcome = case(60.0).plan();
    let first = &outcome.plans[0];
    let best = outcome
        .plans
        .iter()
        .map(|p| p.worst_residual_deg)
        .fold(f64::INFINITY, f64::min);
    assert!(first.worst_residual_deg <= best + 0.1);
    assert!(outcome.plans.len() >= 3);
    for other in &outcome.plans[1..] {
        assert!(other.moves != first.moves);
        let more = other.moves > first.moves;
        assert_eq!(more, other.worst_residual_deg < first.worst_residual_deg);
    }
    assert!(outcome.optimality.unwrap().proven);
}

#[test]
fn no_plan_uses_what_is_not_on_board() {
    let mut form: BinnacleForm = class_a().into();
    form.aboard.magnets[0].count = 5;
    form.aboard.quadrantal = vec!["7 inch".to_owned()];
    form.aboard.flinders_pieces_mm = vec![225.0];
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

fn refusal_of(change: impl FnOnce(&mut Adjustment<'_>)) -> Refused {
    let case = case(60.0);
    let mut adjustment = case.adjustment();
    adjustment.limits = Limits::default();
    change(&mut adjustment);
    let outcome = plan(&adjustment).unwrap();
    assert!(outcome.plans.is_empty(), "a refused plan is not given");
    outcome.refusals.into_iter().next().unwrap()
}

#[test]
fn what_is_refused_says_why_and_what_would_cure_it() {
    let refused = refusal_of(|a| a.circumstances.cargo_on_board = true);
    assert_eq!(refused.refusal, Refusal::CargoOnBoard);
    assert_eq!(refused.cures[0], Cure::AfterDischarge);
    let refused = refusal_of(|a| a.circumstances.model_age_days = Some(400.0));
    assert!(refused.words.contains("400 days old"), "{}", refused.words);
    assert_eq!(refused.cures[0], Cure::HeadingsAtSea);
    let refused = refusal_of(|a| a.limits.band_deg = 0.2);
    assert!(matches!(refused.refusal, Refusal::BandTooWide { .. }));
    let refused = refusal_of(|a| a.limits.residual_deg = 0.5);
    assert!(
        matches!(refused.refusal, Refusal::ResidualTooLarge { .. }),
        "{}",
        refused.words
    );
    assert_eq!(refused.cures[0], Cure::OtherCorrectors);
}

#[test]
fn a_model_without_covariance_is_refused() {
    let mut case = case(60.0);
    case.model.covariance = None;
    let outcome = case.plan();
    assert_eq!(outcome.refusals[0].refusal, Refusal::NoCovariance);
}

#[test]
fn with_a_poor_magnetometer_spheres_stay_and_where_they_must_move_that_is_said() {
    let mut ship = bare();
    ship.chi[1][1] = -0.30;
    let case = Case::new(ship, class_a(), 60.0);
    let mut adjustment = case.adjustment();
    adjustment.scale_sd = 0.05;
    adjustment.limits = Limits::default();
    let outcome = plan(&adjustment).unwrap();
    let refused = &outcome.refusals[0];
    assert!(
        matches!(refused.refusal, Refusal::MagnetometerTooPoor { .. }),
        "{}",
        refused.words
    );
    assert_eq!(refused.cures[0], Cure::BetterMagnetometer);
    adjustment.limits.residual_deg = 20.0;
    adjustment.limits.band_deg = 20.0;
    let outcome = plan(&adjustment).unwrap();
    assert_eq!(
        outcome.plans[0].setting.quadrantal,
        case.binnacle.setting.quadrantal
    );
    assert!(
        outcome
            .notes
            .iter()
            .any(|note| note.contains("spheres are left as found"))
    );
}

#[test]
fn a_bar_is_left_alone_where_the_data_do_not_tell_chi13() {
    let mut case = case(60.0);
    case.model.identifiable = Some(Identifiable {
        bx_nt: false,
        chi13: false,
        by_nt: true,
        chi23: true,
        chi11_minus_chi22: true,
        chi12: false,
        chi21: false,
        constant_deg: false,
    });
    let outcome = case.plan();
    for plan in &outcome.plans {
        assert_eq!(plan.setting.flinders, case.binnacle.setting.flinders);
    }
}

#[test]
fn mistakes_at_the_berth_are_named() {
    let case = case(60.0);
    let [x, y] = case.reading.field_nt();
    for (heading, field, mistake) in [
        (60.0, [x / 1e5, y / 1e5], Mistake::Gauss),
        (60.0, [x / 1e3, y / 1e3], Mistake::Microtesla),
        (60.0, [y, x], Mistake::SwappedAxes),
        (60.0, [x, -y], Mistake::StarboardReversed),
        (60.0, [-x, y], Mistake::ForwardReversed),
        (240.0, [x, y], Mistake::HeadingReversed),
    ] {
        let found = mistakes(
            &case.model,
            BISCAY,
            MagneticHeading::new(heading).unwrap(),
            field,
            case.reading.errors(),
            Alignment::Keel,
        );
        assert_eq!(found, [mistake], "{mistake}");
    }
    let right = mistakes(
        &case.model,
        BISCAY,
        case.reading.magnetic(),
        [x, y],
        case.reading.errors(),
        Alignment::Keel,
    );
    assert_eq!(right, []);
    let mut wrong = case;
    let heading = MagneticHeading::new(240.0).unwrap();
    let errors = wrong.reading.errors();
    wrong.reading = BerthReading::new(heading, [x, y], errors, Alignment::Keel).unwrap();
    let outcome = wrong.plan();
    let words = &outcome.refusals[0].words;
    assert!(words.contains("the heading is 180 degrees off"), "{words}");
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

#[test]
fn what_cannot_be_is_named() {
    let case = case(60.0);
    let named = |change: &dyn Fn(&mut Adjustment<'_>)| {
        let mut adjustment = case.adjustment();
        change(&mut adjustment);
        plan(&adjustment).unwrap_err().to_string()
    };
    assert!(named(&|a| a.waters = &[]).starts_with("waters: there are none"));
    assert!(named(&|a| a.scale_sd = -1.0).starts_with("scale_sd is -1"));
    assert!(named(&|a| a.compass_deg = Some(f64::NAN)).starts_with("compass_deg is NaN"));
    let error = named(&|a| a.vertical = Some(VerticalReading { down_nt: 1e9 }));
    assert!(error.starts_with("down_nt is"), "{error}");
    let weak = [water("pole", 900.0, 55_000.0, 1.0)];
    let mut adjustment = case.adjustment();
    adjustment.waters = &weak;
    let error = plan(&adjustment).unwrap_err().to_string();
    assert!(error.starts_with("waters[0].h_nt is 900"), "{error}");
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

fn settled(model: &Model, compass_deg: f64, off_deg: f64) -> Settled {
    let compass = crate::angle::CompassHeading::new(compass_deg).unwrap();
    let foretold = model.deviation(compass, BISCAY).unwrap().deviation;
    Settled {
        compass,
        deviation_deg: foretold.degrees_east() + off_deg,
        sd_deg: 0.6,
        earth: BISCAY,
    }
}

#[test]
fn headings_at_sea_pass_when_they_are_enough_and_say_how_many_are_not() {
    let model = &case(60.0).plan().plans[0].model_after;
    let Verification::MoreNeeded {
        headings: 0,
        needed,
    } = verify(model, &[], BISCAY).unwrap()
    else {
        panic!()
    };
    assert!((4..30).contains(&needed.count), "{needed:?}");
    let mut sailed: Vec<Settled> = needed
        .compass_deg
        .iter()
        .map(|deg| settled(model, *deg, 0.3))
        .collect();
    let first = verify(model, &sailed[..1], BISCAY).unwrap();
    let Verification::MoreNeeded { needed: fewer, .. } = first else {
        panic!("{first:?}")
    };
    assert!(fewer.count < needed.count);
    for step in 0..24 {
        sailed.push(settled(model, f64::from(step) * 15.0, -0.2));
    }
    let passed = verify(model, &sailed, BISCAY).unwrap();
    let Verification::Passed {
        headings: 24,
        band95_deg,
        ..
    } = passed
    else {
        panic!("{passed:?}")
    };
    assert!(band95_deg < 1.0);
}

#[test]
fn a_heading_that_is_off_raises_the_alarm_on_either_side() {
    let model = &case(60.0).plan().plans[0].model_after;
    for (compass_deg, off_deg) in [(359.0, 2.3), (1.0, -2.3), (180.0, 2.3)] {
        let found = verify(model, &[settled(model, compass_deg, off_deg)], BISCAY).unwrap();
        let Verification::Alarm { off_deg: told, .. } = found else {
            panic!("{found:?}")
        };
        assert!((told - off_deg).abs() < 1e-9);
    }
    let mut sure = settled(model, 90.0, 1.8);
    sure.sd_deg = 0.1;
    let mut known = model.clone();
    known.covariance = Some([[0.0; 8]; 8]);
    let found = verify(&known, &[sure], BISCAY).unwrap();
    assert!(
        matches!(found, Verification::Alarm { .. }),
        "beyond three standard errors"
    );
}

#[test]
fn an_outcome_comes_back_from_json_as_it_went() {
    let outcome = case(60.0).plan();
    let text = serde_json::to_string(&outcome).unwrap();
    let again: Outcome = serde_json::from_str(&text).unwrap();
    assert_eq!(again.plans[0].setting, outcome.plans[0].setting);
    assert_eq!(again.plans[0].steps.len(), outcome.plans[0].steps.len());
}

#[test]
fn the_parameters_before_are_those_of_the_model() {
    // With nothing moved the model after is the model, and no corrector errs.
    let case = case(60.0);
    let adjustment = case.adjustment();
    let condition = Condition::new(&adjustment).unwrap();
    let same = condition.model_with(&case.binnacle.setting).unwrap();
    let (old, new): (Parameters, Parameters) = (
        case.model.parameters_over_lambda,
        same.parameters_over_lambda,
    );
    for (old, new) in old.to_array().iter().zip(new.to_array()) {
        assert!((old - new).abs() < 1e-9 * old.abs().max(1.0));
    }
    let (old, new) = (case.model.covariance.unwrap(), same.covariance.unwrap());
    for row in 0..8 {
        assert!((old[row][row] - new[row][row]).abs() < 1e-9 * old[row][row]);
    }
}
