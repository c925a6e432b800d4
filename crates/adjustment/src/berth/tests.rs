use super::*;
use crate::test_support::{random_earth, random_ship};
use binnacle_compass::angle::{MagneticHeading, TrueHeading, Variation};
use binnacle_compass::model::{Model, Parameters, ReferenceGrade};
use binnacle_compass::ship::{EarthField, ShipMagnetism};
use rand::{RngExt, SeedableRng};
use rand_chacha::ChaCha8Rng;

const BISCAY: EarthField = EarthField {
    h_nt: 24_000.0,
    z_nt: 38_500.0,
};

const ERRORS: ReadingErrors = ReadingErrors {
    field_sd_nt: 200.0,
    heading_sd_deg: 0.5,
    alignment_sd_deg: 0.3,
    tilt_sd_deg: 0.2,
};

/// λ 0.88, B and C of some degrees.
fn ship() -> ShipMagnetism {
    ShipMagnetism {
        chi: [
            [-0.08, 0.003, -0.02],
            [0.005, -0.16, 0.004],
            [0.0, 0.0, -0.05],
        ],
        b_nt: [1_900.0, -2_400.0, 800.0],
    }
}

fn model_of(ship: &ShipMagnetism) -> Model {
    let mut covariance = [[0.0; 8]; 8];
    for (index, sd) in [60.0_f64, 1.5e-3, 50.0, 1.5e-3, 2e-3, 5e-3, 5e-3, 0.5]
        .into_iter()
        .enumerate()
    {
        covariance[index][index] = sd.powi(2);
    }
    Model {
        parameters_over_lambda: ship.parameters_over_lambda().unwrap(),
        constant_deg: 0.0,
        covariance: Some(covariance),
        identifiable: None,
        rms_deg: None,
        samples_used: 0,
        samples_rejected: 0,
        quality: None,
        reference_grade: ReferenceGrade::Heading,
        mean_h_nt: None,
        needles: None,
    }
}

fn heading(degrees: f64) -> MagneticHeading {
    MagneticHeading::new(degrees).unwrap()
}

/// Reading of a perfect magnetometer at the compass.
fn field_read(ship: &ShipMagnetism, earth: EarthField, magnetic_deg: f64) -> [f64; 2] {
    let [forward, starboard, _] =
        ship.field_at_compass(earth.in_ship_axes(magnetic_deg.to_radians()));
    [forward, starboard]
}

fn reading(magnetic_deg: f64, field_nt: [f64; 2]) -> BerthReading {
    BerthReading::new(heading(magnetic_deg), field_nt, ERRORS, Alignment::Keel).unwrap()
}

fn faultless(magnetic_deg: f64) -> BerthReading {
    reading(magnetic_deg, field_read(&ship(), BISCAY, magnetic_deg))
}

fn assert_whole_ship(found: &FullParameters, ship: &ShipMagnetism) {
    let chi = &ship.chi;
    for (name, found, expected) in [
        ("chi11", found.chi11, chi[0][0]),
        ("chi12", found.chi12, chi[0][1]),
        ("chi13", found.chi13, chi[0][2]),
        ("chi21", found.chi21, chi[1][0]),
        ("chi22", found.chi22, chi[1][1]),
        ("chi23", found.chi23, chi[1][2]),
        ("bx", found.bx_nt, ship.b_nt[0]),
        ("by", found.by_nt, ship.b_nt[1]),
    ] {
        let off = (found.value - expected).abs();
        assert!(off < 1e-9 * expected.abs().max(1.0), "{name}: {found:?}");
    }
}

#[test]
fn every_heading_gives_back_the_whole_of_every_ship() {
    let mut rng = ChaCha8Rng::seed_from_u64(20);
    let mut answered = 0;
    for _ in 0..100 {
        let (ship, earth) = (random_ship(&mut rng), random_earth(&mut rng));
        for degrees in (0..360).step_by(15) {
            let degrees = f64::from(degrees);
            let reading = reading(degrees, field_read(&ship, earth, degrees));
            let Ok(found) = lambda_at_berth(&model_of(&ship), earth, &reading) else {
                continue;
            };
            answered += 1;
            assert!((found.lambda.value - ship.lambda()).abs() < 1e-9);
            assert!(found.consistency.angle_deg.abs() < 1e-6);
            assert_eq!(found.consistency.verdict, Verdict::Consistent);
            assert_whole_ship(&found.parameters, &ship);
        }
    }
    assert!(answered > 2_000, "{answered} of 2400");
}

