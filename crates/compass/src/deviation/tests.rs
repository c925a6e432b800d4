use super::*;
use crate::ship::test_support::{random_earth, random_ship};
use crate::ship::wrap_pi;
use rand::{RngExt, SeedableRng};
use rand_chacha::ChaCha8Rng;

/// A ship with unambiguous headings, and the field at its place.
fn usable_ship(rng: &mut ChaCha8Rng) -> (crate::ship::ShipMagnetism, EarthField, Coefficients) {
    loop {
        let (ship, earth) = (random_ship(rng), random_earth(rng));
        let Ok(parameters) = ship.parameters_over_lambda() else {
            continue;
        };
        let coefficients = Coefficients::new(&parameters, earth).unwrap();
        if coefficients.check_unambiguous().is_ok() {
            return (ship, earth, coefficients);
        }
    }
}

#[test]
fn closed_form_tangent_form_and_poisson_agree_on_200_random_ships() {
    let mut rng = ChaCha8Rng::seed_from_u64(200);
    for _ in 0..200 {
        let (ship, earth, coefficients) = usable_ship(&mut rng);
        for degrees in 0..360 {
            let magnetic = f64::from(degrees).to_radians();
            let poisson = ship.deviation_rad(magnetic, earth);
            let tangent = coefficients.deviation_at_magnetic_rad(magnetic);
            let closed = coefficients
                .deviation_at_compass_rad(magnetic - poisson)
                .unwrap();
            assert!(wrap_pi(tangent - poisson).abs() < 1e-9);
            assert!(wrap_pi(closed - poisson).abs() < 1e-9);
        }
    }
}

#[test]
fn compass_to_magnetic_and_back_is_where_it_began() {
    let mut rng = ChaCha8Rng::seed_from_u64(3);
    for _ in 0..100 {
        let (_, _, coefficients) = usable_ship(&mut rng);
        for degrees in (0..360).step_by(5) {
            let compass = CompassHeading::new(f64::from(degrees)).unwrap();
            let magnetic = coefficients.magnetic(compass).unwrap();
            let back = coefficients.compass(magnetic).unwrap();
            let apart = crate::angle::wrap_180(back.degrees() - compass.degrees());
            assert!(apart.abs() < 1e-7, "{compass} came back as {back}");
        }
    }
}

/// A compass turned in its binnacle by ε is equivalent to a ship with other parameters and
/// all readings less by ε: headings cannot tell the two apart.
#[test]
fn a_turned_lubber_line_is_another_ship_with_every_reading_shifted() {
    let mut rng = ChaCha8Rng::seed_from_u64(4);
    for turn_deg in [-7.0_f64, 0.5, 3.0] {
        let (ship, earth, coefficients) = usable_ship(&mut rng);
        let (sin, cos) = turn_deg.to_radians().sin_cos();
        let mut turned = ship;
        for column in 0..3 {
            let unit = |row: usize| if row == column { 1.0 } else { 0.0 };
            let (x, y) = (ship.chi[0][column] + unit(0), ship.chi[1][column] + unit(1));
            turned.chi[0][column] = cos * x - sin * y - unit(0);
            turned.chi[1][column] = sin * x + cos * y - unit(1);
        }
        turned.b_nt[0] = cos * ship.b_nt[0] - sin * ship.b_nt[1];
        turned.b_nt[1] = sin * ship.b_nt[0] + cos * ship.b_nt[1];
        let parameters = turned.parameters_over_lambda().unwrap();
        let turned = Coefficients::new(&parameters, earth).unwrap();
        for degrees in (0..360).step_by(15) {
            let magnetic = f64::from(degrees).to_radians();
            let shift = turned.deviation_at_magnetic_rad(magnetic)
                - coefficients.deviation_at_magnetic_rad(magnetic);
            assert!(wrap_pi(shift - turn_deg.to_radians()).abs() < 1e-9);
        }
    }
}

#[test]
fn the_gradient_at_a_fixed_compass_heading_is_that_of_finite_differences() {
    let mut rng = ChaCha8Rng::seed_from_u64(5);
    for _ in 0..50 {
        let (ship, earth, coefficients) = usable_ship(&mut rng);
        if coefficients.b.hypot(coefficients.c) > 0.5 {
            continue;
        }
        let parameters = ship.parameters_over_lambda().unwrap();
        let compass = rng.random_range(0.0..std::f64::consts::TAU);
        let (_, gradient) = linearised_at_compass(&parameters, compass, earth).unwrap();
        for (index, analytic) in gradient.into_iter().enumerate() {
            let step = if index == 0 || index == 2 { 0.1 } else { 1e-6 };
            let moved = |by: f64| {
                let mut array = parameters.to_array();
                array[index] += by;
                let moved = Parameters::from_array(array);
                linearised_at_compass(&moved, compass, earth).unwrap().0
            };
            let numeric = wrap_pi(moved(step) - moved(-step)) / (2.0 * step);
            let scale = analytic.abs().max(1e-6);
            assert!(
                (numeric - analytic).abs() < 1e-5 * scale,
                "{index}: {numeric} {analytic}"
            );
        }
    }
}

