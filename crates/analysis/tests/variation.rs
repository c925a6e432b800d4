//! References whose variation is wrong are refused by name; the ship's own changes are not
//! taken for it.

#![allow(clippy::unwrap_used)] // all of this is tests

use binnacle_analysis::fit::{HeadingReading, check_references};
use binnacle_compass::angle::{CompassHeading, TrueHeading, Variation};
use binnacle_compass::model::VariationMistake;
use binnacle_compass::result::FitError;
use binnacle_compass::time::Timestamp;
use rand::{RngExt, SeedableRng};
use rand_chacha::ChaCha8Rng;

const ROWS: u32 = 600;

/// Returns ten-minute rows of a passage with these variations at its ends; the compass's zero
/// steps by so much halfway, and the reference is off by so many variations.
fn passage(
    seed: u64,
    variations_deg: (f64, f64),
    step_deg: f64,
    variations_in_error: f64,
) -> Vec<HeadingReading> {
    let mut rng = ChaCha8Rng::seed_from_u64(seed);
    let start = Timestamp::parse("2026-03-01T00:00:00Z").unwrap();
    let mut course = 0.0;
    let row = |row: u32| {
        if row.is_multiple_of(6) {
            course = 360.0 * rng.random::<f64>();
        }
        let along = f64::from(row) / f64::from(ROWS);
        let (from, to) = variations_deg;
        let variation_deg = from + (to - from) * along;
        let magnetic_deg = course - variation_deg + rng.random::<f64>();
        let deviation_deg = 5.0 * magnetic_deg.to_radians().sin();
        let zero_deg = if along < 0.5 { 0.0 } else { step_deg };
        let true_deg = magnetic_deg + variation_deg + 0.6 * (rng.random::<f64>() - 0.5);
        HeadingReading {
            time: Some(start.plus_seconds(600.0 * f64::from(row))),
            position: None,
            compass: CompassHeading::new(magnetic_deg - deviation_deg - zero_deg).unwrap(),
            gyro: TrueHeading::new(true_deg + variations_in_error * variation_deg),
            satellite: None,
            unnamed: None,
            variation: Variation::new(variation_deg).unwrap(),
            h_nt: 24_000.0 + 8_000.0 * along,
            z_nt: 40_000.0 - 60_000.0 * along,
            sog_kn: Some(12.0),
            windows: 55,
            spread_deg: Some(0.4),
            weight: 1.0,
        }
    };
    (0..ROWS).map(row).collect()
}

#[test]
fn a_mistake_about_the_variation_is_named() {
    for seed in 0..10 {
        for variations_deg in [(-18.0, 2.0), (12.0, -4.0), (20.0, 10.0)] {
            for expected in VariationMistake::ALL {
                let off = expected.variations_in_error();
                let checked = check_references(&passage(seed, variations_deg, 0.0, off));
                assert!(
                    matches!(
                        checked,
                        Err(FitError::VariationMistaken { mistake, .. }) if mistake == expected
                    ),
                    "{seed} {variations_deg:?} {expected:?}: {checked:?}"
                );
            }
        }
    }
}

#[test]
fn a_true_heading_passes_and_so_does_a_compass_that_was_turned_on_the_way() {
    for seed in 0..10 {
        for step_deg in [0.0, 3.0, -5.0, 10.0, -20.0] {
            for variations_deg in [(-18.0, 2.0), (12.0, -4.0), (-5.0, 5.0)] {
                let checked = check_references(&passage(seed, variations_deg, step_deg, 0.0));
                assert_eq!(checked, Ok(()), "{seed} {step_deg} {variations_deg:?}");
            }
        }
    }
}

#[test]
fn where_the_variation_is_the_same_all_the_way_it_shows_no_mistake() {
    let magnetic = passage(1, (-8.0, -8.2), 0.0, -1.0);
    assert_eq!(check_references(&magnetic), Ok(()));
}