#[test]
fn on_east_north_lies_to_port() {
    // Only iron that halves the field all around.
    let ship = ShipMagnetism {
        chi: [[-0.5, 0.0, 0.0], [0.0, -0.5, 0.0], [0.0; 3]],
        b_nt: [0.0; 3],
    };
    let to_port = reading(90.0, [0.0, -12_000.0]);
    let found = lambda_at_berth(&model_of(&ship), BISCAY, &to_port).unwrap();
    assert!((found.lambda.value - 0.5).abs() < 1e-12);
    let to_starboard = reading(90.0, [0.0, 12_000.0]);
    let refused = lambda_at_berth(&model_of(&ship), BISCAY, &to_starboard).unwrap_err();
    let BerthError::Inconsistent(consistency) = refused else {
        panic!("{refused}");
    };
    assert!((consistency.angle_deg.abs() - 180.0).abs() < 1e-9);
}

#[test]
fn lambda_is_scaled_with_the_reading() {
    for degrees in [0.0, 90.0, 137.0, 270.0] {
        let [forward, starboard] = field_read(&ship(), BISCAY, degrees);
        let once = lambda_at_berth(&model_of(&ship()), BISCAY, &faultless(degrees)).unwrap();
        let scaled = reading(degrees, [1.1 * forward, 1.1 * starboard]);
        let scaled = lambda_at_berth(&model_of(&ship()), BISCAY, &scaled).unwrap();
        assert!((scaled.lambda.value - 1.1 * once.lambda.value).abs() < 1e-12);
        assert!((scaled.parameters.bx_nt.value - 1.1 * 1_900.0).abs() < 1e-6);
        assert!((scaled.consistency.angle_deg - once.consistency.angle_deg).abs() < 1e-9);
    }
}

/// Without iron u is H, and each error can be checked alone.
#[test]
fn noise_counts_by_h_tilt_by_the_dip_and_small_turns_not_at_all() {
    let ship = ShipMagnetism::from_parameters(&Parameters::from_array([0.0; 7]), 1.0);
    let mut model = model_of(&ship);
    model.covariance = Some([[0.0; 8]; 8]);
    let only = |change: fn(&mut ReadingErrors)| {
        let mut errors = ReadingErrors {
            field_sd_nt: 1e-3,
            heading_sd_deg: 0.0,
            alignment_sd_deg: 0.0,
            tilt_sd_deg: 0.0,
        };
        change(&mut errors);
        let field = field_read(&ship, BISCAY, 20.0);
        let reading = BerthReading::new(heading(20.0), field, errors, Alignment::Keel).unwrap();
        let found = lambda_at_berth(&model, BISCAY, &reading).unwrap();
        (
            found.lambda.standard_error.unwrap(),
            found.consistency.standard_error_deg.unwrap(),
        )
    };
    let near = |found: (f64, f64), lambda: f64, angle_deg: f64| {
        assert!((found.0 - lambda).abs() < 1e-6, "{found:?}");
        assert!((found.1 - angle_deg).abs() < 1e-4, "{found:?}");
    };
    near(only(|e| e.field_sd_nt = 200.0), 0.008_333, 0.477_5);
    near(only(|e| e.tilt_sd_deg = 0.5), 0.013_999, 0.802_1);
    near(only(|e| e.heading_sd_deg = 0.5), 0.0, 0.5);
    near(only(|e| e.alignment_sd_deg = 0.5), 0.0, 0.5);
}