/// The refusal begins exactly where the directive force reaches zero.
#[test]
fn a_ship_stronger_than_the_earth_is_refused_by_name() {
    let only_b = |b: f64| Coefficients {
        a: 0.0,
        b,
        c: 0.0,
        d: 0.0,
        e: 0.0,
    };
    assert!(only_b(0.999).check_unambiguous().is_ok());
    let refused = only_b(1.001).check_unambiguous().unwrap_err();
    let DeviationError::Ambiguous {
        magnetic_deg,
        directive_force,
    } = refused
    else {
        panic!("{refused}");
    };
    assert!((magnetic_deg - 180.0).abs() < 1e-3);
    assert!((directive_force + 0.001).abs() < 1e-9);
    let north = CompassHeading::new(0.0).unwrap();
    assert_eq!(only_b(1.001).deviation_at_compass(north), Err(refused));
    // On east the reading itself has no magnetic heading behind it.
    assert!(
        only_b(1.001)
            .deviation_at_compass_rad(90_f64.to_radians())
            .is_none()
    );
}

#[test]
fn strong_harmonics_that_never_meet_are_not_refused() {
    // 0.7 + 0.5 exceeds 1, yet the two minima lie apart and the least force is 0.05.
    let coefficients = Coefficients {
        a: 0.0,
        b: 0.7,
        c: 0.0,
        d: 0.35,
        e: 0.0,
    };
    assert!(coefficients.b + coefficients.d > 1.0);
    let (_, least) = coefficients.least_directive_force();
    let sampled = (0..36_000)
        .map(|i| coefficients.directive_force((f64::from(i) / 100.0).to_radians()))
        .fold(f64::INFINITY, f64::min);
    assert!((least - sampled).abs() < 1e-7);
    assert!(least > 0.0);
    assert!(coefficients.check_unambiguous().is_ok());
}

#[test]
fn no_field_and_no_number_are_refused() {
    let parameters = Parameters::from_array([0.0; 7]);
    for (h_nt, z_nt) in [
        (0.0, 50_000.0),
        (-1.0, 0.0),
        (f64::NAN, 0.0),
        (20_000.0, f64::INFINITY),
    ] {
        let refused = Coefficients::new(&parameters, EarthField { h_nt, z_nt }).unwrap_err();
        assert!(matches!(refused, DeviationError::InvalidField { .. }));
    }
    let mut broken = parameters;
    broken.chi12 = f64::NAN;
    let earth = EarthField {
        h_nt: 20_000.0,
        z_nt: 40_000.0,
    };
    assert_eq!(
        Coefficients::new(&broken, earth),
        Err(DeviationError::NotFinite)
    );
}

/// Table 2 of Basterretxea-Iribar, Sotés & Uriarte 2016, with the vertical field that was
/// used for Dakar (docs/science.md, §6). Parameters are printed to 1e-4 gauss, deviations
/// to a tenth of a degree.
#[test]
fn the_papers_parameters_give_the_papers_deviations() {
    let parameters =
        Parameters::from_array([2_060.0, -0.0215, -2_930.0, 0.0022, 0.0352, 0.0012, 0.0016]);
    let file = include_str!("../../data/paper_table2.csv");
    let mut reader = csv::Reader::from_reader(file.as_bytes());
    let mut rows = 0;
    for row in reader.records() {
        let row = row.unwrap();
        let number = |index: usize| row[index].parse::<f64>().unwrap();
        let z_gauss = if &row[1] == "Dakar" { 0.489 } else { number(9) };
        let earth = EarthField {
            h_nt: number(8) * 1e5,
            z_nt: z_gauss * 1e5,
        };
        // True heading, variation and deviation of the table are exact; its compass column
        // is measured.
        let compass = number(2) - number(7) - number(3);
        let (deviation, _) =
            linearised_at_compass(&parameters, compass.to_radians(), earth).unwrap();
        let apart = deviation.to_degrees() - number(3);
        assert!(apart.abs() < 0.06, "{row:?}: {apart}");
        rows += 1;
    }
    assert_eq!(rows, 24);
}
