use super::test_support::{random_earth, random_ship};
use super::*;
use rand::{RngExt, SeedableRng};
use rand_chacha::ChaCha8Rng;

const NORTH_EUROPE: EarthField = EarthField {
    h_nt: 18_000.0,
    z_nt: 45_000.0,
};

const NO_SHIP: ShipMagnetism = ShipMagnetism {
    chi: [[0.0; 3]; 3],
    b_nt: [0.0; 3],
};

#[test]
fn a_ship_without_iron_has_no_deviation() {
    for degrees in 0..360 {
        let magnetic = f64::from(degrees).to_radians();
        assert!(NO_SHIP.deviation_rad(magnetic, NORTH_EUROPE).abs() < 1e-12);
    }
}

#[test]
fn a_compass_whose_zero_moved_reads_as_much_more_on_every_heading() {
    let mut rng = ChaCha8Rng::seed_from_u64(7);
    for _ in 0..200 {
        let (ship, earth) = (random_ship(&mut rng), random_earth(&mut rng));
        let parameters = ship.parameters_over_lambda().unwrap();
        let moved = rng.random_range(-0.5..0.5);
        let turned = parameters.with_compass_turned(moved);
        let compass = |p: &Parameters, magnetic: f64| {
            let [forward, starboard] = p.field_over_lambda(magnetic, earth);
            compass_rad(forward, starboard)
        };
        for degrees in (0..360).step_by(15) {
            let magnetic = f64::from(degrees).to_radians();
            let more = compass(&turned, magnetic + moved) - compass(&parameters, magnetic);
            assert!(wrap_pi(more - moved).abs() < 1e-9, "{degrees}: {more}");
        }
    }
}

/// The table of the adjuster's handbooks: direction of the deviation by cause and heading
/// (sign of sin, cos, sin 2, cos 2 of the heading).
#[test]
fn each_cause_pulls_east_or_west_where_the_handbook_says() {
    let with = |change: fn(&mut ShipMagnetism)| {
        let mut ship = NO_SHIP;
        change(&mut ship);
        ship
    };
    let forward = with(|ship| ship.b_nt[0] = 1_000.0);
    let starboard = with(|ship| ship.b_nt[1] = 1_000.0);
    let forward_from_vertical = with(|ship| ship.chi[0][2] = 0.02);
    let fore_and_aft_iron = with(|ship| ship.chi[0][0] = 0.05);
    let lopsided = with(|ship| {
        ship.chi[0][1] = 0.05;
        ship.chi[1][0] = 0.05;
    });
    // Headings N, NE, E, SE, S, SW, W, NW; + east, - west, 0 none.
    for (cause, ship, expected) in [
        ("red pole aft", forward, "0+++0---"),
        ("red pole to port", starboard, "++0---0+"),
        ("vertical iron", forward_from_vertical, "0+++0---"),
        ("fore-and-aft iron", fore_and_aft_iron, "0+0-0+0-"),
        ("lopsided iron", lopsided, "+0-0+0-0"),
    ] {
        for (step, sign) in expected.chars().enumerate() {
            let magnetic = (step as f64 * 45.0).to_radians();
            let deviation = ship.deviation_rad(magnetic, NORTH_EUROPE);
            let found = match deviation {
                d if d > 1e-3 => '+',
                d if d < -1e-3 => '-',
                _ => '0',
            };
            // Second-order effects may be seen between the four nodes, never at them.
            assert_eq!(found, sign, "{cause} on {}: {deviation}", step * 45);
        }
    }
    let south = EarthField {
        z_nt: -45_000.0,
        ..NORTH_EUROPE
    };
    let east = 90_f64.to_radians();
    assert!(forward_from_vertical.deviation_rad(east, south) < 0.0);
}

#[test]
fn the_parameters_over_lambda_give_the_ships_own_deviation() {
    let mut rng = ChaCha8Rng::seed_from_u64(1);
    for _ in 0..200 {
        let (ship, earth) = (random_ship(&mut rng), random_earth(&mut rng));
        let parameters = ship.parameters_over_lambda().unwrap();
        let again = ShipMagnetism::from_parameters(&parameters, ship.lambda());
        for degrees in (0..360).step_by(10) {
            let magnetic = f64::from(degrees).to_radians();
            let poisson = ship.deviation_rad(magnetic, earth);
            let linearised = parameters.linearised_at_magnetic(magnetic, earth);
            assert!(wrap_pi(linearised.deviation_rad - poisson).abs() < 1e-9);
            assert!(wrap_pi(again.deviation_rad(magnetic, earth) - poisson).abs() < 1e-9);
        }
    }
}

#[test]
fn the_gradient_at_a_fixed_magnetic_heading_is_that_of_finite_differences() {
    let mut rng = ChaCha8Rng::seed_from_u64(2);
    for _ in 0..50 {
        let earth = random_earth(&mut rng);
        let parameters = random_ship(&mut rng).parameters_over_lambda().unwrap();
        let magnetic = rng.random_range(0.0..std::f64::consts::TAU);
        let [forward, starboard] = parameters.field_over_lambda(magnetic, earth);
        if forward.hypot(starboard) < 0.3 * earth.h_nt {
            continue;
        }
        let gradient = parameters.linearised_at_magnetic(magnetic, earth).gradient;
        for (index, analytic) in gradient.into_iter().enumerate() {
            let step = if index == 0 || index == 2 { 0.1 } else { 1e-6 };
            let moved = |by: f64| {
                let mut array = parameters.to_array();
                array[index] += by;
                Parameters::from_array(array)
                    .linearised_at_magnetic(magnetic, earth)
                    .deviation_rad
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

#[test]
fn a_ship_that_turns_the_compass_around_has_no_parameters() {
    let mut ship = NO_SHIP;
    ship.chi[0][0] = -1.5;
    ship.chi[1][1] = -0.5;
    assert_eq!(ship.parameters_over_lambda(), Err(NoShieldingFactor(0.0)));
    ship.b_nt[0] = f64::NAN;
    ship.chi[0][0] = f64::NAN;
    assert!(ship.parameters_over_lambda().is_err());
}