/// With a model uncertain in one direction only, every standard error equals the shift of
/// its estimate as the model moves along that direction.
#[test]
fn every_standard_error_is_the_slope_along_what_the_model_does_not_know() {
    const NO_ERRORS: ReadingErrors = ReadingErrors {
        field_sd_nt: 1e-9,
        heading_sd_deg: 0.0,
        alignment_sd_deg: 0.0,
        tilt_sd_deg: 0.0,
    };
    let mut rng = ChaCha8Rng::seed_from_u64(30);
    for (alignment, constant_deg) in [(Alignment::Keel, 0.0), (Alignment::AsFitted, 2.0)] {
        for degrees in (0..360).step_by(10) {
            let degrees = f64::from(degrees);
            let sizes = [1.0, 2e-5, 1.0, 2e-5, 2e-5, 2e-5, 2e-5, 1e-3];
            let way: [f64; 8] = sizes.map(|size| size * rng.random_range(-1.0..1.0));
            let field = field_read(&ship(), BISCAY, degrees);
            let given = heading(degrees + constant_deg);
            let reading = BerthReading::new(given, field, NO_ERRORS, alignment).unwrap();
            let found = |steps: f64| {
                let mut model = model_of(&ship());
                let mut ratios = model.parameters_over_lambda.to_array();
                for (ratio, way) in ratios.iter_mut().zip(way) {
                    *ratio += steps * way;
                }
                model.parameters_over_lambda = Parameters::from_array(ratios);
                model.constant_deg = constant_deg + steps * way[7];
                model.covariance = Some(way.map(|row| way.map(|column| row * column)));
                let found = lambda_at_berth(&model, BISCAY, &reading).unwrap();
                let p = found.parameters;
                let angle = Estimated {
                    value: found.consistency.angle_deg,
                    standard_error: found.consistency.standard_error_deg,
                };
                [
                    found.lambda,
                    angle,
                    p.chi11,
                    p.chi12,
                    p.chi13,
                    p.chi21,
                    p.chi22,
                    p.chi23,
                    p.bx_nt,
                    p.by_nt,
                ]
            };
            let (back, here, on) = (found(-1.0), found(0.0), found(1.0));
            for index in 0..here.len() {
                let moved = (on[index].value - back[index].value).abs() / 2.0;
                let error = here[index].standard_error.unwrap();
                assert!(
                    (moved - error).abs() < 1e-3 * moved + 1e-9 * here[index].value.abs(),
                    "{alignment:?} {degrees} {index}: {moved} {error}"
                );
            }
        }
    }
}

#[test]
fn a_true_heading_less_its_variation_is_the_heading_to_give() {
    for variation in [-20.0, 20.0] {
        let variation = Variation::new(variation).unwrap();
        let true_heading = TrueHeading::new(5.0).unwrap();
        let magnetic = true_heading - variation;
        let field = field_read(&ship(), BISCAY, 5.0 - variation.degrees_east());
        let reading = BerthReading::new(magnetic, field, ERRORS, Alignment::Keel).unwrap();
        let found = lambda_at_berth(&model_of(&ship()), BISCAY, &reading).unwrap();
        assert!((found.lambda.value - ship().lambda()).abs() < 1e-9);
    }
}

/// The heading comes from the reference with offset κ; the lubber line is where the fit
/// assumes it.
#[test]
fn the_constant_is_taken_off_a_heading_of_the_models_own_reference_only() {
    let mut model = model_of(&ship());
    model.constant_deg = 4.0;
    let field = field_read(&ship(), BISCAY, 60.0);
    let with = |alignment, degrees| {
        let reading = BerthReading::new(heading(degrees), field, ERRORS, alignment).unwrap();
        lambda_at_berth(&model, BISCAY, &reading)
    };
    for found in [with(Alignment::AsFitted, 64.0), with(Alignment::Keel, 60.0)] {
        assert!(found.unwrap().consistency.angle_deg.abs() < 1e-9);
    }
    for wrong in [with(Alignment::AsFitted, 60.0), with(Alignment::Keel, 64.0)] {
        assert!(matches!(wrong, Err(BerthError::Inconsistent(_))));
    }
}

#[test]
fn a_field_that_points_elsewhere_is_refused_with_what_could_be_wrong() {
    let given = 40.0;
    let actual = 45.0;
    let refused = lambda_at_berth(
        &model_of(&ship()),
        BISCAY,
        &reading(given, field_read(&ship(), BISCAY, actual)),
    )
    .unwrap_err();
    let BerthError::Inconsistent(consistency) = refused.clone() else {
        panic!("{refused}");
    };
    assert_eq!(consistency.verdict, Verdict::Inconsistent);
    let suspects = consistency.suspects();
    let [Suspect::Heading { too_small_deg }, ..] = suspects[..] else {
        panic!("{suspects:?}");
    };
    // A compass turns a little less or more than the ship.
    assert!((4.0..6.0).contains(&too_small_deg), "{too_small_deg}");
    let text = refused.to_string();
    for words in [
        "too small",
        "turned",
        "to starboard",
        "and so the variation",
        "steel near the berth adds",
        "magnetism has changed",
    ] {
        assert!(text.contains(words), "{text}");
    }
    assert!(!text.contains('\n'));
}

#[test]
fn steel_is_no_suspect_of_an_angle_that_it_cannot_bring_about() {
    for turned_deg in [90.0, 178.0] {
        let field = field_read(&ship(), BISCAY, 45.0 - turned_deg);
        let refused = lambda_at_berth(&model_of(&ship()), BISCAY, &reading(45.0, field));
        let text = refused.unwrap_err().to_string();
        assert!(text.contains("the heading is"), "{text}");
        assert!(!text.contains("nT across the needle"), "{text}");
    }
}

#[test]
fn an_angle_over_a_degree_passes_only_where_the_errors_explain_it() {
    let two_degrees_off = |heading_sd_deg| {
        let errors = ReadingErrors {
            field_sd_nt: 50.0,
            heading_sd_deg,
            alignment_sd_deg: 0.0,
            tilt_sd_deg: 0.0,
        };
        let field = field_read(&ship(), BISCAY, 200.0);
        BerthReading::new(heading(198.0), field, errors, Alignment::Keel).unwrap()
    };
    let found = |model: &Model, heading_sd_deg| {
        lambda_at_berth(model, BISCAY, &two_degrees_off(heading_sd_deg))
    };
    let model = model_of(&ship());
    let verdict = found(&model, 2.0).unwrap().consistency.verdict;
    assert_eq!(verdict, Verdict::Loose);
    assert!(verdict.to_string().contains("wide errors"));
    assert!(matches!(
        found(&model, 0.2),
        Err(BerthError::Inconsistent(_))
    ));
    // Without the model's errors, nothing explains it.
    let mut bare = model;
    bare.covariance = None;
    assert!(matches!(
        found(&bare, 2.0),
        Err(BerthError::Inconsistent(_))
    ));
}

#[test]
fn a_model_without_a_covariance_gives_lambda_without_a_standard_error() {
    let mut bare = model_of(&ship());
    bare.covariance = None;
    let found = lambda_at_berth(&bare, BISCAY, &faultless(0.0)).unwrap();
    assert_whole_ship(&found.parameters, &ship());
    assert_eq!(found.lambda.standard_error, None);
    assert_eq!(found.parameters.chi11.standard_error, None);
    assert_eq!(found.covariance, None);
}

#[test]
fn a_reading_in_microtesla_is_no_ships_lambda() {
    let [forward, starboard] = field_read(&ship(), BISCAY, 30.0);
    let reading = reading(30.0, [forward / 1e3, starboard / 1e3]);
    let refused = lambda_at_berth(&model_of(&ship()), BISCAY, &reading).unwrap_err();
    assert!(matches!(refused, BerthError::Implausible(lambda) if lambda < 0.001));
    assert!(refused.to_string().contains("0.0009, outside 0.5 to 1.25"));
}

#[test]
fn a_heading_without_directive_force_is_named() {
    let mut model = model_of(&ship());
    model.parameters_over_lambda =
        Parameters::from_array([-23_900.0, 0.0, 0.0, 0.0, 0.0, 0.0, 0.0]);
    let refused = lambda_at_berth(&model, BISCAY, &reading(0.0, [90.0, 0.0])).unwrap_err();
    assert!(
        matches!(refused, BerthError::NoDirectiveForce { magnetic_deg, .. } if magnetic_deg == 0.0)
    );
    // On the opposite heading there is force enough.
    let south = lambda_at_berth(&model, BISCAY, &reading(180.0, [-43_000.0, 0.0]));
    assert!((south.unwrap().lambda.value - 43.0 / 47.9).abs() < 1e-9);
}

#[test]
fn a_model_or_an_earth_that_is_none_is_refused() {
    let mut broken = model_of(&ship());
    broken.covariance.as_mut().unwrap()[3][3] = f64::NAN;
    let refused = lambda_at_berth(&broken, BISCAY, &faultless(0.0)).unwrap_err();
    assert!(matches!(refused, BerthError::Model(_)));
    for h_nt in [0.0, -1.0, f64::NAN, f64::INFINITY] {
        let earth = EarthField { h_nt, ..BISCAY };
        let refused = lambda_at_berth(&model_of(&ship()), earth, &faultless(0.0)).unwrap_err();
        assert!(matches!(refused, BerthError::Field(_)));
    }
}

#[test]
fn a_reading_that_cannot_be_is_refused_by_the_name_of_its_field() {
    let with = |field_nt, change: fn(&mut ReadingErrors)| {
        let mut errors = ERRORS;
        change(&mut errors);
        BerthReading::new(heading(0.0), field_nt, errors, Alignment::Keel)
            .unwrap_err()
            .to_string()
    };
    let good = [20_000.0, -1_000.0];
    let same: fn(&mut ReadingErrors) = |_| {};
    for (refused, name) in [
        (with([f64::NAN, 0.0], same), "forward_nt"),
        (with([0.0, f64::INFINITY], same), "starboard_nt"),
        (with([2e7, 0.0], same), "forward_nt"),
        (with(good, |e| e.field_sd_nt = 0.0), "field_sd_nt"),
        (with(good, |e| e.field_sd_nt = f64::NAN), "field_sd_nt"),
        (with(good, |e| e.heading_sd_deg = -0.1), "heading_sd_deg"),
        (with(good, |e| e.alignment_sd_deg = 6.0), "alignment_sd_deg"),
        (with(good, |e| e.tilt_sd_deg = f64::INFINITY), "tilt_sd_deg"),
    ] {
        assert!(refused.starts_with(name), "{refused}");
    }
    assert!(with([0.0, 0.5], same).contains("no horizontal field"));
}

#[test]
fn moved_magnets_are_found_from_one_reading() {
    let lambda = Estimated {
        value: ship().lambda(),
        standard_error: Some(0.008),
    };
    let mut moved = ship();
    moved.b_nt = [300.0, -150.0, 800.0];
    for degrees in (0..360).step_by(15) {
        let degrees = f64::from(degrees);
        let reading = reading(degrees, field_read(&moved, BISCAY, degrees));
        let model = model_of(&ship());
        let found = permanent_at_berth(&model, BISCAY, &reading, lambda).unwrap();
        assert!((found.bx_nt.value - 300.0).abs() < 1e-6, "{degrees}");
        assert!((found.by_nt.value + 150.0).abs() < 1e-6, "{degrees}");
    }
}

#[test]
fn moved_magnets_need_a_lambda_that_can_be_one() {
    let lambda = |value, standard_error| Estimated {
        value,
        standard_error,
    };
    let found = |lambda| permanent_at_berth(&model_of(&ship()), BISCAY, &faultless(0.0), lambda);
    for value in [0.0, -1.0, 2.0, f64::NAN] {
        let refused = found(lambda(value, None));
        assert!(matches!(refused, Err(BerthError::Implausible(_))));
    }
    for error in [-0.1, f64::NAN] {
        let refused = found(lambda(0.9, Some(error)));
        assert!(matches!(refused, Err(BerthError::Reading { .. })));
    }
    assert_eq!(found(lambda(0.9, None)).unwrap().bx_nt.standard_error, None);
}

#[test]
fn an_estimate_comes_back_from_json() {
    let found = lambda_at_berth(&model_of(&ship()), BISCAY, &faultless(77.0)).unwrap();
    let json = serde_json::to_string(&found).unwrap();
    assert!(json.contains(r#""verdict":"consistent""#), "{json}");
    let again: BerthEstimate = serde_json::from_str(&json).unwrap();
    assert!((again.lambda.value - found.lambda.value).abs() < 1e-12);
}

/// 4 µT of steel along the needle passes for another λ on one heading. Where the ship lies
/// otherwise to it, one λ no longer explains both readings.
#[test]
fn steel_on_one_of_two_headings_is_no_other_lambda() {
    let model = model_of(&ship());
    let [x, y] = field_read(&ship(), BISCAY, 20.0);
    let more = 1.0 + 4_000.0 / x.hypot(y);
    let beside = reading(20.0, [more * x, more * y]);
    let alone = lambda_at_berth(&model, BISCAY, &beside).unwrap();
    assert!((alone.lambda.value - more * ship().lambda()).abs() < 1e-9);
    let clean = [faultless(20.0), faultless(140.0)];
    let both = |first: &BerthReading| {
        lambda_by_two_headings(&model, BISCAY, [first, &clean[1]], 0.9).unwrap()
    };
    let found = both(&beside);
    assert!(found.is_foreign && found.left_nt > 2_000.0, "{found:?}");
    let found = both(&clean[0]);
    assert!(!found.is_foreign && found.left_nt < 1e-6, "{found:?}");
    assert!((found.lambda - ship().lambda()).abs() < 1e-9);
    assert!(found.standard_error < alone.lambda.standard_error.unwrap());
}
